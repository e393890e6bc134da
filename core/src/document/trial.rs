//! Tries commands without keeping any of their changes, so that it can be said why others have done nothing.
//!
//! Takes commands that use tools or edit areas; gives the changes that they would make; other commands are passed over.
//! Leaves the document as it was.

use super::Document;
use crate::command::{Command, CommandClass};
use crate::sculpture::edit::EditStats;
use crate::tools::brush::spec::BrushGroup;

/// The things that keep tools off in a trial.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Heeds {
    /// The limit to the selection.
    pub limit: bool,
    /// The mask.
    pub mask: bool,
}

impl Heeds {
    /// Tools work everywhere.
    pub const NOTHING: Heeds = Heeds { limit: false, mask: false };
}

impl Document {
    /// Counts the voxels that commands would change, one after the other, as far as they can be carried out. Within a stroke nothing is
    /// tried.
    pub fn would_change(&mut self, commands: &[Command], heeds: Heeds) -> EditStats {
        let mut stats = EditStats::default();
        if self.stroke_open() {
            return stats;
        }
        // The mask keeps nothing off itself.
        let about_mask = |command: &Command| match command {
            Command::Mask(_) => true,
            Command::Brush(used) => used.brush().spec().group == BrushGroup::Mask,
            _ => false,
        };
        let lifts = !heeds.mask && self.mask().is_some() && !commands.iter().any(about_mask);
        // Where a snapshot shares them and there is no memory for a copy, nothing is tried.
        if lifts && self.target.own_contents().is_err() {
            return stats;
        }
        let counts = self.counts();
        let limits = self.target.selection.limits();
        self.target.selection.set_limits(limits && heeds.limit);
        let mask = if lifts { self.target.swap_mask(None) } else { None };

        self.strokes.open(String::new());
        for command in commands.iter().filter(|command| can_be_tried(command)) {
            if let Ok(applied) = self.apply(command) {
                stats += applied.stats;
            }
        }
        self.strokes.cancel();
        self.take_back();

        if lifts {
            self.target.swap_mask(mask);
        }
        self.target.selection.set_limits(limits);
        self.return_to(counts);
        stats
    }
}

/// Whether all that a command changes is in the record of a stroke.
fn can_be_tried(command: &Command) -> bool {
    match command.class() {
        CommandClass::Tool | CommandClass::Area | CommandClass::Mask => true,
        CommandClass::Replace
        | CommandClass::File
        | CommandClass::Stroke
        | CommandClass::Arrange
        | CommandClass::Whole
        | CommandClass::Orient
        | CommandClass::Travel
        | CommandClass::Copy
        | CommandClass::Setting => false,
    }
}
