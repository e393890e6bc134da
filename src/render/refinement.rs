//! The state of the refinement of resting pictures: its progress, and the buffers of its samples.
//!
//! Knows no renderer; `refine` decides when to add a sample, and makes it.

use super::cpu_pictures::CpuPictures;
use super::mean::MeanPass;
use super::passes::PictureImages;
use super::pictures::FinishedPictures;

/// The buffers of a picture in progress, in memory and on the device.
#[derive(Default)]
pub(super) struct Buffers {
    pub cpu: CpuPictures,
    pub images: PictureImages,
}

/// The refinement of a renderer's pictures.
#[derive(Default)]
pub(super) struct Refinement {
    /// The samples of a refined picture; 0 and 1: no refinement.
    pub samples: u32,
    /// Refines without waiting for a rest.
    pub at_once: bool,
    /// Number of consecutive frames with the same pictures.
    pub rested: u32,
    /// The samples in the mean.
    pub taken: u32,
    /// Finished rows of the smooth surface in the next sample, of all eyes.
    pub rows: u32,
    /// The present pictures can be refined.
    pub possible: bool,
    /// There was no memory for it.
    pub given_up: bool,
    pub buffers: Buffers,
    pub mean: Option<MeanPass>,
}

impl Refinement {
    /// Starts anew with a changed picture.
    pub fn restart(&mut self) {
        (self.rested, self.taken, self.rows) = (0, 0, 0);
    }

    /// Frees the buffers of samples and their mean; keeps the pipelines.
    pub fn forget(&mut self) {
        let Refinement { samples, at_once, .. } = *self;
        let mut mean = self.mean.take();
        mean.iter_mut().for_each(MeanPass::forget);
        *self = Refinement { samples, at_once, mean, ..Refinement::default() };
    }

    /// Returns the number of samples, and whether to refine without a rest.
    pub fn policy(&self) -> (u32, bool) {
        (self.samples, self.at_once)
    }

    /// Returns the mean of the samples so far, once it is better than the unshifted picture.
    pub fn pictures(&self) -> Option<&FinishedPictures> {
        self.buffers.images.pictures.as_ref().filter(|_| self.taken > 1)
    }

    /// Returns [`Refinement::pictures`], mutable.
    pub fn pictures_mut(&mut self) -> Option<&mut FinishedPictures> {
        self.buffers.images.pictures.as_mut().filter(|_| self.taken > 1)
    }

    /// Returns whether another frame of the same pictures would add nothing.
    pub fn is_complete(&self) -> bool {
        !self.possible || self.taken >= self.samples
    }
}
