//! Shading on the device: a pass that makes the picture of an eye from its index map, which never leaves the device.
//!
//! The picture equals the software shader's ([`crate::shade::shade`]) up to rounding; alpha is 0 where nothing is
//! visible.

use std::sync::Arc;

use ash::vk;

use super::Volume;
use super::composite::PICTURE_FORMAT;
use super::pixel_pass::{PixelArea, PixelPass, PixelShaders, PixelStage, PixelTarget};
use super::shading::{
    COLOURS, KIND_CONSTANTS, LitSurface, MATCAP, NORMALS, UNIFORMS, Uniforms, VOLUME,
};
use super::specialised::Specialised;
use super::target::{EyeTask, IndexTarget};
use crate::gpu::{
    DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Load, PipelineLayout, Recorder,
    ResourceUse, Result, SetLayout, shaders,
};

const INDEX_MAP: u32 = 2;
const PICTURE: u32 = 3;

const SHADERS: PixelShaders = PixelShaders {
    name: "surface shade",
    compute: shaders::SHADE_COMP,
    fragment: shaders::SHADE_FRAG,
    format: PICTURE_FORMAT,
};

/// The index maps and their pictures, of the same size, with a layer of both per eye.
pub struct ShadingImages<'a> {
    pub maps: &'a mut IndexTarget,
    pub pictures: &'a mut EyeImage,
}

/// Shades index maps.
pub struct SurfaceShade {
    passes: Specialised<KIND_CONSTANTS, PixelPass>,
    stage: PixelStage,
    layout: Arc<PipelineLayout>,
    sets: DescriptorSets,
    /// The images that each set refers to: volume, index map, picture.
    named: Vec<(u64, u64, u64)>,
    uniforms: Uniforms,
    slot: usize,
    eyes: u32,
    device: Arc<Device>,
}

impl SurfaceShade {
    /// Creates one for up to `eyes` eyes per frame.
    pub fn new(device: &Arc<Device>, stage: PixelStage, eyes: u32) -> Result<SurfaceShade> {
        let inputs = [
            (VOLUME, vk::DescriptorType::SAMPLED_IMAGE),
            (INDEX_MAP, vk::DescriptorType::SAMPLED_IMAGE),
            (COLOURS, vk::DescriptorType::STORAGE_BUFFER),
            (NORMALS, vk::DescriptorType::STORAGE_BUFFER),
            (MATCAP, vk::DescriptorType::STORAGE_BUFFER),
            (UNIFORMS, vk::DescriptorType::UNIFORM_BUFFER),
        ];
        let set_layout = SetLayout::new(device, SHADERS.name, &stage.bindings(&inputs, PICTURE))?;
        let layout = PipelineLayout::new(device, SHADERS.name, Some(&set_layout), None)?;
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(SurfaceShade {
            passes: Specialised::new(),
            stage,
            layout,
            sets: DescriptorSets::new(device, SHADERS.name, &set_layout, count)?,
            named: vec![(0, 0, 0); count],
            uniforms: Uniforms::new(device)?,
            slot: 0,
            eyes,
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.uniforms.begin(slot);
    }

    /// Records the part of an eye's picture of `volume` described by `task`. Leaves it in the layout of
    /// [`ResourceUse::SHADER_READ`].
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        surface: &LitSurface,
        images: ShadingImages,
        task: &EyeTask,
    ) -> Result<()> {
        let ShadingImages { maps, pictures } = images;
        let eye = task.eye;
        maps.make_readable(recorder, eye);
        let set = self.slot * self.eyes as usize + eye as usize;
        let (volume, index, picture) = (volume.image(), maps.index().image(), pictures.image());
        let names = (volume.id(), index.id(), picture.id());
        if self.named[set] != names {
            self.named[set] = names;
            self.sets.write_sampled(set, VOLUME, volume.view());
            self.sets.write_sampled(set, INDEX_MAP, index.layer_view(eye));
            if self.stage == PixelStage::Compute {
                self.sets.write_storage(set, PICTURE, picture.layer_view(eye));
            }
        }
        self.uniforms.write(&self.sets, set, surface)?;
        self.uniforms.write_surface(&self.sets, set, surface);
        let rest = Load::Colour([0.0; 4]);
        let area = PixelArea { scissor: task.scissor, visible: task.visible, rest };
        let set = self.sets.set(set);
        let pass = self.passes.get(surface.kind(), |constants| {
            PixelPass::new(&self.device, &SHADERS, self.stage, &self.layout, constants)
        })?;
        let target = PixelTarget { image: &mut *pictures, eye, area };
        pass.record::<[u32; 0]>(recorder, set, None, target);
        pictures.transition(recorder, eye, ResourceUse::SHADER_READ);
        Ok(())
    }
}
