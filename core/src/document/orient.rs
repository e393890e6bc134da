//! How a document lays its whole sculpture another way: selection and symmetry follow, and the step
//! keeps the sculpture as it was only where the way back would not restore every byte.

use std::sync::Arc;

use super::{Applied, CommandError, Document};
use crate::command::Command;
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::{Change, Contents, Step};
use crate::sculpture::orient::Reorientation;
use crate::sculpture::orientation::Orientation;

/// The contents laid another way, within `limits`. [`Document::put_oriented`] puts them in place.
pub fn orient_contents(
    contents: &Contents,
    orientation: Orientation,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, CommandError> {
    Ok(Reorientation::new(contents, orientation).run(limits, progress)?)
}

impl Document {
    /// Lays the sculpture another way, as one undo step. Upright is how it is: no step.
    pub(super) fn orient(
        &mut self,
        orientation: Orientation,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.require_can_orient(orientation)?;
        if orientation != Orientation::UPRIGHT {
            let contents = orient_contents(&self.contents, orientation, &self.limits, &())?;
            self.put_oriented(contents, orientation, command)?;
        }
        Ok(Applied::default())
    }

    /// Refuses to lay the sculpture another way within a stroke, or where the history cannot
    /// keep what leads back, unless that is wanted.
    pub fn require_can_orient(&self, orientation: Orientation) -> Result<(), CommandError> {
        self.require_no_stroke("orient")?;
        self.require_room("orient", self.bytes_to_undo(orientation))
    }

    /// Puts the contents laid another way in their place.
    pub fn put_oriented(
        &mut self,
        contents: Contents,
        orientation: Orientation,
        command: &Command,
    ) -> Result<(), CommandError> {
        self.require_can_orient(orientation)?;
        let is_exact = self.is_exact(orientation);
        if !is_exact {
            self.own_contents()?;
        }
        let change = self.swap_oriented(contents, orientation, is_exact);
        self.state.number = self.new_state();
        let state = std::mem::replace(&mut self.settled, self.state);
        self.history.push(Step { label: command.label(), change, state });
        Ok(())
    }

    /// Bytes of a step that undoes an orientation.
    pub(super) fn bytes_to_undo(&self, orientation: Orientation) -> usize {
        if self.is_exact(orientation) { 0 } else { self.contents.kept_bytes() }
    }

    fn is_exact(&self, orientation: Orientation) -> bool {
        Reorientation::new(&self.contents, orientation).is_exact()
    }

    /// Reverses an orientation and returns the change that does it again. `computed`: the contents
    /// that it leads to, if they are known already.
    ///
    /// # Errors
    /// If it must be computed and memory does not suffice.
    pub(super) fn reverse_orientation(
        &mut self,
        back: Orientation,
        before: Option<Box<Contents>>,
        computed: Option<Contents>,
    ) -> Result<Change, CommandError> {
        match before {
            // Repeating the orientation restores the present contents exactly.
            Some(before) => Ok(self.swap_oriented(*before, back, true)),
            None => {
                let contents = match computed {
                    Some(contents) => contents,
                    None => orient_contents(&self.contents, back, &self.limits, &())?,
                };
                let is_exact = self.is_exact(back);
                if !is_exact {
                    self.own_contents()?;
                }
                Ok(self.swap_oriented(contents, back, is_exact))
            }
        }
    }

    /// Puts contents that were laid another way in place of the present ones; gives the way back.
    fn swap_oriented(
        &mut self,
        contents: Contents,
        orientation: Orientation,
        back_is_exact: bool,
    ) -> Change {
        self.selection = self.selection.oriented(orientation, self.grid().dims());
        self.symmetry = self.symmetry.oriented(orientation, self.grid().dims());
        let old = self.put_contents(contents);
        let before = (!back_is_exact).then(|| Box::new(Arc::unwrap_or_clone(old)));
        Change::Oriented { back: orientation.inverse(), before }
    }
}
