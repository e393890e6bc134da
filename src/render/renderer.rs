//! From a sculpture to its pictures: sample, shade, compose with background and overlay. One renderer serves a window,
//! a file or a headset; they use the images differently.
//!
//! Takes a document and a [`FrameDesc`]; draws the pictures, one layer per eye, to images of its own, and repeats only
//! what the desc changes. An interface that changes over a resting sculpture therefore costs only a copy. Knows no
//! window, no camera and no tools: the contents to draw come in as values.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ash::vk;

use super::cpu_pictures::CpuPictures;
use super::frame_cache::{FrameCache, Redraw, RedrawPlan};
pub use super::frame_desc::FrameDesc;
use super::passes::Passes;
pub use super::pictures::{DEPTH_FORMAT, FinishedPictures};
use super::sampled_frame::SampledFrame;
use super::sampler::SampleRequest;
use super::stages::Stages;
use super::times::PictureTimer;
pub use super::times::{DeviceTimes, RenderTimes};
use super::{MAX_EYES, ReferencePicture, Shading};
use crate::document::Document;
use crate::gpu::{Device, Recorder, ResourceUse, Result, read_image_once};
use crate::shade::Pixels;
use crate::surface::IndexMap;
use crate::view::PixelRays;

/// Renders one document.
pub struct Renderer {
    pub(super) passes: Passes,
    pub(super) cpu: CpuPictures,
    pub(super) stages: Stages,
}

impl Renderer {
    /// Creates one for pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Renderer> {
        Ok(Renderer {
            passes: Passes::new(device, format)?,
            cpu: CpuPictures::default(),
            stages: Stages::new(device)?,
        })
    }

    /// Records the pictures of `desc`, which are in [`Renderer::pictures`] afterwards. `slot`:
    /// [`crate::gpu::Frames::slot`]; once per frame.
    ///
    /// A sculpture that is too large for the device is an error of [`crate::gpu::GpuError::Limit`]: try again with the
    /// [`RenderMode::fallback`] of its mode.
    pub fn paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        let painted = self.try_paint(recorder, slot, document, desc);
        if painted.is_err() {
            // A second attempt follows the commands of the failed one, which may have stopped within rendering.
            recorder.end_rendering_if_begun();
        }
        painted
    }

    fn try_paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        // Only complete pictures are kept in the frame cache.
        let before = self.stages.cache.take();
        let changes_known = self.stages.drain_changes(document);
        let known = before.as_ref().filter(|_| changes_known);
        let rests = known.is_some_and(|before| before.is_of(document, desc));
        let moved = !known.is_some_and(|before| before.is_edited_only(document, desc));
        // Pictures of the device have no index maps that would tell which normals they show.
        self.stages.normals.limit_bytes = match desc.mode.shades_on_device() {
            true => u64::MAX,
            false => document.limits().grid_bytes,
        };
        let defers = changes_known && !rests && self.stages.defers_normals(document, desc);
        if defers {
            // The visible voxels must be known first.
            let redraw = if moved { Redraw::All } else { Redraw::Changed };
            self.sample(document, desc, redraw)?;
        }
        let stages = &mut self.stages;
        let normals = if defers {
            stages.normals.update_seen(document.grid(), &stages.changed, &self.cpu.maps, moved)
        } else {
            let changed = changes_known.then_some(stages.changed.as_slice());
            stages.normals.update(document.grid(), changed, rests, &self.cpu.maps)
        };
        let smooth = stages.follow_surface(document, desc, changes_known)?;
        let plan = RedrawPlan::new(before.as_ref(), document, desc, changes_known, normals, smooth);
        if let Some(redraw) = plan.sample.filter(|_| !defers) {
            self.sample(document, desc, redraw)?;
        }
        self.passes.sculpture.composite.begin(slot);
        if plan.compose.is_some() {
            self.stages.begin_timing(recorder, slot, desc.mode)?;
        }
        if let Some(redraw) = plan.shade {
            self.shade(recorder, slot, document, desc, redraw)?;
        }
        if let Some(redraw) = plan.compose {
            let before = before.as_ref().filter(|_| redraw == Redraw::Changed);
            self.compose(recorder, slot, document, desc, before)?;
        }
        let rests = plan.is_nothing() && self.stages.is_complete();
        self.refine_if(rests, recorder, slot, document, desc)?;
        self.stages.cache = Some(FrameCache::new(before, document, desc, smooth.is_some()));
        let pictures = self.passes.layers.fit_pictures(desc.eyes)?;
        for eye in 0..pictures.colour.eyes() {
            pictures.colour.transition(recorder, eye, ResourceUse::COPY_SOURCE);
        }
        Ok(())
    }

    /// Returns the pictures painted last.
    pub fn pictures(&mut self) -> Option<&mut FinishedPictures> {
        self.stages.refinement.pictures_mut().or(self.passes.layers.pictures.as_mut())
    }

    /// Returns the pixels of the pictures painted last, once the recording has been submitted. Waits.
    pub fn read_back(&self) -> Result<Vec<Pixels>> {
        let pictures = self.stages.refinement.pictures().or(self.passes.layers.pictures.as_ref());
        let Some(pictures) = pictures else { return Ok(Vec::new()) };
        let (image, size) = (pictures.colour.image(), pictures.colour.size());
        let read = |eye| {
            let part = image.layer(eye);
            let bytes = read_image_once(
                &self.stages.device,
                part,
                image.size(),
                4,
                ResourceUse::COPY_SOURCE,
            )?;
            Ok(Pixels { size, rgba: bytemuck::pod_collect_to_vec(&bytes) })
        };
        (0..pictures.colour.eyes()).map(read).collect()
    }

    /// Returns the index maps of the pictures painted last.
    pub fn maps(&self) -> &[Arc<IndexMap>] {
        &self.cpu.maps
    }

    /// Returns the times. Those of the device are of the last picture known to be finished.
    pub fn times(&self) -> RenderTimes {
        self.stages.times
    }

    /// Returns all times of the picture painted last. The caller must have waited for it.
    pub fn times_when_done(&mut self) -> Result<RenderTimes> {
        let Stages { cache, times, timer, .. } = &mut self.stages;
        if let Some(mode) = cache.as_ref().map(FrameCache::mode) {
            times.device.sample_ms = self.passes.sampler.device_ms_when_done(mode)?;
            timer.latest(mode, &mut times.device)?;
        }
        Ok(*times)
    }

    /// Discards the cached picture and the device's copy of the document; keeps all passes.
    pub(super) fn forget_pictures(&mut self) -> Result<()> {
        self.passes.forget_document();
        self.stages.forget_pictures()
    }

    /// Sets the reference pictures of the next pictures, at most [`super::MAX_REFERENCES`]. Call before
    /// [`Renderer::paint`], in the same frame. After an error there are none.
    pub fn set_references(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        pictures: &[ReferencePicture],
    ) -> Result<()> {
        if self.passes.layers.shows_references(pictures) {
            return Ok(());
        }
        // Draws everything again: they may be anywhere.
        self.stages.cache = None;
        self.passes.layers.set_references(recorder, slot, pictures)
    }

    /// Sets the longest delay of a picture by the normals of an opened sculpture: until they are complete
    /// ([`Renderer::is_complete`]), estimates replace them. `None`: until all are computed.
    pub fn set_patience(&mut self, patience: Option<Duration>) {
        self.stages.normals.patience = patience;
    }

    /// Returns whether the last pictures have all normals that they show. If not, the next ones will have more.
    pub fn is_complete(&self) -> bool {
        self.stages.has_all_normals()
    }

    pub(super) fn sample(
        &mut self,
        document: &mut Document,
        desc: &FrameDesc,
        redraw: Redraw,
    ) -> Result<()> {
        let start = Instant::now();
        let mut rays = [None; MAX_EYES];
        for (rays, eye) in rays.iter_mut().zip(desc.eyes) {
            *rays = Some(eye.pixel_rays(&desc.world_from_grid));
        }
        let count = desc.eyes.len().min(MAX_EYES);
        let rays = rays.map(|rays| rays.unwrap_or(PixelRays::of_nothing()));
        self.cpu.resize_maps(count);
        let (sampler, stages, maps) =
            (&mut self.passes.sampler, &mut self.stages, &mut self.cpu.maps);
        let request = SampleRequest {
            rays: &rays[..count],
            mode: desc.mode,
            mask: desc.mask_shown(document),
            changed: (redraw == Redraw::Changed).then_some(stages.changed.as_slice()),
        };
        let smooth = stages.levels.surface(stages.normals.field_mut(), desc.sample);
        let result = sampler.sample(document, &request, smooth, maps);
        if result.is_err() {
            sampler.forget_copy();
        } else if stages.levels.is_on_device() {
            stages.ask_for_surface(document, redraw, desc.sample, maps, sampler.visible());
        }
        stages.times.sample_ms = ms_since(start);
        stages.times.read_back_ms = sampler.read_back_ms();
        stages.times.device.sample_ms = sampler.device_ms();
        result
    }

    /// Shades the maps just sampled: on the CPU, as points, or on the device, completely or only the changes.
    pub(super) fn shade(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
        redraw: Redraw,
    ) -> Result<()> {
        let start = Instant::now();
        let Renderer { passes, cpu, stages } = self;
        stages.normals.upload(
            &stages.device,
            recorder,
            slot,
            document.grid(),
            desc.mode.shading(),
        )?;
        match stages.shading(desc.mode) {
            Shading::Software => {
                let composite = &mut passes.sculpture.composite;
                cpu.shade(document, desc, &stages.normals, redraw, |eye, shaded| {
                    composite.note_shaded(eye, shaded);
                });
            }
            Shading::Points => cpu.take_points(document, desc, &stages.normals),
            Shading::Device => {
                stages.timer.start(recorder, PictureTimer::SHADE);
                stages.march_to_surface(
                    recorder,
                    slot,
                    document,
                    &mut passes.sampler,
                    &cpu.maps,
                )?;
                let frame = SampledFrame {
                    slot,
                    document,
                    desc,
                    shading: Shading::Device,
                    normals: &stages.normals,
                    cpu,
                    visible: passes.sampler.visible(),
                    before: None,
                };
                passes.sculpture.shade(recorder, &frame, redraw, &mut passes.sampler)?;
                stages.timer.stop(recorder, PictureTimer::SHADE);
            }
            Shading::Within => {}
        }
        // The normals are part of the shading.
        stages.times.shade_ms = ms_since(start) + stages.normals.took.as_secs_f32() * 1e3;
        Ok(())
    }

    /// Composes the pictures back to front, or only the differences from those of `before`, if they are known.
    pub(super) fn compose(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        desc: &FrameDesc,
        before: Option<&FrameCache>,
    ) -> Result<()> {
        let Passes { sampler, sculpture, layers } = &mut self.passes;
        layers.prepare_ground(recorder, slot, document, desc)?;
        layers.fit_pictures(desc.eyes)?;
        let frame = SampledFrame {
            slot,
            document,
            desc,
            shading: self.stages.shading(desc.mode),
            normals: &self.stages.normals,
            cpu: &self.cpu,
            visible: sampler.visible(),
            before,
        };
        sculpture.compose(recorder, &frame, sampler, layers, &mut self.stages.timer)
    }
}

fn ms_since(start: Instant) -> f32 {
    start.elapsed().as_secs_f32() * 1e3
}
