//! The stages of a renderer's pictures: the changes since the last ones, the progress of normals, smooth surface and
//! refinement, and the times.
//!
//! Follows one document. Decides what to repeat and what is outstanding; the passes draw. If the device finds the
//! smooth surface, that is recorded with the passes that draw, in the frames of the screen, when the device's copy of
//! the normals is up to date.

use std::sync::Arc;

use super::frame_cache::{FrameCache, Redraw};
use super::level_stage::{LevelStage, LevelWish, changed_levels};
use super::normal_stage::NormalStage;
use super::refinement::Refinement;
use super::sampler::{EyeRows, Sampler};
use super::times::{PictureTimer, RenderTimes};
use super::{EyeTask, FrameDesc, LevelTask, MAX_EYES, RenderMode, Shading, SmoothSurface};
use crate::document::{ChangeSubscriber, Document};
use crate::gpu::{Device, Recorder, Result};
use crate::surface::{IndexMap, PixelRect};

/// See the module text.
pub(super) struct Stages {
    /// Drains the bricks that change between two pictures.
    subscriber: ChangeSubscriber,
    /// The bricks that changed since the last picture.
    pub changed: Vec<u32>,
    pub normals: NormalStage,
    pub levels: LevelStage,
    /// The values from which the pictures were made; `None` while they are incomplete.
    pub cache: Option<FrameCache>,
    pub refinement: Refinement,
    pub times: RenderTimes,
    pub timer: PictureTimer,
    pub device: Arc<Device>,
}

impl Stages {
    pub fn new(device: &Arc<Device>) -> Result<Stages> {
        Ok(Stages {
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

    /// Discards all state of the pictures, which are drawn from scratch.
    pub fn forget_pictures(&mut self) -> Result<()> {
        self.cache = None;
        self.refinement.forget();
        self.times = RenderTimes::default();
        self.timer = PictureTimer::new(&self.device)?;
        Ok(())
    }

    /// Collects the bricks that have changed since the last picture. Returns false if all may have.
    pub fn drain_changes(&mut self, document: &mut Document) -> bool {
        let changed = &mut self.changed;
        document.drain_changes_for(&self.subscriber, |_, bricks| {
            changed.clear();
            changed.extend_from_slice(bricks.unwrap_or_default());
            bricks.is_some()
        })
    }

    /// Returns whether there are normals to compute and those of invisible bricks are deferred.
    pub fn defers_normals(&self, document: &Document, desc: &FrameDesc) -> bool {
        (!self.changed.is_empty() || self.normals.has_deferred())
            && self.can_defer_normals(document, desc)
    }

    /// Returns whether the normals of invisible bricks can be deferred: if the CPU shades the voxels of index maps in
    /// memory.
    fn can_defer_normals(&self, document: &Document, desc: &FrameDesc) -> bool {
        let smooth =
            desc.is_smooth(SmoothSurface::Always, document.contents(), self.device.is_software());
        desc.mode.shading() == Shading::Software
            && !smooth
            && self.levels.state().is_none()
            && self.normals.can_defer()
    }

    /// Starts measuring a frame that uses `slot` and draws `mode`.
    pub fn begin_timing(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        mode: RenderMode,
    ) -> Result<()> {
        self.timer.begin(recorder, slot, mode, &mut self.times.device)
    }

    /// Returns whether the last pictures have all normals that they show.
    pub fn has_all_normals(&self) -> bool {
        self.normals.is_settled()
    }

    /// Returns whether the last pictures have all normals, and the smooth surface if they should show it.
    pub fn is_complete(&self) -> bool {
        self.has_all_normals() && !self.levels.is_pending()
    }

    /// Updates the smooth surface for pictures of `desc`. Returns [`LevelStage::state`].
    pub fn follow_surface(
        &mut self,
        document: &Document,
        desc: &FrameDesc,
        changes_known: bool,
    ) -> Result<Option<bool>> {
        let software = self.device.is_software();
        // Estimates of normals give no surface.
        let wanted = self.has_all_normals()
            && desc.is_smooth(SmoothSurface::Always, document.contents(), software);
        let wish = self.wish(document, desc, wanted);
        let known = changes_known.then_some(self.normals.reshaded());
        let edited = self.changed.as_slice();
        self.levels.update(document.grid(), self.normals.field(), edited, known, &wish)?;
        self.normals.reshade(self.levels.changed());
        Ok(self.levels.state())
    }

    /// Decides whether the samples of refined pictures, made next, show the surface.
    pub fn show_surface(
        &mut self,
        document: &Document,
        desc: &FrameDesc,
        wanted: bool,
    ) -> Result<()> {
        let wish = self.wish(document, desc, wanted);
        self.levels.show(document.grid(), self.normals.field(), &wish)
    }

    fn wish(&self, document: &Document, desc: &FrameDesc, wanted: bool) -> LevelWish {
        let device = desc.mode.shades_on_device().then(|| self.device.clone());
        let budget_bytes = document.limits().grid_bytes;
        LevelWish { wanted, device, budget_bytes, patience: self.normals.patience }
    }

    /// Returns the shading of pictures of `mode`: from an index map on the device if that finds the smooth surface.
    pub fn shading(&self, mode: RenderMode) -> Shading {
        if self.levels.is_on_device() { Shading::Device } else { mode.shading() }
    }

    /// Requests the smooth surface from the device in `maps`, just sampled, or only its changes. `visible`: the visible
    /// rect of each eye.
    pub fn ask_for_surface(
        &mut self,
        document: &Document,
        redraw: Redraw,
        sample: u32,
        maps: &[Arc<IndexMap>],
        visible: [PixelRect; MAX_EYES],
    ) {
        for ((eye, map), visible) in (0..).zip(maps).zip(visible) {
            let mut part = EyeTask { visible, ..EyeTask::whole(eye, map.rays) };
            if redraw == Redraw::Changed {
                let changed = changed_levels(document.grid(), self.levels.changed(), &map.rays);
                part.scissor = changed.bounds();
            }
            if !part.scissor.is_empty() {
                self.levels.ask_device(LevelTask { part, sample });
            }
        }
    }

    /// Requests the smooth surface from the device in some rows of a map, and nothing else.
    pub fn ask_for_rows(&mut self, rows: &EyeRows, sample: u32, visible: PixelRect) {
        let part = EyeTask { eye: rows.eye as u32, rays: rows.rays, scissor: rows.rect(), visible };
        self.levels.ask_device_only(LevelTask { part, sample });
    }

    /// Records the requests to the device. `maps` are those of the last sampling.
    pub fn march_to_surface(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
        sampler: &mut Sampler,
        maps: &[Arc<IndexMap>],
    ) -> Result<()> {
        if !self.levels.has_tasks() {
            return Ok(());
        }
        let Some(normals) = self.normals.copy() else { return Ok(()) };
        let target = sampler.smooth_maps(maps)?;
        let scene = (document.grid(), normals);
        self.levels.march(&self.device, recorder, slot, scene, target)
    }
}
