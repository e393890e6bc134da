//! The folder in which the histories of saved files lie: `HASH.undo` for a file with that hash, and `N.new` while one
//! is written, which is renamed once it is whole and on the disk.
//!
//! There is one history for each path at most: when a file is saved again, that of what it held before goes.

use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::file;
use super::{Found, HistoryToKeep, SavedHistoryOptions};
use crate::format::FormatError;
use crate::journal::files::{Appender, Files};
use crate::journal::frame;
use crate::sculpture::history::Contents;
use crate::sculpture::{Digest, Limits};

const HISTORY: &str = "undo";
const NEW: &str = "new";

/// Most histories in a folder, however small.
const MAX_HISTORIES: usize = 1000;

/// A folder of histories.
#[derive(Clone, Debug)]
pub struct HistoryDir {
    files: Arc<dyn Files>,
    folder: PathBuf,
    max_bytes: u64,
}

impl HistoryDir {
    pub fn new(options: &SavedHistoryOptions) -> HistoryDir {
        let SavedHistoryOptions { folder, files, max_bytes } = options.clone();
        HistoryDir { files, folder, max_bytes }
    }

    fn path(&self, hash: Digest) -> PathBuf {
        self.folder.join(format!("{hash}.{HISTORY}"))
    }

    /// The history of a file with this hash.
    pub fn find(&self, file_hash: Digest, contents: &Contents, limits: &Limits) -> Found {
        let path = self.path(file_hash);
        let source = match self.files.open_shared(&path) {
            Ok(source) => source,
            Err(error) if error.kind() == ErrorKind::NotFound => return Found::Nothing,
            Err(error) => return Found::Unusable(error.to_string()),
        };
        match file::read(source, file_hash, contents, limits) {
            Ok(history) => Found::History(history),
            // The rest of the error message concerns sculptures.
            Err(FormatError::Damaged(what)) => Found::Unusable(what.to_string()),
            Err(error) => Found::Unusable(error.to_string()),
        }
    }

    /// Writes a history, removes that of what the file held before, and those written longest ago that the bound has
    /// no room for.
    pub fn keep(&self, history: HistoryToKeep, is_given_up: &AtomicBool) -> Result<()> {
        self.files.make_folder(&self.folder)?;
        self.remove_abandoned();
        let own = self.path(history.file_hash);
        if !history.steps.is_empty() && !self.write(&history, &own, is_given_up)? {
            return Ok(());
        }
        self.remove_of(&history.path, &own);
        self.keep_within_bounds(&own);
        Ok(())
    }

    /// Writes the file of a history. False if it was given up.
    fn write(&self, history: &HistoryToKeep, own: &Path, is_given_up: &AtomicBool) -> Result<bool> {
        let (unfinished, mut new) = self.create()?;
        let mut sequence = 0;
        let mut append = |record: frame::RecordBuffer| {
            new.append(&record.sealed(sequence))?;
            sequence += 1;
            Ok(())
        };
        let written = file::write(history, self.max_bytes / 2, is_given_up, &mut append)
            .map_err(|error| match error {
                FormatError::Io(error) => error,
                error => Error::other(error.to_string()),
            })
            .and_then(|is_whole| new.sync().map(|()| is_whole))
            .and_then(|is_whole| match is_whole {
                true => self.files.rename(&unfinished, own).map(|()| true),
                false => Ok(false),
            });
        if !matches!(written, Ok(true)) {
            // Should it stay, the next history that is written removes it.
            let _ = self.files.remove(&unfinished);
        }
        written
    }

    /// An unfinished file, locked, with the head in it: without that it might be taken for an abandoned one.
    fn create(&self) -> Result<(PathBuf, Box<dyn Appender>)> {
        let mut number = u64::from(std::process::id());
        loop {
            let path = self.folder.join(format!("{number}.{NEW}"));
            match self.files.create(&path) {
                Ok(mut new) => {
                    new.append(&frame::head()).inspect_err(|_| {
                        let _ = self.files.remove(&path);
                    })?;
                    return Ok((path, new));
                }
                // Another's, or just taken for one that was left.
                Err(error)
                    if matches!(error.kind(), ErrorKind::AlreadyExists | ErrorKind::WouldBlock) =>
                {
                    number += 1;
                }
                Err(error) => return Err(error),
            }
        }
    }

    fn named(&self, ending: &str) -> Vec<PathBuf> {
        let mut paths = self.files.list(&self.folder).unwrap_or_default();
        paths.retain(|path| path.extension().is_some_and(|own| own == ending));
        paths
    }

    /// Removes what killed sessions have left unfinished. Those of living ones are locked.
    fn remove_abandoned(&self) {
        for path in self.named(NEW) {
            if self.files.open(&path).is_ok_and(|source| source.bytes > 0) {
                self.remove(&path);
            }
        }
    }

    /// Removes the histories that were kept for `path`, but for `own`: the file does not hold that any more.
    fn remove_of(&self, path: &Path, own: &Path) {
        for other in self.named(HISTORY).iter().filter(|other| *other != own) {
            let kept_for = self.files.open_shared(other).ok().and_then(file::path_of);
            if kept_for.is_some_and(|kept_for| kept_for == path) {
                self.remove(other);
            }
        }
    }

    /// Removes those written longest ago that there is no room for, `own` last.
    fn keep_within_bounds(&self, own: &Path) {
        let known = |path: PathBuf| {
            let source = self.files.open_shared(&path).ok()?;
            Some((path != own, std::cmp::Reverse(source.changed_unix_s), source.bytes, path))
        };
        let mut all: Vec<_> = self.named(HISTORY).into_iter().filter_map(known).collect();
        all.sort();
        let mut bytes = 0;
        for (at, (_, _, own_bytes, path)) in all.iter().enumerate() {
            bytes += own_bytes;
            if bytes > self.max_bytes || at >= MAX_HISTORIES {
                self.remove(path);
            }
        }
    }

    fn remove(&self, path: &Path) {
        if let Err(error) = self.files.remove(path)
            && error.kind() != ErrorKind::NotFound
        {
            tracing::warn!("cannot remove {}: {error}", path.display());
        }
    }
}
