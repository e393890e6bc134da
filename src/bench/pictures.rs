//! Benchmarks of pictures: each mode from a document to a picture, with the time of each stage.
//!
//! With a Vulkan device, all pictures come from the renderer of the window: whole ones and those
//! after an edit. Without one the CPU modes are still measured, by their kernels, up to the shaded
//! picture.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{Affine3A, Mat4, Vec3};

use super::kernel_pictures::KernelPictures;
use super::measured::{AfterEdit, BenchScene, StageTimes};
use crate::document::Document;
use crate::gpu::{Device, Frames, Result};
use crate::picture::BACKGROUND;
use crate::render::{Background, FrameDesc, RenderMode, Renderer, Shading, SmoothSurface};
use crate::screen::offscreen::FORMAT;
use crate::shade::{Ground, Lighting};
use crate::view::{Eye, PixelRays};

/// Renders one document in one mode.
pub struct BenchPictures {
    rays: PixelRays,
    maker: Maker,
}

enum Maker {
    Renderer(Box<Rendered>),
    Kernels(Box<KernelPictures>),
}

/// The light and view of the sculpture, for comparisons.
#[derive(Clone, Copy, Debug)]
pub struct BenchLook {
    pub lighting: Lighting,
    pub smooth_surface: SmoothSurface,
    pub ground: Option<Ground>,
    pub smooth_edges: bool,
    /// Factor on the size of everything in the picture.
    pub magnification: f32,
}

/// The renderer of the window, offscreen.
struct Rendered {
    mode: RenderMode,
    /// Instead of the scene's.
    look: Option<BenchLook>,
    eyes: Vec<Eye>,
    /// The same eyes, displaced by a tiny distance.
    beside: Vec<Eye>,
    lighting: Lighting,
    renderer: Renderer,
    frames: Frames,
    device: Arc<Device>,
    /// Whether the last whole picture was rendered from `beside`.
    is_beside: bool,
}

/// Longest delay of a picture after an edit by the normals of an opened sculpture, as in the window.
const PATIENCE: Duration = Duration::from_millis(6);

impl BenchPictures {
    /// Creates one; `None` if the mode needs a device and there is none.
    pub fn new(
        scene: &BenchScene,
        document: &mut Document,
        device: Option<&Arc<Device>>,
    ) -> Result<Option<BenchPictures>> {
        let Some(eye) = scene.eyes.first() else { return Ok(None) };
        let rays = eye.pixel_rays(&document.world_from_grid());
        let maker = match device {
            Some(device) => Maker::Renderer(Box::new(Rendered::new(scene, device)?)),
            None => match KernelPictures::new(scene, document) {
                Some(kernels) => Maker::Kernels(Box::new(kernels)),
                None => return Ok(None),
            },
        };
        Ok(Some(BenchPictures { rays, maker }))
    }

    /// Switches to another mode. Returns false if that needs another value of this type.
    pub fn turn_to(&mut self, mode: RenderMode) -> bool {
        match &mut self.maker {
            Maker::Renderer(rendered) => {
                rendered.mode = mode;
                true
            }
            Maker::Kernels(_) => false,
        }
    }

    /// Sets the look of further pictures; `None`: that of the scene. Returns false without a device.
    pub fn set_look(&mut self, look: Option<&BenchLook>) -> bool {
        match &mut self.maker {
            Maker::Renderer(rendered) => {
                rendered.look = look.copied();
                true
            }
            Maker::Kernels(_) => false,
        }
    }

    /// Returns the rays of the first eye.
    pub fn rays(&self) -> &PixelRays {
        &self.rays
    }

    /// Renders a whole picture.
    pub fn whole(&mut self, document: &mut Document) -> Result<StageTimes> {
        match &mut self.maker {
            Maker::Renderer(rendered) => rendered.whole(document),
            Maker::Kernels(kernels) => Ok(kernels.whole(document)),
        }
    }

    /// Renders the picture that a window shows of the view at rest, after that of an edit.
    pub fn settle(&mut self, document: &mut Document) -> Result<()> {
        match &mut self.maker {
            Maker::Renderer(rendered) => rendered.draw(document).map(drop),
            Maker::Kernels(_) => Ok(()),
        }
    }

    /// Renders the picture after an edit, from the same position as the last one.
    pub fn after_edit(&mut self, document: &mut Document) -> Result<AfterEdit> {
        match &mut self.maker {
            Maker::Renderer(rendered) => rendered.after_edit(document),
            Maker::Kernels(kernels) => Ok(kernels.after_edit(document)),
        }
    }
}

impl Rendered {
    fn new(scene: &BenchScene, device: &Arc<Device>) -> Result<Rendered> {
        let aside = |eye: &Eye| {
            let aside = Affine3A::from_translation(Vec3::X * 1e-3);
            Eye { eye_from_world: aside * eye.eye_from_world, ..*eye }
        };
        Ok(Rendered {
            mode: scene.mode,
            look: None,
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
        // The renderer does not repeat unchanged pictures.
        self.is_beside = !self.is_beside;
        self.renderer.set_patience(None);
        self.draw(document)
    }

    fn after_edit(&mut self, document: &mut Document) -> Result<AfterEdit> {
        // From the same position, so that only the effect of the edit is repeated; with the window's limit on delays.
        self.renderer.set_patience(Some(PATIENCE));
        let times = self.draw(document)?;
        Ok(match self.mode.shading() {
            Shading::Software => {
                AfterEdit { shaded: times.sample + times.shade, composite: times.composite }
            }
            // Shading on the device finishes with the whole picture.
            Shading::Points | Shading::Device | Shading::Within => {
                AfterEdit { shaded: times.whole(), composite: None }
            }
        })
    }

    /// Renders a picture and waits for it.
    fn draw(&mut self, document: &mut Document) -> Result<StageTimes> {
        let [top, bottom] = BACKGROUND.map(|c| Vec3::from(c.map(f32::from)) / 255.0);
        let look = self.look.unwrap_or(BenchLook {
            lighting: self.lighting,
            smooth_surface: SmoothSurface::Never,
            ground: None,
            smooth_edges: false,
            magnification: 1.0,
        });
        let magnified = |eye: &Eye| {
            let scale = Vec3::new(look.magnification, look.magnification, 1.0);
            Eye { projection: Mat4::from_scale(scale) * eye.projection, ..*eye }
        };
        let eyes = if self.is_beside { &self.beside } else { &self.eyes };
        let eyes: Vec<Eye> = eyes.iter().map(magnified).collect();
        let desc = FrameDesc {
            eyes: &eyes,
            world_from_grid: document.world_from_grid(),
            mode: self.mode,
            smooth_surface: look.smooth_surface,
            sample: 0,
            lighting: look.lighting,
            show_mask: false,
            background: Background::Gradient { top, bottom },
            ground: look.ground,
            smooth_edges: look.smooth_edges,
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
