//! Shading of a renderer's index maps: on the CPU, as points, or on the device, all of them or what has changed.

use std::time::Instant;

use super::frame_cache::Redraw;
use super::pixel_pass::PixelStage;
use super::renderer::ms_since;
use super::times::PictureTimer;
use super::{EyeTask, FrameDesc, MAX_EYES, Renderer, Shading, Surface, SurfaceShade};
use crate::document::Document;
use crate::gpu::{Recorder, Result};
use crate::shade::{Pixels, shade_rect};
use crate::surface::changed_pixels;

impl Renderer {
    pub(super) fn shade(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
        redraw: Redraw,
    ) -> Result<()> {
        let start = Instant::now();
        self.normals.upload(&self.device, recorder, slot, desc.mode.shading())?;
        match self.shading(desc.mode) {
            Shading::Software => self.shade_in_software(document, desc, redraw),
            Shading::Points => {
                let source = desc.source(document, self.normals.field());
                for ((map, cloud), eye) in self.maps.iter().zip(&mut self.clouds).zip(desc.eyes) {
                    cloud.take(map, &source, &desc.pose(eye), &desc.lighting);
                }
            }
            Shading::Device => {
                self.timer.start(recorder, PictureTimer::SHADE);
                self.march_to_surface(recorder, slot, document)?;
                self.shade_on_device(recorder, slot, document, desc, redraw)?;
                self.timer.stop(recorder, PictureTimer::SHADE);
            }
            Shading::Within => {}
        }
        // The normals of what is shaded are part of it.
        self.times.shade_ms = ms_since(start) + self.normals.took.as_secs_f32() * 1e3;
        Ok(())
    }

    fn shade_in_software(&mut self, document: &Document, desc: &FrameDesc, redraw: Redraw) {
        self.pixels.resize_with(self.maps.len(), Pixels::default);
        let source = desc.source(document, self.normals.field());
        let lighting = &desc.lighting;
        for (i, (map, pixels)) in self.maps.iter().zip(&mut self.pixels).enumerate() {
            let pose = desc.pose(&desc.eyes[i]);
            let shaded = match redraw {
                Redraw::All => {
                    self.software.shade(map, &source, &pose, lighting, pixels);
                    None
                }
                Redraw::Changed => {
                    let reach_vx = desc.reach_vx();
                    let rects =
                        changed_pixels(source.grid, self.normals.reshaded(), &map.rays, reach_vx);
                    for rect in rects.as_slice() {
                        shade_rect(map, &source, &pose, lighting, *rect, pixels);
                    }
                    Some(rects.bounds())
                }
            };
            self.composite.note_shaded(i as u32, shaded);
        }
    }

    fn shade_on_device(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
        redraw: Redraw,
    ) -> Result<()> {
        let visible = self.sampler.visible();
        let estimates = !self.is_complete();
        let Some((maps, volume, colours)) = self.sampler.on_device() else { return Ok(()) };
        let pass = match &mut self.surface_shade {
            Some(pass) => pass,
            none => {
                let stage = PixelStage::of(&self.device);
                none.insert(SurfaceShade::new(&self.device, stage, MAX_EYES as u32)?)
            }
        };
        pass.begin(slot);
        let pictures = self.composite.pictures(maps.size())?;
        for ((i, eye), map) in (0..).zip(desc.eyes).zip(&self.maps) {
            let mut task = EyeTask { visible: visible[i as usize], ..EyeTask::whole(i, map.rays) };
            if redraw == Redraw::Changed {
                let (grid, rays) = (document.grid(), &map.rays);
                task.scissor =
                    changed_pixels(grid, self.normals.reshaded(), rays, desc.reach_vx()).bounds();
            }
            if !task.scissor.is_empty() {
                let normals = self.normals.copy();
                let surface =
                    Surface { colours, normals, ..desc.surface(document, estimates, eye) };
                pass.record(recorder, volume, &surface, maps, pictures, &task)?;
            }
        }
        Ok(())
    }
}
