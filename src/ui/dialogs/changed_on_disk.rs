//! The question before overwriting a file that another program has changed.
//!
//! Takes the file; asks with requests, or leads to the choice of another name. Looks at no file.

use egui::{Id, Modal, Ui};

use crate::command::Command;
use crate::editor::questions::{ChangedOnDisk, Next};
use crate::format::options::ImportOptions;
use crate::ui::dialogs::shared::{Dialog, DialogContext, FileTask, Opening};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

impl Dialog for Option<ChangedOnDisk> {
    fn is_open(&self) -> bool {
        self.is_some()
    }

    fn close(&mut self) -> bool {
        self.take().is_some()
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let Some(file @ ChangedOnDisk { path, .. }) = &*self else { return };
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let mut is_answered = false;
        let mut save_as = false;
        let response = Modal::new(Id::new("changed on disk")).show(root.ctx(), |ui| {
        ui.set_width(380.0);
        ui.heading("The file has changed on disk");
        ui.add_space(4.0);
        ui.label(format!(
            "Another program has changed {name} since it was opened or saved here. Nothing has been overwritten."
        ))
        .on_hover_text(path.display().to_string());
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let button = ui.add(theme::primary(ui.visuals(), "Save as …"));
            if button.on_hover_text("Keep both: save yours under another name").clicked() {
                (is_answered, save_as) = (true, true);
            }
            let button = ui.button("Overwrite");
            if button.on_hover_text("Replace the file with yours; its changes are lost").clicked() {
                shared.requests.push(UiRequest::Overwrite(file.clone()));
                is_answered = true;
            }
            let button = ui.button("Reload");
            if button.on_hover_text("Open the file as it is now; undo restores your work").clicked() {
                let import = ImportOptions::default();
                let open = Command::Open { path: path.clone(), import };
                shared.requests.push(UiRequest::Go(Next::Run(open)));
                is_answered = true;
            }
            is_answered |= ui.button("Cancel").clicked();
        });
    });
        if !is_answered && !response.should_close() {
            return;
        }
        if let Some(ChangedOnDisk { path, next, .. }) = self.take()
            && save_as
        {
            shared.openings.push(Opening::Files(FileTask::SaveAs(next), Some(path)));
        }
    }
}
