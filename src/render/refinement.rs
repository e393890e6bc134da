//! The state of the refinement of resting pictures: how far it has come, and the buffers of its samples.
//!
//! Knows no renderer; `refine` decides when a sample is added, and makes it.

use super::cpu_pictures::CpuPictures;
use super::mean::Mean;
use super::passes::PictureImages;
use super::pictures::Pictures;

/// The buffers in which a picture is made, in memory and on the device.
#[derive(Default)]
pub(super) struct Buffers {
    pub cpu: CpuPictures,
    pub images: PictureImages,
}

/// The refinement of a renderer's pictures.
#[derive(Default)]
pub(super) struct Refinement {
    /// The samples of a refined picture; 0 and 1: pictures are not refined.
    pub samples: u32,
    /// Whether a picture need not rest before it is refined.
    pub at_once: bool,
    /// How many frames in a row had the same pictures.
    pub rested: u32,
    /// The samples in the mean.
    pub taken: u32,
    /// Rows of pixels of the next sample, of all eyes, in which the smooth surface has been found.
    pub rows: u32,
    /// The present pictures can be refined.
    pub possible: bool,
    /// There was no memory for it.
    pub given_up: bool,
    pub buffers: Buffers,
    pub mean: Option<Mean>,
}

impl Refinement {
    /// Begins anew, with a picture that has just changed.
    pub fn restart(&mut self) {
        (self.rested, self.taken, self.rows) = (0, 0, 0);
    }

    /// Frees what samples are made in, and their mean; keeps its pipelines.
    pub fn forget(&mut self) {
        let Refinement { samples, at_once, .. } = *self;
        let mut mean = self.mean.take();
        mean.iter_mut().for_each(Mean::forget);
        *self = Refinement { samples, at_once, mean, ..Refinement::default() };
    }

    /// Returns how many samples are wanted, and whether at once.
    pub fn policy(&self) -> (u32, bool) {
        (self.samples, self.at_once)
    }

    /// Returns the mean of the samples so far, once it is better than the unshifted picture.
    pub fn pictures(&self) -> Option<&Pictures> {
        self.buffers.images.pictures.as_ref().filter(|_| self.taken > 1)
    }

    /// [`Refinement::pictures`], mutable.
    pub fn pictures_mut(&mut self) -> Option<&mut Pictures> {
        self.buffers.images.pictures.as_mut().filter(|_| self.taken > 1)
    }

    /// Returns whether the next frame of the same pictures has nothing to add.
    pub fn is_complete(&self) -> bool {
        !self.possible || self.taken >= self.samples
    }
}
