//! Timestamps.

use crate::{Context, Error, Result};
use ash::vk;
use gridwalk::Timestamps;

/// A pool of timestamps; none on a queue that has no clock.
pub(crate) struct Queries {
    context: Context,
    pool: vk::QueryPool,
}

impl Queries {
    pub(crate) fn new(context: &Context, count: u32) -> Result<Queries> {
        let mut queries = Queries { context: context.clone(), pool: vk::QueryPool::null() };
        if context.has_timestamps() {
            let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(count);
            // SAFETY: the device lives and its queue has timestamps.
            queries.pool = unsafe { context.device().create_query_pool(&info, None) }.map_err(Error::vulkan("vkCreateQueryPool"))?;
        }
        Ok(queries)
    }

    pub(crate) fn timestamps(&self) -> Option<Timestamps> {
        (self.pool != vk::QueryPool::null()).then_some(Timestamps { pool: self.pool, first_query: 0 })
    }

    /// Records something between the first two timestamps, of at least two. The command buffer is recording outside of a render pass.
    pub(crate) fn around<R>(&self, cmd: vk::CommandBuffer, record: impl FnOnce() -> R) -> R {
        let (device, pool) = (self.context.device(), self.pool);
        let stamp = |query| {
            if pool != vk::QueryPool::null() {
                // SAFETY: the command buffer is recording (the caller is within `submit`); the pool is of this device, idle, and holds both
                // queries, each of which is reset in this command buffer before it is written once.
                unsafe {
                    device.cmd_reset_query_pool(cmd, pool, query, 1);
                    device.cmd_write_timestamp2(cmd, vk::PipelineStageFlags2::ALL_COMMANDS, pool, query);
                }
            }
        };
        stamp(0);
        let result = record();
        stamp(1);
        result
    }

    /// The first `count` queries, after the submission that wrote each of them; none without timestamps.
    pub(crate) fn read(&self, count: u32) -> Result<Vec<u64>> {
        if self.pool == vk::QueryPool::null() || count == 0 {
            return Ok(Vec::new());
        }
        let mut stamps = vec![0_u64; count as usize];
        // SAFETY: the pool has at least as many queries, all of which the finished submission has written.
        unsafe {
            self.context.device().get_query_pool_results(
                self.pool,
                0,
                &mut stamps,
                vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT,
            )
        }
        .map_err(Error::vulkan("vkGetQueryPoolResults"))?;
        Ok(stamps)
    }

    pub(crate) fn milliseconds(&self, begin: u64, end: u64) -> f64 {
        let limits = &self.context.device_info().limits;
        let mask = 1_u64.checked_shl(limits.timestamp_bits).map_or(u64::MAX, |bit| bit - 1);
        (end.wrapping_sub(begin) & mask) as f64 * f64::from(limits.timestamp_period_ns) * 1e-6
    }
}

impl Drop for Queries {
    fn drop(&mut self) {
        // SAFETY: every submission was waited for; a null pool may be destroyed.
        self.context.destroy(|device| unsafe { device.destroy_query_pool(self.pool, None) });
    }
}
