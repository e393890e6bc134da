//! Owns the line at the top of a panel: its title, and the button that makes it a window of its own or docks it.
//!
//! Asks with requests; knows no panel's content.

use egui::{Rect, Response, Sense, Ui, WidgetInfo, WidgetType, pos2, vec2};

use super::context::UiContext;
use super::layout::PanelLayout;
use super::request::UiRequest;
use super::widgets::buttons::explain;
use super::widgets::{icons, theme};
use crate::input::{Action, Panel};

const BUTTON: f32 = theme::LEAST_TARGET;

/// Shows the line at the top of a panel, with the button that detaches or docks it.
pub fn head(
    ui: &mut Ui,
    panel: Panel,
    layout: &PanelLayout,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    let size = vec2(ui.available_width(), BUTTON);
    let (row, _) = ui.allocate_exact_size(size, Sense::hover());
    let font = egui::TextStyle::Small.resolve(ui.style());
    let colour = ui.visuals().weak_text_color();
    let left = pos2(row.left() + 2.0, row.center().y);
    ui.painter().text(left, egui::Align2::LEFT_CENTER, panel.title(), font, colour);
    let place = Rect::from_min_max(pos2(row.right() - BUTTON, row.top()), row.max);
    detach_button(ui, place, panel, layout, context, requests);
}

/// Shows the button that detaches or docks a panel, at `place`.
pub fn detach_button(
    ui: &mut Ui,
    place: Rect,
    panel: Panel,
    layout: &PanelLayout,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) -> Response {
    let detached = layout.detached.contains(&panel);
    let response = ui.interact(place, ui.id().with(("detach", panel)), Sense::click());
    response.widget_info(|| {
        let name = panel.title();
        let text = if detached { format!("Dock: {name}") } else { format!("Detach: {name}") };
        WidgetInfo::labeled(WidgetType::Button, ui.is_enabled(), text)
    });
    let visuals = ui.style().interact(&response);
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(place, visuals.corner_radius, visuals.weak_bg_fill);
    }
    icons::detach(ui.painter(), place.shrink(7.0), detached, visuals.text_color());
    let response = explain(response, context, Action::Detach(panel));
    if response.clicked() {
        requests.push(UiRequest::Do(Action::Detach(panel)));
    }
    response
}
