//! The questions that the editor needs answered before it continues, as values for the interface.

use std::path::PathBuf;

use crate::command::Command;
use crate::session::{FileIdentity, Holder};

/// A step that would lose unsaved work.
#[derive(Clone, PartialEq, Debug)]
pub enum Next {
    Leave,
    /// `new` or `open`.
    Run(Command),
    /// Recovers the work of an earlier session from the journal of this number.
    Recover(u64),
}

/// A file to save that another program has changed.
#[derive(Clone, PartialEq, Debug)]
pub struct ChangedOnDisk {
    pub path: PathBuf,
    /// The identity of the file at the attempt to save it; `None` if it could not be read.
    pub found: Option<FileIdentity>,
    /// The step that should follow.
    pub next: Option<Next>,
}

/// The present sculpture's file, which another program has open.
#[derive(Clone, PartialEq, Debug)]
pub struct InUse {
    pub path: PathBuf,
    pub holder: Holder,
}

/// A command that the history cannot keep, and why.
#[derive(Clone, PartialEq, Debug)]
pub struct Unkept {
    pub command: Command,
    pub why: String,
}
