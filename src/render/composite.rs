//! The composite pass: draws the shaded picture of a sculpture over the background, with the depth of its
//! surface, so that tools drawn later stand before or behind it.
//!
//! Takes index maps (from the device or the CPU), the pictures shaded from them, and a colour target of any
//! format with a D32 depth buffer. Keeps the pictures on the device.

use std::ops::Range;
use std::sync::Arc;

use ash::vk;
use glam::UVec2;

use super::composite_eye::{CompositeEye, constants};
use super::pending::PendingUpload;
use super::screen_pass::{Input, ScreenPass};
use super::target::IndexTarget;
use crate::gpu::layout::CompositeView;
use crate::gpu::{Depth, Device, EyeImage, Pipeline, Recorder, Result, Staging, shaders};
use crate::shade::Pixels;
use crate::surface::PixelRect;

/// The format of shaded pictures on the device.
pub(super) const PICTURE_FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// The bindings of the index image and of the picture.
const INDEX: u32 = 0;
const PICTURE: u32 = 1;

/// Shaded pictures on the device, and their valid rows.
#[derive(Default)]
pub(super) struct ShadedPictures {
    pictures: Option<EyeImage>,
    uploaded: Vec<Range<u32>>,
    pending: Vec<PendingUpload>,
}

/// Draws sculptures to a target.
pub struct Composite {
    screen: ScreenPass,
    pipeline: Pipeline,
    pictures: Option<EyeImage>,
    /// The rows of each eye's picture that are on the device.
    uploaded: Vec<Range<u32>>,
    /// The part of each eye's picture that was shaded after its last upload.
    pending: Vec<PendingUpload>,
    staging: Staging,
}

impl Composite {
    /// Creates one for targets of `format` and up to `eyes` eyes.
    pub fn new(device: &Arc<Device>, format: vk::Format, eyes: u32) -> Result<Composite> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let image = vk::DescriptorType::SAMPLED_IMAGE;
        let bindings = [(INDEX, image, fragment), (PICTURE, image, fragment)];
        let name = "composite";
        let screen =
            ScreenPass::new::<CompositeView>(device, name, format, eyes, &bindings, fragment)?;
        let shader = match screen.is_linear() {
            true => shaders::COMPOSITE_LINEAR_FRAG,
            false => shaders::COMPOSITE_FRAG,
        };
        let pipeline = Pipeline::graphics(device, &screen.graphics(shader, Depth::OVERWRITE))?;
        Ok(Composite {
            screen,
            pipeline,
            pictures: None,
            uploaded: vec![0..0; eyes as usize],
            pending: vec![PendingUpload::Nothing; eyes as usize],
            staging: Staging::new(
                device,
                "shaded pictures",
                vk::BufferUsageFlags::TRANSFER_SRC,
                1 << 20,
            )?,
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.screen.begin(slot);
        self.staging.begin(slot);
    }

    /// Returns the pictures of all eyes, `size` pixels each, for a pass that shades on the device. Call before
    /// rendering begins; that pass leaves them in the layout of [`crate::gpu::ResourceUse::SHADER_READ`].
    pub fn pictures(&mut self, size: UVec2) -> Result<&mut EyeImage> {
        if self.pictures.as_ref().is_some_and(|pictures| pictures.size() != size) {
            self.pictures = None;
        }
        Ok(match &mut self.pictures {
            Some(pictures) => pictures,
            none => none.insert(EyeImage::new(
                self.screen.device(),
                "shaded picture",
                size,
                self.screen.eyes(),
                PICTURE_FORMAT,
                vk::ImageUsageFlags::SAMPLED
                    | vk::ImageUsageFlags::STORAGE
                    | vk::ImageUsageFlags::COLOR_ATTACHMENT
                    | vk::ImageUsageFlags::TRANSFER_DST,
            )?),
        })
    }

    /// Exchanges the pictures for others.
    pub(super) fn swap_pictures(&mut self, other: &mut ShadedPictures) {
        other.uploaded.resize(self.uploaded.len(), 0..0);
        other.pending.resize(self.pending.len(), PendingUpload::Nothing);
        std::mem::swap(&mut self.pictures, &mut other.pictures);
        std::mem::swap(&mut self.uploaded, &mut other.uploaded);
        std::mem::swap(&mut self.pending, &mut other.pending);
    }

    /// Records that the picture of `eye` was shaded, or only these pixels of it.
    pub(super) fn note_shaded(&mut self, eye: u32, changed: Option<PixelRect>) {
        let pending = &mut self.pending[eye as usize];
        *pending = pending.and(changed);
    }

    /// Uploads the part of the picture of `eye` that was shaded after its last upload. Call before rendering begins.
    pub(super) fn upload_shaded(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        pixels: &Pixels,
        visible: PixelRect,
    ) -> Result<()> {
        match std::mem::take(&mut self.pending[eye as usize]) {
            PendingUpload::Nothing => Ok(()),
            PendingUpload::Changed(rect) => self.upload(recorder, eye, pixels, visible, Some(rect)),
            PendingUpload::All => self.upload(recorder, eye, pixels, visible, None),
        }
    }

    /// Uploads the rows of `visible` of the picture of `eye`, or only those of `changed`, if nothing else differs from
    /// the last upload. Call before rendering begins; the pictures of all eyes have the same size.
    pub fn upload(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        pixels: &Pixels,
        visible: PixelRect,
        changed: Option<PixelRect>,
    ) -> Result<()> {
        let former = std::mem::replace(&mut self.uploaded[eye as usize], visible.rows());
        let changed = changed.filter(|_| former == visible.rows());
        let rect = changed.map_or(visible, |changed| changed.intersect(visible));
        let piece = self.staging.push(rect.rows_of(&pixels.rgba, pixels.size.x), 4)?;
        let image = self.pictures(pixels.size)?;
        match changed {
            Some(_) => image.update_rows(recorder, eye, piece, rect.rows()),
            None => image.upload_rows(recorder, eye, piece, rect.rows()),
        }
        Ok(())
    }

    /// Draws the background and the picture uploaded or shaded last for the eye of `view`, within rendering. Its
    /// map in `maps` must be the one it was shaded from, and ready for shaders ([`IndexTarget::make_readable`]).
    pub fn draw(&mut self, recorder: &mut Recorder, maps: &IndexTarget, view: &CompositeEye) {
        let eye = view.eye;
        self.screen.draw_background(recorder, view);
        let Some(pictures) = &self.pictures else { return };
        let (index, picture) = (maps.index().image(), pictures.image());
        let inputs = [
            Input { binding: INDEX, image: index, view: index.layer_view(eye) },
            Input { binding: PICTURE, image: picture, view: picture.layer_view(eye) },
        ];
        self.screen.write_inputs(eye, inputs);
        let push = constants(view, self.screen.is_linear());
        self.screen.draw(recorder, &self.pipeline, view, &push, 3);
    }
}
