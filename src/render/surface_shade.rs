//! Owns shading on the device: a compute pass that makes the picture of an eye from its index map,
//! which never leaves the device.
//!
//! The picture is the software shader's ([`crate::shade::shade`]) but for rounding; alpha is 0 where
//! nothing is seen.

use std::sync::Arc;

use ash::vk;

use super::Volume;
use super::shading::{COLOURS, Surface, UNIFORMS, Uniforms, VOLUME};
use super::target::{EyeImage, IndexTarget};
use crate::gpu::{
    DescriptorSets, Device, FRAMES_IN_FLIGHT, Pipeline, PipelineLayout, Recorder, Result,
    SetLayout, Use, shaders,
};

const INDEX_MAP: u32 = 2;
const PICTURE: u32 = 3;

/// Pixels along the edge of the square that one group of invocations works on.
const GROUP_PX: u32 = 8;

/// Shades index maps.
pub struct SurfaceShade {
    pipeline: Pipeline,
    sets: DescriptorSets,
    /// The images that each set names: volume, index map, picture.
    named: Vec<(u64, u64, u64)>,
    uniforms: Uniforms,
    slot: usize,
    eyes: u32,
}

impl SurfaceShade {
    /// For up to `eyes` eyes a frame.
    pub fn new(device: &Arc<Device>, eyes: u32) -> Result<SurfaceShade> {
        let compute = vk::ShaderStageFlags::COMPUTE;
        let bindings = [
            (VOLUME, vk::DescriptorType::SAMPLED_IMAGE, compute),
            (INDEX_MAP, vk::DescriptorType::SAMPLED_IMAGE, compute),
            (PICTURE, vk::DescriptorType::STORAGE_IMAGE, compute),
            (COLOURS, vk::DescriptorType::STORAGE_BUFFER, compute),
            (UNIFORMS, vk::DescriptorType::UNIFORM_BUFFER, compute),
        ];
        let set_layout = SetLayout::new(device, "surface shade", &bindings)?;
        let layout = PipelineLayout::new(device, "surface shade", Some(&set_layout), None)?;
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(SurfaceShade {
            pipeline: Pipeline::compute(device, "surface shade", shaders::SHADE_COMP, &layout)?,
            sets: DescriptorSets::new(device, "surface shade", &set_layout, count)?,
            named: vec![(0, 0, 0); count],
            uniforms: Uniforms::new(device)?,
            slot: 0,
            eyes,
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.uniforms.begin(slot);
    }

    /// Records the picture of `eye` of `volume` from its map in `maps`, to its layer of `pictures`, which has
    /// the size of the maps and storage usage. Leaves it in the layout of [`Use::SHADER_READ`].
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        surface: &Surface,
        maps: &mut IndexTarget,
        pictures: &mut EyeImage,
        eye: u32,
    ) -> Result<()> {
        maps.make_readable(recorder, eye);
        pictures.renew(recorder, eye, Use::SHADER_WRITE);
        let set = self.slot * self.eyes as usize + eye as usize;
        let (volume, index, picture) = (volume.image(), maps.index().image(), pictures.image());
        let names = (volume.id(), index.id(), picture.id());
        if self.named[set] != names {
            self.named[set] = names;
            self.sets.write_sampled(set, VOLUME, volume.view());
            self.sets.write_sampled(set, INDEX_MAP, index.layer_view(eye));
            self.sets.write_storage(set, PICTURE, picture.layer_view(eye));
        }
        self.uniforms.write(&self.sets, set, surface)?;
        self.uniforms.write_colours(&self.sets, set, surface);
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, self.sets.set(set));
        let groups = (maps.size() + (GROUP_PX - 1)) / GROUP_PX;
        recorder.dispatch([groups.x, groups.y, 1]);
        pictures.make(recorder, eye, Use::SHADER_READ);
        Ok(())
    }
}
