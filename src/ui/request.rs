//! The requests of panels and dialogs, which the program executes.
//!
//! Panels and dialogs return them for changes to values that another part owns (the document, the tool, the viewpoint,
//! the controls). Knows no panel and no dialog.

use std::path::PathBuf;

use glam::Vec2;

use super::pictures::{FilmRequest, FinalRequest};
use crate::command::Command;
use crate::editor::questions::{ChangedOnDisk, Next};
use crate::editor::tool::ToolEdit;
use crate::format::options::ImportOptions;
use crate::input::Action;
use crate::input::remap::KeyChange;
use crate::print_check::CheckOptions;
use crate::viewpoint::head::CalibrationStep;

/// A request that a person made in the interface.
#[derive(Clone, PartialEq, Debug)]
pub enum UiRequest {
    /// Execute an action, as a key or the mouse would.
    Do(Action),
    /// Execute a command whose arguments were chosen in a window.
    Run(Command),
    /// Add a reference picture from a file.
    AddReference(PathBuf),
    /// Rotate the sculpture by angles in radians: to the right, and down.
    Turn(Vec2),
    /// Change the tool.
    Tool(ToolEdit),
    /// Make a final picture of the view.
    FinalPicture(Box<FinalRequest>),
    /// Make a film.
    Film(FilmRequest),
    /// Read a file to ask about its import.
    Study(PathBuf, ImportOptions),
    /// Check whether the sculpture can be printed.
    PrintCheck(CheckOptions),
    /// Stop the long work, if it can be stopped.
    StopWork,
    /// A step of the calibration of the tracker.
    Calibrate(CalibrationStep),
    /// Change the table of keys in use.
    Keys(KeyChange),
    /// Use another table of keys, by its index.
    UsePreset(usize),
    /// Do a step that would lose unsaved work, without asking again.
    Go(Next),
    /// Save (after asking for a name if there is none), then do that step.
    SaveFirst(Next),
    /// Execute a command that saves, then do that step.
    SaveThen(Command, Next),
    /// Restore the work that an earlier session left in the journal of this number.
    Recover(u64),
    /// Remove that journal.
    DiscardLeft(u64),
    /// List the work of earlier sessions, or say that there is none.
    ListLeft,
    /// Save to this file although another program has changed it, then do the next step.
    Overwrite(ChangedOnDisk),
    /// Do not save to the sculpture's file, which another program has open.
    KeepReadOnly,
    /// Continue with an unnamed copy of the sculpture's file.
    BecomeCopy,
    /// Execute a command although it cannot be undone.
    Irreversibly(Command),
}
