//! The background without video: a vertical gradient.
//!
//! Fills an eye's viewport and leaves the depth, which is cleared to infinity. Passes that draw the
//! sculpture follow and touch only its visible rect: a pixel of a gradient costs much less than one
//! whose ray misses the sculpture.

use std::sync::Arc;

use ash::vk;

use super::composite_eye::{Background, CompositeEye, constants, is_srgb};
use crate::gpu::layout::CompositeView;
use crate::gpu::{Depth, Device, Graphics, Pipeline, PipelineLayout, Recorder, Result, shaders};

/// Draws backgrounds.
pub(super) struct BackgroundPass {
    pipeline: Pipeline,
    /// The target stores linear values, encoded by the device.
    linear: bool,
}

impl BackgroundPass {
    /// Creates one for targets of `format` with a D32 depth buffer.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<BackgroundPass> {
        let push = Some((vk::ShaderStageFlags::FRAGMENT, size_of::<CompositeView>()));
        let layout = PipelineLayout::new(device, "background", None, push)?;
        let fragment = shaders::BACKGROUND_FRAG;
        let depth = Some(Depth::KEEP);
        let pass = Graphics::screen("background", fragment, &layout, format, depth);
        Ok(BackgroundPass { pipeline: Pipeline::graphics(device, &pass)?, linear: is_srgb(format) })
    }

    /// Draws the background of `view`, if it has one, within rendering.
    pub fn draw(&self, recorder: &mut Recorder, view: &CompositeEye) {
        if view.background == Background::Keep {
            return;
        }
        recorder.set_scissor(view.pixels_of(view.scissor));
        recorder.bind_pipeline(&self.pipeline);
        recorder.push(self.pipeline.layout(), &constants(view, self.linear));
        recorder.draw(3, 1);
    }
}
