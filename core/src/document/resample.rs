//! Gives the sculpture another resolution as one undo step, which keeps the former sculpture.
//!
//! Takes contents and a resolution; returns new contents, or puts them in place. If the size changes, the marker is reset.

use super::{Applied, CommandError, Document};
use crate::command::Command;
use crate::progress::Progress;
use crate::resample::{Resolution, resampled};
use crate::sculpture::Limits;
use crate::sculpture::history::{Contents, StepChange};

/// Returns the contents in another resolution, computed within `limits`. [`Document::put_resampled`] puts them in place.
pub fn resample_contents(
    contents: &Contents,
    to: Resolution,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, CommandError> {
    Ok(resampled(contents, to, limits, progress)?)
}

impl Document {
    /// Returns an error if the sculpture cannot be resampled: within a stroke, or if the history cannot keep the former
    /// one and irreversible steps are not allowed.
    pub fn require_can_resample(&self) -> Result<(), CommandError> {
        self.require_no_stroke("resample")?;
        self.require_room_for_whole("resample")
    }

    /// Replaces the contents by the same ones in another resolution.
    pub fn put_resampled(
        &mut self,
        contents: Contents,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.require_can_resample()?;
        let before = Box::new(self.target.swap_contents(contents));
        self.strokes.forget_last_uses();
        self.timeline.push_change(command.label(), StepChange::Whole(before));
        Ok(Applied::default())
    }
}
