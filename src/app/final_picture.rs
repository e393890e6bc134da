//! The final picture of the view, made on a thread while the window stays alive, and saved as a file.
//!
//! Takes the view as it is at the start; what changes later does not matter to it. Knows no window.

use super::screenshot;
use super::workspace::Workspace;
use crate::editor::job::Failure;
use crate::picture::{self, FinalOptions, PictureError, TraceOn};
use crate::progress::Report;
use crate::trace::{TraceError, TraceShot};

impl Workspace {
    /// Starts a final picture of the view: as the eye of the window, of two the left one, sees it.
    pub(super) fn start_final_picture(&mut self, options: FinalOptions) {
        let eyes = self.eyes();
        let Some(&eye) = eyes.first() else { return };
        let document = self.session().document();
        let contents = document.share_contents();
        let up = document.placement().rotation * self.ui.view.up;
        let shot = TraceShot { eye, world_from_grid: document.world_from_grid(), up };
        let path = screenshot::free_path(self.session().path(), "final", "png");
        let work = move |report: &Report| match picture::write_final(
            &contents,
            &shot,
            &options,
            &TraceOn::Cpu,
            &path,
            report,
        ) {
            Ok(()) => Ok(format!("Saved {}", path.display())),
            Err(PictureError::Trace(TraceError::Cancelled)) => Err(Failure::Cancelled),
            Err(error) => Err(Failure::Error(error.to_string())),
        };
        self.editor.start_side_work(work, "Final picture");
    }
}
