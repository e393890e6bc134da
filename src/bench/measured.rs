//! The measured values of pictures: the view that is rendered, and the times of its stages, with a device or without.
//!
//! Values alone; knows no renderer and no kernel.

use std::time::Duration;

use crate::render::RenderMode;
use crate::render::renderer::DeviceTimes;
use crate::shade::Lighting;
use crate::view::Eye;

/// The view to render.
#[derive(Clone, Copy)]
pub struct BenchScene<'a> {
    pub mode: RenderMode,
    /// One or two.
    pub eyes: &'a [Eye],
    pub lighting: Lighting,
}

/// The times of the stages of a picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Sampling, with upload and readback if the device samples.
    pub sample: Duration,
    /// The readback of the map, as a part of sampling.
    pub read_back: Option<Duration>,
    pub shade: Duration,
    /// Composition on the device.
    pub composite: Option<Duration>,
    /// By the device's time stamps.
    pub device: DeviceTimes,
}

impl StageTimes {
    pub fn whole(&self) -> Duration {
        self.sample + self.shade + self.composite.unwrap_or_default()
    }
}

/// The latency of a picture after an edit.
#[derive(Clone, Copy, Debug, Default)]
pub struct AfterEdit {
    /// Time until it was shaded.
    pub shaded: Duration,
    /// From there to the finished picture; `None` if the device shades as it draws, or there is no device.
    pub composite: Option<Duration>,
}
