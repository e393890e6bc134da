//! The folder in which journals lie: a file `N.journal` for each, and `N.new` while a checkpoint is written.
//!
//! Numbers say which is which to people, too. Only who has created `N.new` may name it `N.journal`, so no two
//! sessions ever write to one.

use std::io::{ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::files::{Appender, Disk, Files, Source};

const JOURNAL: &str = "journal";
const NEW: &str = "new";

/// A folder of journals.
#[derive(Clone, Debug)]
pub struct JournalDir {
    files: Arc<dyn Files>,
    folder: PathBuf,
}

/// The state of the file at a number of the folder.
pub enum AbandonedJournal {
    /// A journal that no session writes to, open and locked.
    Journal(Source),
    /// One that belongs to a session that runs.
    InUse,
    /// It cannot be opened.
    Unreadable(std::io::Error),
}

impl JournalDir {
    /// The journals in a folder of the disk.
    pub fn new(folder: &Path) -> JournalDir {
        JournalDir::with_files(folder, Arc::new(Disk))
    }

    /// The journals in a folder of any files.
    pub fn with_files(folder: &Path, files: Arc<dyn Files>) -> JournalDir {
        JournalDir { files, folder: folder.to_path_buf() }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The file of a number.
    pub fn path(&self, number: u64) -> PathBuf {
        self.folder.join(format!("{number}.{JOURNAL}"))
    }

    fn unfinished(&self, number: u64) -> PathBuf {
        self.folder.join(format!("{number}.{NEW}"))
    }

    /// The numbers of all journals, rising.
    pub fn numbers(&self) -> Result<Vec<u64>> {
        self.numbers_of(JOURNAL)
    }

    fn numbers_of(&self, ending: &str) -> Result<Vec<u64>> {
        let number = |path: &PathBuf| {
            let is_named = path.extension()? == ending;
            let stem = path.file_stem()?.to_str()?;
            is_named.then_some(stem)?.parse().ok()
        };
        let mut numbers: Vec<u64> =
            self.files.list(&self.folder)?.iter().filter_map(number).collect();
        numbers.sort_unstable();
        Ok(numbers)
    }

    /// How many journals were left by sessions that do not run any more, as far as can be seen.
    pub fn count_left(&self) -> usize {
        let numbers = self.numbers().unwrap_or_default();
        numbers
            .into_iter()
            .filter(|number| matches!(self.open(*number), AbandonedJournal::Journal(_)))
            .count()
    }

    /// Opens the journal of a number.
    pub fn open(&self, number: u64) -> AbandonedJournal {
        match self.files.open(&self.path(number)) {
            Ok(source) => AbandonedJournal::Journal(source),
            Err(error) if error.kind() == ErrorKind::WouldBlock => AbandonedJournal::InUse,
            Err(error) => AbandonedJournal::Unreadable(error),
        }
    }

    /// Removes a journal.
    pub fn remove(&self, number: u64) -> Result<()> {
        self.files.remove(&self.path(number))
    }

    /// Creates the unfinished file of a number that no journal has; of `own`, if there is one, which a checkpoint
    /// is to replace.
    pub(super) fn create(&self, own: Option<u64>) -> Result<(u64, Box<dyn Appender>)> {
        self.files.make_folder(&self.folder)?;
        if let Some(number) = own {
            let path = self.unfinished(number);
            return match self.files.create(&path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                    // That of an earlier try, which could not be removed then.
                    self.files.remove(&path)?;
                    Ok((number, self.files.create(&path)?))
                }
                created => Ok((number, created?)),
            };
        }
        self.remove_abandoned();
        let mut number = self.numbers()?.last().map_or(1, |last| last + 1);
        loop {
            match self.files.create(&self.unfinished(number)) {
                // Named after the numbers were listed: it may be another's by now.
                Ok(_) if self.numbers()?.contains(&number) => self.abandon(number),
                Ok(file) => return Ok((number, file)),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
            number += 1;
        }
    }

    /// Makes the unfinished file of a number its journal.
    pub(super) fn publish(&self, number: u64) -> Result<()> {
        self.files.rename(&self.unfinished(number), &self.path(number))
    }

    /// Whether a number has an unfinished file, as far as can be seen.
    pub(super) fn is_unfinished(&self, number: u64) -> bool {
        self.numbers_of(NEW).is_ok_and(|numbers| numbers.contains(&number))
    }

    /// Removes the unfinished file of a number. Should it stay, the next session removes it.
    pub(super) fn abandon(&self, number: u64) {
        let _ = self.files.remove(&self.unfinished(number));
    }

    /// Removes what sessions that were killed have left unfinished. Those of living ones are locked before
    /// the first byte is in them.
    fn remove_abandoned(&self) {
        for number in self.numbers_of(NEW).unwrap_or_default() {
            if self.files.open(&self.unfinished(number)).is_ok_and(|source| source.bytes > 0) {
                self.abandon(number);
            }
        }
    }
}
