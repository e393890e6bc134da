//! The access of a session to the files of its sculptures, and the other programs that have them open.
//!
//! The file of the present sculpture is locked ([`lock`](super::lock)) as long as it is the present one, if
//! [`FileAccess`] says so; undo and redo past `open` give one back and take the other. A file that is saved is locked
//! at least meanwhile. Only .vsc files are locked; volumes are written for other programs.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::lock::{self, FileLock, Holder, Taken};
use super::on_disk::key;
use super::{Session, SessionError};
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
    taken: Taken,
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
            matches!(present.taken, Taken::Ours(_)) && present.path == Some(key(path))
        })
    }

    /// The file at `path` has become the present one, and was locked for that.
    pub fn adopt(&mut self, path: &Path, lock: Option<FileLock>) {
        if let Some(lock) = lock.filter(|_| self.mode == FileAccess::Locked) {
            self.present = Some(Present { path: Some(key(path)), taken: Taken::Ours(lock) });
            self.is_news = false;
        }
    }

    /// A file was opened.
    pub fn opened(&mut self, path: &Path) {
        if self.mode == FileAccess::ReadOnly {
            self.read_only.insert(key(path));
        }
    }
}

impl Session {
    /// Changes how files are treated from now on, that of the present sculpture included.
    pub fn set_file_access(&mut self, mode: FileAccess) {
        self.access.mode = mode;
        if let Some(path) = self.path().map(Path::to_path_buf) {
            self.access.opened(&path);
        }
        self.follow_file();
    }

    /// How files are treated.
    pub fn file_access(&self) -> FileAccess {
        self.access.mode
    }

    /// The other program that has the present sculpture's file open, if there is one. Returned once.
    pub fn take_foreign_holder(&mut self) -> Option<Holder> {
        if !std::mem::take(&mut self.access.is_news) {
            return None;
        }
        match &self.access.present.as_ref()?.taken {
            Taken::Foreign(holder) => Some(holder.clone()),
            _ => None,
        }
    }

    /// Whether the present sculpture's file is not to be overwritten.
    pub fn is_read_only(&self) -> bool {
        self.path().is_some_and(|path| self.access.read_only.contains(&key(path)))
    }

    /// Does not overwrite the present sculpture's file from now on.
    pub fn keep_read_only(&mut self) {
        if let Some(path) = self.path() {
            let path = key(path);
            self.access.read_only.insert(path);
        }
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

    /// Refuses to overwrite a file that was opened to be read only.
    pub(super) fn require_may_write(&self, path: &Path) -> Result<(), SessionError> {
        match self.access.read_only.contains(&key(path)) {
            true => Err(SessionError::ReadOnly { path: path.to_path_buf() }),
            false => Ok(()),
        }
    }

    /// Locks the file of the present sculpture, and gives back the lock of any other.
    pub(super) fn follow_file(&mut self) {
        let is_locked =
            |path: &&Path| self.access.mode == FileAccess::Locked && format::is_sculpture(path);
        let path = self.path().filter(is_locked).map(key);
        if self.access.present.as_ref().is_some_and(|present| present.path == path) {
            return;
        }
        // The former lock first: the new one may be of the same file by another name.
        self.access.present = None;
        let taken = path.as_deref().map_or(Taken::Without, lock::take);
        self.access.is_news = matches!(taken, Taken::Foreign(_));
        self.access.present = Some(Present { path, taken });
    }
}

/// The lock with which the file at `path` is saved; none where there can be none, or where it is held already.
pub(super) fn lock_to_save(path: &Path, is_held: bool) -> Result<Option<FileLock>, SessionError> {
    if is_held || !format::is_sculpture(path) {
        return Ok(None);
    }
    match lock::take(path) {
        Taken::Ours(lock) => Ok(Some(lock)),
        Taken::Without => Ok(None),
        Taken::Foreign(holder) => Err(SessionError::InUse { path: path.to_path_buf(), holder }),
    }
}
