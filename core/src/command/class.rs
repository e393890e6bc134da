//! The classes of commands: the only list of all commands by kind. All code that treats kinds alike asks it.
//!
//! Takes a command; returns its class. Knows nothing of how commands are executed.

use super::Command;

/// A kind of commands: they change the same things in the same manner.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CommandClass {
    /// Replaces the sculpture with another one, as an undo step.
    Replace,
    /// Concerns files alone.
    File,
    /// Begins or finishes a stroke.
    Stroke,
    /// Uses a tool at one place, which an array can repeat.
    Tool,
    /// Changes the voxels or colours of an area, or of a patch of the surface.
    Area,
    /// Changes the mask alone.
    Mask,
    /// Changes voxels and, with them, the clipboard, the marker or the operation that an array repeats.
    Arrange,
    /// Changes the sculpture as a whole, in place.
    Whole,
    /// Reorients the whole sculpture.
    Orient,
    /// Moves the sides of the sculpture's box.
    Canvas,
    /// Moves along the history.
    Travel,
    /// Fills the clipboard; changes nothing else.
    Copy,
    /// Sets how and where tools work, the placement, or what the history allows. No undo step.
    Setting,
}

impl Command {
    /// Returns the class of the command.
    pub const fn class(&self) -> CommandClass {
        match self {
            Command::New(_) | Command::Open { .. } => CommandClass::Replace,
            Command::Embed { .. } | Command::Save { .. } => CommandClass::File,
            Command::Begin { .. } | Command::End | Command::Cancel => CommandClass::Stroke,
            Command::Construct { .. }
            | Command::DrawnSolid { .. }
            | Command::Brush(_)
            | Command::Texture { .. }
            | Command::Paste { .. } => CommandClass::Tool,
            Command::Fill { .. }
            | Command::Clear { .. }
            | Command::Dye { .. }
            | Command::Tint { .. }
            | Command::Flood { .. } => CommandClass::Area,
            Command::Mask(_) => CommandClass::Mask,
            Command::Cut | Command::Move { .. } | Command::Array { .. } => CommandClass::Arrange,
            Command::Repair(_) | Command::Resample(_) | Command::Surface(_) => CommandClass::Whole,
            Command::Orient(_) => CommandClass::Orient,
            Command::Canvas(_) => CommandClass::Canvas,
            Command::Undo { .. } | Command::Redo { .. } => CommandClass::Travel,
            Command::Copy => CommandClass::Copy,
            Command::Mark(_)
            | Command::Select(_)
            | Command::Limit(_)
            | Command::Irreversible(_)
            | Command::Symmetry(_)
            | Command::Place(_) => CommandClass::Setting,
        }
    }
}
