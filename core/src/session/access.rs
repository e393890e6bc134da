//! The access of a session to the files of its sculptures, and the other programs that have them open.
//!
//! The file of the present sculpture is locked ([`lock`](super::lock)) as long as it is the present one, if
//! [`FileAccess`] says so; undo and redo past `open` give one back and take the other. A file that is saved is locked
//! at least meanwhile. Only .vsc files are locked; volumes are written for other programs.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::error::SessionError;
use super::lock::{self, FileLock, Holder, LockResult};
use super::on_disk::key;
use crate::format;

/// How a session treats the files of its sculptures.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum FileAccess {
    /// They are locked only while they are saved, as suits a script that is soon over.
    #[default]
    Brief,
    /// The present one is locked, so that other programs know of it.
    Locked,
    /// They are not locked, and what was opened is not overwritten.
    ReadOnly,
}

/// The present sculpture's file.
#[derive(Debug)]
struct Present {
    /// None if it is not to be locked.
    path: Option<PathBuf>,
    taken: LockResult,
}

/// A session's record of who may write.
#[derive(Debug, Default)]
pub(super) struct Access {
    mode: FileAccess,
    /// None: to be found out.
    present: Option<Present>,
    /// The person has not been told yet that another program has it.
    is_news: bool,
    /// Files that are not to be overwritten.
    read_only: HashSet<PathBuf>,
}

impl Access {
    /// Whether the lock of the file at `path` is ours.
    pub fn holds(&self, path: &Path) -> bool {
        self.present.as_ref().is_some_and(|present| {
            matches!(present.taken, LockResult::Ours(_)) && present.path == Some(key(path))
        })
    }

    /// The file at `path` has become the present one, and was locked for that.
    pub(crate) fn adopt(&mut self, path: &Path, lock: Option<FileLock>) {
        if let Some(lock) = lock.filter(|_| self.mode == FileAccess::Locked) {
            self.present = Some(Present { path: Some(key(path)), taken: LockResult::Ours(lock) });
            self.is_news = false;
        }
    }

    /// A file was opened.
    pub fn opened(&mut self, path: &Path) {
        if self.mode == FileAccess::ReadOnly {
            self.read_only.insert(key(path));
        }
    }

    /// Changes how files are treated from now on, that of the present sculpture at `path` included.
    pub fn set_mode(&mut self, mode: FileAccess, path: Option<&Path>) {
        self.mode = mode;
        if let Some(path) = path {
            self.opened(path);
        }
        self.follow(path);
    }

    /// How files are treated.
    pub fn mode(&self) -> FileAccess {
        self.mode
    }

    /// The other program that has the present sculpture's file open, if there is one. Returned once.
    pub fn take_foreign_holder(&mut self) -> Option<Holder> {
        if !std::mem::take(&mut self.is_news) {
            return None;
        }
        match &self.present.as_ref()?.taken {
            LockResult::Foreign(holder) => Some(holder.clone()),
            _ => None,
        }
    }

    /// Whether the file at `path` is not to be overwritten.
    pub fn is_read_only(&self, path: &Path) -> bool {
        self.read_only.contains(&key(path))
    }

    /// Does not overwrite the file at `path` from now on.
    pub fn keep_read_only(&mut self, path: &Path) {
        self.read_only.insert(key(path));
    }

    /// Refuses to overwrite a file that was opened to be read only.
    pub(crate) fn require_may_write(&self, path: &Path) -> Result<(), SessionError> {
        match self.is_read_only(path) {
            true => Err(SessionError::ReadOnly { path: path.to_path_buf() }),
            false => Ok(()),
        }
    }

    /// Locks the file of the present sculpture at `path`, and gives back the lock of any other.
    pub fn follow(&mut self, path: Option<&Path>) {
        let is_locked =
            |path: &&Path| self.mode == FileAccess::Locked && format::is_sculpture(path);
        let path = path.filter(is_locked).map(key);
        if self.present.as_ref().is_some_and(|present| present.path == path) {
            return;
        }
        // The former lock first: the new one may be of the same file by another name.
        self.present = None;
        let taken = path.as_deref().map_or(LockResult::Without, lock::take);
        self.is_news = matches!(taken, LockResult::Foreign(_));
        self.present = Some(Present { path, taken });
    }
}

/// The lock with which the file at `path` is saved; none where there can be none, or where it is held already.
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
