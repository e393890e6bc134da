//! The mean of pictures, in linear light, on the device: each picture is blended into an image of half floats, which
//! is then drawn as a picture again.
//!
//! Light is linear in the square of a value, as for the shaders. Takes opaque pictures of one size; does not know
//! how they differ.

use std::sync::Arc;

use ash::vk;

use super::MAX_EYES;
use super::composite_eye::is_srgb;
use crate::gpu::layout::MeanView;
use crate::gpu::{
    Attachment, Blend, DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Graphics, Load,
    Pipeline, PipelineLayout, Recorder, ResourceUse, Result, SetLayout, shaders,
};

/// A format to which every device can blend.
const FORMAT: vk::Format = vk::Format::R16G16B16A16_SFLOAT;

/// The kinds of images in a descriptor set: a picture to add, or the mean to draw.
const KINDS: usize = 2;
const ADD: usize = 0;
const RESOLVE: usize = 1;

/// The passes and the mean.
pub(super) struct MeanPass {
    add: Pipeline,
    resolve: Pipeline,
    sets: DescriptorSets,
    /// The image that each set names.
    named: [u64; KINDS * MAX_EYES * FRAMES_IN_FLIGHT],
    mean: Option<EyeImage>,
    slot: usize,
    /// The device decodes and encodes the pictures, so that shaders see linear light.
    linear: bool,
    device: Arc<Device>,
}

impl MeanPass {
    /// Makes the mean of pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<MeanPass> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let name = "mean of pictures";
        let set_layout =
            SetLayout::new(device, name, &[(0, vk::DescriptorType::SAMPLED_IMAGE, fragment)])?;
        let push = Some((fragment, size_of::<MeanView>()));
        let layout = PipelineLayout::new(device, name, Some(&set_layout), push)?;
        let count = KINDS * MAX_EYES * FRAMES_IN_FLIGHT;
        let add = Graphics::screen(name, shaders::MEAN_ADD_FRAG, &layout, FORMAT, None);
        let resolve = Graphics::screen(name, shaders::MEAN_RESOLVE_FRAG, &layout, format, None);
        Ok(MeanPass {
            add: Pipeline::graphics(
                device,
                &Graphics { colour: Some((FORMAT, Blend::Alpha)), ..add },
            )?,
            resolve: Pipeline::graphics(device, &resolve)?,
            sets: DescriptorSets::new(device, name, &set_layout, count)?,
            named: [0; KINDS * MAX_EYES * FRAMES_IN_FLIGHT],
            mean: None,
            slot: 0,
            linear: is_srgb(format),
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot` ([`crate::gpu::Frames::slot`]).
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
    }

    /// Frees the mean.
    pub fn forget(&mut self) {
        self.mean = None;
    }

    /// Adds the layers of `pictures`, as the `count`-th picture; the first one replaces the former contents. Leaves
    /// them in the layout of [`ResourceUse::SHADER_READ`]. Once per frame.
    pub fn add(
        &mut self,
        recorder: &mut Recorder,
        pictures: &mut EyeImage,
        count: u32,
    ) -> Result<()> {
        let (size, eyes) = (pictures.size(), pictures.eyes().min(MAX_EYES as u32));
        if self.mean.as_ref().is_some_and(|mean| mean.size() != size || mean.eyes() != eyes) {
            self.mean = None;
        }
        let mean = match &mut self.mean {
            Some(mean) => mean,
            none => {
                let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
                none.insert(EyeImage::new(
                    &self.device,
                    "mean of pictures",
                    size,
                    eyes,
                    FORMAT,
                    usage,
                )?)
            }
        };
        for eye in 0..eyes {
            pictures.transition(recorder, eye, ResourceUse::SHADER_READ);
            let set = set_index(self.slot, ADD, eye);
            name(&self.sets, &mut self.named, set, pictures, eye);
            let load = match count {
                1 => {
                    mean.begin_overwrite(recorder, eye, ResourceUse::COLOUR_TARGET);
                    Load::Colour([0.0; 4])
                }
                _ => {
                    mean.transition(recorder, eye, ResourceUse::COLOUR_TARGET);
                    Load::Keep
                }
            };
            let weight = 1.0 / count as f32;
            let view = MeanView { weight, linear: self.linear.into() };
            let target = LayerTarget { image: &*mean, eye, load };
            draw(recorder, target, &self.add, self.sets.set(set), &view);
            mean.transition(recorder, eye, ResourceUse::SHADER_READ);
        }
        Ok(())
    }

    /// Draws the mean to the layers of `pictures`, which have its size. Leaves them in the layout of
    /// [`ResourceUse::COLOUR_TARGET`]. Once per frame, after [`MeanPass::add`].
    pub fn resolve(&mut self, recorder: &mut Recorder, pictures: &mut EyeImage) {
        let Some(mean) = &self.mean else { return };
        for eye in 0..mean.eyes() {
            let set = set_index(self.slot, RESOLVE, eye);
            name(&self.sets, &mut self.named, set, mean, eye);
            pictures.begin_overwrite(recorder, eye, ResourceUse::COLOUR_TARGET);
            let view = MeanView { weight: 1.0, linear: self.linear.into() };
            let set = self.sets.set(set);
            let target = LayerTarget { image: &*pictures, eye, load: Load::Forget };
            draw(recorder, target, &self.resolve, set, &view);
        }
    }
}

fn set_index(slot: usize, kind: usize, eye: u32) -> usize {
    (slot * KINDS + kind) * MAX_EYES + eye as usize
}

/// Writes the layer of `eye` to a set, unless it is there already.
fn name(sets: &DescriptorSets, named: &mut [u64], set: usize, image: &EyeImage, eye: u32) {
    let image = image.image();
    if named[set] != image.id() {
        named[set] = image.id();
        sets.write_sampled(set, 0, image.layer_view(eye));
    }
}

/// A layer to draw to, and the treatment of its contents.
struct LayerTarget<'a> {
    image: &'a EyeImage,
    eye: u32,
    load: Load,
}

/// Draws all pixels of a layer.
fn draw(
    recorder: &mut Recorder,
    target: LayerTarget,
    pipeline: &Pipeline,
    set: vk::DescriptorSet,
    view: &MeanView,
) {
    let LayerTarget { image, eye, load } = target;
    let colour = Attachment { view: image.image().layer_view(eye), load, store: true };
    recorder.begin_rendering(image.size().to_array(), Some(colour), None);
    recorder.bind_pipeline(pipeline);
    recorder.bind_set(pipeline, set);
    recorder.push(pipeline.layout(), view);
    recorder.draw(3, 1);
    recorder.end_rendering();
}
