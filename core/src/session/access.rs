//! The access of a session to the files of its sculptures, and other programs that have them open.
//!
//! The file of the present sculpture stays locked ([`lock`](super::lock)) while that sculpture is the present one, if
//! [`FileAccess`] says so. Undo and redo past `open` release one lock and take another. A file is locked at least while
//! it is saved. Only .vsc files are locked; volumes are written for other programs.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::error::SessionError;
use super::lock::{self, FileLock, Holder, LockResult};
use super::on_disk::key;
use crate::format;

/// How a session treats the files of its sculptures.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum FileAccess {
    /// Locked only while they are saved, as suits a short script.
    #[default]
    Brief,
    /// The present one stays locked, so that other programs know of it.
    Locked,
    /// Not locked; opened files are not overwritten.
    ReadOnly,
}

/// The present sculpture's file.
#[derive(Debug)]
struct Present {
    /// `None` if it is not locked.
    path: Option<PathBuf>,
    taken: LockResult,
}

/// A session's record of write access.
#[derive(Debug, Default)]
pub(super) struct Access {
    mode: FileAccess,
    /// `None` until it is determined.
    present: Option<Present>,
    /// Whether the person has yet to be told that another program has the file open.
    is_news: bool,
    /// Files that must not be overwritten.
    read_only: HashSet<PathBuf>,
}

impl Access {
    /// Returns whether this session holds the lock of the file at `path`.
    pub fn holds(&self, path: &Path) -> bool {
        self.present.as_ref().is_some_and(|present| {
            matches!(present.taken, LockResult::Ours(_)) && present.path == Some(key(path))
        })
    }

    /// Makes the file at `path`, which was locked for that, the present one.
    pub(crate) fn adopt(&mut self, path: &Path, lock: Option<FileLock>) {
        if let Some(lock) = lock.filter(|_| self.mode == FileAccess::Locked) {
            self.present = Some(Present { path: Some(key(path)), taken: LockResult::Ours(lock) });
            self.is_news = false;
        }
    }

    /// Notes that a file was opened.
    pub fn opened(&mut self, path: &Path) {
        if self.mode == FileAccess::ReadOnly {
            self.read_only.insert(key(path));
        }
    }

    /// Changes how files are treated from now on, including the file of the present sculpture at `path`.
    pub fn set_mode(&mut self, mode: FileAccess, path: Option<&Path>) {
        self.mode = mode;
        if let Some(path) = path {
            self.opened(path);
        }
        self.follow(path);
    }

    /// Returns how files are treated.
    pub fn mode(&self) -> FileAccess {
        self.mode
    }

    /// Returns the other program that has the present sculpture's file open, if there is one. Reports it once.
    pub fn take_foreign_holder(&mut self) -> Option<Holder> {
        if !std::mem::take(&mut self.is_news) {
            return None;
        }
        match &self.present.as_ref()?.taken {
            LockResult::Foreign(holder) => Some(holder.clone()),
            _ => None,
        }
    }

    /// Returns whether the file at `path` must not be overwritten.
    pub fn is_read_only(&self, path: &Path) -> bool {
        self.read_only.contains(&key(path))
    }

    /// Protects the file at `path` from being overwritten from now on.
    pub fn keep_read_only(&mut self, path: &Path) {
        self.read_only.insert(key(path));
    }

    /// Returns an error if the file was opened read-only.
    pub(crate) fn require_may_write(&self, path: &Path) -> Result<(), SessionError> {
        match self.is_read_only(path) {
            true => Err(SessionError::ReadOnly { path: path.to_path_buf() }),
            false => Ok(()),
        }
    }

    /// Locks the file of the present sculpture at `path`, and releases the lock of any other.
    pub fn follow(&mut self, path: Option<&Path>) {
        let is_locked =
            |path: &&Path| self.mode == FileAccess::Locked && format::is_sculpture(path);
        let path = path.filter(is_locked).map(key);
        if self.present.as_ref().is_some_and(|present| present.path == path) {
            return;
        }
        // The former lock is released first: the new one may be for the same file by another name.
        self.present = None;
        let taken = path.as_deref().map_or(LockResult::Without, lock::take);
        self.is_news = matches!(taken, LockResult::Foreign(_));
        self.present = Some(Present { path, taken });
    }
}

/// Returns the lock for saving the file at `path`; `None` if it cannot be locked or the lock is held already.
pub(super) fn lock_to_save(path: &Path, is_held: bool) -> Result<Option<FileLock>, SessionError> {
    if is_held || !format::is_sculpture(path) {
        return Ok(None);
    }
    match lock::take(path) {
        LockResult::Ours(lock) => Ok(Some(lock)),
        LockResult::Without => Ok(None),
        LockResult::Foreign(holder) => {
            Err(SessionError::InUse { path: path.to_path_buf(), holder })
        }
    }
}
