//! How a renderer's pictures come to show the smooth surface: the parts of painting that the [`LevelStage`] needs.
//!
//! Where the device finds the surface, that is recorded with the passes that draw, in the frames of the screen: by then
//! the device's copy of the normals is up to date.
//!
//! [`LevelStage`]: super::level_stage::LevelStage

use std::ops::Range;

use glam::UVec2;

use super::frame_cache::Redraw;
use super::level_stage::{LevelWish, changed_levels};
use super::{EyeTask, FrameDesc, RenderMode, Renderer, Shading, SmoothSurface};
use crate::document::Document;
use crate::gpu::{Recorder, Result};
use crate::surface::PixelRect;
use crate::view::PixelRays;

impl Renderer {
    /// Brings the smooth surface up to date for pictures of `desc`. Returns
    /// [`super::level_stage::LevelStage::state`].
    pub(super) fn follow_surface(
        &mut self,
        document: &Document,
        desc: &FrameDesc,
        changes_known: bool,
    ) -> Result<Option<bool>> {
        let known = changes_known.then_some(self.normals.reshaded());
        let software = self.device.is_software();
        // Estimates of normals give no surface.
        let wanted = self.normals.field().is_complete()
            && desc.is_smooth(SmoothSurface::Always, document.contents(), software);
        let wish = self.wish(desc, wanted);
        self.levels.update(document.grid(), self.normals.field(), known, &wish)?;
        self.normals.reshade(self.levels.changed());
        Ok(self.levels.state())
    }

    /// Decides whether the samples of refined pictures, which are made next, show the surface.
    pub(super) fn show_surface(
        &mut self,
        document: &Document,
        desc: &FrameDesc,
        wanted: bool,
    ) -> Result<()> {
        let wish = self.wish(desc, wanted);
        self.levels.show(document.grid(), self.normals.field(), &wish)
    }

    fn wish(&self, desc: &FrameDesc, wanted: bool) -> LevelWish {
        let device = desc.mode.shades_on_device().then(|| self.device.clone());
        LevelWish { wanted, device, patience: self.patience() }
    }

    /// How pictures of `mode` are shaded: where the device finds the smooth surface, from an index map there.
    pub(super) fn shading(&self, mode: RenderMode) -> Shading {
        if self.levels.is_on_device() { Shading::Device } else { mode.shading() }
    }

    /// Asks the device for the smooth surface in the maps just sampled, or what has changed of it.
    pub(super) fn ask_for_surface(&mut self, document: &Document, redraw: Redraw, sample: u32) {
        let visible = self.sampler.visible();
        for ((eye, map), visible) in (0..).zip(&self.maps).zip(visible) {
            let mut task = EyeTask { visible, ..EyeTask::whole(eye, map.rays) };
            if redraw == Redraw::Changed {
                let changed = changed_levels(document.grid(), self.levels.changed(), &map.rays);
                task.scissor = changed.bounds();
            }
            if !task.scissor.is_empty() {
                self.levels.ask_device(task, sample);
            }
        }
    }

    /// Asks the device for the smooth surface in these rows of the map of an eye, and for nothing else.
    pub(super) fn ask_for_rows(
        &mut self,
        eye: usize,
        rays: PixelRays,
        rows: Range<u32>,
        sample: u32,
    ) {
        let scissor =
            PixelRect { min: UVec2::new(0, rows.start), max: UVec2::new(rays.size.x, rows.end) };
        let visible = self.sampler.visible()[eye];
        self.levels.ask_device_only(EyeTask { eye: eye as u32, rays, scissor, visible }, sample);
    }

    /// Records what the device was asked for.
    pub(super) fn march_to_surface(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &Document,
    ) -> Result<()> {
        if !self.levels.has_tasks() {
            return Ok(());
        }
        let Some(normals) = self.normals.copy() else { return Ok(()) };
        let target = self.sampler.smooth_maps(&self.maps)?;
        let scene = (document.grid(), normals);
        self.levels.march(&self.device, recorder, slot, scene, target)
    }
}
