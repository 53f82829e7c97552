//! Compaction in order: the place of every set flag among those before it, and the length of the queue that they make.

use crate::{
    Context, Result, kernels,
    pipeline::{Pipeline, Recorder},
    push,
};

/// Flags that one workgroup scans: `FLAG_BLOCK` in `render/shared/flags.glsl`.
const FLAG_BLOCK: u32 = 2048;

/// Sums of blocks that a compaction of at most `capacity` flags keeps, in words.
pub(crate) fn sum_count(capacity: u32) -> u32 {
    capacity.div_ceil(FLAG_BLOCK)
}

/// The three kernels of the compaction.
pub(crate) struct Compaction {
    reduce: Pipeline,
    spine: Pipeline,
    downsweep: Pipeline,
}

/// Device addresses of what a compaction reads and writes.
#[derive(Clone, Copy)]
pub(crate) struct CompactionInfo {
    /// The most flags that there may be.
    pub(crate) capacity: u32,
    /// Header of the queue that is flagged: how many flags there are.
    pub(crate) queue: u64,
    /// A word a flag, 0 or 1.
    pub(crate) flags: u64,
    /// Scratch of [`sum_count`] words.
    pub(crate) sums: u64,
    /// A word a flag: its place.
    pub(crate) offsets: u64,
    /// Header of the queue that the set flags make.
    pub(crate) next: u64,
}

impl Compaction {
    pub(crate) fn new(context: &Context) -> Result<Compaction> {
        Ok(Compaction {
            reduce: Pipeline::new(context, &kernels::FLAG_REDUCE, &[])?,
            spine: Pipeline::new(context, &kernels::FLAG_SPINE, &[])?,
            downsweep: Pipeline::new(context, &kernels::FLAG_DOWNSWEEP, &[])?,
        })
    }

    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, info: &CompactionInfo) {
        let CompactionInfo { capacity, queue, flags, sums, offsets, next } = *info;
        let blocks = gridwalk::split_workgroups(sum_count(capacity));
        recorder.dispatch(&self.reduce, &push::FlagReduce { queue, flags, sums }, blocks);
        recorder.dispatch(&self.spine, &push::FlagSpine { queue, sums, next }, [1, 1, 1]);
        recorder.dispatch(&self.downsweep, &push::FlagDownsweep { queue, flags, sums, offsets }, blocks);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that fails panics")]
mod tests {
    use super::*;
    use crate::{ContextDesc, layout::QueueHeader, pipeline::Timer};

    const CANARY: u32 = 0xDEAD_BEEF;

    /// What the kernels compute: an exclusive prefix sum, and the total.
    fn places(flags: &[u32]) -> (Vec<u32>, u32) {
        let mut sum = 0;
        let mut place = |flag| {
            sum += flag;
            sum - flag
        };
        (flags.iter().map(|&flag| place(flag)).collect(), sum)
    }

    fn compact(context: &Context, compaction: &Compaction, flags: &[u32], capacity: u32) -> (Vec<u32>, QueueHeader) {
        let guarded = |name, words: u32| context.upload(name, &vec![CANARY; words as usize + 16]).unwrap();
        let count = flags.len() as u32;
        let headers = context.upload("headers", &[QueueHeader { count, ..QueueHeader::default() }, QueueHeader::default()]).unwrap();
        let (given, sums, offsets) = (guarded("flags", capacity), guarded("sums", sum_count(capacity)), guarded("offsets", capacity));
        given.write(0, flags).unwrap();
        let info = CompactionInfo {
            capacity,
            queue: headers.address(),
            flags: given.address(),
            sums: sums.address(),
            offsets: offsets.address(),
            next: headers.address() + size_of::<QueueHeader>() as u64,
        };
        let mut timer = Timer::new(context).unwrap();
        context
            .submit("compaction", |cmd| {
                compaction.record(&mut Recorder::new(context, cmd, &mut timer), &info);
                Ok(())
            })
            .unwrap();
        let beyond = offsets.read::<u32>(u64::from(count) * 4, (capacity - count) as usize + 16).unwrap();
        assert!(beyond.iter().all(|&word| word == CANARY), "{count} flags: a word behind the offsets was written");
        let beyond = sums.read::<u32>(u64::from(sum_count(count)) * 4, 16).unwrap();
        assert!(beyond.iter().all(|&word| word == CANARY), "{count} flags: a word behind the sums was written");
        assert_eq!(given.read::<u32>(0, flags.len()).unwrap(), flags);
        (offsets.read(0, flags.len()).unwrap(), headers.read(size_of::<QueueHeader>() as u64, 1).unwrap()[0])
    }

    #[test]
    fn places_are_those_of_a_scan() {
        let context =
            Context::new(&ContextDesc { validation: std::env::var("GRIDWALK_VALIDATE").as_deref() != Ok("0"), ..ContextDesc::default() })
                .unwrap();
        let compaction = Compaction::new(&context).unwrap();
        let edges = [64, 256, 2048, 4096, 65_536, 262_144, 256 * 2048];
        let sizes = [0, 1, 2, 3, 7].into_iter().chain(edges.into_iter().flat_map(|edge| [edge - 1, edge, edge + 1]));
        for size in sizes.chain([1_000_003]) {
            let mut state = 0x9E37_79B9_u32 ^ size;
            let mut random = || {
                state ^= state << 13;
                state ^= state >> 17;
                state ^= state << 5;
                state
            };
            let cases: [Vec<u32>; 4] = [
                (0..size).map(|_| random() & 1).collect(),
                (0..size).map(|_| u32::from(random() < 1 << 22)).collect(),
                vec![1; size as usize],
                vec![0; size as usize],
            ];
            for (case, flags) in cases.iter().enumerate() {
                // A queue may hold less than its capacity.
                for capacity in [size, size + 5000] {
                    let (offsets, header) = compact(&context, &compaction, flags, capacity);
                    let (expected, total) = places(flags);
                    assert!(
                        offsets == expected,
                        "size {size}, case {case}: first at {:?}",
                        offsets.iter().zip(&expected).position(|(a, b)| a != b)
                    );
                    let [x, y, z] = crate::pipeline::queue_groups(&context, total);
                    assert_eq!(
                        [header.count, header.groups_x, header.groups_y, header.groups_z],
                        [total, x, y, z],
                        "size {size}, case {case}"
                    );
                }
            }
        }
        assert_eq!(context.take_validation_messages(), Vec::<String>::new());
    }
}
