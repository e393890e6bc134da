//! GPU times of parts of frames: time stamps before and after each part.
//!
//! Nothing waits for them. The stamps of a slot are read when its next frame begins, since its last
//! one has finished then, or by a caller that has waited for a frame anyway.

use std::sync::Arc;

use ash::vk;

use super::commands::{FRAMES_IN_FLIGHT, Recorder, run_once};
use super::device::Device;
use super::error::{During, Result};
use super::retire::Retired;

/// Largest number of parts: each has a bit of a word.
const MAX_PARTS: usize = 32;

/// Measures `PARTS` parts of the recorded frames, each at most once a frame.
pub struct Timer<const PARTS: usize> {
    slots: Vec<TimingSlot>,
    /// The slot of the current frame.
    slot: usize,
    ms_per_tick: f64,
    /// Mask of the valid bits of a time stamp.
    mask: u64,
    device: Arc<Device>,
}

struct TimingSlot {
    pool: QueryPool,
    /// A bit for each part of the slot's last frame that was recorded completely.
    recorded: u32,
}

impl<const PARTS: usize> Timer<PARTS> {
    /// Creates a timer; `None` if the device's queue has no time stamps.
    pub fn new(device: &Arc<Device>, name: &str) -> Result<Option<Timer<PARTS>>> {
        const { assert!(0 < PARTS && PARTS <= MAX_PARTS) };
        let bits = device.time_stamp_bits();
        if bits == 0 {
            return Ok(None);
        }
        let slots = (0..FRAMES_IN_FLIGHT)
            .map(|_| Ok(TimingSlot { pool: QueryPool::new(device, name, PARTS)?, recorded: 0 }))
            .collect::<Result<Vec<_>>>()?;
        // An abandoned frame leaves its queries as they were, so they must have a value.
        run_once(device, |recorder| {
            slots.iter().for_each(|slot| slot.pool.reset(recorder));
            Ok(())
        })?;
        Ok(Some(Timer {
            slots,
            slot: 0,
            ms_per_tick: f64::from(device.limits().timestamp_period) * 1e-6,
            mask: u64::MAX >> (u64::BITS - bits.min(u64::BITS)),
            device: device.clone(),
        }))
    }

    /// Starts a frame that uses `slot`, outside of rendering. Returns the times of the parts of the
    /// slot's last frame, in milliseconds.
    pub fn begin(&mut self, recorder: &mut Recorder, slot: usize) -> Result<[Option<f32>; PARTS]> {
        self.slot = slot % FRAMES_IN_FLIGHT;
        let former = self.latest()?;
        let slot = &mut self.slots[self.slot];
        slot.recorded = 0;
        slot.pool.reset(recorder);
        Ok(former)
    }

    /// Starts `part` when all commands recorded so far have finished.
    pub fn start(&mut self, recorder: &mut Recorder, part: usize) {
        self.slots[self.slot].pool.stamp(recorder, 2 * part);
    }

    /// Ends `part` when all commands recorded so far have finished.
    pub fn stop(&mut self, recorder: &mut Recorder, part: usize) {
        let slot = &mut self.slots[self.slot];
        slot.pool.stamp(recorder, 2 * part + 1);
        slot.recorded |= 1 << part;
    }

    /// Returns the times of the parts of the current frame in milliseconds; `None` for parts that were not recorded or
    /// have not finished. The caller must have waited for the frame.
    pub fn latest(&self) -> Result<[Option<f32>; PARTS]> {
        let slot = &self.slots[self.slot];
        if slot.recorded == 0 {
            return Ok([None; PARTS]);
        }
        // Start and stop, each followed by a word that is not 0 once it is available.
        let mut stamps = [[[0u64; 2]; 2]; PARTS];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WITH_AVAILABILITY;
        let (pool, found) = (slot.pool.handle, stamps.as_flattened_mut());
        // SAFETY: the pool has one query per stamp, all of which were reset.
        match unsafe { self.device.raw().get_query_pool_results(pool, 0, found, flags) } {
            Ok(()) | Err(vk::Result::NOT_READY) => {}
            Err(error) => return Err(error).during("read time stamps"),
        }
        let mut times = [None; PARTS];
        for (part, (time, [start, stop])) in times.iter_mut().zip(stamps).enumerate() {
            if slot.recorded >> part & 1 == 1 && start[1] != 0 && stop[1] != 0 {
                let ticks = stop[0].wrapping_sub(start[0]) & self.mask;
                *time = Some((ticks as f64 * self.ms_per_tick) as f32);
            }
        }
        Ok(times)
    }
}

/// The queries of one frame.
struct QueryPool {
    handle: vk::QueryPool,
    count: u32,
    device: Arc<Device>,
}

impl QueryPool {
    fn new(device: &Arc<Device>, name: &str, parts: usize) -> Result<QueryPool> {
        let count = 2 * parts as u32;
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(count);
        // SAFETY: the info is complete.
        let handle =
            unsafe { device.raw().create_query_pool(&info, None) }.during("create time stamps")?;
        device.name(handle, name);
        Ok(QueryPool { handle, count, device: device.clone() })
    }

    fn reset(&self, recorder: &mut Recorder) {
        // SAFETY: recording, outside of rendering; the pool lives until the submission is done.
        unsafe {
            self.device.raw().cmd_reset_query_pool(recorder.raw(), self.handle, 0, self.count);
        }
    }

    fn stamp(&self, recorder: &mut Recorder, query: usize) {
        let stage = vk::PipelineStageFlags2::ALL_COMMANDS;
        let query = (query as u32).min(self.count - 1);
        // SAFETY: recording; the pool lives until the submission is done and has the query.
        unsafe {
            self.device.raw().cmd_write_timestamp2(recorder.raw(), stage, self.handle, query);
        }
    }
}

impl Drop for QueryPool {
    fn drop(&mut self) {
        self.device.retire(Retired::QueryPool(self.handle));
    }
}
