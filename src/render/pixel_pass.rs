//! Computes a value for each pixel of an image, by a compute shader or by a fragment shader that is drawn over all of
//! it. Both wrap the same function of a pixel.
//!
//! On a GPU a compute shader needs no rasteriser and no blending. A software device spends more time on starting a
//! workgroup than on a ray, and less on fragments: only there, pixels are drawn.
//!
//! Takes the shaders, their bindings, and the image; does not know their meaning.

use std::sync::Arc;

use ash::vk;
use bytemuck::Pod;

use crate::gpu::{
    Attachment, Binding, Device, EyeImage, Graphics, Load, Pipeline, PipelineLayout, Recorder,
    ResourceUse, Result,
};
use crate::surface::PixelRect;

/// Edge of the square of pixels that a workgroup computes (shaders/square.wgsl).
const SQUARE_PX: u32 = 8;

/// The kind of shader.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PixelStage {
    Compute,
    Fragment,
}

impl PixelStage {
    pub const ALL: [PixelStage; 2] = [PixelStage::Compute, PixelStage::Fragment];

    /// Returns the faster one on `device`.
    pub fn of(device: &Device) -> PixelStage {
        if device.is_software() { PixelStage::Fragment } else { PixelStage::Compute }
    }

    pub(super) fn flags(self) -> vk::ShaderStageFlags {
        match self {
            PixelStage::Compute => vk::ShaderStageFlags::COMPUTE,
            PixelStage::Fragment => vk::ShaderStageFlags::FRAGMENT,
        }
    }

    /// Returns the bindings of a pass: `inputs`, and the storage image that a compute shader writes.
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

    /// Returns the usage of the image while a pass writes it.
    pub(super) fn target_usage(self) -> vk::ImageUsageFlags {
        match self {
            PixelStage::Compute => vk::ImageUsageFlags::STORAGE,
            PixelStage::Fragment => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        }
    }
}

/// The pixels that a pass computes.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelArea {
    /// The pixels to compute again. A compute shader computes all of the image.
    pub scissor: PixelRect,
    /// The pixels with values of their own.
    pub visible: PixelRect,
    /// The value of all others.
    pub rest: Load,
}

/// The target layer of an image, and its pixels.
pub(super) struct PixelTarget<'a> {
    pub image: &'a mut EyeImage,
    pub eye: u32,
    pub area: PixelArea,
}

/// The two forms of a pass.
pub(super) struct PixelShaders {
    pub name: &'static str,
    pub compute: &'static [u32],
    pub fragment: &'static [u32],
    /// Format of the image.
    pub format: vk::Format,
}

/// A pass over the pixels of an image.
pub(super) struct PixelPass {
    pipeline: Pipeline,
    stage: PixelStage,
}

impl PixelPass {
    /// Creates a pass. `constants`: the specialization constants of the shaders, from number 0 on.
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

    /// Records the computation of `target`, outside of rendering. `set` binds it for a compute shader. Leaves it in the
    /// layout of the stage that wrote it.
    pub fn record<T: Pod>(
        &self,
        recorder: &mut Recorder,
        set: vk::DescriptorSet,
        constants: Option<&T>,
        target: PixelTarget,
    ) {
        let PixelTarget { image, eye, area } = target;
        let size = image.size();
        match self.stage {
            PixelStage::Compute => image.begin_overwrite(recorder, eye, ResourceUse::SHADER_WRITE),
            PixelStage::Fragment => {
                image.begin_overwrite_area(
                    recorder,
                    eye,
                    area.scissor.corner_and_size(),
                    ResourceUse::COLOUR_TARGET,
                );
                let view = image.image().layer_view(eye);
                let colour = Some(Attachment { view, load: area.rest, store: true });
                let place = area.scissor.corner_and_size();
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
                let ([x, y], [width, height]) =
                    area.scissor.intersect(area.visible).corner_and_size();
                recorder.set_scissor([x, y, width, height]);
                recorder.draw(3, 1);
                recorder.end_rendering();
            }
        }
    }
}
