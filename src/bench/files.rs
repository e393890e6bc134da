//! Benchmarks of files: the times to save and load a sculpture, and its size on disk.

use std::time::{Duration, Instant};

use serde::Serialize;

use super::statistics::{Times, measure};
use crate::format::options::{ExportForm, ImportOptions};
use crate::format::{self, FormatError};
use crate::sculpture::Limits;
use crate::sculpture::history::Contents;

/// One format.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct FileReport {
    /// The extension.
    pub ending: String,
    pub bytes: u64,
    /// Including the sync to disk.
    pub save: Times,
    pub load: Times,
}

/// Saves and loads in the formats of `endings`, in a temporary folder.
pub fn files(
    contents: &Contents,
    endings: &[&str],
    runs: usize,
    limits: &Limits,
) -> Result<Vec<FileReport>, FormatError> {
    let folder = tempfile::tempdir()?;
    let mut reports = Vec::new();
    for ending in endings {
        let path = folder.path().join(format!("sculpture.{ending}"));
        let timed = |f: &dyn Fn() -> Result<(), FormatError>| {
            measure(runs, || {
                let start = Instant::now();
                f()?;
                Ok::<Duration, FormatError>(start.elapsed())
            })
        };
        let save = timed(&|| format::save(&path, contents, ExportForm::Auto, &()))?;
        let load =
            timed(&|| format::load(&path, &ImportOptions::default(), limits, &()).map(|_| ()))?;
        let bytes = std::fs::metadata(&path)?.len();
        let (Some(save), Some(load)) = (save, load) else { continue };
        reports.push(FileReport { ending: ending.to_string(), bytes, save, load });
    }
    Ok(reports)
}
