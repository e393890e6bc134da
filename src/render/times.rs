//! Owns what a renderer says of the time that its last picture took, and the device's clock for it.

use std::sync::Arc;

use super::{RenderMode, Shading};
use crate::gpu::{Device, Recorder, Result, Timer};

/// How long the parts of the last picture took, in milliseconds. What was not done anew keeps its
/// time.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct RenderTimes {
    /// Finding the voxel of every pixel, with upload and read-back.
    pub sample_ms: f32,
    /// Of these, bringing the maps from the device to memory, once they were complete; none where
    /// they stay or are made in memory.
    pub read_back_ms: Option<f32>,
    /// The software shader.
    pub shade_ms: f32,
    pub device: DeviceTimes,
}

/// How long the device took for its parts of a picture, for all eyes, by its own time stamps, in
/// milliseconds. None for what it has no part in, and where its queue has no time stamps.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct DeviceTimes {
    /// Slices or the march; uploads and read-back come on top.
    pub sample_ms: Option<f32>,
    /// The shader that turns index maps into pictures.
    pub shade_ms: Option<f32>,
    /// The composite, or what draws in its place: points, the shader that samples and lights at
    /// once; with background, tools and lines.
    pub compose_ms: Option<f32>,
}

/// Times the parts of pictures on the device, where it has time stamps.
pub(super) struct PictureTimer {
    timer: Option<Timer<2>>,
}

impl PictureTimer {
    pub const SHADE: usize = 0;
    pub const COMPOSE: usize = 1;

    pub fn new(device: &Arc<Device>) -> Result<PictureTimer> {
        Ok(PictureTimer { timer: Timer::new(device, "times of pictures")? })
    }

    /// Starts a frame that uses `slot` and draws `mode`. Notes in `times` what the slot's last
    /// frame took.
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

    /// Notes in `times` what the frame begun last took, which drew `mode`, if it is done.
    pub fn latest(&self, mode: RenderMode, times: &mut DeviceTimes) -> Result<()> {
        let Some(timer) = &self.timer else { return Ok(()) };
        note(timer.latest()?, mode, times);
        Ok(())
    }
}

/// Takes over what is known; `mode` is what is drawn now.
fn note([shade_ms, compose_ms]: [Option<f32>; 2], mode: RenderMode, times: &mut DeviceTimes) {
    // Of a former mode nothing is kept.
    let shades = mode.shading() == Shading::Device;
    times.shade_ms = shade_ms.or(times.shade_ms).filter(|_| shades);
    times.compose_ms = compose_ms.or(times.compose_ms);
}
