//! The dialogs for files, drawn by the program itself, so that they work in a headset too, with
//! what can be chosen about a file beside the list.

use std::path::{Path, PathBuf};

use egui::{ComboBox, DragValue, RichText, TextEdit, Ui};
use egui_file_dialog::{DialogState, FileDialog, Filter};

use super::state::folder_of;
use super::top_bar::capital;
use super::{UiRequest, UiState, look, theme};
use crate::command::Command;
use crate::editor::questions::Next;
use crate::editor::tool::ToolEdit;
use crate::format::options::{
    Colouring, Existence, ExportOptions, ImportOptions, MeshFill, MeshSize, RawLayout,
};
use crate::sculpture::grid::MAX_AXIS_VX;

/// The endings of the program's own files, and of what other programs read best.
const ENDING: &str = "vsc";
const EXPORT_ENDING: &str = "pvm";
const SIDE_WIDTH: f32 = 170.0;

/// What a file dialog is open for.
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

/// The file dialog and what it is open for.
pub struct Files {
    dialog: FileDialog,
    task: FileTask,
    choice: Choice,
    /// Where a sculpture was opened or saved last.
    folder: Option<PathBuf>,
}

/// What is chosen about a file, kept from one dialog to the next.
struct Choice {
    import: ImportOptions,
    /// As typed, kept while `import` has none.
    threshold: f64,
    raw: String,
}

impl Files {
    pub fn new() -> Files {
        let choice =
            Choice { import: ImportOptions::default(), threshold: 128.0, raw: String::new() };
        Files { dialog: FileDialog::new(), task: FileTask::Open, choice, folder: None }
    }

    /// The folder that dialogs open in where no file says another.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    pub fn set_folder(&mut self, folder: PathBuf) {
        self.folder = Some(folder);
    }

    pub fn is_open(&self) -> bool {
        matches!(self.dialog.state(), DialogState::Open)
    }

    /// Opens the dialog, in the folder of `path` if there is one.
    pub fn open(&mut self, task: FileTask, path: Option<&Path>) {
        const VOLUMES: &str = "Sculptures, volumes, models and meshes";
        const PICTURES: &str = "Images (.png, .jpg)";
        let mut dialog = FileDialog::new()
            .add_file_filter(VOLUMES, Filter::new(crate::format::can_be_read))
            .add_file_filter_extensions(PICTURES, vec!["png", "jpg", "jpeg"])
            .default_size([720.0, 400.0])
            .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .resizable(false)
            .movable(false);
        dialog.set_right_panel_width(SIDE_WIDTH);
        let folder = folder_of(path).or_else(|| self.folder.clone());
        if let Some(folder) = folder.filter(|folder| folder.is_dir()) {
            dialog = dialog.initial_directory(folder);
        }
        let name = path.and_then(|p| p.file_stem()).map(|n| n.to_string_lossy().into_owned());
        let name = name.as_deref().unwrap_or("sculpture");
        dialog = match task {
            FileTask::Open => dialog.title("Open").default_file_filter(VOLUMES),
            FileTask::Picture => {
                dialog.title("Choose an image to paint with").default_file_filter(PICTURES)
            }
            FileTask::Reference => {
                dialog.title("Choose an image to sculpt from").default_file_filter(PICTURES)
            }
            FileTask::Matcap => dialog.title("Choose a matcap").default_file_filter(PICTURES),
            FileTask::SaveAs(_) => dialog
                .title("Save as")
                .add_save_extension("Sculpture", ENDING)
                .default_save_extension("Sculpture")
                .default_file_name(&format!("{name}.{ENDING}")),
            FileTask::Export => dialog
                .title("Export")
                .add_save_extension("Volume", EXPORT_ENDING)
                .add_save_extension("Raw voxels", "raw")
                .add_save_extension("MagicaVoxel", "vox")
                .add_save_extension("Qubicle", "qb")
                .add_save_extension("Print (STL)", "stl")
                .add_save_extension("Print (3MF)", "3mf")
                .add_save_extension("Mesh (glTF)", "glb")
                .add_save_extension("Mesh (PLY)", "ply")
                .add_save_extension("Mesh (OBJ)", "obj")
                .default_save_extension("Volume")
                .default_file_name(&format!("{name}.{EXPORT_ENDING}")),
        };
        match task {
            FileTask::Open | FileTask::Picture | FileTask::Reference | FileTask::Matcap => {
                dialog.pick_file();
            }
            FileTask::SaveAs(_) | FileTask::Export => dialog.save_file(),
        }
        self.dialog = dialog;
        self.task = task;
    }
}

impl Default for Files {
    fn default() -> Self {
        Files::new()
    }
}

pub fn show(root: &Ui, state: &mut UiState, requests: &mut Vec<UiRequest>) {
    let Files { dialog, task, choice, .. } = &mut state.dialogs.files;
    // The library draws its search field black on any ground: dark text could not be read there.
    dialog.config_mut().show_search = root.visuals().dark_mode;
    dialog.update_with_right_panel_ui(root.ctx(), &mut |ui, _| {
        ui.add_space(4.0);
        match task {
            FileTask::Open => import_options(ui, choice),
            FileTask::SaveAs(_) => {
                ui.label("Keeps everything: all colours, the base colour, the texts of the file.");
                ui.add_space(8.0);
                ui.weak("Other programs read what Export writes.");
            }
            FileTask::Export => {
                ui.label("Volumes, voxel models and meshes, by the ending of the name.");
                ui.add_space(8.0);
                ui.weak("What the format leaves open is asked next.");
            }
            FileTask::Picture => {
                ui.label("The image is wrapped around the tool in Paint mode.");
            }
            FileTask::Reference => {
                ui.label("The image stands in the scene, on the side that you look along.");
            }
            FileTask::Matcap => {
                ui.label("A square image of a lit ball that touches all four edges.");
            }
        }
    });
    let Some(path) = dialog.take_picked() else { return };
    match task {
        FileTask::Picture => requests.push(UiRequest::Tool(ToolEdit::Picture(Some(path)))),
        FileTask::Reference => requests.push(UiRequest::AddReference(path)),
        FileTask::Matcap => look::take_matcap(state, path),
        FileTask::Open => {
            let upright = state.known_files.upright.of(&path);
            let import = ImportOptions { upright, ..choice.import };
            requests.push(UiRequest::Run(Command::Open { path, import }));
        }
        FileTask::SaveAs(next) => {
            let path = with_ending(path, ENDING);
            let save = Command::Save { path, export: ExportOptions::default() };
            requests.push(match next.take() {
                Some(next) => UiRequest::SaveThen(save, next),
                None => UiRequest::Run(save),
            });
        }
        FileTask::Export => {
            let path = with_ending(path, EXPORT_ENDING);
            state.dialogs.export.open(path, requests);
        }
    }
}

fn import_options(ui: &mut Ui, choice: &mut Choice) {
    ui.label(RichText::new("Density threshold").strong());
    let existence = &mut choice.import.existence;
    let mut auto = *existence == Existence::Auto;
    ui.radio_value(&mut auto, true, "Automatic")
        .on_hover_text("Threshold chosen from the file's histogram");
    ui.horizontal(|ui| {
        ui.radio_value(&mut auto, false, "Manual");
        ui.add_enabled(!auto, DragValue::new(&mut choice.threshold))
            .on_hover_text("Lowest density that becomes a filled voxel, in the file's units");
    });
    *existence = if auto { Existence::Auto } else { Existence::Threshold(choice.threshold) };

    ui.add_space(8.0);
    ui.label(RichText::new("Colours").strong());
    let colouring = &mut choice.import.colouring;
    ComboBox::from_id_salt("colouring").selected_text(capital(&colouring.to_string())).show_ui(
        ui,
        |ui| {
            for (value, name) in Colouring::NAMED {
                ui.selectable_value(colouring, value, capital(name));
            }
        },
    );

    ui.add_space(8.0);
    ui.label(RichText::new("Meshes").strong());
    mesh_options(ui, &mut choice.import);

    ui.add_space(8.0);
    ui.label(RichText::new("Layout of a .raw file").strong());
    let field = TextEdit::singleline(&mut choice.raw).hint_text("128x256x256:u8");
    ui.add(field.desired_width(f32::INFINITY)).on_hover_text(
        "WIDTHxHEIGHTxDEPTH:TYPE[:skip=BYTES][:size=SX,SY,SZ]\n\
         where TYPE is u8, u16le, u16be, i16le, i16be, f32le, f32be, rgb8 or rgba8",
    );
    choice.import.raw = match choice.raw.trim() {
        "" => None,
        text => match text.parse::<RawLayout>() {
            Ok(layout) => Some(layout),
            Err(error) => {
                ui.colored_label(theme::error_colour(ui.visuals()), RichText::new(error).small());
                None
            }
        },
    };
}

/// How large a mesh becomes, and what of it.
fn mesh_options(ui: &mut Ui, import: &mut ImportOptions) {
    if let MeshSize::LongestVx(longest_vx) = &mut import.mesh_size {
        ui.add(DragValue::new(longest_vx).range(8..=MAX_AXIS_VX).suffix(" voxels"))
            .on_hover_text("Longest side of a mesh (.obj, .stl, .ply, .glb), in voxels");
    }
    let fill = &mut import.mesh_fill;
    ComboBox::from_id_salt("mesh fill").selected_text(capital(&fill.to_string())).show_ui(
        ui,
        |ui| {
            for (value, name) in MeshFill::NAMED {
                ui.selectable_value(fill, value, capital(name));
            }
        },
    );
}

/// The path with an ending, if it was typed without one.
fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    if path.extension().is_none() { path.with_extension(ending) } else { path }
}
