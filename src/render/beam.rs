//! Beams: a pass that finds the distance at which the rays of each tile may first hit a brick in use. The rays of the
//! pixels start there.
//!
//! Takes a volume and the rays of an eye; returns an image of distances, in lengths of the ray directions. The picture
//! stays the same: a walk from there finds the same voxel.

use std::sync::Arc;

use ash::vk;

use super::Volume;
use super::pixel_pass::{PixelArea, PixelPass, PixelShaders, PixelStage, PixelTarget};
use crate::gpu::layout::MarchView;
use crate::gpu::{
    DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Image, Load, PipelineLayout, Recorder,
    ResourceUse, Result, SetLayout, shaders,
};
use crate::surface::{PixelRect, SmallBricks};
use crate::view::PixelRays;

/// Binary logarithm of the edge of a tile in pixels. Larger tiles need fewer beams, but sooner
/// become wider than a brick: at 1.7 voxels per pixel, as with a grid of 512^3 in a picture 480
/// pixels high, a tile of eight pixels is.
pub const TILE_LOG2: u32 = 2;

const DILATED: u32 = 0;
const STARTS: u32 = 1;

const SHADERS: PixelShaders = PixelShaders {
    name: "beams",
    compute: shaders::BEAM_COMP,
    fragment: shaders::BEAM_FRAG,
    format: vk::Format::R32_SFLOAT,
};

/// Finds the start of rays.
pub struct Beams {
    pass: PixelPass,
    sets: DescriptorSets,
    /// The images that each set refers to: bricks, starts.
    named: Vec<(u64, u64)>,
    starts: Option<EyeImage>,
    slot: usize,
    eyes: u32,
    device: Arc<Device>,
}

impl Beams {
    /// Creates one for up to `eyes` eyes per frame.
    pub fn new(device: &Arc<Device>, stage: PixelStage, eyes: u32) -> Result<Beams> {
        let bindings = stage.bindings(&[(DILATED, vk::DescriptorType::SAMPLED_IMAGE)], STARTS);
        let set_layout = SetLayout::new(device, SHADERS.name, &bindings)?;
        let push = Some((stage.flags(), size_of::<MarchView>()));
        let layout = PipelineLayout::new(device, SHADERS.name, Some(&set_layout), push)?;
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(Beams {
            pass: PixelPass::new(device, &SHADERS, stage, &layout, &[])?,
            sets: DescriptorSets::new(device, SHADERS.name, &set_layout, count)?,
            named: vec![(0, 0); count],
            starts: None,
            slot: 0,
            eyes,
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
    }

    /// Records the beams of `eye` with `rays`; all eyes of a frame have the same size in pixels.
    /// Returns their image, with a texel per tile and a layer per eye, ready for shaders.
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        rays: &PixelRays,
        eye: u32,
    ) -> Result<&Image> {
        let tiles = (rays.size + ((1 << TILE_LOG2) - 1)) >> TILE_LOG2;
        if self.starts.as_ref().is_some_and(|starts| starts.size() != tiles) {
            self.starts = None;
        }
        let starts = match &mut self.starts {
            Some(starts) => starts,
            none => none.insert(EyeImage::new(
                &self.device,
                "starts of rays",
                tiles,
                self.eyes,
                SHADERS.format,
                vk::ImageUsageFlags::SAMPLED | self.pass.stage().target_usage(),
            )?),
        };
        let set = self.slot * self.eyes as usize + eye as usize;
        let names = (volume.dilated_occupancy().id(), starts.image().id());
        if self.named[set] != names {
            self.named[set] = names;
            self.sets.write_sampled(set, DILATED, volume.dilated_occupancy().view());
            if self.pass.stage() == PixelStage::Compute {
                self.sets.write_storage(set, STARTS, starts.image().layer_view(eye));
            }
        }
        let view = march_view(rays, volume);
        let all = PixelRect::of_picture(tiles);
        let area = PixelArea { scissor: all, visible: all, rest: Load::Forget };
        let target = PixelTarget { image: starts, eye, area };
        self.pass.record(recorder, self.sets.set(set), Some(&view), target);
        starts.transition(recorder, eye, ResourceUse::SHADER_READ);
        Ok(starts.image())
    }

    /// Returns the image of [`Beams::record`].
    pub fn starts(&self) -> Option<&Image> {
        self.starts.as_ref().map(EyeImage::image)
    }
}

/// Returns the push constants of passes that follow `rays` through `volume`.
pub(super) fn march_view(rays: &PixelRays, volume: &Volume) -> MarchView {
    let small = SmallBricks::new(rays);
    MarchView {
        origin: rays.origin.to_array(),
        width: rays.size.x,
        corner: rays.corner.to_array(),
        height: rays.size.y,
        step_x: rays.step_x.to_array(),
        tile_log2: TILE_LOG2,
        step_y: rays.step_y.to_array(),
        dims: volume.dims().to_array(),
        small_least: small.least,
        small_weights: small.weights.to_array(),
        ..MarchView::default()
    }
}
