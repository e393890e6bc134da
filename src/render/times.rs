//! The times of a renderer's last picture, and the GPU timer for them.

use std::sync::Arc;

use super::{RenderMode, Shading};
use crate::gpu::{Device, Recorder, Result, Timer};

/// The times of the stages of the last picture, in milliseconds. A stage that was not repeated
/// keeps its time.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct RenderTimes {
    /// Sampling, with upload and readback.
    pub sample_ms: f32,
    /// The part of it that reads back complete maps; `None` if they stay on the device or are made in memory.
    pub read_back_ms: Option<f32>,
    /// The software shader.
    pub shade_ms: f32,
    pub device: DeviceTimes,
}

/// The device's times of a picture, for all eyes, by its own time stamps, in milliseconds. `None` for stages that do
/// not run on the device, and if its queue has no time stamps.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct DeviceTimes {
    /// Slices or the march, without upload and readback.
    pub sample_ms: Option<f32>,
    /// The shader from index maps to pictures.
    pub shade_ms: Option<f32>,
    /// The composite, or its replacement: points, or the shader that samples and lights; with background, tools and
    /// lines.
    pub compose_ms: Option<f32>,
}

/// Measures the stages of pictures on the device, if it has time stamps.
pub(super) struct PictureTimer {
    timer: Option<Timer<2>>,
}

impl PictureTimer {
    pub const SHADE: usize = 0;
    pub const COMPOSE: usize = 1;

    pub fn new(device: &Arc<Device>) -> Result<PictureTimer> {
        Ok(PictureTimer { timer: Timer::new(device, "times of pictures")? })
    }

    /// Starts a frame that uses `slot` and draws `mode`. Stores the times of the slot's last frame in `times`.
    pub fn begin(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        mode: RenderMode,
        times: &mut DeviceTimes,
    ) -> Result<()> {
        let Some(timer) = &mut self.timer else { return Ok(()) };
        note(timer.begin(recorder, slot)?, mode, times);
        Ok(())
    }

    pub fn start(&mut self, recorder: &mut Recorder, part: usize) {
        if let Some(timer) = &mut self.timer {
            timer.start(recorder, part);
        }
    }

    pub fn stop(&mut self, recorder: &mut Recorder, part: usize) {
        if let Some(timer) = &mut self.timer {
            timer.stop(recorder, part);
        }
    }

    /// Stores the times of the current frame, which drew `mode`, in `times` if it has finished.
    pub fn latest(&self, mode: RenderMode, times: &mut DeviceTimes) -> Result<()> {
        let Some(timer) = &self.timer else { return Ok(()) };
        note(timer.latest()?, mode, times);
        Ok(())
    }
}

/// Adopts the known times; `mode` is the present one.
fn note([shade_ms, compose_ms]: [Option<f32>; 2], mode: RenderMode, times: &mut DeviceTimes) {
    // Drops the times of another mode.
    let shades = mode.shading() == Shading::Device;
    times.shade_ms = shade_ms.or(times.shade_ms).filter(|_| shades);
    times.compose_ms = compose_ms.or(times.compose_ms);
}
