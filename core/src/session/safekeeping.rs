//! Keeps the work of a session safe, as its owner switches on: the journal, the undo histories on the
//! disk, and the locks of the sculptures' files.
//!
//! Passes on to the types that own these (`JournalKeeper`, `Histories`, `Access`), with the parts of the session that
//! they need. Executes no command.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use super::Session;
use super::access::FileAccess;
use super::histories;
use super::journal_keeper::{JournalKeeper, SessionParts};
use super::lock::Holder;
use super::on_disk::FileIdentity;
use crate::document::DocumentSnapshot;
use crate::persist::journal::{JournalEntry, JournalOptions};
use crate::persist::saved_history::{FoundHistory, SavedHistoryOptions};
use crate::sculpture::history::StepStore;

/// The journal.
impl Session {
    /// Begins a journal with what the session is now. It is removed when the session ends with everything saved.
    ///
    /// # Errors
    /// If no thread can be made. Problems with files are reported by [`Session::take_journal_message`].
    pub fn keep_journal(&mut self, options: JournalOptions) -> std::io::Result<()> {
        self.discard_journal();
        self.journal = Some(JournalKeeper::begin(options, self.parts())?);
        Ok(())
    }

    fn parts(&mut self) -> SessionParts<'_> {
        let Session { document, files, pictures, .. } = self;
        SessionParts { document, files, pictures }
    }

    /// The journal, and the parts of the session that a checkpoint holds; none if no journal is kept.
    pub(super) fn journal_and_parts(&mut self) -> Option<(&mut JournalKeeper, SessionParts<'_>)> {
        let Session { document, files, pictures, journal, .. } = self;
        Some((journal.as_mut()?, SessionParts { document, files, pictures }))
    }

    /// Whether a journal is kept, on the disk or still without room there.
    pub fn keeps_journal(&self) -> bool {
        self.journal.is_some()
    }

    /// The number of the journal on its shelf, once it has one.
    pub fn journal_number(&self) -> Option<u64> {
        self.journal.as_ref()?.writer().number()
    }

    /// The journal's file, once it has one.
    pub fn journal_path(&self) -> Option<PathBuf> {
        self.journal.as_ref()?.path()
    }

    /// Returns the message for the user on the journal, once: that it cannot be written, or can be again.
    pub fn take_journal_message(&self) -> Option<String> {
        self.journal.as_ref()?.writer().take_message()
    }

    /// The reason why commands are not in the journal, with a remedy, for as long as that lasts.
    pub fn journal_trouble(&self) -> Option<String> {
        self.journal.as_ref()?.writer().trouble()
    }

    /// Waits until what was done is in the journal's file: after that not even a kill loses it.
    pub fn wait_for_journal(&self) {
        if let Some(journal) = &self.journal {
            journal.writer().wait_written();
        }
    }

    /// Puts what was done on the disk. Whether all of it is there, and not even a power cut loses it.
    pub fn secure_in_journal(&self) -> bool {
        self.sync_journal();
        self.journal.as_ref().is_some_and(|journal| journal.writer().is_complete())
    }

    /// Waits until what was done is on the disk: after that not even a power cut loses it.
    pub fn sync_journal(&self) {
        if let Some(journal) = &self.journal {
            journal.writer().wait_synced();
        }
    }

    /// Ends the journal and removes it: its contents are saved or not wanted.
    pub fn discard_journal(&mut self) {
        if let Some(journal) = self.journal.take() {
            journal.end(true);
        }
    }

    /// Gives the journal a checkpoint if it wants one. To be called now and then while nothing is executed, so that
    /// a journal that could not be written catches up.
    pub fn attend_journal(&mut self) {
        if let Some((journal, parts)) = self.journal_and_parts() {
            journal.attend(parts);
        }
    }

    /// Adds an entry to the journal.
    pub(super) fn keep(&mut self, entry: JournalEntry, took: Duration) {
        if let Some((journal, parts)) = self.journal_and_parts() {
            journal.keep(entry, took, parts);
        }
    }
}

/// The undo histories on the disk.
impl Session {
    /// Gives undo steps that memory has no room for to a file in this folder, up to
    /// [`Limits::history_disk_bytes`](crate::document::Limits::history_disk_bytes); nothing if that is 0. The file goes
    /// with the session.
    ///
    /// # Errors
    /// If no thread can be made. Problems with files are reported by [`Session::take_history_message`].
    pub fn keep_history_in(&mut self, folder: &Path) -> std::io::Result<()> {
        self.histories.keep_steps_in(folder, self.document.limits())?;
        if let Some(store) = self.histories.step_store() {
            self.document.use_step_store(store);
        }
        Ok(())
    }

    /// Returns the message for the user on the history on disk or on those of saved files: that they cannot be written,
    /// or can be again. Each is returned once.
    pub fn take_history_message(&self) -> Option<String> {
        self.histories.take_message()
    }

    /// Keeps the undo histories of the files that are saved from now on, and goes on with those of the files that are
    /// opened. If the session began with a file, with that of this file, too: to be called before a journal or a
    /// recording begins, and after [`Session::keep_history_in`].
    pub fn keep_saved_histories(&mut self, options: SavedHistoryOptions) {
        self.histories.keep_saved(options);
        let history = self.document.history();
        let is_untouched = history.undo_count() + history.redo_count() == 0 && !self.modified();
        let identity = self.path().and_then(|path| self.on_disk.known(path));
        if is_untouched && identity.is_some() {
            let (contents, limits) = (self.document.contents(), self.document.limits());
            let saved = self.histories.saved().map(Arc::as_ref);
            let found = histories::find(saved, identity, contents, limits);
            self.go_on_with(found);
        }
    }

    /// Goes on with the history of the file that has just been opened.
    pub(super) fn go_on_with(&mut self, found: FoundHistory) {
        if !self.histories.adopt(found, &mut self.document, &mut self.files) {
            return;
        }
        // Neither a journal nor a recording can repeat it: they go on from what is now.
        if let Some(recording) = &mut self.recording {
            recording.fall_behind();
        }
        if let Some(journal) = &mut self.journal {
            journal.note_gap();
        }
    }

    /// All steps with what they have led to, and where those of them lie that memory has no room for; none within a
    /// stroke.
    pub fn steps(&self) -> Option<(DocumentSnapshot, Option<Arc<dyn StepStore>>)> {
        Some((self.document.snapshot()?, self.histories.step_store()))
    }

    /// How the histories of saved files are kept, if they are.
    pub fn saved_history_options(&self) -> Option<&SavedHistoryOptions> {
        self.histories.saved().map(|saved| saved.options())
    }

    /// Waits until the history of the file that was saved last is written.
    pub fn wait_for_saved_history(&self) {
        if let Some(saved) = self.histories.saved() {
            saved.wait();
        }
    }
}

/// The sculptures' files, which other programs may have open or change.
impl Session {
    /// Changes how files are treated from now on, that of the present sculpture included.
    pub fn set_file_access(&mut self, mode: FileAccess) {
        self.access.set_mode(mode, self.files.path(self.document.state()));
    }

    /// How files are treated.
    pub fn file_access(&self) -> FileAccess {
        self.access.mode()
    }

    /// The other program that has the present sculpture's file open, if there is one. Returned once.
    pub fn take_foreign_holder(&mut self) -> Option<Holder> {
        self.access.take_foreign_holder()
    }

    /// Whether the present sculpture's file is not to be overwritten.
    pub fn is_read_only(&self) -> bool {
        self.path().is_some_and(|path| self.access.is_read_only(path))
    }

    /// Does not overwrite the present sculpture's file from now on.
    pub fn keep_read_only(&mut self) {
        if let Some(path) = self.files.path(self.document.state()) {
            self.access.keep_read_only(path);
        }
    }

    /// The person has been told that another program has changed the file at `path`, and wants it replaced as it was
    /// found then ([`SessionError::ChangedOnDisk`](super::SessionError::ChangedOnDisk)): the next
    /// [`Command::Save`](crate::command::Command::Save) does so, unless it has changed once more.
    pub fn accept_change_on_disk(&mut self, path: &Path, found: Option<FileIdentity>) {
        self.on_disk.learn(path, found);
    }

    /// Makes the present sculpture a copy of its file, which has no file yet and so is not saved.
    pub fn become_copy(&mut self) {
        self.files.forget(self.document.state());
        // No command has done this: the journal goes on from a checkpoint.
        if let Some(journal) = &mut self.journal {
            journal.note_gap();
        }
        self.attend_journal();
        self.follow_file();
    }

    /// Locks the file of the present sculpture, and gives back the lock of any other.
    pub(super) fn follow_file(&mut self) {
        self.access.follow(self.files.path(self.document.state()));
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let is_needed = self.modified() || std::thread::panicking();
        if let Some(journal) = self.journal.take() {
            journal.end(!is_needed);
        }
    }
}
