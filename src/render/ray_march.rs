//! The ray march: each pixel's ray walks through the grid by words and voxels, from where its tile's beam
//! ([`super::beam`]) ends, and writes the first existing voxel to the index map.
//!
//! Uses the arithmetic of the ray caster on the CPU ([`crate::surface::raycast`]), so that the maps are equal up to
//! rounding on devices without exact division.
//!
//! Takes a volume and the rays of an eye; fills an [`IndexTarget`].

use std::sync::Arc;

use ash::vk;

use super::beam::{Beams, march_view};
use super::pixel_pass::{PixelArea, PixelPass, PixelShaders, PixelStage, PixelTarget};
use crate::gpu::layout::MarchView;
use crate::gpu::{
    DescriptorSets, Device, FRAMES_IN_FLIGHT, Load, PipelineLayout, Recorder, Result, SetLayout,
    shaders,
};
use crate::render::{EyeTask, IndexTarget, Volume};
use crate::sculpture::NO_VOXEL;

const VOLUME: u32 = 0;
const STARTS: u32 = 1;
const INDEX_MAP: u32 = 2;

const SHADERS: PixelShaders = PixelShaders {
    name: "ray march",
    compute: shaders::RAY_MARCH_COMP,
    fragment: shaders::RAY_MARCH_FRAG,
    format: vk::Format::R32_UINT,
};

/// Marches index maps.
pub struct RayMarch {
    pass: PixelPass,
    sets: DescriptorSets,
    /// The images that each set refers to: volume, index map, starts of rays.
    named: Vec<(u64, u64, u64)>,
    beams: Beams,
    slot: usize,
    eyes: u32,
}

impl RayMarch {
    /// Creates one for up to `eyes` eyes per frame.
    pub fn new(device: &Arc<Device>, stage: PixelStage, eyes: u32) -> Result<RayMarch> {
        let image = vk::DescriptorType::SAMPLED_IMAGE;
        let inputs = [VOLUME, STARTS].map(|binding| (binding, image));
        let set_layout = SetLayout::new(device, SHADERS.name, &stage.bindings(&inputs, INDEX_MAP))?;
        let push = Some((stage.flags(), size_of::<MarchView>()));
        let layout = PipelineLayout::new(device, SHADERS.name, Some(&set_layout), push)?;
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(RayMarch {
            pass: PixelPass::new(device, &SHADERS, stage, &layout, &[])?,
            sets: DescriptorSets::new(device, SHADERS.name, &set_layout, count)?,
            named: vec![(0, 0, 0); count],
            beams: Beams::new(device, stage, eyes)?,
            slot: 0,
            eyes,
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.beams.begin(slot);
    }

    /// Records the part of an index map described by `task`. Leaves the map as [`PixelPass::record`] does.
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        task: &EyeTask,
        target: &mut IndexTarget,
    ) -> Result<()> {
        let (eye, rays) = (task.eye, &task.rays);
        let starts = self.beams.record(recorder, volume, rays, eye)?;
        let set = self.slot * self.eyes as usize + eye as usize;
        let index = target.index().image();
        let names = (volume.image().id(), index.id(), starts.id());
        if self.named[set] != names {
            self.named[set] = names;
            self.sets.write_sampled(set, VOLUME, volume.image().view());
            self.sets.write_sampled(set, STARTS, starts.layer_view(eye));
            if self.pass.stage() == PixelStage::Compute {
                self.sets.write_storage(set, INDEX_MAP, index.layer_view(eye));
            }
        }
        let view = march_view(rays, volume);
        let rest = Load::Integers([NO_VOXEL; 4]);
        let area = PixelArea { scissor: task.scissor, visible: task.visible, rest };
        let set = self.sets.set(set);
        let target = PixelTarget { image: target.index_mut(), eye, area };
        self.pass.record(recorder, set, Some(&view), target);
        Ok(())
    }
}
