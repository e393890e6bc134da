//! The sign over everything during long work: its name, its progress, the unfinished picture, and the button that stops
//! it.

use egui::{Color32, Id, Key, Modal, ProgressBar, Ui};

use crate::editor::job::Busy;
use crate::ui::dialogs::final_picture::Preview;
use crate::ui::request::UiRequest;
use crate::ui::widgets::names::capital;

const WIDTH: f32 = 320.0;
const WIDTH_WITH_PREVIEW: f32 = 420.0;

/// Shows the long work, if it has a sign. `preview`: the picture that it makes.
pub fn show(
    root: &Ui,
    busy: Option<&Busy>,
    preview: Option<&mut Preview>,
    requests: &mut Vec<UiRequest>,
) {
    let Some(busy) = busy.filter(|busy| busy.shown) else { return };
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
