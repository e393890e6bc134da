//! Refining a resting picture: while a renderer's pictures stay the same, each frame adds a sample (a picture with the
//! eyes shifted by a fraction of a pixel) and shows the mean of all so far.
//!
//! The samples have buffers of their own (index maps, shaded pixels, pictures). Picking and partial redraws therefore
//! use the unshifted picture as if there were no samples, and any movement is shown at once. This file decides when a
//! picture counts as resting; the redraw plan detects that it is unchanged.

use std::sync::Arc;
use std::time::Instant;

use super::frame_cache::Redraw;
use super::frame_desc::FrameDesc;
use super::mean::MeanPass;
use super::passes::Passes;
use super::refinement::Buffers;
use super::renderer::Renderer;
use super::sampler::EyeRows;
use super::stages::Stages;
use super::{Background, MAX_EYES, SmoothSurface};
use crate::document::Document;
use crate::gpu::{GpuError, Recorder, ResourceUse, Result};

/// Number of equal frames before a picture is refined. While a person works, pictures change more often, and occasional
/// smooth edges would flicker.
const REST_FRAMES: u32 = 6;

/// Pixels of the smooth surface sampled per frame: some 15 ms on two cores.
const SMOOTH_PIXELS: u32 = 1 << 16;

impl Renderer {
    /// Refines resting pictures to the mean of this many samples, one more per frame, until the report of a frame says
    /// that they are complete. 0 and 1: no refinement.
    pub fn set_refinement(&mut self, samples: u32) {
        if samples != self.stages.refinement.samples {
            self.stages.refinement.samples = samples;
            self.stages.refinement.restart();
        }
    }

    /// Sets whether refinement begins with the first unchanged frame, for pictures to be saved, instead of after a
    /// rest.
    pub fn refine_at_once(&mut self, at_once: bool) {
        self.stages.refinement.at_once = at_once;
    }

    /// Adds a sample to the mean of the pictures of `desc` if one is due. `rests`: they are the same as in the last
    /// frame.
    pub(super) fn refine_if(
        &mut self,
        rests: bool,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        // A transparent background has no light to average.
        let opaque = desc.video.is_some() || !matches!(desc.background, Background::Keep);
        let refinement = &mut self.stages.refinement;
        refinement.possible =
            refinement.samples > 1 && !refinement.given_up && opaque && !desc.eyes.is_empty();
        if !(rests && refinement.possible) {
            refinement.restart();
            return Ok(());
        }
        refinement.rested += 1;
        let rest_frames = if refinement.at_once { 0 } else { REST_FRAMES };
        if refinement.rested <= rest_frames || refinement.is_complete() {
            return Ok(());
        }
        match self.refine(recorder, slot, document, desc) {
            Err(reason @ (GpuError::OutOfMemory(_) | GpuError::Limit { .. })) => {
                // The picture stays as it is.
                tracing::warn!("pictures are not refined: {reason}");
                recorder.end_rendering_if_begun();
                self.stages.refinement.forget();
                (self.stages.refinement.given_up, self.stages.refinement.possible) = (true, false);
                Ok(())
            }
            result => result,
        }
    }

    /// Adds a sample to the mean.
    fn refine(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> Result<()> {
        let software = self.stages.device.is_software();
        let mut smooth = desc.is_smooth(SmoothSurface::AtRest, document.contents(), software);
        if smooth {
            self.stages.show_surface(document, desc, true)?;
            if self.stages.levels.is_pending() {
                // Continues in the next frame.
                return Ok(());
            }
            // A grid that is too large for it shows its voxels.
            smooth = self.stages.levels.state().is_some();
        }
        let refinement = &mut self.stages.refinement;
        let mean = match &mut refinement.mean {
            Some(mean) => mean,
            none => none.insert(MeanPass::new(&self.stages.device, self.passes.layers.format())?),
        };
        mean.begin(slot);
        if refinement.taken == 0 && !smooth && !desc.smooth_edges {
            // Sample 0 is the picture itself.
            if let Some(pictures) = &mut self.passes.layers.pictures {
                mean.add(recorder, &mut pictures.colour, 1)?;
                refinement.taken = 1;
            }
            return Ok(());
        }
        let index = refinement.taken;
        let mut eyes = [desc.eyes[0]; MAX_EYES];
        for (shifted, eye) in eyes.iter_mut().zip(desc.eyes) {
            *shifted = eye.sample(index);
        }
        let eyes = &eyes[..desc.eyes.len().min(MAX_EYES)];
        let desc = desc.of_sample(eyes, index);
        self.swap_buffers();
        let found = match smooth {
            true => self.find_smooth_rows(recorder, slot, document, &desc),
            false => Ok(true),
        };
        let result = match found {
            Ok(true) => self.add_sample(recorder, slot, document, &desc, smooth).map(|()| true),
            // Continues in the next frames.
            unfinished => unfinished,
        };
        self.swap_buffers();
        if smooth {
            self.stages.show_surface(document, &desc, false)?;
        }
        match &result {
            Ok(true) => {
                (self.stages.refinement.taken, self.stages.refinement.rows) = (index + 1, 0)
            }
            Ok(false) => {}
            // Without this sample there is no mean to show.
            Err(_) => (self.stages.refinement.taken, self.stages.refinement.rows) = (0, 0),
        }
        result.map(|_| ())
    }

    /// Samples the smooth surface in as many more rows of the present maps as fit into a frame. Returns whether these
    /// were the last.
    fn find_smooth_rows(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
    ) -> Result<bool> {
        let Some(eye) = desc.eyes.first() else { return Ok(true) };
        let (width, height) = (eye.size.x.max(1), eye.size.y);
        let all = height * desc.eyes.len() as u32;
        let from = self.stages.refinement.rows;
        // These rows belong to a single eye.
        let to = (from + (SMOOTH_PIXELS / width).max(1))
            .min((from / height.max(1) + 1) * height)
            .min(all);
        let mut is_found = true;
        if from < to {
            let (i, rows) = ((from / height) as usize, from % height..from % height + (to - from));
            self.cpu.resize_maps(desc.eyes.len());
            let rays = desc.eyes[i].pixel_rays(&desc.world_from_grid);
            let rows = EyeRows { eye: i, rays, rows };
            if self.stages.levels.is_on_device() {
                if from == 0 {
                    self.sample(document, desc, Redraw::All)?;
                }
                let Renderer { passes: Passes { sampler, .. }, cpu, stages } = self;
                stages.ask_for_rows(&rows, desc.sample, sampler.visible()[i]);
                stages.march_to_surface(recorder, slot, document, sampler, &cpu.maps)?;
            } else {
                let Stages { levels, normals, .. } = &mut self.stages;
                let (start, patience) = (Instant::now(), normals.patience);
                let mut goes_on = || patience.is_none_or(|patience| start.elapsed() < patience);
                if let Some(mut smooth) = levels.surface(normals.field_mut(), desc.sample) {
                    let map = Arc::make_mut(&mut self.cpu.maps[i]);
                    let sampler = &mut self.passes.sampler;
                    is_found =
                        sampler.sample_rows(document.grid(), &rows, &mut smooth, map, &mut goes_on);
                }
            }
        }
        if is_found {
            self.stages.refinement.rows = to;
        }
        Ok(is_found && to == all)
    }

    /// Makes a sample in the present buffers, whose maps may have been sampled already, and then the mean.
    fn add_sample(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        document: &mut Document,
        desc: &FrameDesc,
        is_sampled: bool,
    ) -> Result<()> {
        if !is_sampled {
            self.sample(document, desc, Redraw::All)?;
        }
        self.stages.begin_timing(recorder, slot, desc.mode)?;
        self.shade(recorder, slot, document, desc, Redraw::All)?;
        self.compose(recorder, slot, document, desc, None)?;
        if let (Some(mean), Some(pictures)) =
            (&mut self.stages.refinement.mean, &mut self.passes.layers.pictures)
        {
            mean.add(recorder, &mut pictures.colour, desc.sample + 1)?;
            mean.resolve(recorder, &mut pictures.colour);
            for eye in 0..pictures.colour.eyes() {
                pictures.colour.transition(recorder, eye, ResourceUse::COPY_SOURCE);
            }
        }
        Ok(())
    }

    /// Exchanges the buffers of the unshifted picture for those of the samples.
    fn swap_buffers(&mut self) {
        let Buffers { cpu, images } = &mut self.stages.refinement.buffers;
        self.cpu.swap(cpu);
        self.passes.swap_images(images);
    }
}
