//! Draws what lies behind the sculpture: a calm vertical gradient.

use std::sync::Arc;

use ash::vk;

use crate::gpu::{
    Blend, Depth, Device, Graphics, Pipeline, PipelineLayout, Recorder, Result, shaders,
};
use crate::sculpture::Rgb;

/// Push constants of `background.frag.wgsl`.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Constants {
    top: [f32; 4],
    bottom: [f32; 4],
}

/// The colours at the upper and the lower edge.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Gradient {
    pub top: Rgb,
    pub bottom: Rgb,
}

/// The background's pass.
pub struct Background {
    pipeline: Pipeline,
}

impl Background {
    /// For a target of `colour` with a depth attachment of `depth`, which is left as it is.
    pub fn new(device: &Arc<Device>, colour: vk::Format, depth: vk::Format) -> Result<Background> {
        let push = Some((vk::ShaderStageFlags::FRAGMENT, size_of::<Constants>()));
        let layout = PipelineLayout::new(device, "background", None, push)?;
        let pipeline = Pipeline::graphics(
            device,
            &Graphics {
                name: "background",
                vertex: shaders::SCREEN_VERT,
                fragment: shaders::BACKGROUND_FRAG,
                layout: &layout,
                vertices: None,
                topology: vk::PrimitiveTopology::TRIANGLE_LIST,
                cull: vk::CullModeFlags::NONE,
                colour: Some((colour, Blend::Replace)),
                depth: Some(Depth { format: depth, compare: vk::CompareOp::ALWAYS, write: false }),
            },
        )?;
        Ok(Background { pipeline })
    }

    /// Records the background of a picture `height` pixels high.
    pub fn draw(&self, recorder: &mut Recorder, height: u32, gradient: &Gradient) {
        let colour = |Rgb(c): Rgb, w| {
            let [r, g, b] = c.map(|c| f32::from(c) / 255.0);
            [r, g, b, w]
        };
        let constants = Constants {
            top: colour(gradient.top, 0.0),
            bottom: colour(gradient.bottom, height as f32),
        };
        recorder.bind_pipeline(&self.pipeline);
        recorder.push(self.pipeline.layout(), &constants);
        recorder.draw(3, 1);
    }
}
