//! Moves the box of the edited sculpture: as a change of its own, or within a stroke, whose record it divides.
//!
//! Takes canvases; returns the reverse changes. Selection and marker stay where they are in signed coordinates. Knows no
//! undo steps.

use std::sync::Arc;

use glam::IVec3;

use super::EditTarget;
use crate::document::CommandError;
use crate::sculpture::Limits;
use crate::sculpture::canvas_frame::Canvas;
use crate::sculpture::history::{Contents, StepChange};
use crate::sculpture::record::BrickRecord;
use crate::sculpture::reframe::{keeps_all, reframed};

/// For a box that the sculpture has had before.
const ANY_SIZE: Limits = Limits {
    grid_bytes: u64::MAX,
    colour_bytes: u64::MAX,
    history_bytes: usize::MAX,
    history_disk_bytes: u64::MAX,
};

/// The edits that a stroke has recorded, taken back for as long as the box grows.
#[derive(Debug)]
pub(in crate::document) struct SetAside(BrickRecord);

impl EditTarget {
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
            None => match reframed(&self.contents, &back, &ANY_SIZE) {
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
