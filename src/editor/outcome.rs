//! The effects of an edit besides the change of the document, as values for the editor's owner.

use super::questions::{ChangedOnDisk, Next, Unkept};
use crate::command::Command;
use crate::notice::Notice;

/// An effect of an edit, besides the change of the document.
#[derive(Clone, PartialEq, Debug)]
pub enum Outcome {
    /// The sculpture has been replaced: its views start anew.
    Replaced,
    Notice(Notice),
    /// Nothing has changed because tools are limited to the selection.
    Limited,
    /// This would lose unsaved work: ask the person.
    Unsaved(Next),
    /// This cannot be undone: ask the person.
    Unkept(Unkept),
    /// Another program has changed the file: ask the person.
    ChangedOnDisk(ChangedOnDisk),
    /// A name for the sculpture's file is needed; then do that.
    NameNeeded(Option<Next>),
    /// This command has opened or saved a file.
    FileUsed(Command),
    /// Leave the program, as requested during long work.
    Leave,
    /// Recover the work of an earlier session from the journal of this number. This was requested with unsaved work,
    /// which is saved now.
    Recover(u64),
}
