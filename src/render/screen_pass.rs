//! The parts shared by the passes that draw a sculpture to a target: the background, a descriptor set for each frame in
//! flight and eye, the layout of their pipelines, and the recording of a draw.
//!
//! Takes the bindings and push constants of a pass when it is made; in a frame the images that its shaders read, a
//! pipeline and the eye's place on the target. Does not know the contents of a pass.

use std::sync::Arc;

use ash::vk;
use bytemuck::Pod;

use super::background::BackgroundPass;
use super::composite_eye::{CompositeEye, is_srgb};
use crate::gpu::{
    Binding, Depth, DescriptorSets, Device, FRAMES_IN_FLIGHT, Graphics, Image, Pipeline,
    PipelineLayout, Recorder, Result, SetLayout,
};

/// Most images read by the shaders of a pass.
const MAX_IMAGES: usize = 2;

/// An image read by the shaders, its binding, and its view for one eye.
pub(super) struct Input<'a> {
    pub binding: u32,
    pub image: &'a Image,
    pub view: vk::ImageView,
}

pub(super) struct ScreenPass {
    name: &'static str,
    layout: Arc<PipelineLayout>,
    format: vk::Format,
    background: BackgroundPass,
    sets: DescriptorSets,
    /// The images that each set names.
    named: Vec<[u64; MAX_IMAGES]>,
    slot: usize,
    eyes: u32,
    device: Arc<Device>,
}

impl ScreenPass {
    /// Creates one for targets of `format` with a D32 depth buffer and up to `eyes` eyes. `push` is the type of the
    /// push constants, `stages` those that read them.
    pub fn new<Push: Pod>(
        device: &Arc<Device>,
        name: &'static str,
        format: vk::Format,
        eyes: u32,
        bindings: &[Binding],
        stages: vk::ShaderStageFlags,
    ) -> Result<ScreenPass> {
        let set_layout = SetLayout::new(device, name, bindings)?;
        let push = Some((stages, size_of::<Push>()));
        let count = FRAMES_IN_FLIGHT * eyes as usize;
        Ok(ScreenPass {
            name,
            layout: PipelineLayout::new(device, name, Some(&set_layout), push)?,
            format,
            background: BackgroundPass::new(device, format)?,
            sets: DescriptorSets::new(device, name, &set_layout, count)?,
            named: vec![[0; MAX_IMAGES]; count],
            slot: 0,
            eyes,
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
    }

    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    pub fn eyes(&self) -> u32 {
        self.eyes
    }

    /// Returns whether the target stores linear values, which the device encodes.
    pub fn is_linear(&self) -> bool {
        is_srgb(self.format)
    }

    pub fn sets(&self) -> &DescriptorSets {
        &self.sets
    }

    /// Returns the index of the descriptor set of `eye` in this frame.
    pub fn set(&self, eye: u32) -> usize {
        self.slot * self.eyes as usize + eye as usize
    }

    /// Writes the images that shaders read for `eye` to its set, unless they are there already.
    pub fn write_inputs<const N: usize>(&mut self, eye: u32, inputs: [Input<'_>; N]) {
        const { assert!(N <= MAX_IMAGES) };
        let set = self.set(eye);
        let mut names = [0; MAX_IMAGES];
        for (name, input) in names.iter_mut().zip(&inputs) {
            *name = input.image.id();
        }
        if self.named[set] != names {
            self.named[set] = names;
            inputs.iter().for_each(|i| self.sets.write_sampled(set, i.binding, i.view));
        }
    }

    /// Returns the description of a pipeline of this pass: a fragment shader over all pixels of the target.
    pub fn graphics<'a>(&'a self, fragment: &'a [u32], depth: Depth) -> Graphics<'a> {
        Graphics::screen(self.name, fragment, &self.layout, self.format, Some(depth))
    }

    /// Draws the background of `view`, within rendering.
    pub fn draw_background(&self, recorder: &mut Recorder, view: &CompositeEye) {
        self.background.draw(recorder, view);
    }

    /// Draws `vertices` vertices with the set of the eye of `view` in the visible part of the sculpture, within
    /// rendering.
    pub fn draw<Push: Pod>(
        &self,
        recorder: &mut Recorder,
        pipeline: &Pipeline,
        view: &CompositeEye,
        constants: &Push,
        vertices: u32,
    ) {
        recorder.bind_pipeline(pipeline);
        recorder.bind_set(pipeline, self.sets.set(self.set(view.eye)));
        recorder.push(pipeline.layout(), constants);
        recorder.set_scissor(view.scissor());
        recorder.draw(vertices, 1);
    }
}
