//! The interface of the sculpture on a printed marker.

use egui::Ui;

use crate::input::Action;
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::widgets::buttons::explain;
use crate::viewpoint::ar::ArStatus;

fn state_text(ar: &ArStatus) -> String {
    match (ar.video, ar.seen) {
        (false, _) => "No video to find the printed marker in".to_owned(),
        (true, false) => format!("Looking for printed marker {}", ar.marker),
        (true, true) => {
            format!("On printed marker {}, {:.2} mm per voxel", ar.marker, ar.voxel_mm)
        }
    }
}

/// Shows this section of the options.
pub fn options(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let mut on = context.ar.on;
    let stand = ui.checkbox(&mut on, "Stand on the printed marker");
    if explain(stand, context, Action::ToggleAr).changed() {
        requests.push(UiRequest::Do(Action::ToggleAr));
    }
    if context.ar.on {
        ui.label(state_text(&context.ar));
    }
}

/// Shows this part of the status line.
pub fn status(ui: &mut Ui, context: &UiContext) {
    if context.ar.on {
        ui.separator();
        let word = if context.ar.seen { "Marker found" } else { "Marker not found" };
        ui.strong(word).on_hover_text(state_text(&context.ar));
    }
}
