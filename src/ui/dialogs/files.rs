//! The file dialogs, drawn by the program itself so that they work in a headset, too, with the options for a file
//! beside the list.

use std::path::{Path, PathBuf};

use egui::Ui;
use egui_file_dialog::{DialogState, FileDialog, Filter};

use crate::command::Command;
use crate::editor::tool::ToolEdit;
use crate::format::exports;
use crate::format::options::{ExportOptions, ImportOptions};
use crate::ui::dialogs::look;
use crate::ui::dialogs::shared::{Dialog, DialogContext, FileTask, Opening};
use crate::ui::request::UiRequest;

/// The ending of the program's own files.
const ENDING: &str = "vsc";
const SIDE_WIDTH: f32 = 170.0;

/// The file dialog and its task.
pub struct Files {
    dialog: FileDialog,
    task: FileTask,
    /// Folder of the file opened or saved last.
    folder: Option<PathBuf>,
    /// The export formats with their extensions. The first is the initial default.
    exports: Vec<(&'static str, &'static str)>,
    /// The format of the last export, as an index of them.
    export: usize,
}

impl Files {
    pub fn new() -> Files {
        Files {
            dialog: FileDialog::new(),
            task: FileTask::Open,
            folder: None,
            exports: exports(),
            export: 0,
        }
    }

    /// Returns the extension that Export proposes.
    pub fn export_ending(&self) -> &'static str {
        self.exports[self.export].1
    }

    /// Makes Export propose an extension from now on, if it has such a format.
    pub fn set_export_ending(&mut self, ending: &str) {
        let known = |(_, own): &(&str, &str)| own.eq_ignore_ascii_case(ending);
        self.export = self.exports.iter().position(known).unwrap_or(self.export);
    }

    /// Returns the folder in which dialogs open if no file names another.
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
            .add_file_filter(VOLUMES, Filter::new(crate::format::may_be_read))
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
            FileTask::Export => {
                let add = |dialog: FileDialog, (name, ending): &(&str, &str)| {
                    dialog.add_save_extension(name, ending)
                };
                let (chosen, ending) = self.exports[self.export];
                self.exports
                    .iter()
                    .fold(dialog.title("Export"), add)
                    .default_save_extension(chosen)
                    .default_file_name(&format!("{name}.{ending}"))
            }
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

impl Dialog for Files {
    fn is_open(&self) -> bool {
        Files::is_open(self)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let ask = &mut shared.ask_import;
        let Files { dialog, task, exports, export, .. } = self;
        // The library draws its search field black in any theme: dark text would be unreadable.
        dialog.config_mut().show_search = root.visuals().dark_mode;
        dialog.update_with_right_panel_ui(root.ctx(), &mut |ui, _| {
        ui.add_space(4.0);
        match task {
            FileTask::Open => {
                ui.label("Sculptures, scans, voxel models and meshes.");
                ui.add_space(8.0);
                ui.checkbox(ask, "Ask how to import").on_hover_text(
                    "Previews scans and meshes, and asks for thresholds, size and so on. Otherwise, or with Shift \
                     held, they open with the last choices",
                );
            }
            FileTask::SaveAs(_) => {
                ui.label("Keeps everything: all colours, the base colour, the texts of the file.");
                ui.add_space(8.0);
                ui.weak("Use Export to write files for other programs.");
            }
            FileTask::Export => {
                ui.label("Volumes, voxel models and meshes, chosen by the file extension.");
                ui.add_space(8.0);
                ui.weak("The options of the format come next.");
            }
            FileTask::Picture => {
                ui.label("The image is wrapped around the tool in Paint mode.");
            }
            FileTask::Reference => {
                ui.label("The image stands in the scene, on the side that you are looking from.");
            }
            FileTask::Matcap => {
                ui.label("A square image of a lit ball that touches all four edges.");
            }
        }
    });
        let Some(path) = dialog.take_picked() else { return };
        match task {
            FileTask::Picture => {
                shared.requests.push(UiRequest::Tool(ToolEdit::Picture(Some(path))));
            }
            FileTask::Reference => shared.requests.push(UiRequest::AddReference(path)),
            FileTask::Matcap => look::take_matcap(shared.view, shared.toasts, path),
            FileTask::Open => {
                let upright = shared.upright.of(&path);
                let import = ImportOptions { upright, ..ImportOptions::default() };
                let at_once = root.input(|input| input.modifiers.shift);
                shared.openings.push(Opening::Import { path, import, at_once });
            }
            FileTask::SaveAs(next) => {
                let path = with_ending(path, ENDING);
                let save = Command::Save { path, export: ExportOptions::default() };
                shared.requests.push(match next.take() {
                    Some(next) => UiRequest::SaveThen(save, next),
                    None => UiRequest::Run(save),
                });
            }
            FileTask::Export => {
                let path = with_ending(path, exports[*export].1);
                let ending = path.extension().unwrap_or_default().to_string_lossy();
                self.set_export_ending(&ending);
                shared.openings.push(Opening::Export(path));
            }
        }
    }
}

/// Returns the path, with `ending` if it was typed without one.
fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    if path.extension().is_none() { path.with_extension(ending) } else { path }
}

/// Returns the folder of a file, to open dialogs there.
pub fn folder_of(path: Option<&Path>) -> Option<PathBuf> {
    path.and_then(|p| p.parent()).filter(|p| !p.as_os_str().is_empty()).map(PathBuf::from)
}
