//! What the interface shows of the sculpture on a marker.

use egui::Ui;

use super::buttons::explain;
use super::{Facts, Intent, UiState};
use crate::input::Action;

/// What the interface reads of the marker.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ArFacts {
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

impl ArFacts {
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
pub fn options(ui: &mut Ui, state: &UiState, facts: &Facts, intents: &mut Vec<Intent>) {
    let mut on = facts.ar.on;
    let stand = ui.checkbox(&mut on, "Stand on the printed marker");
    if explain(stand, state, facts, Action::ToggleAr).changed() {
        intents.push(Intent::Do(Action::ToggleAr));
    }
    if facts.ar.on {
        ui.label(facts.ar.state());
    }
}

/// Its part of the status line.
pub fn status(ui: &mut Ui, facts: &Facts) {
    if facts.ar.on {
        ui.separator();
        let word = if facts.ar.seen { "Marker found" } else { "Marker not found" };
        ui.strong(word).on_hover_text(facts.ar.state());
    }
}
