//! Owns parts of a panel that fold away under their title, and stay so from one start to the next.

use egui::{CollapsingHeader, RichText, Ui};

use crate::ui::layout::PanelLayout;

/// Shows `content` under a title. `state`: the layout, which remembers the open sections, and what the content needs;
/// `open`: the initial state.
pub fn show<S: AsMut<PanelLayout>>(
    ui: &mut Ui,
    title: RichText,
    open: bool,
    state: &mut S,
    content: impl FnOnce(&mut Ui, &mut S),
) {
    let name = title.text().to_string();
    let before = state.as_mut().sections.get(&name).copied().unwrap_or(open);
    let shown = CollapsingHeader::new(title)
        .open(Some(before))
        .show_unindented(ui, |ui| content(ui, state));
    if shown.header_response.clicked() {
        state.as_mut().sections.insert(name, !before);
        ui.ctx().request_repaint();
    }
    ui.add_space(4.0);
}
