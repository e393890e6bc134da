//! Owns the GPU-only pass: one fragment shader walks each pixel's ray to its voxel, lights it and
//! writes colour and depth, over the background. Nothing is read back, and there is no index map.
//!
//! The seed's GPU-only renderer did so while slicing, with the six neighbours two voxels away for
//! a normal and one colour; this one has the software shader's normals, and the voxels' colours
//! where they are on the device ([`super::Colours`]).

use std::sync::Arc;

use ash::vk;

use super::Volume;
use super::background::BackgroundPass;
use super::beam::Beams;
use super::composite::{CompositeEye, constants, is_srgb};
use super::pixel_pass::PixelStage;
use super::shading::{COLOURS, KIND_CONSTANTS, Surface, UNIFORMS, Uniforms, VOLUME};
use super::specialised::Specialised;
use crate::gpu::layout::CompositeView;
use crate::gpu::{
    Depth, DescriptorSets, Device, FRAMES_IN_FLIGHT, Graphics, Pipeline, PipelineLayout, Recorder,
    Result, SetLayout, shaders,
};
use crate::view::PixelRays;

/// Where rays start: the binding of the beams' image.
const STARTS: u32 = 6;

/// Draws sculptures straight to a screen.
pub struct GpuOnly {
    pipelines: Specialised<KIND_CONSTANTS, Pipeline>,
    layout: Arc<PipelineLayout>,
    format: vk::Format,
    sets: DescriptorSets,
    /// The images that each set names: volume, starts of rays.
    named: Vec<(u64, u64)>,
    beams: Beams,
    background: BackgroundPass,
    uniforms: Uniforms,
    slot: usize,
    eyes: u32,
    /// The target stores linear values, encoded by the device.
    linear: bool,
    device: Arc<Device>,
}

impl GpuOnly {
    /// For targets of `format` with a D32 depth buffer and up to `eyes` eyes.
    pub fn new(device: &Arc<Device>, format: vk::Format, eyes: u32) -> Result<GpuOnly> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let bindings = [
            (VOLUME, vk::DescriptorType::SAMPLED_IMAGE, fragment),
            (COLOURS, vk::DescriptorType::STORAGE_BUFFER, fragment),
            (UNIFORMS, vk::DescriptorType::UNIFORM_BUFFER, fragment),
            (STARTS, vk::DescriptorType::SAMPLED_IMAGE, fragment),
        ];
        let set_layout = SetLayout::new(device, "GPU only", &bindings)?;
        let push = Some((fragment, size_of::<CompositeView>()));
        let layout = PipelineLayout::new(device, "GPU only", Some(&set_layout), push)?;
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(GpuOnly {
            pipelines: Specialised::new(),
            layout,
            format,
            sets: DescriptorSets::new(device, "GPU only", &set_layout, count)?,
            named: vec![(0, 0); count],
            beams: Beams::new(device, PixelStage::of(device), eyes)?,
            background: BackgroundPass::new(device, format)?,
            uniforms: Uniforms::new(device)?,
            slot: 0,
            eyes,
            linear: is_srgb(format),
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.uniforms.begin(slot);
        self.beams.begin(slot);
    }

    /// Records what [`GpuOnly::draw`] needs for `eye`, which sees `volume` by `rays`. Before rendering
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

    /// Draws what `eye` sees of `volume`, lit as `surface` says, by the rays of `view`, within rendering.
    /// After [`GpuOnly::prepare`] in the same frame.
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        surface: &Surface,
        eye: u32,
        view: &CompositeEye,
    ) -> Result<()> {
        let set = self.slot * self.eyes as usize + eye as usize;
        self.background.draw(recorder, view);
        let bits = volume.image();
        let Some(starts) = self.beams.starts() else { return Ok(()) };
        let names = (bits.id(), starts.id());
        if self.named[set] != names {
            self.named[set] = names;
            self.sets.write_sampled(set, STARTS, starts.layer_view(eye));
            self.sets.write_sampled(set, VOLUME, bits.view());
        }
        self.uniforms.write(&self.sets, set, surface)?;
        self.uniforms.write_colours(&self.sets, set, surface);
        let pipeline = self.pipelines.get(surface.kind(), |constants| {
            let (fragment, depth) = (shaders::GPU_ONLY_FRAG, Some(Depth::OVERWRITE));
            let pass = Graphics::screen("GPU only", fragment, &self.layout, self.format, depth);
            Pipeline::graphics(&self.device, &Graphics { constants, ..pass })
        })?;
        recorder.bind_pipeline(pipeline);
        recorder.bind_set(pipeline, self.sets.set(set));
        recorder.push(pipeline.layout(), &constants(view, self.linear));
        recorder.set_scissor(view.scissor());
        recorder.draw(3, 1);
        Ok(())
    }
}
