//! Times of commands, by the device's clock.

use std::time::Instant;

use anyhow::Result;
use gridwalk::ash::vk;
use gridwalk_render::Context;

/// Two timestamps, around what is recorded.
pub struct Stopwatch {
    context: Context,
    /// Null on a device without a clock.
    pool: vk::QueryPool,
}

impl Stopwatch {
    /// Makes one.
    ///
    /// # Errors
    /// What the device reports.
    pub fn new(context: &Context) -> Result<Stopwatch> {
        let mut pool = vk::QueryPool::null();
        if context.has_timestamps() {
            let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2);
            // SAFETY: the device lives, and its queue has timestamps.
            pool = unsafe { context.device().create_query_pool(&info, None) }?;
        }
        Ok(Stopwatch { context: context.clone(), pool })
    }

    /// Records commands, submits them and waits; returns the milliseconds that they took, on the wall for a device without a clock.
    ///
    /// # Errors
    /// What the device reports.
    pub fn time(&self, label: &str, record: impl FnOnce(vk::CommandBuffer)) -> Result<f64> {
        let device = self.context.device();
        let has_clock = self.pool != vk::QueryPool::null();
        let stamp = |cmd, query| {
            if has_clock {
                // SAFETY: the command buffer is recording outside of a render pass, and resets the query before it writes it.
                unsafe { device.cmd_write_timestamp2(cmd, vk::PipelineStageFlags2::ALL_COMMANDS, self.pool, query) };
            }
        };
        let begin = Instant::now();
        self.context.submit(label, |cmd| {
            if has_clock {
                // SAFETY: the command buffer is recording, and no submission that uses the pool is under way: each is waited for.
                unsafe { device.cmd_reset_query_pool(cmd, self.pool, 0, 2) };
            }
            stamp(cmd, 0);
            record(cmd);
            let barrier = vk::MemoryBarrier2::default()
                .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
                .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
                .dst_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
                .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE);
            // SAFETY: the command buffer is recording outside of a render pass.
            unsafe { device.cmd_pipeline_barrier2(cmd, &vk::DependencyInfo::default().memory_barriers(&[barrier])) };
            stamp(cmd, 1);
            Ok(())
        })?;
        let wall = begin.elapsed().as_secs_f64() * 1e3;
        if !has_clock {
            return Ok(wall);
        }
        let mut stamps = [0_u64; 2];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the pool has two queries, which the finished submission has written.
        unsafe { device.get_query_pool_results(self.pool, 0, &mut stamps, flags) }?;
        let limits = &self.context.device_info().limits;
        let mask = 1_u64.checked_shl(limits.timestamp_bits).map_or(u64::MAX, |bit| bit - 1);
        Ok((stamps[1].wrapping_sub(stamps[0]) & mask) as f64 * f64::from(limits.timestamp_period_ns) * 1e-6)
    }
}

impl Drop for Stopwatch {
    fn drop(&mut self) {
        // SAFETY: every submission was waited for; a null pool may be destroyed.
        unsafe { self.context.device().destroy_query_pool(self.pool, None) };
    }
}
