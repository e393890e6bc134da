//! Maintains the journal of a session: adds an entry for each executed command, and a checkpoint whenever one is wanted
//! and no stroke is open.
//!
//! Takes the parts of a session that a checkpoint holds; knows no session. Nothing here waits for a disk unless asked
//! to, and no disk problem makes a command fail.

use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::files::SculptureFiles;
use super::pictures::Pictures;
use crate::command::{Command, CommandClass};
use crate::document::{Applied, Document};
use crate::format::Texts;
use crate::persist::journal::{
    Checkpoint, JournalEntry, JournalOptions, JournalWriter, Mark, STATES,
};
use crate::sculpture::Digest;
use crate::sculpture::history::State;
use crate::sculpture::orientation::Up;

/// The parts of a session that a checkpoint holds.
#[derive(Debug)]
pub(super) struct SessionParts<'a> {
    pub document: &'a Document,
    pub files: &'a SculptureFiles,
    pub pictures: &'a mut Pictures,
}

impl SessionParts<'_> {
    /// Returns the whole state of the session, with as many steps as fit into half of `max_bytes`, and the number of
    /// missing steps. `None` within a stroke.
    fn checkpoint(&mut self, max_bytes: u64) -> Option<(Checkpoint, [usize; 2])> {
        let mut document = self.document.snapshot()?;
        let missing =
            document.history.shorten(usize::try_from(max_bytes / 2).unwrap_or(usize::MAX));
        let pictures = self.pictures.loaded(self.document);
        let limits = *self.document.limits();
        Some((Checkpoint { document, files: self.files.all(), pictures, limits }, missing))
    }
}

/// The journal of a session.
#[derive(Debug)]
pub(super) struct JournalKeeper {
    writer: JournalWriter,
    /// The number of steps of the undo and of the redo list that the journal lacks: those furthest away.
    missing: [usize; 2],
}

impl JournalKeeper {
    /// Begins a journal with the present state of the session.
    ///
    /// # Errors
    /// If no thread can be made, or a stroke is open.
    pub fn begin(options: JournalOptions, mut parts: SessionParts) -> Result<JournalKeeper> {
        let Some((checkpoint, missing)) = parts.checkpoint(options.max_bytes) else {
            let text = "a journal cannot begin within a stroke";
            return Err(Error::new(ErrorKind::InvalidInput, text));
        };
        Ok(JournalKeeper { writer: JournalWriter::begin(options, checkpoint)?, missing })
    }

    /// Returns the writing thread, to query it and to wait for it.
    pub fn writer(&self) -> &JournalWriter {
        &self.writer
    }

    /// Returns the journal's file, once it has one.
    pub fn path(&self) -> Option<PathBuf> {
        Some(self.writer.options().journal_dir.path(self.writer.number()?))
    }

    /// Ends the journal. `remove`: nothing of it is needed any more.
    pub fn end(self, remove: bool) {
        self.writer.end(remove);
    }

    /// Notes a change that no entry can repeat: a checkpoint follows.
    pub(crate) fn note_gap(&mut self) {
        self.writer.note_gap();
    }

    /// Gives the journal a checkpoint if it wants one and no stroke is open.
    pub fn attend(&mut self, mut parts: SessionParts) {
        if !self.writer.wants_checkpoint() {
            return;
        }
        let checkpoint = parts.checkpoint(self.writer.options().max_bytes);
        let Some((checkpoint, missing)) = checkpoint else { return };
        self.writer.checkpoint(checkpoint);
        self.missing = missing;
    }

    /// Adds an executed command.
    pub(crate) fn keep_command(
        &mut self,
        command: &Command,
        applied: Applied,
        took: Duration,
        parts: SessionParts,
    ) {
        let steps = Some(applied.steps);
        let command = match command {
            // The actual number of steps: the journal may hold fewer than the session has.
            Command::Undo { .. } => Command::Undo { steps },
            Command::Redo { .. } => Command::Redo { steps },
            command => command.clone(),
        };
        self.keep(JournalEntry::Command { command, mark: Mark::of(parts.document) }, took, parts);
    }

    /// Adds an entry.
    pub fn keep(&mut self, entry: JournalEntry, took: Duration, parts: SessionParts) {
        let JournalKeeper { writer, missing } = self;
        let history = parts.document.history();
        let left = [history.undo_count(), history.redo_count()];
        let travels = match &entry {
            JournalEntry::Command { command, .. } => command.class() == CommandClass::Travel,
            JournalEntry::Opened { .. }
            | JournalEntry::Saved { .. }
            | JournalEntry::Picture { .. } => false,
        };
        if travels && (left[0] < missing[0] || left[1] < missing[1]) {
            // The command used steps that the journal lacks.
            writer.note_gap();
        }
        if tracing::enabled!(target: STATES, tracing::Level::TRACE) {
            let stroke = if parts.document.stroke_open() { " within a stroke" } else { "" };
            let digest = Digest::of(parts.document.contents());
            tracing::trace!(target: STATES, "done {} {digest}{stroke}", writer.entries() + 1);
        }
        writer.push(entry, took);
        #[cfg(debug_assertions)]
        fail_on_demand(writer.entries());
        if left[1] == 0 {
            missing[1] = 0;
        }
        self.attend(parts);
    }
}

/// Returns the entry for a file that has just been opened.
pub(super) fn opened_entry(
    document: &Document,
    path: &Path,
    texts: &Texts,
    assumed_up: Option<Up>,
) -> JournalEntry {
    JournalEntry::Opened {
        path: absolute(path),
        contents: document.share_contents(),
        texts: texts.clone(),
        assumed_up,
        mark: Mark::of(document),
    }
}

/// Panics after `VS_PANIC_AT` entries: a fault for tests. Not in release builds.
#[cfg(debug_assertions)]
fn fail_on_demand(entries: u64) {
    let at = std::env::var("VS_PANIC_AT").ok().and_then(|text| text.parse().ok());
    assert!(at != Some(entries), "VS_PANIC_AT asked for it");
}

/// Returns the entry for a file that was saved.
pub(super) fn saved_entry(path: &Path, state: State) -> JournalEntry {
    JournalEntry::Saved { path: absolute(path), state }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
}
