//! Tries commands without keeping their changes, to find out why others have had no effect.
//!
//! Takes commands that use tools or edit areas; returns the changes that they would make. Skips other commands. Leaves
//! the document as it was.

use super::Document;
use crate::command::{Command, CommandClass};
use crate::sculpture::edit::EditStats;
use crate::tools::brush::spec::BrushGroup;

/// The restrictions that apply to tools in a trial.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Heeds {
    /// The limit to the selection.
    pub limit: bool,
    /// The mask.
    pub mask: bool,
}

impl Heeds {
    /// No restrictions: tools work everywhere.
    pub const NOTHING: Heeds = Heeds { limit: false, mask: false };
}

impl Document {
    /// Counts the voxels that commands would change, one after the other, as far as they can be executed. Tries nothing
    /// within a stroke.
    pub fn would_change(&mut self, commands: &[Command], heeds: Heeds) -> EditStats {
        let mut stats = EditStats::default();
        if self.stroke_open() {
            return stats;
        }
        // The mask does not protect itself.
        let about_mask = |command: &Command| match command {
            Command::Mask(_) => true,
            Command::Brush(used) => used.brush().spec().group == BrushGroup::Mask,
            _ => false,
        };
        let lifts = !heeds.mask && self.mask().is_some() && !commands.iter().any(about_mask);
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

/// Returns whether all changes of a command are in the record of a stroke.
fn can_be_tried(command: &Command) -> bool {
    match command.class() {
        CommandClass::Tool | CommandClass::Area | CommandClass::Mask => true,
        CommandClass::Replace
        | CommandClass::File
        | CommandClass::Stroke
        | CommandClass::Arrange
        | CommandClass::Whole
        | CommandClass::Orient
        | CommandClass::Canvas
        | CommandClass::Travel
        | CommandClass::Copy
        | CommandClass::Setting => false,
    }
}
