//! The terms on which dialogs are shown, closed and asked, and how they see the rest of the program.
//!
//! Each dialog implements [`Dialog`] beside its own state, reads and asks through [`Shared`], and opens another dialog by
//! an [`Opening`]. Knows no single dialog.

use std::path::PathBuf;

use egui::Ui;

use crate::editor::questions::Next;
use crate::format::options::ImportOptions;
use crate::ui::context::UiContext;
use crate::ui::memory::upright::Upright;
use crate::ui::references::Reference;
use crate::ui::request::UiRequest;
use crate::ui::tasks::PasteAs;
use crate::ui::view_state::ViewState;
use crate::ui::widgets::spot::Spot;
use crate::ui::widgets::toasts::Toasts;

/// A dialog, a question or a window over the sculpture.
pub trait Dialog {
    fn is_open(&self) -> bool;

    /// Returns whether it has the person's attention while it is open: it waits for an answer.
    fn is_modal(&self) -> bool {
        true
    }

    /// Closes it at Escape; false if it is not open, or hears Escape itself.
    fn close(&mut self) -> bool {
        false
    }

    /// Shows it if it is open.
    fn show(&mut self, root: &Ui, shared: &mut Shared);
}

/// The program as dialogs see it, the choices that they change on the spot, and where they put what they ask for.
pub struct Shared<'a> {
    pub context: &'a UiContext<'a>,
    /// Long work is under way.
    pub is_busy: bool,
    pub view: &'a mut ViewState,
    pub references: &'a mut Vec<Reference>,
    pub upright: &'a mut Upright,
    pub toasts: &'a mut Toasts,
    pub requests: &'a mut Vec<UiRequest>,
    /// Whether it is asked how files are imported; the import dialog takes a change.
    pub ask_import: bool,
    /// Dialogs that are to be opened.
    pub openings: Vec<Opening>,
    /// The option that the person is to be led to.
    pub led_to: Option<Spot>,
    /// The use of the picture on the clipboard, if it is wanted.
    pub paste: Option<PasteAs>,
}

/// Another dialog that one leads to.
pub enum Opening {
    /// The choice of a file, in the folder of this one if there is one.
    Files(FileTask, Option<PathBuf>),
    /// The import of a file: with the facts known of it, and whether it is opened without asking.
    Import { path: PathBuf, import: ImportOptions, at_once: bool },
    /// The options of a file that is exported.
    Export(PathBuf),
}

/// The task that a file dialog is open for.
#[derive(Clone, PartialEq, Debug)]
pub enum FileTask {
    Open,
    /// Save under a new name, then do what would lose unsaved work.
    SaveAs(Option<Next>),
    /// Write a file for other programs.
    Export,
    /// Choose a picture for solids to paint with.
    Picture,
    /// Choose a picture to sculpt from.
    Reference,
    /// Choose a picture of a lit ball to shade with.
    Matcap,
}
