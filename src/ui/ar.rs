//! What the interface shows of the sculpture on a marker.

use egui::Ui;

use super::buttons::explain;
use super::{UiContext, UiRequest, UiState};
use crate::input::Action;

/// What the interface reads of the marker.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ArStatus {
    /// The sculpture stands on it.
    pub on: bool,
    /// Frames come from a camera.
    pub video: bool,
    /// The marker is in the picture.
    pub seen: bool,
    /// Its number.
    pub marker: u32,
    /// Size of a voxel on the table.
    pub voxel_mm: f32,
}

impl ArStatus {
    fn state(&self) -> String {
        match (self.video, self.seen) {
            (false, _) => "No video to find the printed marker in".to_owned(),
            (true, false) => format!("Looking for printed marker {}", self.marker),
            (true, true) => {
                format!("On printed marker {}, {:.2} mm per voxel", self.marker, self.voxel_mm)
            }
        }
    }
}

/// Its part of the options.
pub fn options(ui: &mut Ui, state: &UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let mut on = context.ar.on;
    let stand = ui.checkbox(&mut on, "Stand on the printed marker");
    if explain(stand, state, context, Action::ToggleAr).changed() {
        requests.push(UiRequest::Do(Action::ToggleAr));
    }
    if context.ar.on {
        ui.label(context.ar.state());
    }
}

/// Its part of the status line.
pub fn status(ui: &mut Ui, context: &UiContext) {
    if context.ar.on {
        ui.separator();
        let word = if context.ar.seen { "Marker found" } else { "Marker not found" };
        ui.strong(word).on_hover_text(context.ar.state());
    }
}
