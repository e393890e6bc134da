//! Exchanges the edited data for earlier or other values: recorded bricks, the kind of surface, the mask, the whole
//! contents, or the same contents in another box, also within a stroke, whose record a growth divides.
//!
//! Takes the new values and returns the old ones. A change for which the system lacks memory is refused before anything
//! has changed. Selection and marker stay where they are in signed coordinates. Knows no undo steps.

use std::sync::Arc;

use glam::IVec3;

use super::EditTarget;
use crate::document::CommandError;
use crate::sculpture::canvas_frame::Canvas;
use crate::sculpture::edit::EditStats;
use crate::sculpture::history::{Contents, StepChange, SurfaceKind};
use crate::sculpture::memory::NoMemory;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::record::BrickRecord;
use crate::sculpture::reframe::{keeps_all, reframed};
use crate::sculpture::selection::Selection;
use crate::sculpture::stroke::StrokeRecorder;
use crate::sculpture::{Grid, GridError, Limits};

/// The edits that a stroke has recorded, taken back for as long as the box grows.
#[derive(Debug)]
pub(in crate::document) struct SetAside(BrickRecord);

impl EditTarget {
    pub fn no_memory(&self, error: NoMemory) -> CommandError {
        GridError::NoMemory { dims: self.grid().dims(), needed_mib: error.mib() }.into()
    }

    /// Returns the size in bytes of the record of edits that are no undo step yet.
    pub fn recorded_bytes(&self) -> usize {
        let earlier =
            self.earlier.iter().map(|change| size_of::<StepChange>() + change.heap_bytes());
        self.recorder.bytes() + earlier.sum::<usize>()
    }

    /// Ends the record of edits and returns it as a change, with the earlier edits and growths of the stroke. `None` if
    /// there are none.
    pub fn finish_record(&mut self) -> Option<StepChange> {
        self.close_record();
        match self.earlier.len() {
            0 | 1 => self.earlier.pop(),
            _ => Some(StepChange::Several(std::mem::take(&mut self.earlier))),
        }
    }

    /// Ends the record of edits: they become an earlier change of the stroke.
    pub(super) fn close_record(&mut self) {
        let record = self.recorder.finish();
        if !record.is_empty() {
            self.earlier.push(StepChange::Bricks(record));
        }
    }

    /// Reverts all changes that are no undo step yet.
    pub fn take_back(&mut self) {
        let record = self.recorder.finish();
        self.swap_bricks(record);
        while let Some(change) = self.earlier.pop() {
            match change {
                StepChange::Bricks(record) => drop(self.swap_bricks(record)),
                // It has been that size before, and shrinks.
                StepChange::Canvas { back, before } => drop(self.take_canvas_back(back, before)),
                _ => {}
            }
        }
    }

    /// Does `work` in place of all recorded edits. If `work` is refused, the edits are restored.
    pub fn instead_of_recorded(
        &mut self,
        work: impl FnOnce(&mut EditTarget) -> Result<EditStats, CommandError>,
    ) -> Result<EditStats, CommandError> {
        let revision = self.revision;
        let record = self.recorder.finish();
        let done = match self.try_swap_bricks(record) {
            Ok(done) => done,
            Err(refused) => {
                let (record, error) = *refused;
                self.resume(record);
                return Err(error);
            }
        };
        let stats = work(self);
        if stats.is_err() {
            // Nothing has changed since, so this returns the same record again.
            let record = self.swap_bricks(done);
            self.resume(record);
            self.revision = revision;
        }
        stats
    }

    pub(super) fn resume(&mut self, record: BrickRecord) {
        self.recorder.resume(record, &self.contents);
    }

    pub(super) fn swap_bricks(&mut self, record: BrickRecord) -> BrickRecord {
        if record.is_empty() {
            return record;
        }
        self.revision += 1;
        self.bits.forget();
        record.swap(Arc::make_mut(&mut self.contents), &mut self.dirty)
    }

    /// Exchanges the values of a record for the present ones. If the system lacks the memory for it, changes nothing
    /// and returns the record.
    pub fn try_swap_bricks(
        &mut self,
        record: BrickRecord,
    ) -> Result<BrickRecord, Box<(BrickRecord, CommandError)>> {
        let changes = !record.is_empty();
        self.bits.forget();
        match record.try_swap(Arc::make_mut(&mut self.contents), &mut self.dirty) {
            Ok(reverse) => {
                self.revision += u64::from(changes);
                Ok(reverse)
            }
            Err(record) => {
                let contents = &*self.contents;
                let bytes = record.reverse_bytes(contents) + record.written_bytes(contents);
                Err(Box::new((*record, self.no_memory(NoMemory { bytes: bytes as u64 }))))
            }
        }
    }

    /// Replaces the sculpture. If the size or the place of its box changes, the marker is reset.
    pub fn swap_contents(&mut self, contents: Contents) -> Contents {
        let old = self.put_contents(contents);
        let place = |canvas: Canvas| (canvas.dims, canvas.frame.origin, canvas.frame.home);
        if place(self.contents.canvas()) != place(old.canvas()) {
            self.selection = Selection::of(&self.contents.frame);
        }
        Arc::unwrap_or_clone(old)
    }

    /// Replaces the contents with reoriented ones; selection and symmetry follow. Returns the inverse orientation.
    pub fn swap_oriented(
        &mut self,
        contents: Contents,
        orientation: Orientation,
        back_is_exact: bool,
    ) -> StepChange {
        self.selection = self.selection.oriented(orientation, self.grid().dims());
        self.symmetry = self.symmetry.oriented(orientation, self.contents.frame.home);
        let old = self.put_contents(contents);
        let before = (!back_is_exact).then(|| Box::new(Arc::unwrap_or_clone(old)));
        StepChange::Oriented { back: orientation.inverse(), before }
    }

    /// Exchanges all contents and returns the old ones.
    pub(super) fn put_contents(&mut self, contents: Contents) -> Arc<Contents> {
        let old = std::mem::replace(&mut self.contents, Arc::new(contents));
        self.recorder = StrokeRecorder::default();
        self.bits.forget();
        self.dirty.clear();
        self.all_dirty = true;
        self.revision += 1;
        old
    }

    /// Selects the kind of surface and returns the former one.
    pub fn swap_surface(&mut self, kind: SurfaceKind) -> SurfaceKind {
        self.revision += 1;
        std::mem::replace(&mut Arc::make_mut(&mut self.contents).surface, kind)
    }

    /// Exchanges the mask without recording it.
    pub fn swap_mask(&mut self, mask: Option<Box<Grid>>) -> Option<Box<Grid>> {
        std::mem::replace(&mut Arc::make_mut(&mut self.contents).mask, mask)
    }

    /// Replaces the contents by the same ones in another box, and returns the reverse change.
    pub fn swap_canvas(&mut self, contents: Contents) -> StepChange {
        let shift = self.contents.frame.origin - contents.frame.origin;
        self.selection = self.selection.shifted(shift);
        let old = self.put_contents(contents);
        let back = old.canvas();
        let is_exact = keeps_all(&old, &self.contents);
        let before = (!is_exact).then(|| Box::new(Arc::unwrap_or_clone(old)));
        StepChange::Canvas { back, before }
    }

    /// Reverses the move of a box and returns the change that repeats it.
    pub fn take_canvas_back(
        &mut self,
        back: Canvas,
        before: Option<Box<Contents>>,
    ) -> Result<StepChange, Box<(StepChange, CommandError)>> {
        match before {
            // Repeating the move restores the present contents exactly.
            Some(before) => {
                let present = self.contents.canvas();
                self.swap_canvas(*before);
                Ok(StepChange::Canvas { back: present, before: None })
            }
            None => match reframed(&self.contents, &back, &Limits::NONE) {
                Ok(contents) => Ok(self.swap_canvas(contents)),
                Err(error) => {
                    Err(Box::new((StepChange::Canvas { back, before: None }, error.into())))
                }
            },
        }
    }

    /// Takes back the edits recorded since the box last grew, which the next use of a brush will replace.
    pub fn set_aside(&mut self) -> SetAside {
        let record = self.recorder.finish();
        SetAside(self.swap_bricks(record))
    }

    /// Repeats the edits that were set aside, in the same box.
    pub fn put_again(&mut self, aside: SetAside) {
        let record = self.swap_bricks(aside.0);
        self.resume(record);
    }

    /// Lets the box grow before an edit, as a change of the same undo step.
    pub fn grow(&mut self, contents: Contents) {
        self.close_record();
        let change = self.swap_canvas(contents);
        self.earlier.push(change);
    }

    /// Takes back the last growth. Nothing may have been edited since.
    pub fn take_growth_back(&mut self) {
        if let Some(StepChange::Canvas { back, before }) = self.earlier.pop() {
            drop(self.take_canvas_back(back, before));
        }
        // The record before the growth goes on.
        if let Some(StepChange::Bricks(record)) =
            self.earlier.pop_if(|change| matches!(change, StepChange::Bricks(_)))
        {
            self.resume(record);
        }
    }

    /// Returns the distance from grid coordinates to signed ones.
    pub fn origin(&self) -> IVec3 {
        self.contents.frame.origin
    }
}
