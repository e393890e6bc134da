//! The question before unsaved work is lost.

use egui::{Id, Modal, Ui};

use super::{Intent, UiState, theme};

pub fn show(root: &Ui, state: &mut UiState, intents: &mut Vec<Intent>) {
    if !state.leave_open {
        return;
    }
    let response = Modal::new(Id::new("leave")).show(root.ctx(), |ui| {
        ui.set_width(320.0);
        ui.heading("Save before quitting?");
        ui.add_space(4.0);
        ui.label("You have unsaved changes.");
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            if ui.add(theme::primary(ui.visuals(), "Save")).clicked() {
                state.leave_open = false;
                intents.push(Intent::SaveAndLeave);
            }
            if ui.button("Don't save").clicked() {
                state.leave_open = false;
                intents.push(Intent::Leave);
            }
            if ui.button("Cancel").clicked() {
                state.leave_open = false;
            }
        });
    });
    if response.should_close() {
        state.leave_open = false;
    }
}
