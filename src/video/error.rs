//! Errors of video sources, as values with messages for users.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The reason why there are no frames, or no more.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The text is not an address of a video.
    #[error("cannot use the video address {text:?}: {problem}")]
    Address { text: String, problem: String },
    /// An operation on a file, device or connection failed.
    #[error("{subject}: {error}")]
    Io { subject: String, error: io::Error },
    /// The data violate their format.
    #[error("{subject}: {problem}")]
    Malformed { subject: String, problem: String },
    /// Valid, but not supported.
    #[error("{subject}: {problem}")]
    Unsupported { subject: String, problem: String },
    /// The camera exists and sends nothing.
    #[error("{subject}: no picture for {seconds} s")]
    Silent { subject: String, seconds: u64 },
    /// A driver's or decoder's library panicked; its message went to the log.
    #[error("{subject}: the library that decodes it has failed")]
    Panicked { subject: String },
}

impl VideoError {
    pub(super) fn io(subject: impl Into<String>, error: impl Into<io::Error>) -> VideoError {
        VideoError::Io { subject: subject.into(), error: error.into() }
    }

    pub(super) fn malformed(subject: impl Into<String>, problem: impl Into<String>) -> VideoError {
        VideoError::Malformed { subject: subject.into(), problem: problem.into() }
    }

    pub(super) fn unsupported(
        subject: impl Into<String>,
        problem: impl Into<String>,
    ) -> VideoError {
        VideoError::Unsupported { subject: subject.into(), problem: problem.into() }
    }
}

/// Turns a panic of `work` into an error. Libraries for cameras and codecs have assertions about drivers and files,
/// which must not cost more than the frame or the source.
///
/// State that `work` modifies must be harmless when half done: frames not yet shown, readers not used again.
pub(super) fn guarded<T>(
    subject: &str,
    work: impl FnOnce() -> Result<T, VideoError>,
) -> Result<T, VideoError> {
    catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|_| Err(VideoError::Panicked { subject: subject.into() }))
}
