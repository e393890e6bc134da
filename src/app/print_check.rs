//! The print check from the window: runs on a thread, while the window stays alive.
//!
//! Checks the sculpture as it is at the start; the result goes to the window of the check. Knows no window.

use std::sync::PoisonError;

use super::workspace::Workspace;
use crate::editor::job::Failure;
use crate::print_check::{self, CheckError, CheckOptions};
use crate::progress::Report;
use crate::remedy::told;
use crate::ui::dialogs::print_check::Found;

impl Workspace {
    /// Opens the window of the check, which begins unless the sculpture has been checked, or closes it.
    pub(super) fn toggle_print_check(&mut self) {
        let window = &mut self.ui.dialogs.print_check;
        window.open ^= true;
        if window.open && !window.is_current(self.editor.document()) {
            let options = window.options;
            self.start_print_check(options);
        }
    }

    /// Starts a check.
    pub(super) fn start_print_check(&mut self, options: CheckOptions) {
        let document = self.session().document();
        let (contents, revision) = (document.share_contents(), document.revision());
        let budget = document.limits().grid_bytes;
        let news = self.ui.dialogs.print_check.news();
        let work = move |report: &Report| match print_check::check(
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
                let found = Found::new(checked, revision);
                *news.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
                Ok(note.to_string())
            }
            Err(CheckError::Cancelled) => Err(Failure::Cancelled),
            Err(error) => Err(Failure::Error(format!("Print check: {}", told(&error)))),
        };
        self.editor.start_side_work(work, "Print check");
    }
}
