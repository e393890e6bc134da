//! Smooths the edges of pictures that are not refined: those of moving ones, and of a headset. One pass between the
//! sculpture, which is drawn to an image of its own, and tools and lines, which stay sharp.
//!
//! Edges are jumps of the depth by more than some voxels, so colours of the surface are not blurred. Works on the
//! pictures of every render mode, and on each eye separately. For GPUs: lavapipe runs the search for the ends of steps
//! at every pixel, not only at edges, which takes some 60 ms for 640x480 pixels on two cores.

use std::sync::Arc;

use ash::vk;
use glam::{Affine3A, Mat3};

use super::MAX_EYES;
use super::composite_eye::{CompositeEye, is_srgb};
use super::pictures::FinishedPictures;
use crate::gpu::layout::EdgesView;
use crate::gpu::{
    Attachment, DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Graphics, Load, Pipeline,
    PipelineLayout, Recorder, ResourceUse, Result, SetLayout, shaders,
};

/// Distance within which other pixels affect the colour of a pixel.
pub(super) const REACH_PX: u32 = 14;
/// Least distance between two separate surfaces, in voxels.
const LEAP_VX: f32 = 10.0;

/// The pass, and its input pictures.
pub(super) struct SmoothEdges {
    pipeline: Pipeline,
    sets: DescriptorSets,
    /// The images that each set names.
    named: Vec<[u64; 2]>,
    /// Pictures with sharp edges.
    sharp: Option<EyeImage>,
    slot: usize,
    linear: bool,
    device: Arc<Device>,
}

impl SmoothEdges {
    /// Creates one for pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<SmoothEdges> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let name = "smooth edges";
        let image = vk::DescriptorType::SAMPLED_IMAGE;
        let set_layout =
            SetLayout::new(device, name, &[(0, image, fragment), (1, image, fragment)])?;
        let push = Some((fragment, size_of::<EdgesView>()));
        let layout = PipelineLayout::new(device, name, Some(&set_layout), push)?;
        let pass = Graphics::screen(name, shaders::SMOOTH_EDGES_FRAG, &layout, format, None);
        let count = FRAMES_IN_FLIGHT * MAX_EYES;
        Ok(SmoothEdges {
            pipeline: Pipeline::graphics(device, &pass)?,
            sets: DescriptorSets::new(device, name, &set_layout, count)?,
            named: vec![[0; 2]; count],
            sharp: None,
            slot: 0,
            linear: is_srgb(format),
            device: device.clone(),
        })
    }

    /// Starts a frame of `pictures` that uses `slot` ([`crate::gpu::Frames::slot`]).
    pub fn begin(&mut self, slot: usize, pictures: &FinishedPictures) -> Result<()> {
        self.slot = slot % FRAMES_IN_FLIGHT;
        let (size, eyes) = (pictures.colour.size(), pictures.colour.eyes());
        let fits = |sharp: &EyeImage| sharp.size() == size && sharp.eyes() == eyes;
        if !self.sharp.as_ref().is_some_and(fits) {
            use vk::ImageUsageFlags as Usage;
            let (device, format) = (&self.device, pictures.colour.image().format());
            let usage = Usage::COLOR_ATTACHMENT | Usage::SAMPLED;
            let name = "picture with sharp edges";
            self.sharp = Some(EyeImage::new(device, name, size, eyes, format, usage)?);
        }
        Ok(())
    }

    /// Starts drawing the sculpture to the pixels of `view`, with the depth of `pictures`, like [`FinishedPictures::begin`].
    pub fn begin_sculpture(
        &mut self,
        recorder: &mut Recorder,
        pictures: &mut FinishedPictures,
        view: &CompositeEye,
    ) {
        let Some(sharp) = &mut self.sharp else { return };
        std::mem::swap(sharp, &mut pictures.colour);
        pictures.begin(recorder, view.eye, view.background, view.scissor);
        std::mem::swap(sharp, &mut pictures.colour);
    }

    /// Ends it, draws the pixels of `view` with smooth edges to `pictures`, and continues drawing over them.
    pub fn finish(
        &mut self,
        recorder: &mut Recorder,
        pictures: &mut FinishedPictures,
        view: &CompositeEye,
        world_from_grid: &Affine3A,
    ) {
        let (eye, area, projection) = (view.eye, view.scissor, &view.projection);
        recorder.end_rendering();
        let Some(sharp) = &mut self.sharp else { return };
        let FinishedPictures { colour, depth } = pictures;
        sharp.transition(recorder, eye, ResourceUse::SHADER_READ);
        depth.transition(recorder, eye, ResourceUse::SHADER_READ);
        let set = self.slot * MAX_EYES + eye as usize;
        let names = [sharp.image().id(), depth.image().id()];
        if self.named[set] != names {
            self.named[set] = names;
            self.sets.write_sampled(set, 0, sharp.image().layer_view(eye));
            self.sets.write_sampled(set, 1, depth.image().layer_view(eye));
        }
        let place = area.corner_and_size();
        let size = colour.size();
        colour.begin_overwrite_area(recorder, eye, place, ResourceUse::COLOUR_TARGET);
        let attachment = |image: &EyeImage, load| {
            Some(Attachment { view: image.image().layer_view(eye), load, store: true })
        };
        recorder.begin_rendering_in(size.to_array(), place, attachment(colour, Load::Forget), None);
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, self.sets.set(set));
        let columns = Mat3::from(world_from_grid.matrix3).to_cols_array_2d();
        let voxel = columns.map(|column| glam::Vec3::from(column).length()).into_iter();
        // A step in depth changes the nearness by its square over the near plane's distance.
        let leap = LEAP_VX * voxel.fold(0.0, f32::max) / projection.w_axis.z;
        let view = EdgesView { size: size.to_array(), leap, linear: self.linear.into() };
        recorder.push(self.pipeline.layout(), &view);
        recorder.draw(3, 1);
        recorder.end_rendering();
        colour.begin_overwrite_area(recorder, eye, ([0, 0], [0, 0]), ResourceUse::COLOUR_TARGET);
        depth.transition(recorder, eye, ResourceUse::DEPTH_TARGET);
        let (colour, depth) = (attachment(colour, Load::Keep), attachment(depth, Load::Keep));
        recorder.begin_rendering_in(size.to_array(), place, colour, depth);
    }
}
