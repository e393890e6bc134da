//! The long work that the window starts: films, final pictures, checks, files that are looked at, and what earlier
//! sessions left.
//!
//! Each kind of work is made in a file of its own from what it needs; here it is started, and followed until it is done.
//! Knows no window.

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
    /// Waits for long work, if there is any, and puts in place what came of it.
    pub fn finish_job(&mut self) {
        self.editor.finish_job();
        self.settle();
    }

    /// Takes what long work has come to.
    pub(super) fn follow_job(&mut self) {
        self.editor.follow_job();
        self.settle();
    }

    fn view_source(&self, eye: Eye) -> ViewSource<'_> {
        let (session, view) = (self.session(), &self.ui.view);
        ViewSource { session, view, eye, device: &self.render_device }
    }

    /// Starts a final picture of the view: as the eye of the window, of two the left one, sees it.
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

    /// Starts to read a file that is to be imported; the dialog closes where there is other work.
    pub(super) fn start_study(&mut self, path: PathBuf, import: ImportOptions) {
        let limits = *self.session().document().limits();
        let work = study::work(path, import, limits, &self.ui.dialogs.import);
        if !self.editor.start_side_work(work, "Reading") {
            self.ui.dialogs.import.close();
        }
    }

    /// Opens the window of the print check, which begins unless the sculpture has been checked, or closes it.
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

    /// Starts to read what earlier sessions have left, if there is anything, for the dialog.
    pub fn look_for_left(&mut self, journals: JournalOptions) {
        if self.abandoned.look_in(journals) {
            self.read_left("");
        }
    }

    /// The same when the person asks for it, with a word if there is nothing.
    pub(super) fn list_left(&mut self) {
        self.read_left("There is no unsaved work of earlier sessions");
    }

    /// `none`: the message if nothing is found.
    fn read_left(&mut self, none: &'static str) {
        let limits = *self.session().document().limits();
        if let Some(work) = self.abandoned.list(none, limits, &self.ui.dialogs.recovery) {
            self.editor.start_side_work(work, "Looking for unsaved work");
        }
    }

    /// Goes on with what was left in the journal of this number.
    pub(super) fn start_recovery(&mut self, number: u64) {
        if let Some(work) = self.abandoned.recovery(number, self.editor.session()) {
            self.ui.dialogs.recovery.close();
            self.editor.start_recovery(work);
        }
    }

    /// Removes the journal of this number, which nobody wants.
    pub(super) fn discard_left(&mut self, number: u64) {
        match self.abandoned.discard(number) {
            Some(Ok(())) => self.ui.dialogs.recovery.remove(number),
            Some(Err(text)) => self.ui.toasts.error(text),
            None => {}
        }
    }
}
