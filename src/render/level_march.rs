//! The march to the smooth surface: each pixel's ray walks through the cells from where its tile's beam ends
//! ([`super::beam`]), and writes the voxel nearest to the first place on the surface, with the normal there.
//!
//! Takes the device's copies of surface and normals and the rays of an eye; fills an [`IndexTarget`] that has normals.
//! The device's twin of [`crate::shade::LevelSampler`]: maps are equal except for rounding. Always a fragment shader:
//! it also computes parts of a picture, and devices need not support other ways to write such maps.

use std::sync::Arc;

use ash::vk;

use super::beam::{Beams, march_view};
use super::pixel_pass::{PixelArea, PixelPass, PixelShaders, PixelStage, PixelTarget};
use super::shading::NORMALS;
use super::target::MAP_WITH_NORMALS;
use super::{EyeTask, IndexTarget, Levels, Normals};
use crate::gpu::layout::MarchView;
use crate::gpu::{
    DescriptorSets, Device, FRAMES_IN_FLIGHT, Load, PipelineLayout, Recorder, Result, SetLayout,
    shaders,
};
use crate::sculpture::NO_VOXEL;
use crate::shade::LevelSet;

const CELLS: u32 = 0;
const STARTS: u32 = 1;
const LEVELS: u32 = 9;

const STAGE: PixelStage = PixelStage::Fragment;

const SHADERS: PixelShaders = PixelShaders {
    name: "smooth surface",
    compute: &[],
    fragment: shaders::LEVEL_MARCH_FRAG,
    format: MAP_WITH_NORMALS,
};

/// A part of an index map of the smooth surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LevelTask {
    pub part: EyeTask,
    /// Index of the sample of antialiased pictures, as in [`crate::shade::LevelSampler::sample`].
    pub sample: u32,
}

/// Marches index maps of the smooth surface.
pub struct LevelMarch {
    pass: PixelPass,
    sets: DescriptorSets,
    beams: Beams,
    slot: usize,
    eyes: u32,
}

impl LevelMarch {
    /// Creates one for up to `eyes` eyes per frame.
    pub fn new(device: &Arc<Device>, eyes: u32) -> Result<LevelMarch> {
        let image = vk::DescriptorType::SAMPLED_IMAGE;
        let buffer = vk::DescriptorType::STORAGE_BUFFER;
        let bindings = [(CELLS, image), (STARTS, image), (NORMALS, buffer), (LEVELS, buffer)]
            .map(|(binding, kind)| (binding, kind, STAGE.flags()));
        let set_layout = SetLayout::new(device, SHADERS.name, &bindings)?;
        let push = Some((STAGE.flags(), size_of::<MarchView>()));
        let layout = PipelineLayout::new(device, SHADERS.name, Some(&set_layout), push)?;
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(LevelMarch {
            pass: PixelPass::new(device, &SHADERS, STAGE, &layout, &[])?,
            sets: DescriptorSets::new(device, SHADERS.name, &set_layout, count)?,
            beams: Beams::new(device, PixelStage::of(device), eyes)?,
            slot: 0,
            eyes,
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.beams.begin(slot);
    }

    /// Records the part of an index map described by `task`, once per frame and eye. `target` must have normals.
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        levels: &Levels,
        normals: &Normals,
        task: &LevelTask,
        target: &mut IndexTarget,
    ) -> Result<()> {
        let LevelTask { part: task, sample } = *task;
        let (eye, cells) = (task.eye, levels.cells());
        let rays = LevelSet::rays_of_cells(&task.rays);
        let starts = self.beams.record(recorder, cells, &rays, eye)?;
        let set = self.slot * self.eyes as usize + eye as usize;
        self.sets.write_sampled(set, CELLS, cells.image().view());
        self.sets.write_sampled(set, STARTS, starts.layer_view(eye));
        for (binding, buffer) in [(NORMALS, normals.buffer()), (LEVELS, levels.buffer())] {
            let kind = vk::DescriptorType::STORAGE_BUFFER;
            self.sets.write_buffer(set, binding, kind, buffer.whole());
        }
        let view = MarchView { sample, ..march_view(&rays, cells) };
        let rest = Load::Integers([NO_VOXEL; 4]);
        let area = PixelArea { scissor: task.scissor, visible: task.visible, rest };
        let set = self.sets.set(set);
        let target = PixelTarget { image: target.index_mut(), eye, area };
        self.pass.record(recorder, set, Some(&view), target);
        Ok(())
    }
}
