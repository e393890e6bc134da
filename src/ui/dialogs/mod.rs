//! The windows, dialogs and questions over the sculpture, each with its own state, and the order in which they claim
//! attention.
//!
//! [`LIST`] names them once; showing, closing and querying go through it. Each dialog knows only itself and [`shared`];
//! this file connects them. Must not know any panel, nor the owner of the interface's state.

pub mod busy;
pub mod calibration;
pub mod canvas;
pub mod changed_on_disk;
mod elsewhere;
pub mod export;
pub mod files;
pub mod film;
pub mod final_choices;
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
pub mod references;
pub mod shared;
pub mod tints;
pub mod unkept;
pub mod unsaved;

use egui::Ui;

use self::calibration::Calibration;
use self::canvas::CanvasWindow;
use self::export::ExportDialog;
use self::files::Files;
use self::film::FilmDialog;
use self::final_choices::FinalDialog;
use self::final_picture::Preview;
use self::guide::Guide;
use self::import::ImportDialog;
use self::key_table::KeyTable;
use self::light::LightWindow;
use self::masks::Masks;
use self::new::NewDialog;
use self::palette::CommandPalette;
use self::print_check::PrintCheck;
use self::recovery::RecoveryDialog;
use self::references::ReferencesWindow;
pub use self::shared::{Dialog, DialogContext, FileTask, Opening};
use self::tints::Tints;
use crate::command::NewSculpture;
use crate::editor::job::Busy;
use crate::editor::questions::{ChangedOnDisk, InUse, Next, Unkept};

/// All dialogs, open or not.
pub struct Dialogs {
    pub guide: Guide,
    /// The window of keys and mouse.
    pub keys: KeyTable,
    pub light: LightWindow,
    /// The window of reference pictures.
    pub references: ReferencesWindow,
    pub palette: CommandPalette,
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
    /// The window of the canvas and the resolution.
    pub canvas: CanvasWindow,
    pub files: Files,
    /// Asks about unsaved work before this step.
    pub unsaved: Option<Next>,
    /// Asks whether to do something that cannot be undone.
    pub unkept: Option<Unkept>,
    /// Asks about a file that another program has changed.
    pub changed_on_disk: Option<ChangedOnDisk>,
    /// Asks about a file that another program has open.
    pub in_use: Option<InUse>,
    pub calibration: Calibration,
    /// Long work, as reported by the editor. Other requests are refused meanwhile.
    pub busy: Option<Busy>,
    /// The picture that this work makes.
    pub preview: Option<Preview>,
}

impl Dialogs {
    /// Creates closed dialogs. `new`: the default of the dialog for a new sculpture.
    pub fn new(new: &NewSculpture) -> Dialogs {
        Dialogs {
            guide: Guide::default(),
            keys: KeyTable::default(),
            light: LightWindow::default(),
            references: ReferencesWindow::default(),
            palette: CommandPalette::default(),
            new: NewDialog::new(new),
            final_picture: FinalDialog::default(),
            film: FilmDialog::default(),
            export: ExportDialog::default(),
            import: ImportDialog::default(),
            recovery: RecoveryDialog::default(),
            print_check: PrintCheck::default(),
            tints: Tints::default(),
            masks: Masks::default(),
            canvas: CanvasWindow::default(),
            files: Files::new(),
            unsaved: None,
            unkept: None,
            changed_on_disk: None,
            in_use: None,
            calibration: Calibration::default(),
            busy: None,
            preview: None,
        }
    }

    /// Shows the open dialogs, except the sign of long work.
    pub fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        for row in LIST.iter().filter(|row| row.place.is_here(shared.context.in_headset)) {
            let asked = self.import.ask;
            shared.ask_import = asked;
            (row.of_mut)(self).show(root, shared);
            if shared.ask_import != asked {
                self.import.ask = shared.ask_import;
            }
            for opening in std::mem::take(&mut shared.openings) {
                self.open(opening, shared);
            }
        }
    }

    fn open(&mut self, opening: Opening, shared: &mut DialogContext) {
        match opening {
            Opening::Files(task, path) => self.files.open(task, path.as_deref()),
            Opening::Import { path, import, at_once } => {
                self.import.open(path, import, at_once, shared.requests);
            }
            Opening::Export(path) => self.export.open(path, shared.requests),
        }
    }

    fn open_ones(&self) -> impl Iterator<Item = &dyn Dialog> {
        LIST.iter().map(|row| (row.of)(self)).filter(|dialog| dialog.is_open())
    }

    /// Returns whether a dialog or long work claims the person's attention.
    pub fn is_modal(&self) -> bool {
        self.is_asking() || self.busy.is_some()
    }

    /// Returns whether a dialog waits for an answer.
    pub fn is_asking(&self) -> bool {
        self.open_ones().any(|dialog| dialog.is_modal())
    }

    /// Closes the topmost open window. Returns false if there is none.
    pub fn close_top(&mut self) -> bool {
        let mut rows: Vec<&DialogRow> = LIST.iter().filter(|row| row.turn.is_some()).collect();
        rows.sort_by_key(|row| row.turn);
        rows.into_iter().any(|row| (row.of_mut)(self).close())
    }

    /// Returns whether a window is open that needs no answer and that Escape closes.
    pub fn has_window(&self) -> bool {
        self.open_ones().any(|dialog| !dialog.is_modal())
    }
}

/// Where a dialog is shown.
#[derive(Clone, Copy, PartialEq, Eq)]
enum DialogPlace {
    Everywhere,
    /// In the window only: it needs keyboard, mouse or the screen.
    Desk,
    /// On the board in a headset only.
    Board,
}

impl DialogPlace {
    fn is_here(self, in_headset: bool) -> bool {
        match self {
            DialogPlace::Everywhere => true,
            DialogPlace::Desk => !in_headset,
            DialogPlace::Board => in_headset,
        }
    }
}

/// A dialog of the list.
struct DialogRow {
    of: fn(&Dialogs) -> &dyn Dialog,
    of_mut: fn(&mut Dialogs) -> &mut dyn Dialog,
    place: DialogPlace,
    /// Its turn when Escape closes a window, unless it handles Escape itself.
    turn: Option<u8>,
}

/// The row of the dialog with this state.
macro_rules! row {
    ($($state:ident).+, $place:ident, $turn:expr) => {
        DialogRow {
            of: |dialogs| &dialogs.$($state).+,
            of_mut: |dialogs| &mut dialogs.$($state).+,
            place: DialogPlace::$place,
            turn: $turn,
        }
    };
}

/// All dialogs in the order of drawing: later ones lie over earlier ones.
static LIST: [DialogRow; 22] = [
    // In the window it is a strip below the picture.
    row!(guide, Board, Some(17)),
    row!(light, Everywhere, Some(16)),
    row!(references, Desk, Some(12)),
    row!(print_check, Desk, Some(13)),
    row!(tints, Desk, Some(14)),
    row!(masks, Desk, Some(15)),
    row!(canvas, Desk, Some(18)),
    row!(keys, Desk, Some(11)),
    row!(keys.catch, Desk, None),
    row!(palette, Everywhere, None),
    row!(new, Everywhere, Some(8)),
    row!(final_picture, Everywhere, Some(9)),
    row!(film, Everywhere, Some(10)),
    row!(export, Everywhere, Some(5)),
    row!(import, Everywhere, Some(6)),
    row!(recovery, Everywhere, Some(7)),
    row!(calibration, Desk, None),
    row!(unsaved, Everywhere, Some(2)),
    row!(unkept, Everywhere, Some(1)),
    row!(changed_on_disk, Everywhere, Some(3)),
    row!(in_use, Everywhere, Some(4)),
    row!(files, Everywhere, None),
];

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;
    use crate::sculpture::{ColourDepth, Rgb};

    #[test]
    fn escape_closes_one_dialog_after_another_and_none_has_the_turn_of_another() {
        let mut turns: Vec<u8> = LIST.iter().filter_map(|row| row.turn).collect();
        turns.sort_unstable();
        assert!(turns.windows(2).all(|pair| pair[0] < pair[1]), "{turns:?}");

        let mut dialogs = Dialogs::new(&NewSculpture {
            dims: UVec3::splat(8),
            voxel_size: Vec3::ONE,
            colour_depth: ColourDepth::None,
            base: Rgb::STONE,
            solid: true,
            room_vx: 0,
            grows: false,
        });
        (dialogs.guide.open, dialogs.masks.open, dialogs.new.open) = (true, true, true);
        dialogs.unsaved = Some(Next::Leave);
        assert!(dialogs.is_asking() && dialogs.has_window());
        assert!(dialogs.close_top() && dialogs.unsaved.is_none() && dialogs.new.open);
        assert!(dialogs.close_top() && !dialogs.is_asking() && dialogs.masks.open);
        assert!(dialogs.close_top() && !dialogs.masks.open && dialogs.guide.open);
        assert!(dialogs.close_top() && !dialogs.has_window() && !dialogs.close_top());
    }
}
