//! Owns how a panel is detached off: the button in its head, and how it fills a window of its own; and
//! the way back while all panels are hidden.
//!
//! Knows no window: the owner of the windows makes one for each panel in [`UiState::detached`] and has it filled by
//! [`show`].

use egui::{Area, CentralPanel, Frame, Id, Margin, Order, Rect, Response, ScrollArea};
use egui::{Sense, Ui, pos2, vec2};
use egui::{WidgetInfo, WidgetType};

use crate::input::{Action, Panel};
use crate::ui::widgets::buttons::{action_button, explain};
use crate::ui::widgets::{icons, numbers, theme};
use crate::ui::{UiContext, UiRequest, UiState, history, options, toolbox};

const BUTTON: f32 = theme::LEAST_TARGET;
/// Height of the strip along the top of the picture in which the pointer brings up the way back.
const WAY_BACK_HEIGHT: f32 = 64.0;

/// A button in the upper left corner of `within` that shows the hidden panels again, for those who
/// have no keys. It is there while the pointer is near the top, so that it is in no picture.
pub fn way_back(root: &Ui, context: &UiContext, requests: &mut Vec<UiRequest>, within: Rect) {
    let strip = Rect::from_min_size(within.min, vec2(within.width(), WAY_BACK_HEIGHT));
    let near = root.input(|input| input.pointer.hover_pos().is_some_and(|at| strip.contains(at)));
    if !near {
        return;
    }
    Area::new(Id::new("way back"))
        .order(Order::Middle)
        .fixed_pos(within.left_top() + vec2(8.0, 8.0))
        .constrain_to(within)
        .show(root.ctx(), |ui| {
            action_button(ui, context, "Show panels", Action::TogglePanels, true, requests);
        });
}

/// Fills a window with a detached panel.
pub fn show(
    root: &mut Ui,
    panel: Panel,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    theme::apply(root.ctx(), state.appearance.theme, state.appearance.scale);
    theme::hear_slow_clicks(root.ctx());
    if !state.dialogs.files.is_open() {
        numbers::hear(root.ctx());
    }
    // A modal dialog over the sculpture has the person's attention.
    let enabled = !state.dialogs.is_modal();
    let frame = Frame::central_panel(root.style()).inner_margin(Margin::same(8));
    CentralPanel::default().frame(frame).show(root, |ui| {
        ui.add_enabled_ui(enabled, |ui| {
            head(ui, panel, state, context, requests);
            let scroll = ScrollArea::vertical().auto_shrink(false);
            match panel {
                Panel::Toolbox => {
                    scroll.show(ui, |ui| toolbox::content(ui, state, context, requests));
                }
                Panel::Options => {
                    scroll.show(ui, |ui| options::content(ui, state, context, requests));
                }
                // The list scrolls by itself.
                Panel::History => {
                    let height = ui.available_height() - 24.0;
                    history::show(ui, context, height, requests);
                }
            }
        });
    });
}

/// The line at the top of a panel, with the button that tears it off or puts it back.
pub fn head(
    ui: &mut Ui,
    panel: Panel,
    state: &UiState,
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
    detach_button(ui, place, panel, state, context, requests);
}

/// The button that tears a panel off or puts it back, at `place`.
pub fn detach_button(
    ui: &mut Ui,
    place: Rect,
    panel: Panel,
    state: &UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) -> Response {
    let detached = state.layout.detached.contains(&panel);
    let response = ui.interact(place, ui.id().with(("tear off", panel)), Sense::click());
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
