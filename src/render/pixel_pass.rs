//! Owns how a value is computed for each pixel of an image: by a compute shader, or by a fragment
//! shader that is drawn over all of it. Both are made of the same function of a pixel.
//!
//! On a GPU a compute shader needs no rasteriser and no blending. A software device spends more time
//! on starting each group of invocations than on a ray, and less on fragments; there, and only
//! there, pixels are drawn.
//!
//! Takes the shaders, what they are bound with, and the image; knows not what they compute.

use std::sync::Arc;

use ash::vk;
use bytemuck::Pod;

use crate::gpu::{
    Attachment, Binding, Device, EyeImage, Graphics, Load, Pipeline, PipelineLayout, Recorder,
    Result, Use,
};
use crate::surface::PixelRect;

/// Pixels along the edge of the square that one group of invocations works on
/// (shaders/square.wgsl).
const SQUARE_PX: u32 = 8;

/// The kind of shader.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PixelStage {
    Compute,
    Fragment,
}

impl PixelStage {
    pub const ALL: [PixelStage; 2] = [PixelStage::Compute, PixelStage::Fragment];

    /// The faster one on `device`.
    pub fn of(device: &Device) -> PixelStage {
        if device.is_software() { PixelStage::Fragment } else { PixelStage::Compute }
    }

    pub(super) fn flags(self) -> vk::ShaderStageFlags {
        match self {
            PixelStage::Compute => vk::ShaderStageFlags::COMPUTE,
            PixelStage::Fragment => vk::ShaderStageFlags::FRAGMENT,
        }
    }

    /// The bindings of a pass: `inputs`, and the image that it writes where a shader needs one.
    pub(super) fn bindings(
        self,
        inputs: &[(u32, vk::DescriptorType)],
        target: u32,
    ) -> Vec<Binding> {
        let image =
            (self == PixelStage::Compute).then_some((target, vk::DescriptorType::STORAGE_IMAGE));
        let all = inputs.iter().copied().chain(image);
        all.map(|(binding, kind)| (binding, kind, self.flags())).collect()
    }

    /// How an image is used that a pass writes.
    pub(super) fn target_usage(self) -> vk::ImageUsageFlags {
        match self {
            PixelStage::Compute => vk::ImageUsageFlags::STORAGE,
            PixelStage::Fragment => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        }
    }
}

/// The pixels that a pass has to compute.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelArea {
    /// Those to be made anew. A compute shader makes all of them anew.
    pub area: PixelRect,
    /// Those that have a value of their own.
    pub part: PixelRect,
    /// What the others get.
    pub rest: Load,
}

/// The two forms of a pass.
pub(super) struct PixelShaders {
    pub name: &'static str,
    pub compute: &'static [u32],
    pub fragment: &'static [u32],
    /// Of the image that is written.
    pub format: vk::Format,
}

/// A pass over the pixels of an image.
pub(super) struct PixelPass {
    pipeline: Pipeline,
    stage: PixelStage,
}

impl PixelPass {
    /// `constants`: the specialization constants of the shaders, from number 0 on.
    pub fn new(
        device: &Arc<Device>,
        shaders: &PixelShaders,
        stage: PixelStage,
        layout: &Arc<PipelineLayout>,
        constants: &[u32],
    ) -> Result<PixelPass> {
        let PixelShaders { name, compute, fragment, format } = *shaders;
        let pipeline = match stage {
            PixelStage::Compute => Pipeline::compute(device, name, compute, layout, constants),
            PixelStage::Fragment => {
                let pass = Graphics::screen(name, fragment, layout, format, None);
                Pipeline::graphics(device, &Graphics { constants, ..pass })
            }
        };
        Ok(PixelPass { pipeline: pipeline?, stage })
    }

    pub fn stage(&self) -> PixelStage {
        self.stage
    }

    /// Records the computation of the layer of `eye` of `target`; outside of rendering.
    /// A compute shader finds it in `set`. Leaves it in the layout of what wrote it.
    pub fn record<T: Pod>(
        &self,
        recorder: &mut Recorder,
        set: vk::DescriptorSet,
        constants: Option<&T>,
        target: &mut EyeImage,
        eye: u32,
        area: PixelArea,
    ) {
        let size = target.size();
        match self.stage {
            PixelStage::Compute => target.renew(recorder, eye, Use::SHADER_WRITE),
            PixelStage::Fragment => {
                target.renew_area(recorder, eye, area.area.corner_and_size(), Use::COLOUR_TARGET);
                let view = target.image().layer_view(eye);
                let colour = Some(Attachment { view, load: area.rest, store: true });
                let place = area.area.corner_and_size();
                recorder.begin_rendering_in(size.to_array(), place, colour, None);
            }
        }
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, set);
        if let Some(constants) = constants {
            recorder.push(self.pipeline.layout(), constants);
        }
        match self.stage {
            PixelStage::Compute => {
                let groups = (size + (SQUARE_PX - 1)) / SQUARE_PX;
                recorder.dispatch([groups.x, groups.y, 1]);
            }
            PixelStage::Fragment => {
                let ([x, y], [width, height]) = area.area.intersect(area.part).corner_and_size();
                recorder.set_scissor([x, y, width, height]);
                recorder.draw(3, 1);
                recorder.end_rendering();
            }
        }
    }
}
