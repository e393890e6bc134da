//! The dialogs for files, drawn by the program itself, so that they work in a headset too.

use std::path::{Path, PathBuf};

use egui::Ui;
use egui_file_dialog::{DialogState, FileDialog};

use super::state::{FileTask, folder_of};
use super::{Intent, UiState};
use crate::command::Command;

/// The ending of the program's own files.
const ENDING: &str = "pvm";

/// The file dialog and what it is open for.
pub struct Files {
    dialog: FileDialog,
    task: FileTask,
}

impl Files {
    pub fn new() -> Files {
        Files { dialog: FileDialog::new(), task: FileTask::Open }
    }

    pub fn is_open(&self) -> bool {
        matches!(self.dialog.state(), DialogState::Open)
    }

    /// Opens the dialog, in the folder of `path` if there is one.
    pub fn open(&mut self, task: FileTask, path: Option<&Path>) {
        let mut dialog = FileDialog::new()
            .add_file_filter_extensions("Volumes (.pvm)", vec![ENDING])
            .default_size([620.0, 400.0])
            .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .resizable(false)
            .movable(false);
        if let Some(folder) = folder_of(path) {
            dialog = dialog.initial_directory(folder);
        }
        let name = path.and_then(|p| p.file_stem()).map(|n| n.to_string_lossy().into_owned());
        dialog = match task {
            FileTask::Open => dialog.title("Open").default_file_filter("Volumes (.pvm)"),
            FileTask::SaveAs | FileTask::SaveAndLeave => dialog
                .title("Save as")
                .add_save_extension("Volume", ENDING)
                .default_save_extension("Volume")
                .default_file_name(&format!("{}.{ENDING}", name.as_deref().unwrap_or("sculpture"))),
        };
        match task {
            FileTask::Open => dialog.pick_file(),
            FileTask::SaveAs | FileTask::SaveAndLeave => dialog.save_file(),
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

pub fn show(root: &Ui, state: &mut UiState, intents: &mut Vec<Intent>) {
    let files = &mut state.files;
    files.dialog.update(root.ctx());
    let Some(path) = files.dialog.take_picked() else { return };
    match files.task {
        FileTask::Open => {
            intents.push(Intent::Run(Command::Open { path, import: Default::default() }))
        }
        FileTask::SaveAs => intents
            .push(Intent::Run(Command::Save { path: with_ending(path), form: Default::default() })),
        FileTask::SaveAndLeave => {
            intents.push(Intent::Run(Command::Save {
                path: with_ending(path),
                form: Default::default(),
            }));
            intents.push(Intent::Leave);
        }
    }
}

/// The path with an ending, if it was typed without one.
fn with_ending(path: PathBuf) -> PathBuf {
    if path.extension().is_none() { path.with_extension(ENDING) } else { path }
}
