//! The identities of the sculptures' files when the session read or wrote them, so that contents that another program
//! has put there since are not overwritten unseen.
//!
//! Length and hash count, not times: these are coarse on some disks, and programs that copy files set them. Only .vsc files
//! are remembered; volumes are written for other programs, under names that are asked for each time. Writes no file.

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
    /// That of the file at `path`; none if it cannot be read, or is no sculpture by its name.
    pub fn of(path: &Path) -> Option<FileIdentity> {
        if !format::is_sculpture(path) {
            return None;
        }
        // A pipe would be waited for.
        let bytes = fs::metadata(path).ok().filter(|found| found.is_file())?.len();
        let hash = hash_of(path)
            .inspect_err(|error| tracing::warn!("cannot hash {}: {error}", path.display()));
        Some(FileIdentity { bytes, hash: hash.ok()? })
    }

    /// Whether the file at `path` is still this one. Where it is gone, or no file, there is nothing to lose, so the
    /// answer is yes. Where it cannot be read, its contents are unknown, so the answer is no.
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
    /// Notes what the file at `path` is like; none forgets it.
    pub fn learn(&mut self, path: &Path, identity: Option<FileIdentity>) {
        match identity {
            Some(identity) => self.known.insert(key(path), identity),
            None => self.known.remove(&key(path)),
        };
    }

    /// The identity that the file at `path` had, if the session has read or written it.
    pub fn known(&self, path: &Path) -> Option<FileIdentity> {
        self.known.get(&key(path)).copied()
    }
}

/// A path that does not depend on how the folder was written. A link to a file is no other name for it: led
/// elsewhere meanwhile, it leads to another file.
pub(super) fn key(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let folder = absolute.parent().and_then(|folder| folder.canonicalize().ok());
    match (folder, absolute.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => absolute,
    }
}
