use gridwalk::kernels::LEAF_SORT;
use gridwalk_core::dispatch::split_workgroups;
use gridwalk_core::layout::{BuildState, LeafArguments, SplitCell};
use gridwalk_core::split::leaf_count_of;
use gridwalk_core::twin::leaf_sort::leaf_sort;
use gridwalk_tests::gpu::Gpu;
use gridwalk_tests::random::Random;

use super::{assert_same, devices, untouched};

const FIRST_CELL: u32 = 5_000;
const LARGE_LEAF_BOX: u32 = 1 << 31;

/// What the kernel reads of some split cells.
#[derive(Default)]
struct Split {
    records: Vec<SplitCell>,
    offsets: Vec<u32>,
    masks: Vec<u32>,
    boxes: Vec<u32>,
    lists: Vec<u32>,
    // Of large boxes: the first pair and the leaf cells.
    keys: Vec<(usize, Vec<u32>)>,
    pairs: u32,
    leaf_cells: u32,
}

impl Split {
    /// A cell of this level (0: one that stays whole) and so many triangles, of which some have large boxes of at most so many leaf cells.
    fn push(&mut self, level: u32, list_length: u32, largest: u32, random: &mut Random) {
        let (first_reference, list_begin) = (self.offsets.len() as u32, self.lists.len() as u32);
        let (cell, leaf_begin) = (2 * self.records.len() as u32, self.leaf_cells);
        self.records.push(SplitCell { first_reference, list_begin, list_length, leaf_begin, cell, level, xy: 0, z: 0 });
        self.leaf_cells += if level > 0 { leaf_count_of(level) } else { 0 };
        for _ in 0..list_length {
            self.lists.push(3 * random.below(1 << 20));
            self.offsets.push(self.pairs);
            let along = 1 << level;
            if level > 1 && random.below(8) == 0 {
                let count = (33 + random.below(largest)).min(leaf_count_of(level));
                let step = leaf_count_of(level) / count;
                self.keys.push((self.pairs as usize, (0..count).map(|i| leaf_begin + i * step).collect()));
                self.masks.push(0);
                self.boxes.push(LARGE_LEAF_BOX);
                self.pairs += count;
                continue;
            }
            let mut sizes = [1; 3];
            for axis in 0..3 {
                sizes[axis] = 1 + random.below(along.min(32 / sizes.iter().product::<u32>()));
            }
            let low = sizes.map(|size| random.below(along - size + 1));
            let mask = if level > 0 { random.below(u32::MAX) & u32::MAX >> (32 - sizes.iter().product::<u32>()) } else { 0 };
            self.masks.push(mask);
            let first = low[0] + along * (low[1] + along * low[2]);
            self.boxes.push(first | (sizes[0] - 1) << 15 | (sizes[1] - 1) << 20 | level << 25);
            self.pairs += mask.count_ones();
        }
    }
}

/// Whether the pairs are left to the sort of all.
fn check(gpu: &Gpu, split: &Split, what: &str) -> bool {
    let shape = gpu.tracer.shape();
    let what = format!("{what}, {shape:?}");
    let first_pair = split.lists.len() + 7;
    let (references, pairs) = (split.lists.len() as u32, split.pairs as usize);
    let state = BuildState {
        offset_count: references + 1,
        pair_count: split.pairs,
        pass_count: 2,
        digit_bits: 4,
        first_pair: first_pair as u32,
        first_cell: FIRST_CELL,
        split_cells: split.records.len() as u32,
        ..BuildState::default()
    };
    let offsets: Vec<u32> = split.offsets.iter().copied().chain([split.pairs]).collect();
    let mut masks = [split.masks.clone(), untouched(first_pair + pairs - split.masks.len())].concat();
    for (pair, keys) in &split.keys {
        masks[first_pair + pair..][..keys.len()].copy_from_slice(keys);
    }
    let mut lists = [split.lists.clone(), untouched(7 + pairs)].concat();
    let mut cells = [vec![[3, 4]; FIRST_CELL as usize], vec![[0, 0]; split.leaf_cells as usize], vec![[5, 6]]].concat();
    let mut arguments = LeafArguments { count: [9, 1, 1, 0], ..LeafArguments::default() };
    let memory = [
        gpu.upload("leaf state", &[state]),
        gpu.upload("split cells", &split.records),
        gpu.upload("offsets", &offsets),
        gpu.upload("masks", &masks),
        gpu.upload("boxes", &split.boxes),
        gpu.upload("references", &lists),
        gpu.upload("cells", &cells),
        gpu.upload("leaf arguments", &[arguments]),
    ];
    let work = split.pairs + 2 * references + split.leaf_cells / 8;
    let groups = split_workgroups(work / shape.leaf_run + 1, shape.sort_size);
    gpu.launch(&LEAF_SORT, 0, &memory.each_ref(), &[3], groups);
    let records = &split.records;
    leaf_sort(&shape, groups, &state, records, &offsets, &masks, &split.boxes, &mut lists, &mut cells, &mut arguments, 3);
    assert_same(&format!("{what}: lists"), &memory[5].read::<u32>(0, lists.len()), &lists);
    assert_same(&format!("{what}: cells"), &memory[6].read::<[u32; 2]>(0, cells.len()), &cells);
    assert_same(&format!("{what}: arguments"), &memory[7].read::<LeafArguments>(0, 1), &[arguments]);
    arguments.emit != [0; 4]
}

#[test]
fn lists_of_leaf_cells() {
    for gpu in devices().into_iter().filter(|gpu| gpu.tracer.shape().leaf_run > 0) {
        let mut random = Random::new(1);
        for level in 1..=5 {
            let mut split = Split::default();
            split.push(level, 24 + random.below(100), 300, &mut random);
            assert!(!check(gpu, &split, &format!("one of level {level}")));
        }
        let mut split = Split::default();
        for _ in 0..1_000 {
            let level = 1 + random.below(3);
            split.push(level, 24 + random.below(100), 60, &mut random);
        }
        split.push(5, 600, 60, &mut random);
        split.push(4, 200, 500, &mut random);
        // For these there was no room.
        (0..9).for_each(|_| split.push(0, 200, 0, &mut random));
        assert!(!check(gpu, &split, "many"));
        assert!(!check(gpu, &Split::default(), "none"));
    }
}

/// An invocation that would take too many turns does nothing but tell that all pairs are to be sorted. One that takes nearly as many as it
/// may does so to the end: lavapipe would cut it short without a word.
#[test]
fn lists_that_are_long_for_an_invocation() {
    for gpu in devices().into_iter().filter(|gpu| gpu.tracer.shape().leaf_run > 0) {
        let (shape, mut random) = (gpu.tracer.shape(), Random::new(2));
        let filled = |random: &mut Random, most: u32| {
            let mut split = Split::default();
            (0..30).for_each(|_| split.push(1, 30, 0, random));
            let work = |split: &Split| split.pairs + 2 * split.lists.len() as u32 + split.leaf_cells / 8;
            let begin = work(&split) / shape.leaf_run * shape.leaf_run;
            split.push(3, 24, 0, random);
            while work(&split) - begin < most {
                let more = &mut Split::default();
                more.push(3, 1, 60, random);
                let record = split.records.last_mut().unwrap();
                record.list_length += 1;
                split.keys.extend(
                    more.keys.iter().map(|(_, keys)| (split.pairs as usize, keys.iter().map(|key| key + record.leaf_begin).collect())),
                );
                split.offsets.push(split.pairs);
                split.pairs += more.pairs;
                split.lists.append(&mut more.lists);
                split.masks.append(&mut more.masks);
                split.boxes.append(&mut more.boxes);
            }
            (0..30).for_each(|_| split.push(2, 50, 0, random));
            split
        };
        let longest = filled(&mut random, 31_800);
        assert!(!check(gpu, &longest, "long"));
        let longer = filled(&mut random, 32_400);
        assert!(check(gpu, &longer, "too long"));
    }
}
