//! Long work started by the window: films, final pictures, checks, files being inspected, and the recovery of earlier
//! sessions.
//!
//! Other files build each kind of work; this one starts it and follows it until it is done. Knows no window.

use std::path::PathBuf;

use super::view_source::ViewSource;
use super::workspace::Workspace;
use super::{film, final_picture, print_check, study};
use crate::format::options::ImportOptions;
use crate::persist::journal::JournalOptions;
use crate::print_check::CheckOptions;
use crate::ui::dialogs::final_picture::Preview;
use crate::ui::pictures::{FilmRequest, FinalRequest};
use crate::view::Eye;

impl Workspace {
    /// Waits for long work, if there is any, and applies its result.
    pub fn finish_job(&mut self) {
        self.editor.finish_job();
        self.settle();
    }

    /// Applies the result of long work that has ended.
    pub(super) fn follow_job(&mut self) {
        self.editor.follow_job();
        self.settle();
    }

    fn view_source(&self, eye: Eye) -> ViewSource<'_> {
        let (session, view) = (self.session(), &self.ui.view);
        ViewSource { session, view, eye, device: &self.render_device }
    }

    /// Starts a final picture of the view, from the eye of the window (the left one of two).
    pub(super) fn start_final_picture(&mut self, wanted: &FinalRequest) {
        let Some(eye) = self.eyes().first().copied() else { return };
        let preview = Preview::default();
        let work = final_picture::work(&self.view_source(eye), wanted, &preview);
        if self.editor.start_side_work(work, "Final picture") {
            self.ui.dialogs.preview = Some(preview);
        }
    }

    /// Starts a film.
    pub(super) fn start_film(&mut self, wanted: &FilmRequest) {
        match film::work(&self.view_source(self.eye()), &self.config, wanted) {
            Ok(work) => {
                self.editor.start_side_work(work, "Film");
            }
            Err(text) => self.ui.toasts.error(text),
        }
    }

    /// Starts reading a file for import. The dialog closes if there is other work.
    pub(super) fn start_study(&mut self, path: PathBuf, import: ImportOptions) {
        let limits = *self.session().document().limits();
        let work = study::work(path, import, limits, &self.ui.dialogs.import);
        if !self.editor.start_side_work(work, "Reading") {
            self.ui.dialogs.import.close();
        }
    }

    /// Opens the window of the print check, which runs unless the sculpture has been checked, or closes it.
    pub(super) fn toggle_print_check(&mut self) {
        let window = &mut self.ui.dialogs.print_check;
        window.open ^= true;
        if window.open && !window.is_current(self.editor.document()) {
            let options = window.options;
            self.start_print_check(options);
        }
    }

    /// Starts a print check.
    pub(super) fn start_print_check(&mut self, options: CheckOptions) {
        let window = &self.ui.dialogs.print_check;
        let work = print_check::work(self.editor.document(), options, window);
        self.editor.start_side_work(work, "Print check");
    }

    /// Starts reading the journals of earlier sessions for the dialog, if there are any.
    pub fn look_for_left(&mut self, journals: JournalOptions) {
        if self.abandoned.look_in(journals) {
            self.read_left("");
        }
    }

    /// Does the same at the person's request, with a message if there is nothing.
    pub(super) fn list_left(&mut self) {
        self.read_left("There is no unsaved work of earlier sessions");
    }

    /// Starts reading the journals. `none`: the message if nothing is found.
    fn read_left(&mut self, none: &'static str) {
        let limits = *self.session().document().limits();
        if let Some(work) = self.abandoned.list(none, limits, &self.ui.dialogs.recovery) {
            self.editor.start_side_work(work, "Looking for unsaved work");
        }
    }

    /// Restores the journal of this number.
    pub(super) fn start_recovery(&mut self, number: u64) {
        if let Some(work) = self.abandoned.recovery(number, self.editor.session()) {
            self.ui.dialogs.recovery.close();
            self.editor.start_recovery(work);
        }
    }

    /// Removes the unwanted journal of this number.
    pub(super) fn discard_left(&mut self, number: u64) {
        match self.abandoned.discard(number) {
            Some(Ok(())) => self.ui.dialogs.recovery.remove(number),
            Some(Err(text)) => self.ui.toasts.error(text),
            None => {}
        }
    }
}
