//! The way of key-frames to the device: through mapped memory of a fixed size, part by part, on the queue for copies.

use crate::{Buffer, BufferDesc, BufferKind, Context, Error, Result, context::Moment};
use ash::vk;
use std::sync::Arc;

/// What orders the copies and the frames that read them, and tells how long copies took.
pub(super) struct Timeline {
    context: Context,
    semaphore: vk::Semaphore,
    /// Two timestamps a slot; null on a queue without a clock.
    queries: vk::QueryPool,
    timestamp_bits: u32,
}

impl std::fmt::Debug for Timeline {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Timeline").finish_non_exhaustive()
    }
}

impl Timeline {
    /// With a pair of timestamps for each of so many slots.
    pub(super) fn new(context: &Context, slots: u32) -> Result<Timeline> {
        let timestamp_bits = context.copy_timestamp_bits();
        let mut timeline = Timeline {
            context: context.clone(),
            semaphore: vk::Semaphore::null(),
            queries: vk::QueryPool::null(),
            timestamp_bits: if context.has_timestamps() { timestamp_bits } else { 0 },
        };
        let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE).initial_value(0);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
        // SAFETY: the device lives and has timeline semaphores enabled.
        timeline.semaphore = unsafe { context.device().create_semaphore(&info, None) }.map_err(Error::vulkan("vkCreateSemaphore"))?;
        if timeline.timestamp_bits > 0 && slots > 0 {
            let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2 * slots);
            // SAFETY: the device lives; the queue for copies has timestamps.
            timeline.queries = unsafe { context.device().create_query_pool(&info, None) }.map_err(Error::vulkan("vkCreateQueryPool"))?;
        }
        Ok(timeline)
    }

    pub(super) fn moment(&self, value: u64) -> Moment {
        Moment { semaphore: self.semaphore, value }
    }

    /// Waits on the host until the copies with this value are done.
    pub(super) fn wait(&self, value: u64) -> Result<()> {
        self.context.wait("the upload of a key-frame", self.moment(value))
    }

    /// Device milliseconds of a slot's last copies, which were waited for; 0 without a clock.
    pub(super) fn milliseconds(&self, slot: u32) -> Result<f64> {
        if self.queries == vk::QueryPool::null() {
            return Ok(0.0);
        }
        let mut stamps = [0_u64; 2];
        // SAFETY: the pool holds a pair for the slot, and the finished submissions have written both.
        unsafe {
            self.context.device().get_query_pool_results(
                self.queries,
                2 * slot,
                &mut stamps,
                vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT,
            )
        }
        .map_err(Error::vulkan("vkGetQueryPoolResults"))?;
        let mask = 1_u64.checked_shl(self.timestamp_bits).map_or(u64::MAX, |bit| bit - 1);
        let period = f64::from(self.context.device_info().limits.timestamp_period_ns);
        Ok((stamps[1].wrapping_sub(stamps[0]) & mask) as f64 * period * 1e-6)
    }

    fn reset(&self, slot: u32) {
        if self.queries != vk::QueryPool::null() {
            // SAFETY: host resets are enabled where there is a pool; no submission that writes this pair is pending.
            unsafe { self.context.device().reset_query_pool(self.queries, 2 * slot, 2) };
        }
    }

    fn stamp(&self, cmd: vk::CommandBuffer, query: u32) {
        if self.queries != vk::QueryPool::null() {
            // SAFETY: the command buffer is recording, for a family with timestamps; the query was reset and is written once.
            unsafe { self.context.device().cmd_write_timestamp2(cmd, vk::PipelineStageFlags2::ALL_COMMANDS, self.queries, query) };
        }
    }
}

impl Drop for Timeline {
    fn drop(&mut self) {
        self.context.destroy(|device| {
            // SAFETY: the thread that submitted copies has waited for them and ended; null handles may be destroyed.
            unsafe {
                device.destroy_query_pool(self.queries, None);
                device.destroy_semaphore(self.semaphore, None);
            }
        });
    }
}

/// Bytes on their way, and where they go to.
#[derive(Clone, Copy)]
pub(super) struct Parcel<'a> {
    /// A multiple of 4 in number.
    pub(super) bytes: &'a [u8],
    /// Offset in the buffer, a multiple of 4; there is room for all bytes.
    pub(super) offset: u64,
}

/// Mapped memory in parts, each with a command buffer: while the device copies out of one, the host fills the next.
pub(super) struct Staging {
    timeline: Arc<Timeline>,
    context: Context,
    memory: Buffer,
    part_bytes: usize,
    pool: vk::CommandPool,
    parts: [Part; PARTS],
    next: usize,
    /// Of the last submission.
    value: u64,
}

#[derive(Clone, Copy, Default)]
struct Part {
    cmd: vk::CommandBuffer,
    /// When the device is done with it.
    value: u64,
}

const PARTS: usize = 4;

/// Below this a part is not worth its submission.
const LEAST_PART: u64 = 4096;

impl Staging {
    pub(super) fn new(context: &Context, timeline: &Arc<Timeline>, bytes: u64) -> Result<Staging> {
        let part_bytes = (bytes / PARTS as u64).max(LEAST_PART) & !15;
        let size = part_bytes * PARTS as u64;
        let desc = BufferDesc { name: "key-frame staging", size, kind: BufferKind::Upload, dedicated: false };
        let mut staging = Staging {
            timeline: Arc::clone(timeline),
            context: context.clone(),
            memory: context.buffer(&desc)?,
            part_bytes: part_bytes as usize,
            pool: vk::CommandPool::null(),
            parts: [Part::default(); PARTS],
            next: 0,
            value: 0,
        };
        let device = context.device();
        let info = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::TRANSIENT | vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER)
            .queue_family_index(context.copy_family());
        // SAFETY: the device lives and has a queue of the family; the pool is owned by `staging` from its creation.
        let buffers = unsafe {
            staging.pool = device.create_command_pool(&info, None).map_err(Error::vulkan("vkCreateCommandPool"))?;
            let info = vk::CommandBufferAllocateInfo::default().command_pool(staging.pool).command_buffer_count(PARTS as u32);
            device.allocate_command_buffers(&info).map_err(Error::vulkan("vkAllocateCommandBuffers"))?
        };
        for (part, cmd) in staging.parts.iter_mut().zip(buffers) {
            part.cmd = cmd;
        }
        Ok(staging)
    }

    /// Brings parcels to a buffer; `slot` names the pair of timestamps. Returns the value of the timeline at which they have arrived. What
    /// is borrowed was copied by then.
    ///
    /// # Safety
    /// The buffer is not freed before that value was waited for, and nothing else reads or writes it until then; what was sent for the same
    /// slot before was waited for.
    pub(super) unsafe fn send(&mut self, to: &Buffer, slot: u32, parcels: &[Parcel<'_>]) -> Result<u64> {
        let mut regions = Vec::with_capacity(parcels.len());
        let mut filled = 0;
        self.begin()?;
        self.timeline.reset(slot);
        self.timeline.stamp(self.parts[self.next].cmd, 2 * slot);
        for parcel in parcels {
            let (mut rest, mut offset) = (parcel.bytes, parcel.offset);
            while !rest.is_empty() {
                if filled == self.part_bytes {
                    // SAFETY: the caller's contract.
                    unsafe { self.submit(to, &regions) }?;
                    (filled, regions) = (0, Vec::with_capacity(parcels.len()));
                    self.begin()?;
                }
                let (piece, after) = rest.split_at(rest.len().min(self.part_bytes - filled));
                let at = self.next * self.part_bytes + filled;
                self.fill(at, piece)?;
                regions.push(vk::BufferCopy { src_offset: at as u64, dst_offset: offset, size: piece.len() as u64 });
                filled += piece.len();
                offset += piece.len() as u64;
                rest = after;
            }
        }
        // SAFETY: the caller's contract.
        unsafe { self.record(to, &regions) };
        self.timeline.stamp(self.parts[self.next].cmd, 2 * slot + 1);
        // SAFETY: the caller's contract.
        unsafe { self.submit(to, &[]) }?;
        Ok(self.value)
    }

    /// Waits for the part whose turn it is and begins to record its commands.
    fn begin(&mut self) -> Result<()> {
        let part = self.parts[self.next];
        if part.value > 0 {
            self.timeline.wait(part.value)?;
        }
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        let device = self.context.device();
        // SAFETY: the command buffer's last submission was waited for, and its pool resets buffers as they begin.
        unsafe { device.begin_command_buffer(part.cmd, &info) }.map_err(Error::vulkan("vkBeginCommandBuffer"))
    }

    fn fill(&self, at: usize, bytes: &[u8]) -> Result<()> {
        let Some(pointer) = self.memory.pointer() else {
            let reason = "the host cannot see upload memory".to_owned();
            return Err(Error::Allocator { name: self.memory.name().to_owned(), reason });
        };
        debug_assert!((at + bytes.len()) as u64 <= self.memory.size());
        // SAFETY: the memory maps all its bytes from `pointer`, and the range lies within the part whose turn it is, which the device has
        // finished with; this thread alone writes it.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), pointer.add(at), bytes.len()) };
        Ok(())
    }

    /// # Safety
    /// As for [`Staging::send`].
    unsafe fn record(&self, to: &Buffer, regions: &[vk::BufferCopy]) {
        if !regions.is_empty() {
            let cmd = self.parts[self.next].cmd;
            // SAFETY: the command buffer is recording; the regions lie within both buffers, and do not overlap in the target.
            unsafe { self.context.device().cmd_copy_buffer(cmd, self.memory.raw(), to.raw(), regions) };
        }
    }

    /// Records what is left, ends and submits, and goes on to the next part.
    ///
    /// # Safety
    /// As for [`Staging::send`].
    unsafe fn submit(&mut self, to: &Buffer, regions: &[vk::BufferCopy]) -> Result<()> {
        // SAFETY: the caller's contract.
        unsafe { self.record(to, regions) };
        let part = &mut self.parts[self.next];
        // SAFETY: the command buffer is recording; it is not begun again before the value was waited for. The value is one above the last.
        unsafe {
            self.context.device().end_command_buffer(part.cmd).map_err(Error::vulkan("vkEndCommandBuffer"))?;
            self.context.submit_copies(part.cmd, self.timeline.moment(self.value + 1))?;
        }
        self.value += 1;
        part.value = self.value;
        self.next = (self.next + 1) % PARTS;
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // A failure to wait marks the context as given up, and then nothing is freed.
        let _ = self.timeline.wait(self.value);
        self.context.destroy(|device| {
            // SAFETY: every submission was waited for; a null pool may be destroyed, and a pool frees its command buffers.
            unsafe { device.destroy_command_pool(self.pool, None) };
        });
    }
}
