//! Reads a file for the import dialog on a thread, while the window stays alive.
//!
//! The contents of the file, or the reason why it cannot be read, go to the dialog. Knows no
//! window.

use std::path::PathBuf;
use std::sync::PoisonError;

use crate::document::Limits;
use crate::editor::job::Failure;
use crate::format::options::ImportOptions;
use crate::format::{self, FormatError};
use crate::progress::ProgressReport;
use crate::remedy::told;
use crate::ui::dialogs::import::ImportDialog;

/// Returns the work that reads a file for the import dialog.
pub(super) fn work(
    path: PathBuf,
    import: ImportOptions,
    limits: Limits,
    dialog: &ImportDialog,
) -> impl FnOnce(&ProgressReport) -> Result<String, Failure> + Send + use<> {
    let news = dialog.news();
    move |report: &ProgressReport| {
        let found = match format::study(&path, &import, &limits, report) {
            Err(FormatError::Cancelled) => return Err(Failure::Cancelled),
            found => found.map_err(|error| told(&error)),
        };
        *news.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
        Ok(String::new())
    }
}
