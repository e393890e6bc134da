//! The passes that shade a sculpture on the device and draw it to pictures, one for each kind of shading. On a software
//! device, background and sculpture are computed and copied if possible ([`super::software_composite`]).
//!
//! Takes a [`SampledFrame`]; [`Layers`] draws everything around the sculpture.

use std::sync::Arc;

use ash::vk;

use super::frame_cache::Redraw;
use super::layers::Layers;
use super::pixel_pass::PixelStage;
use super::sampled_frame::SampledFrame;
use super::sampler::Sampler;
use super::software_composite::{SoftwareComposite, layout_of};
use super::times::PictureTimer;
use super::{
    Background, Composite, EyeTask, GpuOnly, LitSurface, MAX_EYES, PointsPass, Shading,
    ShadingImages, SurfaceShade,
};
use crate::gpu::{Device, Recorder, Result};
use crate::shade::composed::Composition;
use crate::surface::{PixelRects, changed_pixels};

/// See the module text.
pub(super) struct SculpturePasses {
    pub composite: Composite,
    /// The passes of some modes, created when first needed.
    software_composite: Option<SoftwareComposite>,
    points: Option<PointsPass>,
    surface_shade: Option<SurfaceShade>,
    gpu_only: Option<GpuOnly>,
    format: vk::Format,
    device: Arc<Device>,
}

impl SculpturePasses {
    /// Creates one for pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<SculpturePasses> {
        Ok(SculpturePasses {
            composite: Composite::new(device, format, MAX_EYES as u32)?,
            software_composite: None,
            points: None,
            surface_shade: None,
            gpu_only: None,
            format,
            device: device.clone(),
        })
    }

    /// Shades the maps on the device, completely or only the changes.
    pub fn shade(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        redraw: Redraw,
        sampler: &mut Sampler,
    ) -> Result<()> {
        let Some((maps, volume, colours)) = sampler.on_device() else { return Ok(()) };
        let pass = match &mut self.surface_shade {
            Some(pass) => pass,
            none => {
                let stage = PixelStage::of(&self.device);
                none.insert(SurfaceShade::new(&self.device, stage, MAX_EYES as u32)?)
            }
        };
        pass.begin(frame.slot);
        let pictures = self.composite.pictures(maps.size())?;
        let (desc, normals) = (frame.desc, frame.normals);
        for ((i, eye), map) in (0..).zip(desc.eyes).zip(&frame.cpu.maps) {
            let visible = frame.visible[i as usize];
            let mut task = EyeTask { visible, ..EyeTask::whole(i, map.rays) };
            if redraw == Redraw::Changed {
                let (grid, rays) = (frame.document.grid(), &map.rays);
                task.scissor =
                    changed_pixels(grid, normals.reshaded(), rays, desc.reach_vx()).bounds();
            }
            if !task.scissor.is_empty() {
                let surface = LitSurface { colours, normals: normals.copy(), ..frame.surface(eye) };
                let images = ShadingImages { maps: &mut *maps, pictures: &mut *pictures };
                pass.record(recorder, volume, &surface, images, &task)?;
            }
        }
        Ok(())
    }

    /// Composes the pictures of a frame back to front.
    pub fn compose(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        sampler: &mut Sampler,
        layers: &mut Layers,
        timer: &mut PictureTimer,
    ) -> Result<()> {
        let can_be_computed = self.device.is_software()
            && frame.desc.video.is_none()
            && !frame.desc.smooth_edges
            && frame.cpu.maps.iter().all(|map| map.is_known());
        let computed = layout_of(self.format).filter(|_| can_be_computed);
        match frame.shading {
            Shading::Software if let Some(layout) = computed => {
                self.compute(recorder, frame, layout, layers, timer)
            }
            Shading::Software => {
                for (i, pixels) in (0..).zip(&frame.cpu.pixels[..frame.cpu.maps.len()]) {
                    let visible = frame.visible[i as usize];
                    self.composite.upload_shaded(recorder, i, pixels, visible)?;
                }
                self.draw_shaded(recorder, frame, sampler, layers, timer)
            }
            Shading::Device => self.draw_shaded(recorder, frame, sampler, layers, timer),
            Shading::Points => self.draw_points(recorder, frame, layers, timer),
            Shading::Within => self.draw_within(recorder, frame, sampler, layers, timer),
        }
    }

    /// Composes with [`SoftwareComposite`]. The layout of pixels: whether blue comes first, and whether the device
    /// encodes them.
    fn compute(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        (is_bgra, is_linear): (bool, bool),
        layers: &mut Layers,
        timer: &mut PictureTimer,
    ) -> Result<()> {
        let pass = match &mut self.software_composite {
            Some(pass) => pass,
            none => none.insert(SoftwareComposite::new(&self.device)?),
        };
        pass.begin(frame.slot);
        layers.begin(recorder, frame)?;
        timer.start(recorder, PictureTimer::COMPOSE);
        for eye in frame.eyes() {
            let view = &eye.view;
            let composition = Composition {
                map: eye.map,
                pixels: &frame.cpu.pixels[view.eye as usize],
                projection: view.projection,
                background: match view.background {
                    Background::Keep => None,
                    Background::Gradient { top, bottom } => Some([top, bottom]),
                },
                is_linear,
                is_bgra,
                visible: view.visible,
            };
            for scissor in eye.rects.as_slice() {
                let Some(pictures) = &mut layers.pictures else { return Ok(()) };
                pass.compose(recorder, pictures, view.eye, &composition, *scissor)?;
                layers.draw_over(recorder, frame, &eye, *scissor)?;
            }
        }
        timer.stop(recorder, PictureTimer::COMPOSE);
        Ok(())
    }

    /// Draws shaded pictures, which are on the device, using their maps.
    fn draw_shaded(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        sampler: &mut Sampler,
        layers: &mut Layers,
        timer: &mut PictureTimer,
    ) -> Result<()> {
        let pass = &mut self.composite;
        let maps = sampler.maps(recorder, frame.slot, &frame.cpu.maps)?;
        layers.begin(recorder, frame)?;
        timer.start(recorder, PictureTimer::COMPOSE);
        for eye in frame.eyes() {
            layers.draw(recorder, frame, &eye, &eye.rects, |recorder, view| {
                pass.draw(recorder, maps, view);
                Ok(())
            })?;
        }
        timer.stop(recorder, PictureTimer::COMPOSE);
        Ok(())
    }

    /// Draws lit points.
    fn draw_points(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        layers: &mut Layers,
        timer: &mut PictureTimer,
    ) -> Result<()> {
        let pass = match &mut self.points {
            Some(pass) => pass,
            none => none.insert(PointsPass::new(&self.device, self.format, MAX_EYES as u32)?),
        };
        pass.begin(frame.slot);
        for (eye, cloud) in (0..).zip(&frame.cpu.clouds[..frame.cpu.maps.len()]) {
            pass.upload(eye, cloud)?;
        }
        layers.begin(recorder, frame)?;
        timer.start(recorder, PictureTimer::COMPOSE);
        for eye in frame.eyes() {
            // Each draw writes uniforms.
            let rects = PixelRects::of(eye.rects.bounds());
            layers.draw(recorder, frame, &eye, &rects, |recorder, view| {
                pass.draw(recorder, &eye.surface, view)
            })?;
        }
        timer.stop(recorder, PictureTimer::COMPOSE);
        Ok(())
    }

    /// Draws with the pass that also samples and lights.
    fn draw_within(
        &mut self,
        recorder: &mut Recorder,
        frame: &SampledFrame,
        sampler: &Sampler,
        layers: &mut Layers,
        timer: &mut PictureTimer,
    ) -> Result<()> {
        let pass = match &mut self.gpu_only {
            Some(pass) => pass,
            none => none.insert(GpuOnly::new(&self.device, self.format, MAX_EYES as u32)?),
        };
        pass.begin(frame.slot);
        let Some((volume, colours)) = sampler.copy() else { return Ok(()) };
        layers.begin(recorder, frame)?;
        timer.start(recorder, PictureTimer::COMPOSE);
        for eye in frame.eyes() {
            pass.prepare(recorder, volume, &eye.map.rays, eye.view.eye)?;
            let normals = frame.normals.copy();
            let surface = LitSurface { colours, normals, ..eye.surface };
            // Each draw writes uniforms.
            let rects = PixelRects::of(eye.rects.bounds());
            layers.draw(recorder, frame, &eye, &rects, |recorder, view| {
                pass.draw(recorder, volume, &surface, view)
            })?;
        }
        timer.stop(recorder, PictureTimer::COMPOSE);
        Ok(())
    }
}
