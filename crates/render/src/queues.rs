//! The memory of the wavefront, kept from one picture to the next of the same shape.

use crate::{
    Buffer, BufferDesc, BufferKind, Context, Error, Result,
    compact::sum_count,
    layout::{CameraFrame, Film, FirstHitRecord, Path, QueueHeader, Surface, WaitingRay, Ways},
};
use bytemuck::{AnyBitPattern, NoUninit};
use gridwalk::{Hit, Ray};

/// What decides how large the queues are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct QueueShape {
    /// Pixels of a batch.
    pub(crate) capacity: u32,
    /// Headers: one for each bounce's queue and for each light's shadow rays from it.
    pub(crate) headers: u32,
    pub(crate) has_layers: bool,
    pub(crate) has_counts: bool,
    /// Bytes of the trace's scratch.
    pub(crate) scratch: u64,
    /// Rays of a pixel that may have to wait; 0 where no surface is seen through.
    pub(crate) waiting: u32,
}

/// What a pixel has still to follow, where surfaces are seen through.
pub(crate) struct WaySet {
    pub(crate) ways: Buffer,
    pub(crate) waiting: Buffer,
}

/// Everything that one batch of pixels needs.
pub(crate) struct Queues {
    pub(crate) shape: QueueShape,
    pub(crate) camera: Buffer,
    pub(crate) headers: Buffer,
    pub(crate) rays: [Buffer; 2],
    pub(crate) paths: [Buffer; 2],
    pub(crate) hits: Buffer,
    pub(crate) surfaces: Buffer,
    pub(crate) reflects: Buffer,
    pub(crate) shadows: Buffer,
    pub(crate) offsets: Buffer,
    pub(crate) sums: Buffer,
    pub(crate) shadow_rays: Buffer,
    pub(crate) shadow_paths: Buffer,
    pub(crate) occluded: Buffer,
    pub(crate) film: Buffer,
    pub(crate) unfinished: Buffer,
    pub(crate) scratch: Buffer,
    pub(crate) ways: Option<WaySet>,
    pub(crate) records: Option<Buffer>,
    pub(crate) counters: Option<Buffer>,
    /// The way back to the host, where it does not see the device's memory.
    pub(crate) readback: Option<Buffer>,
    /// Bytes of all these.
    pub(crate) bytes: u64,
}

impl Queues {
    pub(crate) fn new(context: &Context, shape: QueueShape) -> Result<Queues> {
        let mut bytes = 0;
        let mut sized = |name, size, kind| {
            let buffer = context.buffer(&BufferDesc { name, size, kind, dedicated: false })?;
            bytes += buffer.size();
            Ok::<_, Error>(buffer)
        };
        let mut buffer = |name, count: u32, size: usize| sized(name, u64::from(count) * size as u64, BufferKind::Device);
        let QueueShape { capacity, headers, has_layers, has_counts, scratch, waiting } = shape;
        let mut queues = Queues {
            shape,
            camera: buffer("camera", 1, size_of::<CameraFrame>())?,
            headers: buffer("queue headers", headers, size_of::<QueueHeader>())?,
            rays: [buffer("ray queue 0", capacity, size_of::<Ray>())?, buffer("ray queue 1", capacity, size_of::<Ray>())?],
            paths: [buffer("path queue 0", capacity, size_of::<Path>())?, buffer("path queue 1", capacity, size_of::<Path>())?],
            hits: buffer("hits", capacity, size_of::<Hit>())?,
            surfaces: buffer("surfaces", capacity, size_of::<Surface>())?,
            reflects: buffer("reflection flags", capacity, 4)?,
            shadows: buffer("shadow flags", capacity, 4)?,
            offsets: buffer("queue offsets", capacity, 4)?,
            sums: buffer("flag sums", sum_count(capacity), 4)?,
            shadow_rays: buffer("shadow ray queue", capacity, size_of::<Ray>())?,
            shadow_paths: buffer("shadow path queue", capacity, size_of::<Path>())?,
            occluded: buffer("occluded", capacity, 4)?,
            film: buffer("film", capacity, size_of::<Film>())?,
            unfinished: buffer("unfinished", capacity, 4)?,
            ways: if waiting > 0 {
                let waiting_bytes = waiting as usize * size_of::<WaitingRay>();
                Some(WaySet {
                    ways: buffer("ways", capacity, size_of::<Ways>())?,
                    waiting: buffer("waiting rays", capacity, waiting_bytes)?,
                })
            } else {
                None
            },
            records: if has_layers { Some(buffer("first hits", capacity, size_of::<FirstHitRecord>())?) } else { None },
            counters: if has_counts { Some(buffer("walk counters", capacity, 16)?) } else { None },
            scratch: sized("trace scratch", scratch, BufferKind::Device)?,
            readback: None,
            bytes: 0,
        };
        if !queues.film.is_seen() {
            let pixel = if has_layers { size_of::<FirstHitRecord>() } else { size_of::<Film>() };
            queues.readback = Some(sized("read-back", u64::from(capacity) * pixel as u64, BufferKind::Readback)?);
        }
        queues.bytes = bytes;
        Ok(queues)
    }

    /// The first elements of one of the buffers.
    ///
    /// # Errors
    /// As [`Buffer::read`].
    pub(crate) fn fetch<T: AnyBitPattern + NoUninit>(&self, buffer: &Buffer, count: usize) -> Result<Vec<T>> {
        buffer.read_by(self.readback.as_ref(), 0, count)
    }
}
