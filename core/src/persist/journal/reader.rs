//! Reads a journal: its checkpoint, then the entries in order, as far as they are valid.

use thiserror::Error;

use super::checkpoint::{Checkpoint, JournalBeginning};
use super::entry::JournalEntry;
use crate::format::FormatError;
use crate::persist::files::InputFile;
use crate::persist::frame::{Ending, FileRecords};
use crate::sculpture::Limits;

/// The reason why a journal cannot be restored.
#[derive(Debug, Error)]
pub enum JournalError {
    /// It cannot be read, or is no journal.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// Its checkpoint cannot be used.
    #[error("{0}")]
    Checkpoint(#[from] FormatError),
    /// It ends within its checkpoint.
    #[error("it ends before its checkpoint is complete")]
    Incomplete,
}

/// A journal whose checkpoint has been read.
pub struct JournalReader {
    records: FileRecords,
    beginning: JournalBeginning,
    limits: Limits,
}

impl JournalReader {
    /// Reads up to the end of the checkpoint. Contents may take as much as `limits` allow, or the limits of the
    /// recorded session if these are larger.
    pub fn open(
        source: InputFile,
        limits: &Limits,
    ) -> Result<(JournalReader, Checkpoint), JournalError> {
        let mut records = FileRecords::new(source.reader, source.bytes)?;
        let read = Checkpoint::read(&mut records, limits)?;
        let (beginning, checkpoint) = read.ok_or(JournalError::Incomplete)?;
        let limits = checkpoint.limits;
        Ok((JournalReader { records, beginning, limits }, checkpoint))
    }

    /// Returns when the session began, in seconds since 1970 by the clock of that time.
    pub fn began_unix_s(&self) -> u64 {
        self.beginning.began_unix_s
    }

    /// Returns the id of the process that wrote it.
    pub fn process(&self) -> u32 {
        self.beginning.process
    }

    /// Returns the number of unread bytes of the file.
    pub(crate) fn bytes_left(&self) -> u64 {
        self.records.bytes_left()
    }

    /// Returns why there is no further entry; `None` while there may be one.
    pub fn ending(&self) -> Option<Ending> {
        self.records.ending()
    }
}

impl Iterator for JournalReader {
    /// An error also ends the journal: entries after it cannot be interpreted.
    type Item = Result<JournalEntry, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        let record = self.records.next()?;
        Some(JournalEntry::from_record(&record, &self.limits))
    }
}
