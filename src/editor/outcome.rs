//! The effects of an edit besides the change of the document, as values for the owner of the editor.

use super::questions::{ChangedOnDisk, Next, Unkept};
use crate::command::Command;
use crate::notice::Notice;

/// An effect of an edit, besides the change of the document.
#[derive(Clone, PartialEq, Debug)]
pub enum Outcome {
    /// Another sculpture is there: views of it begin anew.
    Replaced,
    Notice(Notice),
    /// Nothing has changed because tools are limited to the selection.
    Limited,
    /// This would lose unsaved work: the person is to be asked.
    Unsaved(Next),
    /// This cannot be undone: the person is to be asked.
    Unkept(Unkept),
    /// Another program has changed the file: the person is to be asked.
    ChangedOnDisk(ChangedOnDisk),
    /// A name for the sculpture's file is needed; then do that.
    NameNeeded(Option<Next>),
    /// A file was opened or saved by this command.
    FileUsed(Command),
    /// The program is to be left, as was asked for while there was long work.
    Leave,
    /// The work that an earlier session left is to be recovered from the journal of this number. This was asked for
    /// while there was unsaved work, which is saved now.
    Recover(u64),
}
