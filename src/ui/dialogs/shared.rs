//! The interface of dialogs: how they are shown, closed and queried, and what they see of the program.
//!
//! Each dialog implements [`Dialog`] for its own state, works through [`DialogContext`], and opens another dialog by an
//! [`Opening`]. Knows no single dialog.

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

    /// Returns whether it needs an answer while it is open.
    fn is_modal(&self) -> bool {
        true
    }

    /// Closes it at Escape. Returns false if it is not open, or handles Escape itself.
    fn close(&mut self) -> bool {
        false
    }

    /// Shows it if it is open.
    fn show(&mut self, root: &Ui, shared: &mut DialogContext);
}

/// The program as dialogs see it, the choices that they change directly, and their requests.
pub struct DialogContext<'a> {
    pub context: &'a UiContext<'a>,
    /// There is long work.
    pub is_busy: bool,
    pub view: &'a mut ViewState,
    pub references: &'a mut Vec<Reference>,
    pub upright: &'a mut Upright,
    pub toasts: &'a mut Toasts,
    pub requests: &'a mut Vec<UiRequest>,
    /// Whether the import dialog asks; it adopts a change.
    pub ask_import: bool,
    /// Dialogs to open.
    pub openings: Vec<Opening>,
    /// The option to show to the person.
    pub led_to: Option<Spot>,
    /// The use of the clipboard's picture, if requested.
    pub paste: Option<PasteAs>,
}

/// A dialog that another one opens.
pub enum Opening {
    /// The choice of a file, in the folder of this file if there is one.
    Files(FileTask, Option<PathBuf>),
    /// The import of a file, with the known facts, and whether it is opened without asking.
    Import { path: PathBuf, import: ImportOptions, at_once: bool },
    /// The options of an exported file.
    Export(PathBuf),
}

/// The task of a file dialog.
#[derive(Clone, PartialEq, Debug)]
pub enum FileTask {
    Open,
    /// Save under a new name, then do a step that would lose unsaved work.
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
