//! The windows, dialogs and questions over the sculpture, each with its own state, and which of
//! them has the person's attention.
//!
//! Takes and gives values; shows nothing itself. The module of each dialog says who shows it.

pub mod busy;
pub mod changed_on_disk;
mod elsewhere;
pub mod export;
pub mod files;
pub mod film;
pub mod final_picture;
mod final_rows;
pub mod guide;
pub mod import;
pub mod in_use;
pub mod key_catch;
pub mod key_table;
pub mod light;
pub mod look;
pub mod masks;
pub mod new;
pub mod palette;
pub mod picture_size;
pub mod print_check;
pub mod recovery;
pub mod tints;
pub mod unkept;
pub mod unsaved;
pub mod upright;

use crate::command::NewSculpture;
use crate::editor::job::Busy;
use crate::editor::questions::{ChangedOnDisk, InUse, Next, Unkept};
use crate::ui::dialogs::export::ExportDialog;
use crate::ui::dialogs::files::Files;
use crate::ui::dialogs::film::FilmDialog;
use crate::ui::dialogs::final_picture::{FinalDialog, Preview};
use crate::ui::dialogs::guide::Guide;
use crate::ui::dialogs::import::ImportDialog;
use crate::ui::dialogs::key_table::KeyTable;
use crate::ui::dialogs::light::LightWindow;
use crate::ui::dialogs::masks::Masks;
use crate::ui::dialogs::new::NewDialog;
use crate::ui::dialogs::palette::Palette;
use crate::ui::dialogs::print_check::PrintCheck;
use crate::ui::dialogs::recovery::RecoveryDialog;
use crate::ui::dialogs::tints::Tints;

/// All dialogs, open or not.
pub struct Dialogs {
    pub guide: Guide,
    /// The window of keys and mouse.
    pub keys: KeyTable,
    pub light: LightWindow,
    /// The window of reference pictures.
    pub references_open: bool,
    pub palette: Palette,
    pub new: NewDialog,
    pub final_picture: FinalDialog,
    pub film: FilmDialog,
    pub export: ExportDialog,
    pub import: ImportDialog,
    /// The dialog about the work that earlier sessions left.
    pub recovery: RecoveryDialog,
    /// The window of the print check.
    pub print_check: PrintCheck,
    /// The window of colours.
    pub tints: Tints,
    pub masks: Masks,
    pub files: Files,
    /// Asks what to do with unsaved work before this.
    pub unsaved: Option<Next>,
    /// Asks whether to do what cannot be undone.
    pub unkept: Option<Unkept>,
    /// Asks what to do with a file that another program has changed.
    pub changed_on_disk: Option<ChangedOnDisk>,
    /// Asks how to go on with a file that another program has open.
    pub in_use: Option<InUse>,
    /// The tracker is being calibrated, as the viewpoint says.
    pub calibrating: bool,
    /// Long work under way, as the editor says; nothing else can be asked for meanwhile.
    pub busy: Option<Busy>,
    /// The picture that this work makes.
    pub preview: Option<Preview>,
}

impl Dialogs {
    /// None is open. `new`: the default of the dialog for a new sculpture.
    pub fn new(new: &NewSculpture) -> Dialogs {
        Dialogs {
            guide: Guide::default(),
            keys: KeyTable::default(),
            light: LightWindow::default(),
            references_open: false,
            palette: Palette::default(),
            new: NewDialog::new(new),
            final_picture: FinalDialog::default(),
            film: FilmDialog::default(),
            export: ExportDialog::default(),
            import: ImportDialog::default(),
            recovery: RecoveryDialog::default(),
            print_check: PrintCheck::default(),
            tints: Tints::default(),
            masks: Masks::default(),
            files: Files::new(),
            unsaved: None,
            unkept: None,
            changed_on_disk: None,
            in_use: None,
            calibrating: false,
            busy: None,
            preview: None,
        }
    }

    /// Whether a dialog or long work lies over the sculpture and has the person's attention.
    pub fn is_modal(&self) -> bool {
        self.is_asking() || self.busy.is_some()
    }

    /// Whether a dialog waits for an answer.
    pub fn is_asking(&self) -> bool {
        self.unsaved.is_some()
            || self.unkept.is_some()
            || self.changed_on_disk.is_some()
            || self.in_use.is_some()
            || self.calibrating
            || self.new.open
            || self.final_picture.open
            || self.film.open
            || self.export.is_open()
            || self.import.is_open()
            || self.recovery.is_open()
            || self.palette.open
            || self.keys.is_catching()
            || self.files.is_open()
    }

    /// Closes the uppermost open window; false if there is none.
    pub fn close_top(&mut self) -> bool {
        if self.unkept.take().is_some()
            || self.unsaved.take().is_some()
            || self.changed_on_disk.take().is_some()
            || self.in_use.take().is_some()
        {
            return true;
        }
        if self.export.close() || self.import.close() || self.recovery.close() {
            return true;
        }
        let asked = [&mut self.new.open, &mut self.final_picture.open, &mut self.film.open];
        asked.into_iter().any(close) || self.windows().into_iter().any(close)
    }

    /// Whether a window is open that waits for no answer, and that Escape closes.
    pub fn has_window(&mut self) -> bool {
        self.windows().into_iter().any(|open| *open)
    }

    /// The windows beside the sculpture, those first that are closed first.
    fn windows(&mut self) -> [&mut bool; 7] {
        [
            &mut self.keys.open,
            &mut self.references_open,
            &mut self.print_check.open,
            &mut self.tints.open,
            &mut self.masks.open,
            &mut self.light.open,
            &mut self.guide.open,
        ]
    }
}

/// Closes what is open; false if it is not.
fn close(open: &mut bool) -> bool {
    std::mem::take(open)
}
