//! The dialog after choosing a file to open: it shows a scan, a mesh or a voxel model, asks what the file does not say,
//! and keeps the answers for the next file of its family. Files without open questions are opened at once.
//!
//! Takes a path and the contents that others have read from the file; asks with a command to open. `volume`, `mesh` and
//! `model` show the questions; `histogram`, `slices`, `box_view` and `voxel_picture` draw.

mod box_view;
mod histogram;
mod mesh;
mod model;
mod raw;
mod remembered;
mod slices;
mod volume;
mod voxel_picture;
mod widths;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{Id, Key, Modal, RichText, Ui, vec2};
use glam::UVec3;

pub use self::remembered::Remembered;
use self::widths::{BESIDE, MOST_WIDTH, NARROW};
use crate::command::Command;
use crate::format::options::{ImportOptions, RawLayout, ScanRegion};
use crate::format::{
    FormatError, MeshStudy, ModelStudy, Outlook, Study, VolumeStudy, family, needs_layout,
};
use crate::remedy::told;
use crate::sculpture::Limits;
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::names::capital;
use crate::ui::widgets::theme;

/// The result of reading the file.
type StudySlot = Arc<Mutex<Option<Result<Study, String>>>>;

/// The stage that the dialog has reached.
#[derive(Debug)]
enum ImportStage {
    Closed,
    /// Asks for the layout of a raw file; with the typed text, and its error.
    Layout {
        text: String,
        error: Option<String>,
    },
    /// The file is being read.
    Reading,
    /// The file cannot be read, for this reason.
    Failed(String),
    Volume(Box<VolumeStudy>),
    Mesh(Box<MeshStudy>),
    Model(Box<ModelStudy>),
}

/// The options chosen so far, and the file for them.
pub struct ImportDialog {
    stage: ImportStage,
    path: PathBuf,
    options: ImportOptions,
    /// Whether the dialog is shown. It always asks about raw files.
    pub ask: bool,
    /// The options chosen last.
    pub remembered: Remembered,
    news: StudySlot,
    /// The shown slices of a volume, in its final orientation.
    at: UVec3,
    /// View angles of a mesh or a model, in radians: about the vertical, and from above.
    view: [f32; 2],
}

impl Default for ImportDialog {
    fn default() -> ImportDialog {
        ImportDialog {
            stage: ImportStage::Closed,
            path: PathBuf::new(),
            options: ImportOptions::default(),
            ask: true,
            remembered: Remembered::default(),
            news: StudySlot::default(),
            at: UVec3::ZERO,
            view: box_view::FIRST,
        }
    }
}

impl ImportDialog {
    pub fn is_open(&self) -> bool {
        !matches!(self.stage, ImportStage::Closed)
    }

    /// Closes it. Returns false if it is not open.
    pub fn close(&mut self) -> bool {
        let was_open = self.is_open();
        self.stage = ImportStage::Closed;
        self.news = StudySlot::default();
        was_open
    }

    /// Returns the slot for the contents of the file, or the error.
    pub fn news(&self) -> StudySlot {
        self.news.clone()
    }

    /// Returns the options chosen so far.
    pub fn options(&self) -> &ImportOptions {
        &self.options
    }

    /// Asks about a file, or to open it if there are no questions. `import`: the facts known already; `at_once`: opens
    /// it with these or the last answers.
    pub fn open(
        &mut self,
        path: PathBuf,
        import: ImportOptions,
        at_once: bool,
        requests: &mut Vec<UiRequest>,
    ) {
        let Some(family) = family(&path) else {
            return requests.push(UiRequest::Run(Command::Open { path, import }));
        };
        self.close();
        self.options = self.remembered.applied(family, import);
        let import = self.options;
        self.path = path.clone();
        self.at = UVec3::MAX;
        if import.raw.is_none() && needs_layout(&path) {
            let text = self.remembered.raw.clone();
            self.stage = ImportStage::Layout { text, error: None };
        } else if at_once || !self.ask {
            requests.push(UiRequest::Run(Command::Open { path, import }));
        } else {
            self.stage = ImportStage::Reading;
            requests.push(UiRequest::Study(path, import));
        }
    }

    /// Takes the result of reading the file. Waits while the program is busy, since nothing can be opened then.
    fn take_news(&mut self, is_busy: bool, requests: &mut Vec<UiRequest>) {
        if is_busy || !matches!(self.stage, ImportStage::Reading) {
            return;
        }
        let news = self.news.lock().unwrap_or_else(PoisonError::into_inner).take();
        match news {
            Some(Ok(Study::Volume(study))) => {
                let dims = study.upright_dims(study.turn(&self.options));
                // Another channel of the same file is shown at the same place.
                if self.at.cmpge(dims).any() {
                    self.at = dims / 2;
                }
                // A region that does not fit was chosen for another version of the file.
                let fits = |region: &ScanRegion| region.high.cmplt(study.volume.dims).all();
                self.options.region = self.options.region.filter(fits);
                volume::allow(&study, &mut self.options);
                self.stage = ImportStage::Volume(study);
            }
            Some(Ok(Study::Mesh(study))) => {
                self.view = box_view::FIRST;
                self.stage = ImportStage::Mesh(study);
            }
            Some(Ok(Study::Model(study))) => {
                self.view = box_view::FIRST;
                self.stage = ImportStage::Model(study);
            }
            Some(Ok(Study::Settled)) => {
                let (path, import) = (self.path.clone(), self.options);
                requests.push(UiRequest::Run(Command::Open { path, import }));
                self.close();
            }
            Some(Err(error)) => self.stage = ImportStage::Failed(error),
            // Reading was cancelled.
            None => {
                self.close();
            }
        }
    }

    /// Returns a forecast of the imported sculpture.
    fn outlook(&self, limits: &Limits) -> Option<Result<Outlook, FormatError>> {
        match &self.stage {
            ImportStage::Volume(study) => {
                Some(study.outlook(&study.settled(&self.options), limits))
            }
            ImportStage::Mesh(study) => Some(study.outlook(&self.options)),
            ImportStage::Model(study) => Some(study.outlook(&self.options, limits)),
            _ => None,
        }
    }

    /// Returns the command that imports the file as shown.
    fn command(&self) -> Command {
        let import = match &self.stage {
            ImportStage::Volume(study) => study.settled(&self.options),
            _ => self.options,
        };
        Command::Open { path: self.path.clone(), import }
    }

    /// Executes the answer.
    fn answer_with(&mut self, answer: ImportAnswer, shared: &mut DialogContext) {
        match answer {
            ImportAnswer::None => {}
            ImportAnswer::Cancel => {
                self.close();
            }
            ImportAnswer::Read => {
                let ImportStage::Layout { text, error } = &mut self.stage else { return };
                match text.trim().parse::<RawLayout>() {
                    Ok(raw) => {
                        self.remembered.raw = raw.to_string();
                        let import = ImportOptions { raw: Some(raw), ..self.options };
                        let path = self.path.clone();
                        self.open(path, import, false, shared.requests);
                    }
                    Err(reason) => *error = Some(reason),
                }
            }
            ImportAnswer::Import => {
                let command = self.command();
                let Command::Open { path, import } = &command else { return };
                if let Some(family) = family(path) {
                    self.remembered.note(family, import);
                }
                if let Some(up) = import.upright {
                    shared.upright.remember(path, up);
                }
                shared.upright.answer(path);
                shared.requests.push(UiRequest::Run(command));
                self.close();
            }
        }
    }

    /// Returns the dialog's width in a window of this width, in points.
    fn width(&self, window: f32) -> f32 {
        let wide = (window - BESIDE).clamp(NARROW.min(window - 16.0), MOST_WIDTH);
        match self.stage {
            ImportStage::Volume(_) => wide,
            ImportStage::Mesh(_) | ImportStage::Model(_) => wide.min(720.0),
            _ => wide.min(NARROW),
        }
    }
}

impl Dialog for ImportDialog {
    fn is_open(&self) -> bool {
        ImportDialog::is_open(self)
    }

    fn close(&mut self) -> bool {
        ImportDialog::close(self)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        self.take_news(shared.is_busy, shared.requests);
        // While the file is read, the sign of long work is shown.
        if !self.is_open() || matches!(self.stage, ImportStage::Reading) {
            model::forget(root.ctx());
            return slices::forget(root.ctx());
        }
        let window = root.ctx().content_rect().size();
        let response = Modal::new(Id::new("import")).show(root.ctx(), |ui| {
            ui.set_width(self.width(window.x));
            let name = self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            ui.heading(format!("Import {name}"));
            // A focused field or button uses Enter itself.
            let free = ui.memory(|memory| memory.focused().is_none());
            let mut enter = free && ui.input(|input| input.key_pressed(Key::Enter));
            let room = vec2(self.width(window.x), window.y - 150.0);
            let mut another = None;
            match &mut self.stage {
                ImportStage::Volume(study) => {
                    if volume::show(ui, study, &mut self.options, &mut self.at, room) {
                        another = Some(UiRequest::Study(self.path.clone(), self.options));
                    }
                }
                ImportStage::Mesh(study) => {
                    mesh::show(ui, study, &mut self.options, &mut self.view, room);
                }
                ImportStage::Model(study) => {
                    model::show(ui, study, &mut self.options, &mut self.view, room);
                }
                ImportStage::Failed(error) => {
                    ui.add_space(4.0);
                    ui.colored_label(theme::error_colour(ui.visuals()), capital(error));
                }
                ImportStage::Layout { text, error } => {
                    enter |= raw::layout(ui, &self.path, text, error.as_ref());
                }
                ImportStage::Closed | ImportStage::Reading => {}
            }
            let answer = foot(ui, self, shared.context, enter);
            if let (Some(study), ImportAnswer::None) = (another, answer) {
                self.stage = ImportStage::Reading;
                shared.requests.push(study);
            }
            answer
        });
        let answer = if response.should_close() { ImportAnswer::Cancel } else { response.inner };
        self.answer_with(answer, shared);
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum ImportAnswer {
    None,
    Import,
    /// Read a raw file with the given layout.
    Read,
    Cancel,
}

/// Shows the forecast and the buttons.
fn foot(ui: &mut Ui, dialog: &mut ImportDialog, context: &UiContext, enter: bool) -> ImportAnswer {
    let outlook = dialog.outlook(context.document.limits());
    let error = match &outlook {
        Some(Ok(outlook)) => {
            become_of(ui, outlook, context.document.limits());
            None
        }
        Some(Err(error)) => Some(told(error)),
        None => None,
    };
    if let Some(error) = &error {
        ui.colored_label(theme::error_colour(ui.visuals()), error);
    }
    ui.add_space(6.0);
    let (label, answer) = match dialog.stage {
        ImportStage::Layout { .. } => ("Read", ImportAnswer::Read),
        _ => ("Import", ImportAnswer::Import),
    };
    let possible = error.is_none() && !matches!(dialog.stage, ImportStage::Failed(_));
    ui.horizontal(|ui| {
        let mut given = ImportAnswer::None;
        let button = ui.add_enabled(possible, theme::primary(ui.visuals(), label));
        if button.clicked() || enter && possible {
            given = answer;
        }
        if ui.button("Cancel").on_hover_text("Leave everything as it is").clicked() {
            given = ImportAnswer::Cancel;
        }
        if !matches!(dialog.stage, ImportStage::Layout { .. }) {
            ui.checkbox(&mut dialog.ask, "Ask each time").on_hover_text(
                "Otherwise files open with the last choices, as they do with Shift held",
            );
        }
        given
    })
    .inner
}

/// Shows the size of the resulting sculpture.
fn become_of(ui: &mut Ui, outlook: &Outlook, limits: &Limits) {
    let mib = |bytes: u64| (bytes as f64 / f64::from(1 << 20)).ceil();
    let UVec3 { x, y, z } = outlook.dims;
    let mm = outlook.dims.as_vec3() * outlook.voxel_size;
    let size = format!("{x} × {y} × {z} voxels, {:.1} × {:.1} × {:.1} mm", mm.x, mm.y, mm.z);
    ui.label(RichText::new(size).strong())
        .on_hover_text("Width, height and depth of the sculpture");
    let colours = match outlook.colour_bytes {
        0 => String::new(),
        bytes => format!(", colours up to {:.0} MiB", mib(bytes)),
    };
    let budget = limits.grid_bytes.saturating_add(limits.colour_bytes);
    ui.label(format!(
        "Memory: shape about {:.0} MiB{colours}; {:.0} MiB while it is read, of {:.0} MiB allowed",
        mib(outlook.grid_bytes),
        mib(outlook.read_bytes),
        mib(budget)
    ))
    .on_hover_text("memory.grid_mib and memory.colour_mib in the settings set the limits");
}
