//! Owns parts of a panel that fold away under their title, and stay as they were left from one start to the next.

use egui::{CollapsingHeader, RichText, Ui};

use crate::ui::UiState;

/// Shows `content` under a title. `open`: whether it is so at the very first.
pub fn show(
    ui: &mut Ui,
    title: RichText,
    open: bool,
    state: &mut UiState,
    content: impl FnOnce(&mut Ui, &mut UiState),
) {
    let name = title.text().to_string();
    let before = state.layout.sections.get(&name).copied().unwrap_or(open);
    let shown = CollapsingHeader::new(title)
        .open(Some(before))
        .show_unindented(ui, |ui| content(ui, state));
    if shown.header_response.clicked() {
        state.layout.sections.insert(name, !before);
        ui.ctx().request_repaint();
    }
    ui.add_space(4.0);
}
