//! Owns the pictures that are measured: each mode's way from a document to a picture, with the
//! time that each stage takes.
//!
//! Where there is a Vulkan device, pictures come from the renderer of the window, whatever the
//! mode. Without one the modes of the CPU are still measured, up to the shaded picture. What an
//! edit costs in a mode of the CPU is measured on its kernels: only the pixels that may have
//! changed are sampled and shaded anew.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{Affine3A, Vec3};

use crate::config::RenderMode;
use crate::document::Document;
use crate::gpu::{Device, Frames, Result};
use crate::picture::BACKGROUND;
use crate::render::{Background, Renderer, Shot};
use crate::screen::offscreen::FORMAT;
use crate::sculpture::Grid;
use crate::shade::{self, Lighting, NORMAL_REACH_VX, Pixels, ShadePose};
use crate::surface::{IndexMap, PixelRect, changed_pixels, quickstep, raycast};
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
}

impl StageTimes {
    pub fn whole(&self) -> Duration {
        self.sample + self.shade + self.composite.unwrap_or_default()
    }
}

/// What makes pictures of one document in one mode.
pub struct Pictures {
    mode: RenderMode,
    eye: Eye,
    lighting: Lighting,
    caster: Option<Caster>,
    rendered: Option<Rendered>,
    map: Arc<IndexMap>,
    pixels: Pixels,
}

/// The kernels of a mode of the CPU.
#[derive(Clone, Copy)]
struct Caster {
    whole: fn(&Grid, &PixelRays, &mut IndexMap),
    rect: fn(&Grid, &mut IndexMap, PixelRect),
}

impl Caster {
    fn of(mode: RenderMode) -> Option<Caster> {
        match mode {
            RenderMode::Ray => Some(Caster { whole: raycast::sample, rect: raycast::sample_rect }),
            RenderMode::Quickstep => {
                Some(Caster { whole: quickstep::sample, rect: quickstep::sample_rect })
            }
            _ => None,
        }
    }
}

/// The renderer of the window, drawing to images.
struct Rendered {
    renderer: Renderer,
    frames: Frames,
    device: Arc<Device>,
    /// Pictures drawn so far.
    count: u32,
}

impl Pictures {
    /// None where the mode needs a device and there is none.
    pub fn new(
        mode: RenderMode,
        document: &mut Document,
        eye: Eye,
        lighting: Lighting,
        device: Option<&Arc<Device>>,
    ) -> Result<Option<Pictures>> {
        let caster = Caster::of(mode);
        if device.is_none() && caster.is_none() {
            return Ok(None);
        }
        let rendered = device.map(Rendered::new).transpose()?;
        let rays = eye.pixel_rays(&document.world_from_grid());
        let mut map = IndexMap::new(rays);
        let mut pixels = Pixels::new(rays.size);
        if let Some(caster) = caster {
            (caster.whole)(document.grid(), &rays, &mut map);
            let whole = PixelRect::of_picture(rays.size);
            shade_rect(document, &eye, &lighting, &map, whole, &mut pixels);
            document.take_dirty(|_, _| ());
        }
        let map = Arc::new(map);
        Ok(Some(Pictures { mode, eye, lighting, caster, rendered, map, pixels }))
    }

    /// What is seen.
    pub fn map(&self) -> &IndexMap {
        &self.map
    }

    /// A whole picture.
    pub fn whole(&mut self, document: &mut Document) -> Result<StageTimes> {
        let mut times = StageTimes::default();
        if let Some(rendered) = &mut self.rendered {
            times = rendered.draw(self.mode, &self.eye, &self.lighting, document, true)?;
            if self.caster.is_none() {
                self.map = rendered.map(&self.map);
            }
        } else if let Some(caster) = self.caster {
            let start = Instant::now();
            let rays = self.map.rays;
            (caster.whole)(document.grid(), &rays, Arc::make_mut(&mut self.map));
            times.sample = start.elapsed();
            let start = Instant::now();
            self.shade(document, PixelRect::of_picture(rays.size));
            times.shade = start.elapsed();
        }
        Ok(times)
    }

    /// The shaded picture after an edit, without the composite.
    pub fn after_edit(&mut self, document: &mut Document) -> Result<Duration> {
        let Some(caster) = self.caster else {
            // From the same place, so that no more is done than the edit asks for.
            let Some(rendered) = &mut self.rendered else { return Ok(Duration::ZERO) };
            let times = rendered.draw(self.mode, &self.eye, &self.lighting, document, false)?;
            self.map = rendered.map(&self.map);
            // What is shaded on the device is there only once the whole picture is.
            return Ok(match self.map.is_known() {
                true => times.sample + times.shade,
                false => times.whole(),
            });
        };
        let start = Instant::now();
        let rays = self.map.rays;
        let rects = document.take_dirty(|contents, changed| {
            Some(changed_pixels(&contents.grid, changed?, &rays, NORMAL_REACH_VX))
        });
        let whole = [PixelRect::of_picture(rays.size)];
        for &rect in rects.as_ref().map_or(&whole[..], |rects| rects.as_slice()) {
            (caster.rect)(document.grid(), Arc::make_mut(&mut self.map), rect);
            self.shade(document, rect);
        }
        Ok(start.elapsed())
    }

    fn shade(&mut self, document: &Document, rect: PixelRect) {
        shade_rect(document, &self.eye, &self.lighting, &self.map, rect, &mut self.pixels);
    }
}

fn shade_rect(
    document: &Document,
    eye: &Eye,
    lighting: &Lighting,
    map: &IndexMap,
    rect: PixelRect,
    pixels: &mut Pixels,
) {
    let world_from_grid = document.world_from_grid();
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    shade::shade_rect(map, document.grid(), document.material(), &pose, lighting, rect, pixels);
}

impl Rendered {
    fn new(device: &Arc<Device>) -> Result<Rendered> {
        Ok(Rendered {
            renderer: Renderer::new(device, FORMAT)?,
            frames: Frames::new(device)?,
            device: device.clone(),
            count: 0,
        })
    }

    /// Draws a picture and waits for it; a whole one if it is `anew`.
    fn draw(
        &mut self,
        mode: RenderMode,
        eye: &Eye,
        lighting: &Lighting,
        document: &mut Document,
        anew: bool,
    ) -> Result<StageTimes> {
        // The renderer does nothing twice: a whole picture is seen from a hair's breadth beside
        // the last one.
        self.count += u32::from(anew);
        let aside = Affine3A::from_translation(Vec3::X * 1e-3 * (self.count % 2) as f32);
        let eye = Eye { eye_from_world: aside * eye.eye_from_world, ..*eye };
        let [top, bottom] = BACKGROUND.map(|c| Vec3::from(c.map(f32::from)) / 255.0);
        let shot = Shot {
            eyes: &[eye],
            world_from_grid: document.world_from_grid(),
            mode,
            lighting: *lighting,
            background: Background::Gradient { top, bottom },
            video: None,
            ghosts: &[],
            lines: &[],
        };
        let start = Instant::now();
        let mut recorder = self.frames.begin()?;
        self.renderer.paint(&mut recorder, self.frames.slot(), document, &shot)?;
        let serial = self.frames.submit(recorder, &[], &[])?;
        self.device.wait(serial)?;
        let whole = start.elapsed();
        let times = self.renderer.times();
        let of_ms = |ms: f32| Duration::from_secs_f64(f64::from(ms.max(0.0)) * 1e-3);
        let (sample, shade) = (of_ms(times.sample_ms), of_ms(times.shade_ms));
        let read_back = times.read_back_ms.map(of_ms);
        let composite = Some(whole.saturating_sub(sample + shade));
        Ok(StageTimes { sample, read_back, shade, composite })
    }

    /// What was seen in the picture drawn last.
    fn map(&self, before: &Arc<IndexMap>) -> Arc<IndexMap> {
        self.renderer.maps().first().unwrap_or(before).clone()
    }
}
