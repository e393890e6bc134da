//! Owns the picture of the sculpture: brings up to date what has changed (the voxels seen, their
//! shades, the picture with background and overlay) and nothing else.
//!
//! Takes the workbench's state as values; leaves the picture in an image of its own, so that an
//! interface that changes over a resting sculpture costs a copy only.

use std::sync::Arc;
use std::time::Instant;

use ash::vk;
use glam::{Affine3A, UVec2, Vec3};

use super::guides;
use super::sampler::Sampler;
use super::workbench::Workbench;
use crate::config::{LightSettings, RenderMode, Theme};
use crate::gpu::{Attachment, Device, GpuError, Load, Recorder, Result, Use};
use crate::render::overlay::{Ghost, Line, Overlay, Scene};
use crate::render::target::EyeImage;
use crate::render::{Background, Composite, CompositeEye};
use crate::shade::{Pixels, ShadePose, shade};
use crate::surface::IndexMap;
use crate::view::Eye;

const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// What the voxels of a picture depend on.
#[derive(Clone, Copy, PartialEq)]
struct SampleKey {
    revision: u64,
    eye: Eye,
    world_from_grid: Affine3A,
    mode: RenderMode,
}

/// What the picture as a whole depends on.
#[derive(Clone, PartialEq)]
struct PictureKey {
    sample: SampleKey,
    light: LightSettings,
    theme: Theme,
    ghost: Option<Ghost>,
    lines: Vec<Line>,
}

/// The picture of the sculpture.
pub struct Painter {
    sampler: Sampler,
    composite: Composite,
    overlay: Overlay,
    picture: Picture,
    /// Shared with the workbench, which asks it what the pointer points at.
    map: Arc<IndexMap>,
    pixels: Pixels,
    /// What the picture was made of.
    shown: Option<PictureKey>,
    device: Arc<Device>,
}

/// The finished picture and its depth.
struct Picture {
    colour: EyeImage,
    depth: EyeImage,
}

impl Painter {
    /// For pictures of `format`, the first for `eye`.
    pub fn new(device: &Arc<Device>, format: vk::Format, eye: &Eye) -> Result<Painter> {
        let rays = eye.pixel_rays(&Affine3A::IDENTITY);
        Ok(Painter {
            sampler: Sampler::new(device)?,
            composite: Composite::new(device, format, 1)?,
            overlay: Overlay::new(device, format, DEPTH)?,
            picture: Picture::new(device, eye.size, format)?,
            map: Arc::new(IndexMap::new(rays)),
            pixels: Pixels::default(),
            shown: None,
            device: device.clone(),
        })
    }

    /// Records what the workbench's next picture needs, and gives the picture, in the layout of
    /// [`Use::COPY_SOURCE`]. `slot`: [`crate::gpu::Frames::slot`].
    pub fn paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        bench: &mut Workbench,
    ) -> Result<&EyeImage> {
        let mut key = picture_key(bench);
        let before = self.shown.take();
        if before.as_ref() != Some(&key) {
            let resample = before.as_ref().is_none_or(|b| b.sample != key.sample);
            if resample {
                self.sample(bench, &mut key)?;
            }
            self.composite.begin(slot);
            if resample || before.is_none_or(|b| b.light != key.light) {
                self.shade(bench, &key);
                self.composite.upload(recorder, 0, &self.pixels)?;
            }
            self.compose(recorder, slot, bench, &key)?;
        }
        // Only what is complete counts as shown.
        self.shown = Some(key);
        self.picture.colour.make(recorder, 0, Use::COPY_SOURCE);
        Ok(&self.picture.colour)
    }

    /// Finds the voxels that are seen. A sculpture that is too large for the device's images is
    /// cast on the CPU from then on.
    fn sample(&mut self, bench: &mut Workbench, key: &mut PictureKey) -> Result<()> {
        let start = Instant::now();
        bench.forget_seen();
        let map = Arc::make_mut(&mut self.map);
        let SampleKey { eye, world_from_grid, mode, .. } = key.sample;
        let document = bench.session_mut().document_mut();
        let result = self.sampler.sample(document, &eye, &world_from_grid, mode, map);
        if result.is_err() {
            self.sampler.forget_copy();
        }
        match result {
            Err(error @ GpuError::Limit { .. }) => {
                let mode = RenderMode::Ray;
                bench.ui.toasts.error(format!("{error}; rendering by {}", mode.label()));
                bench.ui.view.mode = mode;
                key.sample.mode = mode;
                let document = bench.session_mut().document_mut();
                self.sampler.sample(document, &eye, &world_from_grid, mode, map)?;
            }
            result => result?,
        }
        bench.saw(self.map.clone());
        bench.times.sample_ms = ms_since(start);
        Ok(())
    }

    fn shade(&mut self, bench: &mut Workbench, key: &PictureKey) {
        let start = Instant::now();
        let document = bench.session().document();
        let pose = ShadePose {
            eye_from_world: key.sample.eye.eye_from_world,
            world_from_grid: key.sample.world_from_grid,
        };
        let lighting = key.light.lighting();
        shade(&self.map, document.grid(), document.material(), &pose, &lighting, &mut self.pixels);
        bench.times.shade_ms = ms_since(start);
    }

    /// Puts the picture together, back to front.
    fn compose(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        bench: &Workbench,
        key: &PictureKey,
    ) -> Result<()> {
        let eye = &key.sample.eye;
        if self.picture.colour.size() != eye.size {
            let format = self.picture.colour.image().format();
            self.picture = Picture::new(&self.device, eye.size, format)?;
        }
        let maps = self.sampler.maps(recorder, slot, &self.map)?;
        self.picture.begin(recorder);
        let composite = CompositeEye {
            rays: self.map.rays,
            projection: eye.projection,
            dims: bench.session().document().grid().dims(),
            corner: UVec2::ZERO,
            size: eye.size,
            background: background(key.theme),
        };
        self.composite.draw(recorder, maps, 0, &composite);
        let scene = Scene {
            eye_from_grid: eye.eye_from_world * key.sample.world_from_grid,
            projection: eye.projection,
            size: eye.size.to_array(),
            ghost: key.ghost,
            lines: &key.lines,
        };
        self.overlay.draw(recorder, slot, &scene)?;
        recorder.end_rendering();
        Ok(())
    }
}

impl Picture {
    fn new(device: &Arc<Device>, size: UVec2, format: vk::Format) -> Result<Picture> {
        use vk::ImageUsageFlags as Usage;
        let usage = Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC;
        let colour = EyeImage::new(device, "picture", size, 1, format, usage)?;
        let usage = Usage::DEPTH_STENCIL_ATTACHMENT;
        let depth = EyeImage::new(device, "picture depth", size, 1, DEPTH, usage)?;
        Ok(Picture { colour, depth })
    }

    fn begin(&mut self, recorder: &mut Recorder) {
        self.colour.renew(recorder, 0, Use::COLOUR_TARGET);
        self.depth.renew(recorder, 0, Use::DEPTH_TARGET);
        // The composite covers every pixel of both.
        let attachment = |image: &EyeImage, store| {
            Some(Attachment { view: image.image().view(), load: Load::Forget, store })
        };
        recorder.begin_rendering(
            self.colour.size().to_array(),
            attachment(&self.colour, true),
            attachment(&self.depth, false),
        );
    }
}

fn picture_key(bench: &Workbench) -> PictureKey {
    let document = bench.session().document();
    let ui = &bench.ui;
    let aid = bench.aid();
    PictureKey {
        sample: SampleKey {
            revision: document.revision(),
            eye: bench.eye(),
            world_from_grid: bench.world_from_grid(),
            mode: ui.view.mode,
        },
        light: ui.view.light.clone(),
        theme: ui.theme,
        ghost: guides::ghost(&aid),
        lines: guides::lines(&aid),
    }
}

/// Quiet greys, lighter above, that let any colour of stone stand out.
fn background(theme: Theme) -> Background {
    let grey = |r: u8, g: u8, b: u8| Vec3::new(r.into(), g.into(), b.into()) / 255.0;
    match theme {
        Theme::Dark => {
            Background::Gradient { top: grey(0x3a, 0x40, 0x4c), bottom: grey(0x18, 0x1a, 0x1f) }
        }
        Theme::Light => {
            Background::Gradient { top: grey(0xf4, 0xf6, 0xf8), bottom: grey(0xc4, 0xcb, 0xd2) }
        }
    }
}

fn ms_since(start: Instant) -> f32 {
    start.elapsed().as_secs_f32() * 1e3
}
