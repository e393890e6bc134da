//! Owns the ways in which a source of video fails, as values with a text for people.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Why there is no picture, or no more.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The text does not say where to find a video.
    #[error("cannot use the video address {text:?}: {problem}")]
    Address { text: String, problem: String },
    /// A file, device or connection did not do as asked.
    #[error("{subject}: {error}")]
    Io { subject: String, error: io::Error },
    /// What came is not what its format promises.
    #[error("{subject}: {problem}")]
    Malformed { subject: String, problem: String },
    /// Well formed, but this program has no way to show it.
    #[error("{subject}: {problem}")]
    Unsupported { subject: String, problem: String },
    /// The camera is there and silent.
    #[error("{subject}: no picture for {seconds} s")]
    Silent { subject: String, seconds: u64 },
    /// A driver's or decoder's library gave up with a panic; its message went to the log.
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

/// Turns a panic of `work` into an error. Libraries for cameras and codecs assert what drivers and
/// strangers' files promise; that must not cost more than the picture or the source.
///
/// What `work` changes must be harmless half done: pictures not yet shown, readers not used again.
pub(super) fn guarded<T>(
    subject: &str,
    work: impl FnOnce() -> Result<T, VideoError>,
) -> Result<T, VideoError> {
    catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|_| Err(VideoError::Panicked { subject: subject.into() }))
}
