//! The folder of the journals: a file `N.journal` for each, and `N.new` while a checkpoint is being written.
//!
//! The numbers identify journals to users, too. Only the session that has created `N.new` may rename it to `N.journal`,
//! so no two sessions ever write to the same one.

use std::io::{ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::persist::dir::{FileDir, UNFINISHED, create_numbered};
use crate::persist::files::{Appender, Disk, FileSystem, InputFile};

const JOURNAL: &str = "journal";

/// A folder of journals.
#[derive(Clone, Debug)]
pub struct JournalDir {
    dir: FileDir,
}

/// The state of the file at a number of the folder.
pub enum AbandonedJournal {
    /// A journal that no session writes to, open and locked.
    Journal(InputFile),
    /// The journal of a running session.
    InUse,
    /// It cannot be opened.
    Unreadable(std::io::Error),
}

impl JournalDir {
    /// Opens a folder of journals on the disk.
    pub fn new(folder: &Path) -> JournalDir {
        JournalDir::with_files(folder, Arc::new(Disk))
    }

    /// Opens a folder of journals through a file layer.
    pub fn with_files(folder: &Path, files: Arc<dyn FileSystem>) -> JournalDir {
        JournalDir { dir: FileDir::new(folder.to_path_buf(), files) }
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        self.dir.folder()
    }

    /// Returns the path of the file of a number.
    pub fn path(&self, number: u64) -> PathBuf {
        self.dir.path(number, JOURNAL)
    }

    /// Returns the numbers of all journals, ascending.
    pub fn numbers(&self) -> Result<Vec<u64>> {
        self.dir.numbers(JOURNAL)
    }

    /// Returns how many journals were left by sessions that no longer run, as far as can be determined.
    pub fn count_left(&self) -> usize {
        let numbers = self.numbers().unwrap_or_default();
        numbers
            .into_iter()
            .filter(|number| matches!(self.open(*number), AbandonedJournal::Journal(_)))
            .count()
    }

    /// Opens the journal of a number.
    pub fn open(&self, number: u64) -> AbandonedJournal {
        match self.dir.open(&self.path(number)) {
            Ok(source) => AbandonedJournal::Journal(source),
            Err(error) if error.kind() == ErrorKind::WouldBlock => AbandonedJournal::InUse,
            Err(error) => AbandonedJournal::Unreadable(error),
        }
    }

    /// Removes a journal.
    pub fn remove(&self, number: u64) -> Result<()> {
        self.dir.remove(&self.path(number))
    }

    /// Creates the unfinished file of a number that no journal has; of `own`, if given, whose journal a checkpoint is
    /// to replace.
    pub(super) fn create(&self, own: Option<u64>) -> Result<(u64, Box<dyn Appender>)> {
        self.dir.make_folder()?;
        if let Some(number) = own {
            return match self.dir.begin(number) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                    // The file of an earlier attempt that could not be removed then.
                    self.dir.abandon(number)?;
                    Ok((number, self.dir.begin(number)?))
                }
                created => Ok((number, created?)),
            };
        }
        self.remove_abandoned();
        let first = self.numbers()?.last().map_or(1, |last| last + 1);
        create_numbered(first, &[ErrorKind::AlreadyExists], |number| {
            let file = self.dir.begin(number)?;
            // Renamed after the numbers were listed: it may belong to another session by now.
            if self.numbers()?.contains(&number) {
                self.abandon(number);
                return Err(ErrorKind::AlreadyExists.into());
            }
            Ok(file)
        })
    }

    /// Turns the unfinished file of a number into its journal.
    pub(super) fn publish(&self, number: u64) -> Result<()> {
        self.dir.publish(number, &self.path(number))
    }

    /// Returns whether a number has an unfinished file, as far as can be determined.
    pub(super) fn is_unfinished(&self, number: u64) -> bool {
        self.dir.is_unfinished(number)
    }

    /// Removes the unfinished file of a number. If this fails, the next session removes it.
    pub(super) fn abandon(&self, number: u64) {
        let _ = self.dir.abandon(number);
    }

    /// Removes the unfinished files of killed sessions.
    fn remove_abandoned(&self) {
        for number in self.dir.numbers(UNFINISHED).unwrap_or_default() {
            if self.dir.is_left(&self.dir.unfinished(number)) {
                self.abandon(number);
            }
        }
    }
}
