//! The images for finished pictures: colour and depth, with a layer per eye.

use std::sync::Arc;

use ash::vk;
use glam::UVec2;

use super::Background;
use crate::gpu::{Attachment, Device, EyeImage, Load, Recorder, ResourceUse, Result};
use crate::surface::PixelRect;
use crate::view::Eye;

/// The format of depth: reversed, 1 at the near plane and 0 at infinity.
pub const DEPTH_FORMAT: vk::Format = vk::Format::D32_SFLOAT;

/// Finished pictures, with a layer per eye.
pub struct FinishedPictures {
    /// In the layout of [`ResourceUse::COPY_SOURCE`].
    pub colour: EyeImage,
    /// In the layout of [`ResourceUse::DEPTH_TARGET`], of [`DEPTH_FORMAT`].
    pub depth: EyeImage,
}

impl FinishedPictures {
    fn new(
        device: &Arc<Device>,
        size: UVec2,
        eyes: u32,
        format: vk::Format,
    ) -> Result<FinishedPictures> {
        use vk::ImageUsageFlags as Usage;
        // Composed pictures are copied to them (super::software_composite).
        let copied = match device.is_software() {
            true => Usage::TRANSFER_DST,
            false => Usage::empty(),
        };
        let usage = copied | Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC | Usage::SAMPLED;
        let colour = EyeImage::new(device, "picture", size, eyes, format, usage)?;
        let usage = copied | Usage::DEPTH_STENCIL_ATTACHMENT | Usage::TRANSFER_SRC | Usage::SAMPLED;
        let depth = EyeImage::new(device, "picture depth", size, eyes, DEPTH_FORMAT, usage)?;
        Ok(FinishedPictures { colour, depth })
    }

    /// Starts drawing `area` of the picture of `eye`, at infinite depth; the rest keeps its contents. A gradient covers
    /// all of it; with [`Background::Keep`] the undrawn part is transparent, with premultiplied colours.
    pub(super) fn begin(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        background: Background,
        area: PixelRect,
    ) {
        let size = self.colour.size();
        let place = area.corner_and_size();
        self.colour.begin_overwrite_area(recorder, eye, place, ResourceUse::COLOUR_TARGET);
        self.depth.begin_overwrite_area(recorder, eye, place, ResourceUse::DEPTH_TARGET);
        let colours = match background {
            Background::Keep => Load::Colour([0.0; 4]),
            // The gradient covers every pixel.
            Background::Gradient { .. } => Load::Forget,
        };
        let attachment = |image: &EyeImage, load| {
            let view = image.image().layer_view(eye);
            Some(Attachment { view, load, store: true })
        };
        let colour = attachment(&self.colour, colours);
        let depth = attachment(&self.depth, Load::Depth(0.0));
        recorder.begin_rendering_in(size.to_array(), area.corner_and_size(), colour, depth);
    }

    /// Starts drawing over the contents of `area` of the picture of `eye`.
    pub(super) fn begin_over(&mut self, recorder: &mut Recorder, eye: u32, area: PixelRect) {
        self.colour.transition(recorder, eye, ResourceUse::COLOUR_TARGET);
        self.depth.transition(recorder, eye, ResourceUse::DEPTH_TARGET);
        let attachment = |image: &EyeImage| {
            let view = image.image().layer_view(eye);
            Some(Attachment { view, load: Load::Keep, store: true })
        };
        let (colour, depth) = (attachment(&self.colour), attachment(&self.depth));
        let size = self.colour.size().to_array();
        recorder.begin_rendering_in(size, area.corner_and_size(), colour, depth);
    }
}

/// Returns the images for pictures of `eyes`.
pub(super) fn pictures<'a>(
    device: &Arc<Device>,
    pictures: &'a mut Option<FinishedPictures>,
    format: vk::Format,
    eyes: &[Eye],
) -> Result<&'a mut FinishedPictures> {
    let size = eyes.first().map_or(UVec2::ONE, |eye| eye.size);
    let count = eyes.len() as u32;
    let fits = |p: &FinishedPictures| p.colour.size() == size && p.colour.eyes() == count;
    if !pictures.as_ref().is_some_and(fits) {
        *pictures = None;
    }
    Ok(match pictures {
        Some(pictures) => pictures,
        none => none.insert(FinishedPictures::new(device, size, count, format)?),
    })
}
