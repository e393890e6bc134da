//! Owns the pictures that are measured: each mode's way from a document to a picture, with the
//! time that each stage takes.
//!
//! The stages are those of the window. The composite is measured where there is a Vulkan device:
//! it takes map and picture to the device and draws them over a background.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ash::vk;
use glam::{UVec2, Vec3};

use crate::config::RenderMode;
use crate::document::Document;
use crate::gpu::{Device, Frames, Result, Staging};
use crate::picture::BACKGROUND;
use crate::render::{
    Background, Composite, CompositeEye, IndexReadback, IndexTarget, Slicing, Volume,
};
use crate::screen::offscreen::{FORMAT, Offscreen};
use crate::sculpture::Grid;
use crate::shade::{self, Lighting, NORMAL_REACH_VX, Pixels, ShadePose};
use crate::surface::slices::SliceAreas;
use crate::surface::{IndexMap, PixelRect, changed_pixels, quickstep, raycast};
use crate::view::{Eye, PixelRays};

/// How long the stages of a picture took.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Finding the voxel of each pixel.
    pub sample: Duration,
    /// Bringing the map from the device.
    pub read_back: Option<Duration>,
    pub shade: Duration,
    pub composite: Option<Duration>,
}

impl StageTimes {
    pub fn whole(&self) -> Duration {
        let rest = self.read_back.unwrap_or_default() + self.composite.unwrap_or_default();
        self.sample + self.shade + rest
    }
}

/// What makes pictures of one document in one mode.
pub struct Pictures {
    sampler: Sampler,
    eye: Eye,
    lighting: Lighting,
    map: IndexMap,
    pixels: Pixels,
    composer: Option<Composer>,
}

/// How maps are made.
enum Sampler {
    /// On the CPU: all of a picture, or a rectangle of it.
    Cpu {
        whole: fn(&Grid, &PixelRays, &mut IndexMap),
        rect: fn(&Grid, &mut IndexMap, PixelRect),
    },
    Slices(Box<Slices>),
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
        let sampler = match (mode, device) {
            (RenderMode::Ray, _) => {
                Sampler::Cpu { whole: raycast::sample, rect: raycast::sample_rect }
            }
            (RenderMode::Quickstep, _) => {
                Sampler::Cpu { whole: quickstep::sample, rect: quickstep::sample_rect }
            }
            (RenderMode::Slicing, Some(device)) => {
                Sampler::Slices(Box::new(Slices::new(device, document.grid(), eye.size)?))
            }
            (RenderMode::Slicing, None) => return Ok(None),
        };
        document.take_dirty(|_, _| ());
        let composer = device.map(|device| Composer::new(device, eye.size)).transpose()?;
        let map = IndexMap::new(eye.pixel_rays(&document.world_from_grid()));
        Ok(Some(Pictures { sampler, eye, lighting, map, pixels: Pixels::default(), composer }))
    }

    /// What is seen.
    pub fn map(&self) -> &IndexMap {
        &self.map
    }

    /// A whole picture.
    pub fn whole(&mut self, document: &mut Document) -> Result<StageTimes> {
        let rays = self.eye.pixel_rays(&document.world_from_grid());
        let mut times = StageTimes::default();
        let start = Instant::now();
        match &mut self.sampler {
            Sampler::Cpu { whole, .. } => whole(document.grid(), &rays, &mut self.map),
            Sampler::Slices(slices) => {
                slices.follow(document)?;
                slices.draw(&rays)?;
                let drawn = Instant::now();
                slices.fetch(&mut self.map)?;
                times.read_back = Some(drawn.elapsed());
            }
        }
        times.sample = start.elapsed() - times.read_back.unwrap_or_default();
        times.shade = self.shade(document, PixelRect::of_picture(rays.size));
        if let Some(composer) = &mut self.composer {
            let start = Instant::now();
            composer.compose(&self.map, &self.pixels, &self.eye, document.grid())?;
            times.composite = Some(start.elapsed());
        }
        Ok(times)
    }

    /// The shaded picture after an edit: of samplers on the CPU only what may have changed.
    pub fn after_edit(&mut self, document: &mut Document) -> Result<Duration> {
        let start = Instant::now();
        let rays = self.map.rays;
        match &mut self.sampler {
            &mut Sampler::Cpu { rect: sample, .. } => {
                let rects = document.take_dirty(|contents, changed| {
                    Some(changed_pixels(&contents.grid, changed?, &rays, NORMAL_REACH_VX))
                });
                let Some(rects) = rects else { return self.whole(document).map(|t| t.whole()) };
                for &rect in rects.as_slice() {
                    sample(document.grid(), &mut self.map, rect);
                    self.shade(document, rect);
                }
            }
            Sampler::Slices(slices) => {
                slices.follow(document)?;
                slices.draw(&rays)?;
                slices.fetch(&mut self.map)?;
                self.shade(document, PixelRect::of_picture(rays.size));
            }
        }
        Ok(start.elapsed())
    }

    fn shade(&mut self, document: &Document, rect: PixelRect) -> Duration {
        let start = Instant::now();
        let pose = ShadePose {
            eye_from_world: self.eye.eye_from_world,
            world_from_grid: document.world_from_grid(),
        };
        let (grid, material) = (document.grid(), document.material());
        let (lighting, pixels) = (&self.lighting, &mut self.pixels);
        shade::shade_rect(&self.map, grid, material, &pose, lighting, rect, pixels);
        start.elapsed()
    }
}

/// Slicing, and the copy of the bits that it draws.
struct Slices {
    pass: Slicing,
    volume: Volume,
    areas: SliceAreas,
    target: IndexTarget,
    readback: IndexReadback,
    frames: Frames,
    slot: usize,
    device: Arc<Device>,
}

impl Slices {
    fn new(device: &Arc<Device>, grid: &Grid, size: UVec2) -> Result<Slices> {
        let mut areas = SliceAreas::default();
        areas.update(grid, None);
        Ok(Slices {
            pass: Slicing::new(device)?,
            volume: Volume::new(device, grid)?,
            areas,
            target: IndexTarget::new(device, size, 1)?,
            readback: IndexReadback::new(device),
            frames: Frames::new(device)?,
            slot: 0,
            device: device.clone(),
        })
    }

    /// Brings copy and areas up to date.
    fn follow(&mut self, document: &mut Document) -> Result<()> {
        document.take_dirty(|contents, changed| {
            if changed.is_some_and(|bricks| bricks.is_empty()) {
                return Ok(());
            }
            self.areas.update(&contents.grid, changed);
            let mut recorder = self.frames.begin()?;
            let slot = self.frames.slot();
            self.volume.update(&mut recorder, slot, &contents.grid, changed)?;
            self.frames.submit(recorder, &[], &[]).map(|_| ())
        })
    }

    /// Draws a map and waits for it.
    fn draw(&mut self, rays: &PixelRays) -> Result<()> {
        let mut recorder = self.frames.begin()?;
        self.slot = self.frames.slot();
        self.pass.begin(self.slot, &self.volume);
        let (pass, areas, target) = (&mut self.pass, &mut self.areas, &mut self.target);
        pass.record(&mut recorder, &self.volume, areas, rays, target, 0)?;
        self.readback.record(&mut recorder, self.slot, target, 0, rays)?;
        let serial = self.frames.submit(recorder, &[], &[])?;
        self.readback.submitted(self.slot, serial);
        self.device.wait(serial)
    }

    fn fetch(&self, map: &mut IndexMap) -> Result<()> {
        self.readback.fetch(self.slot, map)
    }
}

/// The composite pass and the picture that it draws to.
struct Composer {
    composite: Composite,
    maps: IndexTarget,
    staging: Staging,
    screen: Offscreen,
    frames: Frames,
    device: Arc<Device>,
}

impl Composer {
    fn new(device: &Arc<Device>, size: UVec2) -> Result<Composer> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        Ok(Composer {
            composite: Composite::new(device, FORMAT, 1)?,
            maps: IndexTarget::new(device, size, 1)?,
            staging: Staging::new(device, "index maps", usage, 1 << 20)?,
            screen: Offscreen::new(device, size, 1)?,
            frames: Frames::new(device)?,
            device: device.clone(),
        })
    }

    /// Draws a picture and waits for it.
    fn compose(&mut self, map: &IndexMap, pixels: &Pixels, eye: &Eye, grid: &Grid) -> Result<()> {
        let [top, bottom] = BACKGROUND.map(|c| Vec3::from(c.map(f32::from)) / 255.0);
        let view = CompositeEye {
            rays: map.rays,
            projection: eye.projection,
            dims: grid.dims(),
            corner: UVec2::ZERO,
            size: eye.size,
            background: Background::Gradient { top, bottom },
        };
        let mut recorder = self.frames.begin()?;
        let slot = self.frames.slot();
        self.composite.begin(slot);
        self.staging.begin(slot);
        let piece = self.staging.push(&map.voxels, 4)?;
        self.maps.upload(&mut recorder, 0, piece);
        self.maps.make_readable(&mut recorder, 0);
        self.composite.upload(&mut recorder, 0, pixels)?;
        self.screen.begin(&mut recorder, 0);
        self.composite.draw(&mut recorder, &self.maps, 0, &view);
        self.screen.end(&mut recorder);
        let serial = self.frames.submit(recorder, &[], &[])?;
        self.device.wait(serial)
    }
}
