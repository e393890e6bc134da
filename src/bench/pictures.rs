//! Owns the pictures that are measured: each mode's way from a document to a picture, with the
//! time that each stage takes.
//!
//! Where there is a Vulkan device, pictures come from the renderer of the window, whatever the
//! mode, whole ones and those after an edit. Without one the modes of the CPU are still measured, on
//! their kernels, up to the shaded picture.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{Affine3A, Vec3};

use super::kernel_pictures::KernelPictures;
use crate::document::Document;
use crate::gpu::{Device, Frames, Result};
use crate::picture::BACKGROUND;
use crate::render::renderer::DeviceTimes;
use crate::render::{Background, FrameDesc, RenderMode, Renderer, Shading};
use crate::screen::offscreen::FORMAT;
use crate::shade::Lighting;
use crate::view::{Eye, PixelRays};

/// How long the stages of a picture took.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Finding the voxel of each pixel, with the way to the device and back where there is one.
    pub sample: Duration,
    /// Of the sampling: bringing the map from the device to memory.
    pub read_back: Option<Duration>,
    pub shade: Duration,
    /// Putting the picture together on the device.
    pub composite: Option<Duration>,
    /// By the device's own time stamps.
    pub device: DeviceTimes,
}

impl StageTimes {
    pub fn whole(&self) -> Duration {
        self.sample + self.shade + self.composite.unwrap_or_default()
    }
}

/// How long a picture took after an edit.
#[derive(Clone, Copy, Debug, Default)]
pub struct AfterEdit {
    /// Until it was shaded.
    pub shaded: Duration,
    /// From there to the finished picture; none where the device shades as it draws, or there is
    /// none.
    pub composite: Option<Duration>,
}

/// What makes pictures of one document in one mode.
pub struct Pictures {
    rays: PixelRays,
    maker: Maker,
}

enum Maker {
    Renderer(Box<Rendered>),
    Kernels(Box<KernelPictures>),
}

/// What is to be seen.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    pub mode: RenderMode,
    /// One or two.
    pub eyes: &'a [Eye],
    pub lighting: Lighting,
}

/// The renderer of the window, drawing to images.
struct Rendered {
    mode: RenderMode,
    eyes: Vec<Eye>,
    /// These, a hair's breadth aside.
    beside: Vec<Eye>,
    lighting: Lighting,
    renderer: Renderer,
    frames: Frames,
    device: Arc<Device>,
    /// Whether the last whole picture was drawn from beside.
    is_beside: bool,
}

impl Pictures {
    /// None where the mode needs a device and there is none.
    pub fn new(
        scene: &Scene,
        document: &mut Document,
        device: Option<&Arc<Device>>,
    ) -> Result<Option<Pictures>> {
        let Some(eye) = scene.eyes.first() else { return Ok(None) };
        let rays = eye.pixel_rays(&document.world_from_grid());
        let maker = match device {
            Some(device) => Maker::Renderer(Box::new(Rendered::new(scene, device)?)),
            None => match KernelPictures::new(scene, document) {
                Some(kernels) => Maker::Kernels(Box::new(kernels)),
                None => return Ok(None),
            },
        };
        Ok(Some(Pictures { rays, maker }))
    }

    /// Makes pictures in another mode from now on; false if that needs a maker of its own.
    pub fn turn_to(&mut self, mode: RenderMode) -> bool {
        match &mut self.maker {
            Maker::Renderer(rendered) => {
                rendered.mode = mode;
                true
            }
            Maker::Kernels(_) => false,
        }
    }

    /// Of the first eye.
    pub fn rays(&self) -> &PixelRays {
        &self.rays
    }

    /// A whole picture.
    pub fn whole(&mut self, document: &mut Document) -> Result<StageTimes> {
        match &mut self.maker {
            Maker::Renderer(rendered) => rendered.whole(document),
            Maker::Kernels(kernels) => Ok(kernels.whole(document)),
        }
    }

    /// The picture after an edit, from where the last one was seen.
    pub fn after_edit(&mut self, document: &mut Document) -> Result<AfterEdit> {
        match &mut self.maker {
            Maker::Renderer(rendered) => rendered.after_edit(document),
            Maker::Kernels(kernels) => Ok(kernels.after_edit(document)),
        }
    }
}

impl Rendered {
    fn new(scene: &Scene, device: &Arc<Device>) -> Result<Rendered> {
        let aside = |eye: &Eye| {
            let aside = Affine3A::from_translation(Vec3::X * 1e-3);
            Eye { eye_from_world: aside * eye.eye_from_world, ..*eye }
        };
        Ok(Rendered {
            mode: scene.mode,
            eyes: scene.eyes.to_vec(),
            beside: scene.eyes.iter().map(aside).collect(),
            lighting: scene.lighting,
            renderer: Renderer::new(device, FORMAT)?,
            frames: Frames::new(device)?,
            device: device.clone(),
            is_beside: false,
        })
    }

    fn whole(&mut self, document: &mut Document) -> Result<StageTimes> {
        // The renderer does nothing twice.
        self.is_beside = !self.is_beside;
        self.draw(document)
    }

    fn after_edit(&mut self, document: &mut Document) -> Result<AfterEdit> {
        // From the same place, so that no more is done than the edit asks for.
        let times = self.draw(document)?;
        Ok(match self.mode.shading() {
            Shading::Software => {
                AfterEdit { shaded: times.sample + times.shade, composite: times.composite }
            }
            // What is shaded on the device is there only once the whole picture is.
            Shading::Points | Shading::Device | Shading::Within => {
                AfterEdit { shaded: times.whole(), composite: None }
            }
        })
    }

    /// Draws a picture and waits for it.
    fn draw(&mut self, document: &mut Document) -> Result<StageTimes> {
        let [top, bottom] = BACKGROUND.map(|c| Vec3::from(c.map(f32::from)) / 255.0);
        let desc = FrameDesc {
            eyes: if self.is_beside { &self.beside } else { &self.eyes },
            world_from_grid: document.world_from_grid(),
            mode: self.mode,
            lighting: self.lighting,
            background: Background::Gradient { top, bottom },
            video: None,
            previews: &[],
            lines: &[],
        };
        let start = Instant::now();
        let mut recorder = self.frames.begin()?;
        self.renderer.paint(&mut recorder, self.frames.slot(), document, &desc)?;
        let serial = self.frames.submit(recorder, &[], &[])?;
        self.device.wait(serial)?;
        let whole = start.elapsed();
        let times = self.renderer.times_when_done()?;
        let of_ms = |ms: f32| Duration::from_secs_f64(f64::from(ms.max(0.0)) * 1e-3);
        let (sample, shade) = (of_ms(times.sample_ms), of_ms(times.shade_ms));
        let read_back = times.read_back_ms.map(of_ms);
        let composite = Some(whole.saturating_sub(sample + shade));
        Ok(StageTimes { sample, read_back, shade, composite, device: times.device })
    }
}
