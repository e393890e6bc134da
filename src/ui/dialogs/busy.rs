//! The sign over everything while long work is under way: its name, its progress, the picture that is being made, and
//! the button that stops it.

use egui::{Color32, Id, Key, Modal, ProgressBar, Ui};

use crate::ui::top_bar::capital;
use crate::ui::{UiContext, UiRequest, UiState};

const WIDTH: f32 = 320.0;
const WIDTH_WITH_PREVIEW: f32 = 420.0;

pub fn show(root: &Ui, state: &mut UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let Some(busy) = state.dialogs.busy.as_ref().filter(|busy| busy.shown) else { return };
    // A texture belongs to one interface: that of the window.
    let preview = state.dialogs.preview.as_mut().filter(|_| !context.in_headset);
    let stop = Modal::new(Id::new("busy")).show(root.ctx(), |ui| {
        ui.set_width(if preview.is_some() { WIDTH_WITH_PREVIEW } else { WIDTH });
        ui.heading(busy.what);
        ui.add_space(4.0);
        if let Some(preview) = preview {
            preview.show(ui);
        }
        ui.label(capital(&busy.stage.what));
        ui.add(match busy.stage.done {
            Some(done) => ProgressBar::new(done).show_percentage(),
            None => ProgressBar::new(0.0).fill(Color32::TRANSPARENT),
        });
        ui.add_space(8.0);
        ui.button("Cancel").on_hover_text("Stop and leave everything as it was").clicked()
    });
    if stop.inner || root.input(|input| input.key_pressed(Key::Escape)) {
        requests.push(UiRequest::StopWork);
    }
}
