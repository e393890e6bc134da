//! The protection of a session's work, for its owner to switch on and to query: the journal, the undo histories on
//! disk, and the locks of the sculptures' files.
//!
//! Delegates to the types that own these (`JournalKeeper`, `Histories`, `Access`), with the parts of the session that
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

/// Methods for the journal.
impl Session {
    /// Begins a journal with the present state of the session. It is removed when the session ends with everything
    /// saved.
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

    /// Returns the journal and the parts of the session that a checkpoint holds; `None` if no journal is kept.
    pub(super) fn journal_and_parts(&mut self) -> Option<(&mut JournalKeeper, SessionParts<'_>)> {
        let Session { document, files, pictures, journal, .. } = self;
        Some((journal.as_mut()?, SessionParts { document, files, pictures }))
    }

    /// Returns whether a journal is kept, on disk or still without room there.
    pub fn keeps_journal(&self) -> bool {
        self.journal.is_some()
    }

    /// Returns the number of the journal on its shelf, once it has one.
    pub fn journal_number(&self) -> Option<u64> {
        self.journal.as_ref()?.writer().number()
    }

    /// Returns the journal's file, once it has one.
    pub fn journal_path(&self) -> Option<PathBuf> {
        self.journal.as_ref()?.path()
    }

    /// Returns the message for the user on the journal, once: it cannot be written, or can be written again.
    pub fn take_journal_message(&self) -> Option<String> {
        self.journal.as_ref()?.writer().take_message()
    }

    /// Returns the reason why commands are not in the journal, with a remedy, as long as that lasts.
    pub fn journal_trouble(&self) -> Option<String> {
        self.journal.as_ref()?.writer().trouble()
    }

    /// Waits until all changes are in the journal's file. After that, not even a kill loses them.
    pub fn wait_for_journal(&self) {
        if let Some(journal) = &self.journal {
            journal.writer().wait_written();
        }
    }

    /// Writes all changes to the disk. Returns whether all of them are there, so that not even a power cut loses them.
    pub fn secure_in_journal(&self) -> bool {
        self.sync_journal();
        self.journal.as_ref().is_some_and(|journal| journal.writer().is_complete())
    }

    /// Waits until all changes are on the disk. After that, not even a power cut loses them.
    pub fn sync_journal(&self) {
        if let Some(journal) = &self.journal {
            journal.writer().wait_synced();
        }
    }

    /// Ends the journal and removes it: its contents are saved or unwanted.
    pub fn discard_journal(&mut self) {
        if let Some(journal) = self.journal.take() {
            journal.end(true);
        }
    }

    /// Gives the journal a checkpoint if it wants one. Call this now and then between commands, so that a journal that
    /// could not be written catches up.
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

/// Methods for the undo histories on disk.
impl Session {
    /// Moves undo steps for which memory has no room to a file in this folder, up to
    /// [`Limits::history_disk_bytes`](crate::document::Limits::history_disk_bytes); does nothing if that is 0. The file
    /// is removed with the session.
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

    /// Returns the message for the user on the history on disk or on those of saved files: they cannot be written, or
    /// can be written again. Returns each message once.
    pub fn take_history_message(&self) -> Option<String> {
        self.histories.take_message()
    }

    /// Keeps the undo histories of the files that are saved from now on, and continues with those of the files that are
    /// opened, including the file that the session began with. Call this before a journal or a recording begins, and
    /// after [`Session::keep_history_in`].
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

    /// Continues with the history of the file that has just been opened.
    pub(super) fn go_on_with(&mut self, found: FoundHistory) {
        if !self.histories.adopt(found, &mut self.document, &mut self.files) {
            return;
        }
        // Neither a journal nor a recording can repeat it: they continue from the present state.
        if let Some(recording) = &mut self.recording {
            recording.fall_behind();
        }
        if let Some(journal) = &mut self.journal {
            journal.note_gap();
        }
    }

    /// Returns all steps with the state that they led to, and the store of those for which memory has no room; `None`
    /// within a stroke.
    pub fn steps(&self) -> Option<(DocumentSnapshot, Option<Arc<dyn StepStore>>)> {
        Some((self.document.snapshot()?, self.histories.step_store()))
    }

    /// Returns how the histories of saved files are kept, if they are.
    pub fn saved_history_options(&self) -> Option<&SavedHistoryOptions> {
        self.histories.saved().map(|saved| saved.options())
    }

    /// Waits until the history of the last saved file is written.
    pub fn wait_for_saved_history(&self) {
        if let Some(saved) = self.histories.saved() {
            saved.wait();
        }
    }
}

/// Methods for the sculptures' files, which other programs may have open or change.
impl Session {
    /// Changes how files are treated from now on, including the present sculpture's file.
    pub fn set_file_access(&mut self, mode: FileAccess) {
        self.access.set_mode(mode, self.files.path(self.document.state()));
    }

    /// Returns how files are treated.
    pub fn file_access(&self) -> FileAccess {
        self.access.mode()
    }

    /// Returns the other program that has the present sculpture's file open, if there is one. Reports it once.
    pub fn take_foreign_holder(&mut self) -> Option<Holder> {
        self.access.take_foreign_holder()
    }

    /// Returns whether the present sculpture's file must not be overwritten.
    pub fn is_read_only(&self) -> bool {
        self.path().is_some_and(|path| self.access.is_read_only(path))
    }

    /// Protects the present sculpture's file from being overwritten from now on.
    pub fn keep_read_only(&mut self) {
        if let Some(path) = self.files.path(self.document.state()) {
            self.access.keep_read_only(path);
        }
    }

    /// Accepts that another program has changed the file at `path`: the person has been told and wants it replaced as
    /// it was found then ([`SessionError::ChangedOnDisk`](super::SessionError::ChangedOnDisk)). The next
    /// [`Command::Save`](crate::command::Command::Save) does so, unless the file has changed once more.
    pub fn accept_change_on_disk(&mut self, path: &Path, found: Option<FileIdentity>) {
        self.on_disk.learn(path, found);
    }

    /// Makes the present sculpture a copy, which has no file yet and so counts as unsaved.
    pub fn become_copy(&mut self) {
        self.files.forget(self.document.state());
        // No command has done this: the journal continues from a checkpoint.
        if let Some(journal) = &mut self.journal {
            journal.note_gap();
        }
        self.attend_journal();
        self.follow_file();
    }

    /// Locks the file of the present sculpture, and releases the lock of any other.
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
