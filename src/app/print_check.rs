//! The print check from the window: runs on a thread, while the window stays alive.
//!
//! Checks the sculpture as it is at the start; the result goes to the window of the check. Knows no window.

use std::sync::PoisonError;

use crate::document::Document;
use crate::editor::job::Failure;
use crate::print_check::{self, CheckError, CheckOptions};
use crate::progress::ProgressReport;
use crate::remedy::told;
use crate::ui::dialogs::print_check::{PrintCheck, ShownFindings};

/// Returns the work that checks the sculpture, for the window of the check.
pub(super) fn work(
    document: &Document,
    options: CheckOptions,
    window: &PrintCheck,
) -> impl FnOnce(&ProgressReport) -> Result<String, Failure> + Send + use<> {
    let (contents, revision) = (document.share_contents(), document.revision());
    let budget = document.limits().grid_bytes;
    let news = window.news();
    move |report: &ProgressReport| match print_check::check(
        &contents.grid,
        &options,
        budget,
        report,
    ) {
        Ok(checked) => {
            let note = match checked.findings.len() {
                0 if checked.is_printable() => "Print check: no faults found",
                _ if checked.is_printable() => "Print check: printable with support",
                _ => "Print check: there are faults to mend",
            };
            let found = ShownFindings::new(checked, revision);
            *news.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
            Ok(note.to_string())
        }
        Err(CheckError::Cancelled) => Err(Failure::Cancelled),
        Err(error) => Err(Failure::Error(format!("Print check: {}", told(&error)))),
    }
}
