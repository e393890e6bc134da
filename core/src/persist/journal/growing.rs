//! The file of a journal that is being written: records are appended while a sync may run concurrently.

use std::io::ErrorKind;
use std::thread::JoinHandle;

use crate::format::FormatError;
use crate::persist::files::Appender;
use crate::persist::frame::{RecordAppender, RecordBuffer};

/// A file to which entries are appended.
#[derive(Debug)]
pub(super) struct GrowingJournal {
    file: RecordAppender,
    /// Total size of its records in bytes.
    pub bytes: u64,
    /// Size from which it is rewritten from a checkpoint.
    pub compact_at: u64,
    /// A sync that runs concurrently with writing.
    syncing: Option<JoinHandle<std::io::Result<()>>>,
}

impl GrowingJournal {
    /// Wraps an empty file.
    pub fn new(file: Box<dyn Appender>) -> GrowingJournal {
        let file = RecordAppender::new(file);
        GrowingJournal { file, bytes: 0, compact_at: u64::MAX, syncing: None }
    }

    /// Returns whether it still has a name.
    pub fn is_there(&self) -> bool {
        self.file.is_there()
    }

    /// Appends the header.
    pub(crate) fn append_head(&mut self) -> std::io::Result<()> {
        self.file.append_head()
    }

    /// Appends a record.
    pub fn append(&mut self, record: RecordBuffer) -> Result<(), Trouble> {
        self.bytes += self.file.append(record)?;
        Ok(())
    }

    /// Waits until everything is on disk.
    pub fn sync(&mut self) -> std::io::Result<()> {
        self.file.sync()
    }

    /// Returns whether a sync is running.
    pub(crate) fn is_syncing(&self) -> bool {
        self.syncing.is_some()
    }

    /// Starts syncing the written data while entries continue to be written. A busy disk may take long, but written
    /// data survives at least the process. Where no thread can sync concurrently, syncs at once.
    pub(crate) fn begin_sync(&mut self) -> std::io::Result<()> {
        let thread = self.file.syncer().and_then(|sync| {
            std::thread::Builder::new().name("journal sync".to_string()).spawn(sync).ok()
        });
        self.syncing = thread;
        if self.syncing.is_some() { Ok(()) } else { self.file.sync() }
    }

    /// Collects a running sync, if it has ended or `patiently`.
    pub(crate) fn end_sync(&mut self, patiently: bool) -> std::io::Result<()> {
        match self.syncing.take_if(|thread| patiently || thread.is_finished()) {
            Some(thread) => {
                thread.join().unwrap_or_else(|_| Err(std::io::Error::other("panicked")))
            }
            None => Ok(()),
        }
    }
}

/// The reason why something could not be written.
#[derive(Debug, thiserror::Error)]
pub(super) enum Trouble {
    #[error("{0}")]
    Io(#[from] std::io::Error),
    #[error("{0}")]
    Format(#[from] FormatError),
}

impl Trouble {
    /// Returns the remedy for the user, as a part of a sentence.
    pub fn remedy(&self) -> &'static str {
        let kind = match self {
            Trouble::Io(error) | Trouble::Format(FormatError::Io(error)) => error.kind(),
            Trouble::Format(_) => ErrorKind::Other,
        };
        match kind {
            ErrorKind::StorageFull => "make room on that disk",
            ErrorKind::QuotaExceeded => {
                "your quota of that disk is used up, so remove files of yours there"
            }
            ErrorKind::PermissionDenied => "give your account the right to write to that folder",
            ErrorKind::ReadOnlyFilesystem => {
                "that disk is write-protected, so have it mounted for writing"
            }
            _ => "see to that disk and its folder",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_trouble_has_a_remedy_of_its_own() {
        let remedy = |kind| Trouble::Io(std::io::Error::from(kind)).remedy();
        for (kind, word) in [
            (ErrorKind::StorageFull, "room"),
            (ErrorKind::QuotaExceeded, "quota"),
            (ErrorKind::PermissionDenied, "right to write"),
            (ErrorKind::ReadOnlyFilesystem, "write-protected"),
        ] {
            assert!(remedy(kind).contains(word), "{kind}: {}", remedy(kind));
        }
        let full = FormatError::Io(ErrorKind::StorageFull.into());
        assert!(Trouble::from(full).remedy().contains("room"));
    }
}
