//! Owns the ray march: a compute pass in which each pixel's ray walks through the grid, skipping
//! what is empty by blocks of bricks, bricks and words, and writes the first existing voxel to the
//! index map.
//!
//! Decides by the same arithmetic as the ray caster on the CPU ([`crate::surface::raycast`]), so
//! that the maps are equal but for rounding where a device's division is not exact.
//!
//! Takes a volume and the rays of an eye; gives an [`IndexTarget`].

use std::sync::Arc;

use ash::vk;

use crate::gpu::layout::MarchView;
use crate::gpu::{
    DescriptorSets, Device, FRAMES_IN_FLIGHT, Pipeline, PipelineLayout, Recorder, Result,
    SetLayout, shaders,
};
use crate::render::{IndexTarget, Volume};
use crate::view::PixelRays;

/// Pixels along the edge of the square that one group of invocations works on.
const GROUP_PX: u32 = 8;

/// Marches index maps.
pub struct RayMarch {
    pipeline: Pipeline,
    sets: DescriptorSets,
    /// The images that each set names: volume, index map.
    named: Vec<(u64, u64)>,
    slot: usize,
    eyes: u32,
}

impl RayMarch {
    /// For up to `eyes` eyes a frame.
    pub fn new(device: &Arc<Device>, eyes: u32) -> Result<RayMarch> {
        let compute = vk::ShaderStageFlags::COMPUTE;
        let bindings = [
            (0, vk::DescriptorType::SAMPLED_IMAGE, compute),
            (1, vk::DescriptorType::SAMPLED_IMAGE, compute),
            (2, vk::DescriptorType::STORAGE_IMAGE, compute),
        ];
        let set_layout = SetLayout::new(device, "ray march", &bindings)?;
        let push = Some((compute, size_of::<MarchView>()));
        let layout = PipelineLayout::new(device, "ray march", Some(&set_layout), push)?;
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(RayMarch {
            pipeline: Pipeline::compute(device, "ray march", shaders::RAY_MARCH_COMP, &layout)?,
            sets: DescriptorSets::new(device, "ray march", &set_layout, count)?,
            named: vec![(0, 0); count],
            slot: 0,
            eyes,
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
    }

    /// Records the index map of `eye`, seen by `rays`. Leaves the map in the layout of
    /// [`crate::gpu::Use::SHADER_WRITE`].
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        rays: &PixelRays,
        target: &mut IndexTarget,
        eye: u32,
    ) {
        target.begin_writing(recorder, eye);
        let set = self.slot * self.eyes as usize + eye as usize;
        let index = target.index().image();
        let names = (volume.image().id(), index.id());
        if self.named[set] != names {
            self.named[set] = names;
            self.sets.write_sampled(set, 0, volume.image().view());
            self.sets.write_sampled(set, 1, volume.occupancy().view());
            self.sets.write_storage(set, 2, index.layer_view(eye));
        }
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, self.sets.set(set));
        recorder.push(self.pipeline.layout(), &march_view(rays, volume));
        let groups = (rays.size + (GROUP_PX - 1)) / GROUP_PX;
        recorder.dispatch([groups.x, groups.y, 1]);
    }
}

fn march_view(rays: &PixelRays, volume: &Volume) -> MarchView {
    MarchView {
        origin: rays.origin.to_array(),
        width: rays.size.x,
        corner: rays.corner.to_array(),
        height: rays.size.y,
        step_x: rays.step_x.to_array(),
        step_y: rays.step_y.to_array(),
        dims: volume.dims().to_array(),
        ..MarchView::default()
    }
}
