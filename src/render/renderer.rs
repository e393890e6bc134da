//! From a sculpture to its pictures: sample, shade, compose with background and overlay. One
//! renderer serves a window, a file or a headset; they differ in how they use the images.
//!
//! Takes a document and a [`FrameDesc`]; draws the pictures, one layer per eye, to images of its own, and repeats only
//! what the desc changes. So an interface that changes over a resting sculpture costs a copy only. Knows no window, no
//! camera and no tools: the contents to draw come in as values.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ash::vk;

use super::frame_cache::{FrameCache, Redraw, RedrawPlan};
pub use super::frame_desc::FrameDesc;
use super::level_stage::LevelStage;
use super::normal_stage::NormalStage;
use super::overlay::Overlay;
use super::pictures::pictures;
pub use super::pictures::{DEPTH_FORMAT, Pictures};
use super::refinement::Refinement;
use super::sampler::Sampler;
use super::smooth_edges::SmoothEdges;
use super::software_composite::SoftwareComposite;
use super::times::PictureTimer;
pub use super::times::{DeviceTimes, RenderTimes};
use super::{
    Backdrop, Composite, GpuOnly, GroundPass, MAX_EYES, Points, Shading, SmoothSurface,
    SurfaceShade,
};
use crate::document::{ChangeSubscriber, Document};
use crate::gpu::{Device, Recorder, Result, Use, read_image_once};
use crate::shade::points::PointCloud;
use crate::shade::{Pixels, SoftwareShader};
use crate::surface::IndexMap;
use crate::view::PixelRays;

/// Renders one document.
pub struct Renderer {
    pub(super) sampler: Sampler,
    pub(super) composite: Composite,
    /// Made when first needed.
    pub(super) software_composite: Option<SoftwareComposite>,
    pub(super) overlay: Overlay,
    pub(super) pictures: Option<Pictures>,
    pub(super) format: vk::Format,
    /// One per eye. Shared with picking.
    pub(super) maps: Vec<Arc<IndexMap>>,
    pub(super) pixels: Vec<Pixels>,
    pub(super) software: SoftwareShader,
    pub(super) clouds: [PointCloud; MAX_EYES],
    /// The passes of some modes, made when first needed.
    pub(super) points: Option<Points>,
    pub(super) surface_shade: Option<SurfaceShade>,
    pub(super) gpu_only: Option<GpuOnly>,
    pub(super) backdrop: Option<Backdrop>,
    pub(super) ground: Option<GroundPass>,
    pub(super) smooth_edges: Option<SmoothEdges>,
    /// Drains the bricks that change between two pictures.
    subscriber: ChangeSubscriber,
    /// The bricks that changed since the last picture.
    changed: Vec<u32>,
    pub(super) normals: NormalStage,
    pub(super) levels: LevelStage,
    /// The values that the pictures were made from; none while they are incomplete.
    pub(super) cache: Option<FrameCache>,
    pub(super) refinement: Refinement,
    pub(super) times: RenderTimes,
    pub(super) timer: PictureTimer,
    pub(super) device: Arc<Device>,
}

impl Renderer {
    /// For pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Renderer> {
        Ok(Renderer {
            sampler: Sampler::new(device)?,
            composite: Composite::new(device, format, MAX_EYES as u32)?,
            software_composite: None,
            overlay: Overlay::new(device, format, DEPTH_FORMAT)?,
            pictures: None,
            format,
            maps: Vec::new(),
            pixels: Vec::new(),
            software: SoftwareShader::default(),
            clouds: Default::default(),
            points: None,
            surface_shade: None,
            gpu_only: None,
            backdrop: None,
            ground: None,
            smooth_edges: None,
            subscriber: ChangeSubscriber::default(),
            changed: Vec::new(),
            normals: NormalStage::default(),
            levels: LevelStage::default(),
            cache: None,
            refinement: Refinement::default(),
            times: RenderTimes::default(),
            timer: PictureTimer::new(device)?,
            device: device.clone(),
        })
    }

    /// Records the pictures of `desc`; afterwards they are in [`Renderer::pictures`]. `slot`:
    /// [`crate::gpu::Frames::slot`]; once per frame.
    ///
    /// A sculpture that is too large for the device is an error of [`crate::gpu::GpuError::Limit`]:
    /// try again with the [`RenderMode::fallback`] of its mode.
    pub fn paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        let painted = self.try_paint(recorder, slot, document, desc);
        if painted.is_err() {
            // A second attempt follows the commands of the failed one, which may have stopped
            // within rendering.
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
        let before = self.cache.take();
        let changes_known = self.drain_changes(document);
        let known = before.as_ref().filter(|_| changes_known);
        let rests = known.is_some_and(|before| before.is_of(document, desc));
        let moved = !known.is_some_and(|before| before.is_edited_only(document, desc));
        let defers = changes_known
            && !rests
            && (!self.changed.is_empty() || self.normals.has_deferred())
            && self.can_defer_normals(document, desc);
        let normals = if defers {
            // The visible voxels must be known before.
            let redraw = if moved { Redraw::All } else { Redraw::Changed };
            self.sample(document, desc, redraw)?;
            self.normals.update_seen(document.grid(), &self.changed, &self.maps, moved)
        } else {
            let changed = changes_known.then_some(self.changed.as_slice());
            self.normals.update(document.grid(), changed, rests)
        };
        let smooth = self.follow_surface(document, desc, changes_known)?;
        let plan = RedrawPlan::new(before.as_ref(), document, desc, changes_known, normals, smooth);
        if let Some(redraw) = plan.sample.filter(|_| !defers) {
            self.sample(document, desc, redraw)?;
        }
        self.composite.begin(slot);
        if plan.compose.is_some() {
            self.timer.begin(recorder, slot, desc.mode, &mut self.times.device)?;
        }
        if let Some(redraw) = plan.shade {
            self.shade(recorder, slot, document, desc, redraw)?;
        }
        if let Some(redraw) = plan.compose {
            let before = before.as_ref().filter(|_| redraw == Redraw::Changed);
            self.compose(recorder, slot, document, desc, before)?;
        }
        let rests = plan.is_nothing() && self.is_complete() && !self.levels.is_pending();
        self.refine_if(rests, recorder, slot, document, desc)?;
        self.cache = Some(FrameCache::new(before, document, desc, smooth.is_some()));
        let pictures = pictures(&self.device, &mut self.pictures, self.format, desc.eyes)?;
        for eye in 0..pictures.colour.eyes() {
            pictures.colour.transition(recorder, eye, Use::COPY_SOURCE);
        }
        Ok(())
    }

    /// The pictures painted last.
    pub fn pictures(&mut self) -> Option<&mut Pictures> {
        self.refinement.pictures_mut().or(self.pictures.as_mut())
    }

    /// The pixels of the pictures painted last, once the recording has been submitted. Waits.
    pub fn read_back(&self) -> Result<Vec<Pixels>> {
        let pictures = self.refinement.pictures().or(self.pictures.as_ref());
        let Some(pictures) = pictures else { return Ok(Vec::new()) };
        let (image, size) = (pictures.colour.image(), pictures.colour.size());
        let read = |eye| {
            let part = image.layer(eye);
            let bytes = read_image_once(&self.device, part, image.size(), 4, Use::COPY_SOURCE)?;
            Ok(Pixels { size, rgba: bytemuck::pod_collect_to_vec(&bytes) })
        };
        (0..pictures.colour.eyes()).map(read).collect()
    }

    /// The index maps of the pictures painted last.
    pub fn maps(&self) -> &[Arc<IndexMap>] {
        &self.maps
    }

    /// Returns the times. Those of the device are of the last picture that it is known to have finished.
    pub fn times(&self) -> RenderTimes {
        self.times
    }

    /// All times of the picture painted last, for a caller that has waited for it.
    pub fn times_when_done(&mut self) -> Result<RenderTimes> {
        if let Some(mode) = self.cache.as_ref().map(FrameCache::mode) {
            self.times.device.sample_ms = self.sampler.device_ms_when_done(mode)?;
            self.timer.latest(mode, &mut self.times.device)?;
        }
        Ok(self.times)
    }

    /// Discards the cached picture and the device's copy of the document; keeps all passes.
    pub(super) fn forget_pictures(&mut self) -> Result<()> {
        self.cache = None;
        self.refinement.forget();
        self.sampler.forget_copy();
        if let Some(ground) = &mut self.ground {
            ground.forget();
        }
        self.times = RenderTimes::default();
        self.timer = PictureTimer::new(&self.device)?;
        Ok(())
    }

    pub(super) fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Collects the bricks that have changed since the last picture; false if all may have.
    fn drain_changes(&mut self, document: &mut Document) -> bool {
        let changed = &mut self.changed;
        document.drain_changes_for(&self.subscriber, |_, bricks| {
            changed.clear();
            changed.extend_from_slice(bricks.unwrap_or_default());
            bricks.is_some()
        })
    }

    /// Whether the normals of bricks that the next picture does not show can be put off: where the CPU shades the voxels
    /// of index maps in memory.
    fn can_defer_normals(&self, document: &Document, desc: &FrameDesc) -> bool {
        let smooth =
            desc.is_smooth(SmoothSurface::Always, document.contents(), self.device.is_software());
        desc.mode.shading() == Shading::Software
            && !smooth
            && self.levels.state().is_none()
            && self.normals.can_defer()
    }

    /// How long a picture may be held up by the normals of a sculpture that was opened: until they are complete
    /// ([`Renderer::is_complete`]), estimates stand in for them. None: until all are there.
    pub fn set_patience(&mut self, patience: Option<Duration>) {
        self.normals.patience = patience;
    }

    pub(super) fn patience(&self) -> Option<Duration> {
        self.normals.patience
    }

    /// Whether the last pictures have all normals. If not, the next ones have more.
    pub fn is_complete(&self) -> bool {
        self.normals.field().is_complete()
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
        let nothing = PixelRays::of_nothing();
        let rays = rays.map(|rays| rays.unwrap_or(nothing));
        self.maps.resize_with(count, || Arc::new(IndexMap::new(nothing)));
        let result = {
            let changed = (redraw == Redraw::Changed).then_some(self.changed.as_slice());
            let smooth = self.levels.surface(self.normals.field(), desc.sample);
            let (rays, mode) = (&rays[..count], (desc.mode, desc.mask_shown(document)));
            self.sampler.sample(document, rays, mode, smooth, changed, &mut self.maps)
        };
        if result.is_err() {
            self.sampler.forget_copy();
        } else if self.levels.is_on_device() {
            self.ask_for_surface(document, redraw, desc.sample);
        }
        self.times.sample_ms = ms_since(start);
        self.times.read_back_ms = self.sampler.read_back_ms();
        self.times.device.sample_ms = self.sampler.device_ms();
        result
    }
}

pub(super) fn ms_since(start: Instant) -> f32 {
    start.elapsed().as_secs_f32() * 1e3
}
