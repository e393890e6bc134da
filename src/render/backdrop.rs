//! Draws a video frame behind everything: fitted to the screen, mirrored, undistorted if its lens
//! is known, infinitely far away.
//!
//! Keeps the last frame on the device; knows no cameras.

use std::sync::Arc;
use std::time::Instant;

use ash::vk;
use glam::{UVec2, Vec3};

use super::composite_eye::is_srgb;
use crate::gpu::layout::BackdropView;
use crate::gpu::{
    Depth, DescriptorSets, Device, EyeImage, FRAMES_IN_FLIGHT, Graphics, Pipeline, PipelineLayout,
    Recorder, Result, SetLayout, Staging, shaders,
};
use crate::video::{Fit, Framing, Intrinsics, VideoFrame};

/// The display of a frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct VideoView {
    pub fit: Fit,
    pub mirror: bool,
    /// The lens, for any frame size; `None`: no undistortion.
    pub lens: Option<Intrinsics>,
    /// The colour beyond the frame. sRGB, 0 to 1.
    pub beyond: Vec3,
}

/// A frame and its display.
#[derive(Clone, Copy, Debug)]
pub struct Video<'a> {
    pub frame: &'a VideoFrame,
    pub view: VideoView,
}

impl Video<'_> {
    /// Returns the key that the pixels depend on: no two frames arrive at the same time.
    pub fn key(&self) -> (Instant, VideoView) {
        (self.frame.arrived, self.view)
    }
}

/// The pass and the last frame.
pub struct Backdrop {
    pipeline: Pipeline,
    sets: DescriptorSets,
    /// The image that each set refers to.
    named: [u64; FRAMES_IN_FLIGHT],
    picture: Option<EyeImage>,
    /// When the frame in `picture` arrived.
    arrived: Option<Instant>,
    staging: Staging,
    slot: usize,
    /// The target stores linear values, encoded by the device.
    linear: bool,
    device: Arc<Device>,
}

impl Backdrop {
    /// Creates one for targets of `format` with a depth buffer.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Backdrop> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let bindings = [(0, vk::DescriptorType::SAMPLED_IMAGE, fragment)];
        let set_layout = SetLayout::new(device, "backdrop", &bindings)?;
        let push = Some((fragment, size_of::<BackdropView>()));
        let layout = PipelineLayout::new(device, "backdrop", Some(&set_layout), push)?;
        let pipeline = Pipeline::graphics(
            device,
            &Graphics::screen(
                "backdrop",
                shaders::BACKDROP_FRAG,
                &layout,
                format,
                Some(Depth::OVERWRITE),
            ),
        )?;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        Ok(Backdrop {
            pipeline,
            sets: DescriptorSets::new(device, "backdrop", &set_layout, FRAMES_IN_FLIGHT)?,
            named: [0; FRAMES_IN_FLIGHT],
            picture: None,
            arrived: None,
            staging: Staging::new(device, "video", usage, 1 << 20)?,
            slot: 0,
            linear: is_srgb(format),
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot` ([`crate::gpu::Frames::slot`]).
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.staging.begin(slot);
    }

    /// Uploads a frame over the last one, unless it is there already. Call before rendering begins.
    pub fn bring(&mut self, recorder: &mut Recorder, frame: &VideoFrame) -> Result<()> {
        let size = UVec2::new(frame.width, frame.height);
        if size.min_element() == 0 || self.arrived == Some(frame.arrived) {
            return Ok(());
        }
        let piece = self.staging.push(&frame.pixels, 4)?;
        let picture = match &mut self.picture {
            Some(picture) if picture.size() == size => picture,
            picture => picture.insert(EyeImage::new(
                &self.device,
                "video picture",
                size,
                1,
                // Such a target encodes its input: this format decodes it.
                if self.linear { vk::Format::R8G8B8A8_SRGB } else { vk::Format::R8G8B8A8_UNORM },
                vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST,
            )?),
        };
        let rows = 0..picture.size().y;
        picture.upload_rows(recorder, 0, piece, rows);
        self.arrived = Some(frame.arrived);
        Ok(())
    }

    /// Fills a target of `screen` pixels with the last frame, within rendering. Draws nothing
    /// before the first frame.
    pub fn draw(&mut self, recorder: &mut Recorder, screen: UVec2, view: &VideoView) {
        let Some(picture) = &self.picture else { return };
        let image = picture.image();
        if self.named[self.slot] != image.id() {
            self.named[self.slot] = image.id();
            self.sets.write_sampled(self.slot, 0, image.view());
        }
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, self.sets.set(self.slot));
        recorder
            .push(self.pipeline.layout(), &constants(view, picture.size(), screen, self.linear));
        recorder.draw(3, 1);
    }
}

fn constants(view: &VideoView, size: UVec2, screen: UVec2, linear: bool) -> BackdropView {
    let Framing { scale, offset } = Framing::new(size, screen, view.fit, view.mirror);
    let lens = view.lens.map(|lens| lens.scaled(size.x, size.y));
    let pinhole = Intrinsics::pinhole(size.x, size.y, 1.0);
    let numbers = lens.unwrap_or(pinhole);
    BackdropView {
        scale: scale.to_array(),
        offset: offset.to_array(),
        focal: [numbers.fx, numbers.fy].map(|n| n as f32),
        centre: [numbers.cx, numbers.cy].map(|n| n as f32),
        radial: [numbers.k1, numbers.k2, numbers.k3].map(|n| n as f32),
        lens: lens.is_some().into(),
        beyond: if linear { view.beyond.powf(2.2) } else { view.beyond }.to_array(),
        pad_0: 0,
        tangential: [numbers.p1, numbers.p2].map(|n| n as f32),
        screen: screen.as_vec2().to_array(),
        size: size.to_array(),
        pad_1: [0; 2],
    }
}
