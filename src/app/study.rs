//! Reads a file for the import dialog on a thread, while the window stays alive.
//!
//! The contents of the file, or the reason why it cannot be read, go to the dialog. Knows no
//! window.

use std::path::PathBuf;
use std::sync::PoisonError;

use super::workspace::Workspace;
use crate::editor::job::Failure;
use crate::format::options::ImportOptions;
use crate::format::{self, FormatError};
use crate::progress::Report;
use crate::remedy::told;

impl Workspace {
    /// Starts to read a file that is to be imported; the dialog closes where there is other work.
    pub(super) fn start_study(&mut self, path: PathBuf, import: ImportOptions) {
        let limits = *self.session().document().limits();
        let news = self.ui.dialogs.import.news();
        let work = move |report: &Report| {
            let found = match format::study(&path, &import, &limits, report) {
                Err(FormatError::Cancelled) => return Err(Failure::Cancelled),
                found => found.map_err(|error| told(&error)),
            };
            *news.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
            Ok(String::new())
        };
        if !self.editor.start_side_work(work, "Reading") {
            self.ui.dialogs.import.close();
        }
    }
}
