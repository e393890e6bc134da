//! The requests that a person makes in panels and dialogs, for the program to carry out.
//!
//! Panels and dialogs give them instead of acting, for changes to values that another part owns (the document, the tool,
//! the viewpoint, the controls). Knows no panel and no dialog.

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
    /// The same as by key or mouse.
    Do(Action),
    /// A command whose arguments were chosen in a window.
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
    /// Read a file to ask how it is to be imported.
    Study(PathBuf, ImportOptions),
    /// Check whether the sculpture can be printed.
    PrintCheck(CheckOptions),
    /// Stop the long work under way, where it can be stopped.
    StopWork,
    /// A step of the calibration of the tracker.
    Calibrate(CalibrationStep),
    /// Change the table of keys in use.
    Keys(KeyChange),
    /// Use another table of keys, by its index.
    UsePreset(usize),
    /// Do what would lose unsaved work, without asking again.
    Go(Next),
    /// Save, under a name that is asked for if there is none, then do that.
    SaveFirst(Next),
    /// Carry out a command that saves, then do that.
    SaveThen(Command, Next),
    /// Brings back what an earlier session has left in the journal of this number.
    Recover(u64),
    /// Removes that journal.
    DiscardLeft(u64),
    /// List what earlier sessions have left, or say that there is nothing.
    ListLeft,
    /// Save to this file although another program has changed it, then do that.
    Overwrite(ChangedOnDisk),
    /// Do not save to the sculpture's file, which another program has open.
    KeepReadOnly,
    /// Go on with a copy of the sculpture's file, without a name.
    BecomeCopy,
    /// Carry out a command although it cannot be undone.
    Irreversibly(Command),
}
