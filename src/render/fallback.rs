//! Painting with fallback: a sculpture that is too large for the device in one mode is drawn in the next best. Serves
//! windows, files and headsets alike.
//!
//! Takes a [`FrameDesc`]; returns a [`FrameReport`]. The caller reacts to a fallback (another mode from then on, a
//! message).

use std::sync::Arc;

use super::RenderMode;
use super::renderer::{FrameDesc, RenderTimes, Renderer};
use crate::document::Document;
use crate::gpu::{GpuError, Recorder, Result};
use crate::surface::IndexMap;

/// A mode that could not draw, and its replacement.
#[derive(Debug)]
pub struct Fallback {
    pub reason: GpuError,
    pub to: RenderMode,
}

/// The outcome of painting a frame description.
#[derive(Debug)]
pub struct FrameReport {
    /// The mode of the picture; with `painted` false, the mode to go on with.
    pub mode: RenderMode,
    /// False if the caller keeps [`FrameReport::mode`] for its own painting.
    pub painted: bool,
    /// The map from pixels to voxels, one for each eye. The renderer reuses the memory of maps that have no other
    /// owner.
    pub pick_maps: Vec<Arc<IndexMap>>,
    pub times: RenderTimes,
    /// False if the next picture of the same scene will be better: while normals or the smooth surface are missing
    /// ([`Renderer::set_patience`]) or samples ([`Renderer::set_refinement`]).
    pub complete: bool,
    /// In order.
    pub fallbacks: Vec<Fallback>,
}

impl Renderer {
    /// Records the pictures of `desc`, in its mode or the first of its fallbacks that the device can draw. `paints`:
    /// the modes to paint here; it stops at any other one.
    pub fn paint_with_fallback(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
        paints: impl Fn(RenderMode) -> bool,
    ) -> Result<FrameReport> {
        let mut desc = *desc;
        let mut fallbacks = Vec::new();
        while paints(desc.mode) {
            let Err(reason) = self.paint(recorder, slot, document, &desc) else {
                let (mode, pick_maps, times) = (desc.mode, self.maps().to_vec(), self.times());
                let complete = self.stages.is_complete() && self.stages.refinement.is_complete();
                return Ok(FrameReport {
                    mode,
                    painted: true,
                    pick_maps,
                    times,
                    complete,
                    fallbacks,
                });
            };
            let too_large = matches!(reason, GpuError::Limit { .. } | GpuError::OutOfMemory(_));
            let Some(to) = desc.mode.fallback().filter(|_| too_large) else { return Err(reason) };
            fallbacks.push(Fallback { reason, to });
            desc.mode = to;
        }
        let (mode, times) = (desc.mode, self.times());
        let pick_maps = Vec::new();
        Ok(FrameReport { mode, painted: false, pick_maps, times, complete: true, fallbacks })
    }
}
