//! The GPU-only pass: one fragment shader follows each pixel's ray to its voxel, lights it and writes colour and depth,
//! over the background. Nothing is read back, and there is no index map.
//!
//! Takes the bits on the device ([`Volume`]), the rays of an eye and the lights. The normals are those of the software
//! shader; colours are the voxels' where they are on the device ([`super::DeviceColours`]), else one for all.

use std::sync::Arc;

use ash::vk;

use super::Volume;
use super::beam::Beams;
use super::composite_eye::{CompositeEye, constants};
use super::pixel_pass::PixelStage;
use super::screen_pass::{Input, ScreenPass};
use super::shading::{
    COLOURS, KIND_CONSTANTS, LitSurface, MATCAP, NORMALS, UNIFORMS, Uniforms, VOLUME,
};
use super::specialised::Specialised;
use crate::gpu::layout::CompositeView;
use crate::gpu::{Depth, Device, Graphics, Pipeline, Recorder, Result, shaders};
use crate::surface::SmallBricks;
use crate::view::PixelRays;

/// The binding of the beams' image.
const STARTS: u32 = 6;

/// Draws sculptures straight to a target.
pub struct GpuOnly {
    screen: ScreenPass,
    pipelines: Specialised<KIND_CONSTANTS, Pipeline>,
    beams: Beams,
    uniforms: Uniforms,
}

impl GpuOnly {
    /// Creates one for targets of `format` with a D32 depth buffer and up to `eyes` eyes.
    pub fn new(device: &Arc<Device>, format: vk::Format, eyes: u32) -> Result<GpuOnly> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let bindings = [
            (VOLUME, vk::DescriptorType::SAMPLED_IMAGE, fragment),
            (COLOURS, vk::DescriptorType::STORAGE_BUFFER, fragment),
            (NORMALS, vk::DescriptorType::STORAGE_BUFFER, fragment),
            (MATCAP, vk::DescriptorType::STORAGE_BUFFER, fragment),
            (UNIFORMS, vk::DescriptorType::UNIFORM_BUFFER, fragment),
            (STARTS, vk::DescriptorType::SAMPLED_IMAGE, fragment),
        ];
        let name = "GPU only";
        Ok(GpuOnly {
            screen: ScreenPass::new::<CompositeView>(
                device, name, format, eyes, &bindings, fragment,
            )?,
            pipelines: Specialised::new(),
            beams: Beams::new(device, PixelStage::of(device), eyes)?,
            uniforms: Uniforms::new(device)?,
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.screen.begin(slot);
        self.uniforms.begin(slot);
        self.beams.begin(slot);
    }

    /// Records the beams that [`GpuOnly::draw`] needs for `eye`, which sees `volume` by `rays`. Call before rendering
    /// begins.
    pub fn prepare(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        rays: &PixelRays,
        eye: u32,
    ) -> Result<()> {
        self.beams.record(recorder, volume, rays, eye)?;
        Ok(())
    }

    /// Draws `volume` as seen by the eye of `view`, lit as in `surface`, within rendering. Call after
    /// [`GpuOnly::prepare`] in the same frame.
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        surface: &LitSurface,
        view: &CompositeEye,
    ) -> Result<()> {
        let eye = view.eye;
        self.screen.draw_background(recorder, view);
        let Some(starts) = self.beams.starts() else { return Ok(()) };
        let bits = volume.image();
        let inputs = [
            Input { binding: STARTS, image: starts, view: starts.layer_view(eye) },
            Input { binding: VOLUME, image: bits, view: bits.view() },
        ];
        self.screen.write_inputs(eye, inputs);
        let set = self.screen.set(eye);
        let small = SmallBricks::new(&view.rays);
        self.uniforms.write_seen(self.screen.sets(), set, surface, &small)?;
        self.uniforms.write_surface(self.screen.sets(), set, surface);
        let pipeline = self.pipelines.get(surface.kind(), |constants| {
            let pass = self.screen.graphics(shaders::GPU_ONLY_FRAG, Depth::OVERWRITE);
            Pipeline::graphics(self.screen.device(), &Graphics { constants, ..pass })
        })?;
        let push = constants(view, self.screen.is_linear());
        self.screen.draw(recorder, pipeline, view, &push, 3);
        Ok(())
    }
}
