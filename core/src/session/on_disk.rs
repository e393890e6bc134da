//! The identities of the sculptures' files when the session read or wrote them, so that later contents from another
//! program are not overwritten unnoticed.
//!
//! Length and hash count, not times: these are coarse on some disks, and programs that copy files set them. Only .vsc
//! files are remembered; volumes are written for other programs, under names that are asked for each time. Writes no
//! file.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{ErrorKind, Result};
use std::path::{Path, PathBuf};

use crate::format;
use crate::sculpture::digest::Digest;

/// The identity of a file: its length and hash.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FileIdentity {
    bytes: u64,
    pub(super) hash: Digest,
}

impl FileIdentity {
    /// Returns the identity of the file at `path`; `None` if it cannot be read or its name is not that of a sculpture.
    pub fn of(path: &Path) -> Option<FileIdentity> {
        if !format::is_sculpture(path) {
            return None;
        }
        // Reading a pipe would block.
        let bytes = fs::metadata(path).ok().filter(|found| found.is_file())?.len();
        let hash = hash_of(path)
            .inspect_err(|error| tracing::warn!("cannot hash {}: {error}", path.display()));
        Some(FileIdentity { bytes, hash: hash.ok()? })
    }

    /// Returns whether the file at `path` is still this one. True if it is gone or is no file, since nothing can be
    /// lost. False if it cannot be read, since its contents are unknown.
    pub(crate) fn may_be_replaced(self, path: &Path) -> bool {
        match fs::metadata(path) {
            Ok(found) if found.is_file() => {
                found.len() == self.bytes && hash_of(path).is_ok_and(|hash| hash == self.hash)
            }
            Ok(_) => true,
            Err(error) => matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory),
        }
    }
}

fn hash_of(path: &Path) -> Result<Digest> {
    Digest::of_reader(File::open(path)?)
}

/// The files that a session has read or written.
#[derive(Debug, Default)]
pub(super) struct OnDisk {
    known: HashMap<PathBuf, FileIdentity>,
}

impl OnDisk {
    /// Notes the identity of the file at `path`; `None` forgets it.
    pub fn learn(&mut self, path: &Path, identity: Option<FileIdentity>) {
        match identity {
            Some(identity) => self.known.insert(key(path), identity),
            None => self.known.remove(&key(path)),
        };
    }

    /// Returns the identity that the file at `path` had when the session last read or wrote it, if it did.
    pub fn known(&self, path: &Path) -> Option<FileIdentity> {
        self.known.get(&key(path)).copied()
    }
}

/// Returns a path that does not depend on how the folder was written. A link is not resolved to its file: if it is
/// redirected meanwhile, it leads to another file.
pub(super) fn key(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let folder = absolute.parent().and_then(|folder| folder.canonicalize().ok());
    match (folder, absolute.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => absolute,
    }
}
