//! Draws the pictures of two eyes, and the interface over them, to one screen, in any [`StereoLayout`].
//! [`StereoLayout::pixel`] is its twin on the CPU.
//!
//! Takes images; does not know their contents.

use std::sync::Arc;

use ash::vk;
use glam::{IVec2, UVec2};

use super::specialised::Specialised;
use crate::gpu::layout::StereoView;
use crate::gpu::{
    DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Graphics, Pipeline, PipelineLayout,
    Recorder, Result, SetLayout, shaders,
};
use crate::view::StereoLayout;

/// The input of the pass. All images are in the layout of [`crate::gpu::ResourceUse::SHADER_READ`].
#[derive(Clone, Copy)]
pub struct StereoSources<'a> {
    /// Two layers: left, right.
    pub pictures: &'a EyeImage,
    /// Their upper left corner in the window, in pixels.
    pub corner: IVec2,
    /// The interface, premultiplied, with the size of the window.
    pub interface: &'a EyeImage,
}

/// The pass.
pub struct Stereo {
    /// Indexed by layout.
    pipelines: Specialised<1, Pipeline>,
    layout: Arc<PipelineLayout>,
    format: vk::Format,
    sets: DescriptorSets,
    /// The images that each set refers to.
    named: [(u64, u64); FRAMES_IN_FLIGHT],
    slot: usize,
    device: Arc<Device>,
}

impl Stereo {
    /// Creates one for targets of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Stereo> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let image = vk::DescriptorType::SAMPLED_IMAGE;
        let bindings = [0, 1, 2].map(|binding| (binding, image, fragment));
        let set_layout = SetLayout::new(device, "stereo", &bindings)?;
        let push = Some((fragment, size_of::<StereoView>()));
        let layout = PipelineLayout::new(device, "stereo", Some(&set_layout), push)?;
        Ok(Stereo {
            pipelines: Specialised::new(),
            layout,
            format,
            sets: DescriptorSets::new(device, "stereo", &set_layout, FRAMES_IN_FLIGHT)?,
            named: [(0, 0); FRAMES_IN_FLIGHT],
            slot: 0,
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot` ([`crate::gpu::Frames::slot`]) and shows `sources`.
    pub fn begin(&mut self, slot: usize, sources: &StereoSources) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        let (pictures, interface) = (sources.pictures.image(), sources.interface.image());
        let named = &mut self.named[self.slot];
        if *named != (pictures.id(), interface.id()) {
            *named = (pictures.id(), interface.id());
            self.sets.write_sampled(self.slot, 0, pictures.layer_view(0));
            self.sets.write_sampled(self.slot, 1, pictures.layer_view(1));
            self.sets.write_sampled(self.slot, 2, interface.layer_view(0));
        }
    }

    /// Fills a target with the size of the window, within rendering. With [`StereoLayout::Layers`] the target is that
    /// of `eye`.
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        layout: StereoLayout,
        eye: u32,
        sources: &StereoSources,
    ) -> Result<()> {
        let window: UVec2 = sources.interface.size();
        let constants = StereoView {
            window: window.to_array(),
            size: sources.pictures.size().to_array(),
            corner: sources.corner.to_array(),
            eye,
            ..StereoView::default()
        };
        // The shader numbers the layouts as the type does.
        let pipeline = self.pipelines.get([layout as u32], |constants| {
            let fragment = shaders::STEREO_FRAG;
            let pass = Graphics::screen("stereo", fragment, &self.layout, self.format, None);
            Pipeline::graphics(&self.device, &Graphics { constants, ..pass })
        })?;
        recorder.bind_pipeline(pipeline);
        recorder.bind_set(pipeline, self.sets.set(self.slot));
        recorder.push(pipeline.layout(), &constants);
        recorder.draw(3, 1);
        Ok(())
    }
}
