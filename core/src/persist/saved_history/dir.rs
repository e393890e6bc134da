//! The folder of the histories of saved files: `HASH.undo` for a file with that hash, and `N.new` while one is being
//! written, which is renamed once it is complete and on disk.
//!
//! There is at most one history for each path: when a file is saved again, the history of its previous contents is
//! removed.

use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::file::{self, HistoryToKeep, SavedHistory};
use crate::format::FormatError;
use crate::persist::dir::{FileDir, UNFINISHED, create_numbered};
use crate::persist::files::{Disk, FileSystem};
use crate::persist::frame::RecordAppender;
use crate::sculpture::history::Contents;
use crate::sculpture::{Digest, Limits};

const HISTORY: &str = "undo";

/// Greatest number of histories in a folder, however small.
const MAX_HISTORIES: usize = 1000;

/// The location and the limits of the histories of saved files.
#[derive(Clone, Debug)]
pub struct SavedHistoryOptions {
    /// The folder of the files.
    pub folder: PathBuf,
    /// The file layer.
    pub files: Arc<dyn FileSystem>,
    /// Greatest size of all histories together in bytes. A single one takes at most half of it.
    pub max_bytes: u64,
}

impl SavedHistoryOptions {
    /// Returns the options for a folder on the disk, with at most `max_bytes`.
    pub fn new(folder: &Path, max_bytes: u64) -> SavedHistoryOptions {
        SavedHistoryOptions { folder: folder.to_path_buf(), files: Arc::new(Disk), max_bytes }
    }
}

/// The result of a search for the history of a file.
#[derive(Debug)]
pub enum FoundHistory {
    /// No history is kept.
    Nothing,
    /// The steps that can be undone and redone.
    History(SavedHistory),
    /// A history exists that cannot be used: the reason, as a part of a sentence.
    Unusable(String),
}

/// A folder of histories.
#[derive(Clone, Debug)]
pub struct HistoryDir {
    dir: FileDir,
    max_bytes: u64,
}

impl HistoryDir {
    pub fn new(options: &SavedHistoryOptions) -> HistoryDir {
        let SavedHistoryOptions { folder, files, max_bytes } = options.clone();
        HistoryDir { dir: FileDir::new(folder, files), max_bytes }
    }

    fn path(&self, hash: Digest) -> PathBuf {
        self.dir.path(hash, HISTORY)
    }

    /// Returns the history of a file with this hash.
    pub fn find(&self, file_hash: Digest, contents: &Contents, limits: &Limits) -> FoundHistory {
        let path = self.path(file_hash);
        let source = match self.dir.open_shared(&path) {
            Ok(source) => source,
            Err(error) if error.kind() == ErrorKind::NotFound => return FoundHistory::Nothing,
            Err(error) => return FoundHistory::Unusable(error.to_string()),
        };
        match file::read(source, file_hash, contents, limits) {
            Ok(history) => FoundHistory::History(history),
            // The rest of the error message concerns sculptures.
            Err(FormatError::Damaged(what)) => FoundHistory::Unusable(what.to_string()),
            Err(error) => FoundHistory::Unusable(error.to_string()),
        }
    }

    /// Writes a history, removes the one of the file's previous contents, and removes the oldest ones beyond the limit.
    pub fn keep(&self, history: HistoryToKeep, is_given_up: &AtomicBool) -> Result<()> {
        self.dir.make_folder()?;
        self.remove_abandoned();
        let own = self.path(history.file_hash);
        if !history.steps.is_empty() && !self.write(&history, &own, is_given_up)? {
            return Ok(());
        }
        self.remove_of(&history.path, &own);
        self.dir.keep_within(HISTORY, &own, self.max_bytes, MAX_HISTORIES);
        Ok(())
    }

    /// Writes the file of a history. Returns false if it was abandoned.
    fn write(&self, history: &HistoryToKeep, own: &Path, is_given_up: &AtomicBool) -> Result<bool> {
        let (number, mut new) = self.create()?;
        let mut append = |record| new.append(record).map(drop);
        let written = file::write(history, self.max_bytes / 2, is_given_up, &mut append)
            .map_err(|error| match error {
                FormatError::Io(error) => error,
                error => Error::other(error.to_string()),
            })
            .and_then(|is_whole| new.sync().map(|()| is_whole))
            .and_then(|is_whole| match is_whole {
                true => self.dir.publish(number, own).map(|()| true),
                false => Ok(false),
            });
        if !matches!(written, Ok(true)) {
            // If this fails, the next write of a history removes it.
            let _ = self.dir.abandon(number);
        }
        written
    }

    /// Creates an unfinished file, locked and with its header: without the header it might be taken for an abandoned
    /// one.
    fn create(&self) -> Result<(u64, RecordAppender)> {
        // It belongs to another session, or was just taken for an abandoned one.
        let taken = [ErrorKind::AlreadyExists, ErrorKind::WouldBlock];
        let process = u64::from(std::process::id());
        let (number, file) = create_numbered(process, &taken, |number| self.dir.begin(number))?;
        let mut new = RecordAppender::new(file);
        new.append_head().inspect_err(|_| {
            let _ = self.dir.abandon(number);
        })?;
        Ok((number, new))
    }

    /// Removes the unfinished files of killed sessions.
    fn remove_abandoned(&self) {
        for path in self.dir.paths(UNFINISHED).unwrap_or_default() {
            if self.dir.is_left(&path) {
                self.dir.remove_needless(&path);
            }
        }
    }

    /// Removes the histories that were kept for `path`, except `own`: they belong to previous contents of the file.
    fn remove_of(&self, path: &Path, own: &Path) {
        let histories = self.dir.paths(HISTORY).unwrap_or_default();
        for other in histories.iter().filter(|other| *other != own) {
            let kept_for = self.dir.open_shared(other).ok().and_then(file::path_of);
            if kept_for.is_some_and(|kept_for| kept_for == path) {
                self.dir.remove_needless(other);
            }
        }
    }
}
