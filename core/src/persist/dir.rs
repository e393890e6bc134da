//! A folder of files of one kind, named `STEM.ENDING`, for journals, saved histories and undo steps: names, lists,
//! numbers, creates and publishes files, and removes old or abandoned ones.
//!
//! A file of [`FileDir`] is written as `N.new`, locked, and renamed once it is complete and on disk; an `N.new` without
//! a lock was left by a killed session. The files of [`spill`](super::spill) share only [`path_in`], [`has_ending`] and
//! [`create_numbered`]: they are never published, an empty one may be in use, and an abandoned one is locked until it
//! is removed. Knows no contents; callers define the meaning of endings.

use std::cmp::Reverse;
use std::fmt::Display;
use std::io::{ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::files::{Appender, FileSystem, InputFile};

/// The ending of an incomplete file.
pub(super) const UNFINISHED: &str = "new";

/// A folder of files that are published when they are complete.
#[derive(Clone, Debug)]
pub(super) struct FileDir {
    files: Arc<dyn FileSystem>,
    folder: PathBuf,
}

impl FileDir {
    pub fn new(folder: PathBuf, files: Arc<dyn FileSystem>) -> FileDir {
        FileDir { files, folder }
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Creates the folder; does nothing if it exists.
    pub fn make_folder(&self) -> Result<()> {
        self.files.make_folder(&self.folder)
    }

    /// Returns the path of a file of the folder.
    pub fn path(&self, stem: impl Display, ending: &str) -> PathBuf {
        path_in(&self.folder, stem, ending)
    }

    /// Returns the files with an ending.
    pub fn paths(&self, ending: &str) -> Result<Vec<PathBuf>> {
        let mut paths = self.files.list(&self.folder)?;
        paths.retain(|path| has_ending(path, ending));
        Ok(paths)
    }

    /// Returns the numbers of the files with an ending that are named by a number, ascending.
    pub fn numbers(&self, ending: &str) -> Result<Vec<u64>> {
        let number = |path: &PathBuf| path.file_stem()?.to_str()?.parse().ok();
        let mut numbers: Vec<u64> = self.paths(ending)?.iter().filter_map(number).collect();
        numbers.sort_unstable();
        Ok(numbers)
    }

    /// Opens a file and locks it: [`FileSystem::open`].
    pub fn open(&self, path: &Path) -> Result<InputFile> {
        self.files.open(path)
    }

    /// Opens a complete file: [`FileSystem::open_shared`].
    pub fn open_shared(&self, path: &Path) -> Result<InputFile> {
        self.files.open_shared(path)
    }

    pub fn remove(&self, path: &Path) -> Result<()> {
        self.files.remove(path)
    }

    /// Removes a file that is no longer needed. Logs a failure.
    pub(crate) fn remove_needless(&self, path: &Path) {
        if let Err(error) = self.files.remove(path)
            && error.kind() != ErrorKind::NotFound
        {
            tracing::warn!("cannot remove {}: {error}", path.display());
        }
    }

    /// Creates the unfinished file of a number, which must not exist, and locks it.
    pub fn begin(&self, number: u64) -> Result<Box<dyn Appender>> {
        self.files.create(&self.unfinished(number))
    }

    /// Returns the path of the unfinished file of a number.
    pub fn unfinished(&self, number: u64) -> PathBuf {
        self.path(number, UNFINISHED)
    }

    /// Renames the unfinished file of a number to its final name, durably.
    pub fn publish(&self, number: u64, path: &Path) -> Result<()> {
        self.files.rename(&self.unfinished(number), path)
    }

    /// Returns whether a number has an unfinished file, as far as can be determined.
    pub(crate) fn is_unfinished(&self, number: u64) -> bool {
        self.numbers(UNFINISHED).is_ok_and(|numbers| numbers.contains(&number))
    }

    /// Removes the unfinished file of a number.
    pub(crate) fn abandon(&self, number: u64) -> Result<()> {
        self.files.remove(&self.unfinished(number))
    }

    /// Returns whether an unfinished file was left by a killed session. Those of living sessions are locked before
    /// their first byte is written.
    pub(crate) fn is_left(&self, unfinished: &Path) -> bool {
        self.files.open(unfinished).is_ok_and(|source| source.bytes > 0)
    }

    /// Removes the files with an ending that exceed the limits, the oldest first, and `newest` last, whatever its
    /// timestamp.
    pub(crate) fn keep_within(
        &self,
        ending: &str,
        newest: &Path,
        max_bytes: u64,
        max_count: usize,
    ) {
        let known = |path: PathBuf| {
            let source = self.files.open_shared(&path).ok()?;
            Some((path != newest, Reverse(source.changed_unix_s), source.bytes, path))
        };
        let paths = self.paths(ending).unwrap_or_default();
        let mut all: Vec<_> = paths.into_iter().filter_map(known).collect();
        all.sort();
        let mut bytes = 0;
        for (at, (_, _, own_bytes, path)) in all.iter().enumerate() {
            bytes += own_bytes;
            if bytes > max_bytes || at >= max_count {
                self.remove_needless(path);
            }
        }
    }
}

/// Returns the path of a file in a folder.
pub(super) fn path_in(folder: &Path, stem: impl Display, ending: &str) -> PathBuf {
    folder.join(format!("{stem}.{ending}"))
}

/// Returns whether a file has an ending.
pub(super) fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own == ending)
}

/// Creates a file under the first free number, from `first` on, and returns the number as well. `taken`: the kinds of
/// error by which `create` reports that a number is in use.
pub(super) fn create_numbered<T>(
    first: u64,
    taken: &[ErrorKind],
    mut create: impl FnMut(u64) -> Result<T>,
) -> Result<(u64, T)> {
    for number in first..=u64::MAX {
        match create(number) {
            Err(error) if taken.contains(&error.kind()) => {}
            created => return created.map(|file| (number, file)),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}
