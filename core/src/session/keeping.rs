//! How a session keeps its journal: an entry for each command that was executed, and a checkpoint whenever one is
//! wanted and no stroke is open.
//!
//! Nothing here waits for a disk, and nothing that goes wrong there makes a command fail.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use super::Session;
use crate::command::Command;
use crate::document::Applied;
use crate::format::Texts;
use crate::persist::journal::{Checkpoint, Entry, JournalOptions, JournalWriter, Mark, STATES};
use crate::sculpture::Digest;
use crate::sculpture::history::State;
use crate::sculpture::orientation::Up;

/// The journal of a session.
#[derive(Debug)]
pub(super) struct Keeping {
    writer: JournalWriter,
    /// How many steps of the undo and the redo list, those furthest away, the journal does not hold.
    missing: [usize; 2],
}

impl Keeping {
    /// Notes that something was done that no entry can repeat: a checkpoint follows.
    pub fn note_gap(&mut self) {
        self.writer.note_gap();
    }
}

impl Session {
    /// Begins a journal with what the session is now. It is removed when the session ends with everything saved.
    ///
    /// # Errors
    /// If no thread can be made. Problems with files are reported by [`Session::take_journal_message`].
    pub fn keep_journal(&mut self, options: JournalOptions) -> std::io::Result<()> {
        self.discard_journal();
        let Some((checkpoint, missing)) = self.checkpoint(options.max_bytes) else {
            let text = "a journal cannot begin within a stroke";
            return Err(std::io::Error::new(std::io::ErrorKind::InvalidInput, text));
        };
        let writer = JournalWriter::begin(options, checkpoint)?;
        self.journal = Some(Keeping { writer, missing });
        Ok(())
    }

    /// Whether a journal is kept, on the disk or still without room there.
    pub fn keeps_journal(&self) -> bool {
        self.journal.is_some()
    }

    /// The number of the journal on its shelf, once it has one.
    pub fn journal_number(&self) -> Option<u64> {
        self.journal.as_ref()?.writer.number()
    }

    /// The journal's file, once it has one.
    pub fn journal_path(&self) -> Option<PathBuf> {
        let writer = &self.journal.as_ref()?.writer;
        Some(writer.options().journal_dir.path(writer.number()?))
    }

    /// Returns the message for the user on the journal, once: that it cannot be written, or can be again.
    pub fn take_journal_message(&self) -> Option<String> {
        self.journal.as_ref()?.writer.take_message()
    }

    /// The reason why commands are not in the journal, with a remedy, for as long as that lasts.
    pub fn journal_trouble(&self) -> Option<String> {
        self.journal.as_ref()?.writer.trouble()
    }

    /// Waits until what was done is in the journal's file: after that not even a kill loses it.
    pub fn wait_for_journal(&self) {
        if let Some(journal) = &self.journal {
            journal.writer.wait_written();
        }
    }

    /// Puts what was done on the disk. Whether all of it is there, and not even a power cut loses it.
    pub fn secure_in_journal(&self) -> bool {
        self.sync_journal();
        self.journal.as_ref().is_some_and(|journal| journal.writer.is_complete())
    }

    /// Waits until what was done is on the disk: after that not even a power cut loses it.
    pub fn sync_journal(&self) {
        if let Some(journal) = &self.journal {
            journal.writer.wait_synced();
        }
    }

    /// Ends the journal and removes it: its contents are saved or not wanted.
    pub fn discard_journal(&mut self) {
        if let Some(journal) = self.journal.take() {
            journal.writer.end(true);
        }
    }

    /// Gives the journal a checkpoint if it wants one. To be called now and then while nothing is executed, so that
    /// a journal that could not be written catches up.
    pub fn attend_journal(&mut self) {
        let Some(max_bytes) = self
            .journal
            .as_ref()
            .filter(|journal| journal.writer.wants_checkpoint())
            .map(|journal| journal.writer.options().max_bytes)
        else {
            return;
        };
        let Some((checkpoint, missing)) = self.checkpoint(max_bytes) else { return };
        if let Some(journal) = &mut self.journal {
            journal.writer.checkpoint(checkpoint);
            journal.missing = missing;
        }
    }

    /// All that the session is, with as many steps as half of `max_bytes` holds, and how many are missing. None
    /// within a stroke.
    fn checkpoint(&mut self, max_bytes: u64) -> Option<(Checkpoint, [usize; 2])> {
        let mut document = self.document.snapshot()?;
        // Entries after the checkpoint know no earlier pictures than those in it.
        self.pictures.retain(|path, _| self.document.has_picture(path));
        let missing =
            document.history.shorten(usize::try_from(max_bytes / 2).unwrap_or(usize::MAX));
        let pictures = self.pictures.iter();
        let pictures = pictures.map(|(path, file)| (path.clone(), file.clone())).collect();
        let limits = *self.document.limits();
        Some((Checkpoint { document, files: self.files.all(), pictures, limits }, missing))
    }

    /// Adds an executed command to the journal.
    pub(super) fn keep_command(&mut self, command: &Command, applied: Applied, took: Duration) {
        if self.journal.is_none() {
            return;
        }
        let steps = Some(applied.steps);
        let command = match command {
            // As many as there were: the journal may hold fewer than the session has.
            Command::Undo { .. } => Command::Undo { steps },
            Command::Redo { .. } => Command::Redo { steps },
            command => command.clone(),
        };
        self.keep(Entry::Command { command, mark: Mark::of(&self.document) }, took);
    }

    /// Adds a loaded picture to the journal.
    pub(super) fn keep_picture(&mut self, path: PathBuf, file: Vec<u8>) {
        let same = self.pictures.get(&path).is_some_and(|known| known[..] == file[..]);
        let file: Arc<[u8]> = file.into();
        self.pictures.insert(path.clone(), file.clone());
        self.keep(Entry::Picture { path, file: (!same).then_some(file) }, Duration::ZERO);
    }

    /// Adds an entry to the journal.
    pub(super) fn keep(&mut self, entry: Entry, took: Duration) {
        let Some(Keeping { writer, missing }) = &mut self.journal else { return };
        let history = self.document.history();
        let left = [history.undo_count(), history.redo_count()];
        let travels = matches!(
            entry,
            Entry::Command { command: Command::Undo { .. } | Command::Redo { .. }, .. }
        );
        if travels && (left[0] < missing[0] || left[1] < missing[1]) {
            // It went through steps that the journal lacks.
            writer.note_gap();
        }
        if tracing::enabled!(target: STATES, tracing::Level::TRACE) {
            let stroke = if self.document.stroke_open() { " within a stroke" } else { "" };
            let digest = Digest::of(self.document.contents());
            tracing::trace!(target: STATES, "done {} {digest}{stroke}", writer.entries() + 1);
        }
        writer.push(entry, took);
        #[cfg(debug_assertions)]
        fail_on_demand(writer.entries());
        if left[1] == 0 {
            missing[1] = 0;
        }
        self.attend_journal();
    }

    /// The entry of a file that has just been opened.
    pub(super) fn opened_entry(&self, path: &Path, texts: &Texts, assumed_up: Option<Up>) -> Entry {
        Entry::Opened {
            path: absolute(path),
            contents: self.document.share_contents(),
            texts: texts.clone(),
            assumed_up,
            mark: Mark::of(&self.document),
        }
    }
}

/// A fault for tests: after `VS_PANIC_AT` entries the program panics. Not in the program that people use.
#[cfg(debug_assertions)]
fn fail_on_demand(entries: u64) {
    let at = std::env::var("VS_PANIC_AT").ok().and_then(|text| text.parse().ok());
    assert!(at != Some(entries), "VS_PANIC_AT asked for it");
}

/// The entry of a file that was saved.
pub(super) fn saved_entry(path: &Path, state: State) -> Entry {
    Entry::Saved { path: absolute(path), state }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
}

impl Drop for Session {
    fn drop(&mut self) {
        let is_needed = self.modified() || std::thread::panicking();
        if let Some(journal) = self.journal.take() {
            journal.writer.end(!is_needed);
        }
    }
}
