//! Offscreen targets: colour and depth for one or two eyes, read back as pictures. For files,
//! tests, and pictures shown elsewhere.

use std::sync::Arc;

use ash::vk;
use glam::UVec2;

use crate::gpu::{
    Attachment, Device, EyeImage, Load, Recorder, ResourceUse, Result, read_image_once,
};
use crate::shade::Pixels;

/// The colour format: sRGB values, not encoded by the device.
pub const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// An offscreen target.
pub struct Offscreen {
    colour: EyeImage,
    depth: EyeImage,
    device: Arc<Device>,
}

impl Offscreen {
    /// Creates a target of `size` pixels for each of `eyes` eyes (1 or 2).
    pub fn new(device: &Arc<Device>, size: UVec2, eyes: u32) -> Result<Offscreen> {
        use vk::ImageUsageFlags as Usage;
        let usage = Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC;
        let colour = EyeImage::new(device, "offscreen", size, eyes, FORMAT, usage)?;
        let usage = Usage::DEPTH_STENCIL_ATTACHMENT;
        let format = vk::Format::D32_SFLOAT;
        let depth = EyeImage::new(device, "offscreen depth", size, eyes, format, usage)?;
        Ok(Offscreen { colour, depth, device: device.clone() })
    }

    /// Returns the size in pixels.
    pub fn size(&self) -> UVec2 {
        self.colour.size()
    }

    pub fn eyes(&self) -> u32 {
        self.colour.eyes()
    }

    /// Starts rendering for `eye`, cleared to transparent black at infinite depth.
    pub fn begin(&mut self, recorder: &mut Recorder, eye: u32) {
        self.colour.begin_overwrite(recorder, eye, ResourceUse::COLOUR_TARGET);
        self.depth.begin_overwrite(recorder, eye, ResourceUse::DEPTH_TARGET);
        recorder.begin_rendering(
            self.size().to_array(),
            Some(Attachment {
                view: self.colour.image().layer_view(eye),
                load: Load::Colour([0.0; 4]),
                store: true,
            }),
            Some(Attachment {
                view: self.depth.image().layer_view(eye),
                load: Load::Depth(0.0),
                store: false,
            }),
        );
    }

    /// Ends rendering.
    pub fn end(&self, recorder: &mut Recorder) {
        recorder.end_rendering();
    }

    /// Returns the picture of `eye`, once the recording has been submitted. Waits for it.
    pub fn read_back(&self, eye: u32) -> Result<Pixels> {
        let image = self.colour.image();
        let part = image.layer(eye);
        let bytes =
            read_image_once(&self.device, part, image.size(), 4, ResourceUse::COLOUR_TARGET)?;
        Ok(Pixels { size: self.size(), rgba: bytemuck::pod_collect_to_vec(&bytes) })
    }
}
