//! The reasons why a session refuses a command, worded for the person.

use std::path::PathBuf;

use thiserror::Error;

use super::lock::Holder;
use super::on_disk::FileIdentity;
use crate::document::CommandError;
use crate::format::FormatError;

/// Why a command failed. The sculpture is as it was before.
#[derive(Debug, Error)]
pub enum SessionError {
    /// The document has refused the command.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// A file cannot be read.
    #[error("cannot open {path}: {error}")]
    Open {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: FormatError,
    },
    /// A file cannot be written.
    #[error("cannot save {path}: {error}")]
    Save {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: FormatError,
    },
    /// The file differs from what this session has read or written.
    #[error(
        "cannot save {path}: another program has changed it since it was opened or saved here; save under another name, \
         or open it again; to replace it, remove it first"
    )]
    ChangedOnDisk {
        /// The file.
        path: PathBuf,
        /// Its present identity; `None` if it cannot be read.
        found: Option<FileIdentity>,
    },
    /// Another program has the file open.
    #[error("cannot save {path}: {holder} has it open; close it there, or save under another name")]
    InUse {
        /// The file.
        path: PathBuf,
        /// The program that has it open.
        holder: Holder,
    },
    /// The file was opened read-only.
    #[error("cannot save {path}: it was opened read-only; save under another name")]
    ReadOnly {
        /// The file.
        path: PathBuf,
    },
    /// The image for a texture cannot be read.
    #[error("cannot read the image {path}: {error}")]
    Picture {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: FormatError,
    },
    /// The journal's file cannot be created or written.
    #[error("cannot record to {path}: {error}")]
    Journal {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: std::io::Error,
    },
    /// The journal's file already holds something.
    #[error(
        "cannot record to {path}: that file {holds}; choose another name, or move the file away"
    )]
    JournalTaken {
        /// The file.
        path: PathBuf,
        /// A description of the file's contents.
        holds: &'static str,
    },
    /// The sculpture has already been changed.
    #[error("a recording must begin before the sculpture is changed")]
    JournalLate,
}

impl SessionError {
    /// Returns whether the work was cancelled.
    pub fn is_cancelled(&self) -> bool {
        use SessionError::{Open, Save};
        match self {
            Open { error, .. } | Save { error, .. } => matches!(error, FormatError::Cancelled),
            SessionError::Command(error) => matches!(error, CommandError::Cancelled),
            _ => false,
        }
    }
}
