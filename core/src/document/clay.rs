//! Carries out what moves clay: pulls, at the clay as it is or as it was when the stroke began.
//!
//! As all tools it changes voxels through [`Document::edit`] and [`Document::paint`] alone.

use glam::UVec3;

use super::{CommandError, Document};
use crate::command::SpraySurface;
use crate::sculpture::Grid;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::tools::brush::deform::Deform;
use crate::tools::brush::kernel::grab::{Grab, Pulled};

impl Document {
    /// Pulls at a ball of clay and at its mirror images, all at once.
    pub(super) fn grab(
        &mut self,
        grab: &Grab,
        surface: SpraySurface,
    ) -> Result<EditStats, CommandError> {
        grab.check().map_err(CommandError::Grab)?;
        grab.check_steps(self.grid().voxel_size()).map_err(CommandError::Grab)?;
        match surface {
            SpraySurface::Now => self.pull(grab),
            SpraySurface::Stroke => self.instead_of_stroke(|document| document.pull(grab)),
        }
    }

    fn pull(&mut self, grab: &Grab) -> Result<EditStats, CommandError> {
        let pulled = grab.pulled(&self.contents, &self.symmetry);
        self.put_pulled(&pulled)
    }

    /// The surface that uses of a brush with [`SpraySurface::Stroke`] move: as it was when the stroke began.
    pub fn stroke_surface(&self) -> &Grid {
        self.stroke_surface.as_deref().unwrap_or(self.grid())
    }

    /// Moves the surface in a ball and in its mirror images.
    pub(super) fn deform(
        &mut self,
        deform: &Deform,
        surface: SpraySurface,
    ) -> Result<EditStats, CommandError> {
        deform.check().map_err(CommandError::Grab)?;
        let from = match surface {
            SpraySurface::Stroke => self.stroke_surface.as_deref(),
            SpraySurface::Now => None,
        };
        let stamp = deform.offset().stamp(from.unwrap_or(self.grid()), &self.symmetry);
        let inherited = self.inherited(&stamp.add);
        self.check_colour_memory(|document, exact| {
            document.new_pages(&stamp.add, EditOp::Add(None), exact)
                + inherited.new_pages(document.contents())
        })?;
        if surface == SpraySurface::Stroke {
            self.keep_stroke_surface()?;
        }
        let mut stats = self.edit(&stamp.remove, EditOp::Subtract);
        stats += self.edit(&stamp.add, EditOp::Add(None));
        if !inherited.is_empty() {
            self.paint(&stamp.add, |v, now| inherited.colour(v).unwrap_or(now));
        }
        Ok(stats)
    }

    /// Does `work` in place of all that the open stroke has done so far. If it is refused, the stroke is as it was.
    fn instead_of_stroke(
        &mut self,
        work: impl FnOnce(&mut Document) -> Result<EditStats, CommandError>,
    ) -> Result<EditStats, CommandError> {
        let (revision, state) = (self.revision, self.state);
        let record = self.recorder.finish();
        let done = match self.try_swap_bricks(record) {
            Ok(done) => done,
            Err(refused) => {
                let (record, error) = *refused;
                self.recorder.resume(record, &self.contents.grid);
                return Err(error);
            }
        };
        self.state = self.settled;
        let stats = work(self);
        if stats.is_err() {
            // Nothing has changed since, so this gives the same record again.
            let record = self.swap_bricks(done);
            self.recorder.resume(record, &self.contents.grid);
            (self.revision, self.state) = (revision, state);
        }
        stats
    }

    /// Removes, adds and paints what moved clay leaves and covers.
    fn put_pulled(&mut self, pulled: &Pulled) -> Result<EditStats, CommandError> {
        let stamp = &pulled.stamp;
        if self.has_colour() {
            let unpainted = |b: &UVec3| self.material().page(self.grid().brick_index(*b)).is_none();
            let painted = stamp.paint.bricks().iter().filter(|(b, _)| unpainted(b)).count() as u64;
            self.check_colour_memory(|_, _| painted)?;
        }
        let mut stats = self.edit(&stamp.remove, EditOp::Subtract);
        stats += self.edit(&stamp.add, EditOp::Add(None));
        stats += self.paint(&stamp.paint, |v, now| pulled.colour(v).unwrap_or(now));
        Ok(stats)
    }
}
