//! Fills the windows of detached panels, and shows the button that brings panels back while all are hidden.
//!
//! Knows no window: the owner of the windows makes one for each panel in [`crate::ui::layout::PanelLayout::detached`]
//! and has it filled by [`show`].

use egui::{Area, CentralPanel, Frame, Id, Margin, Order, Rect, ScrollArea};
use egui::{Ui, vec2};

use crate::input::{Action, Panel};
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::buttons::action_button;
use crate::ui::widgets::{numbers, theme};
use crate::ui::{history, options, panel_head, toolbox};

/// Height of the strip along the top of the picture in which the pointer reveals the button.
const STRIP_HEIGHT: f32 = 64.0;

/// Shows a button in the upper left corner of `within` that brings hidden panels back, for people without a keyboard.
/// It appears only while the pointer is near the top, so that pictures stay free of it.
pub fn show_panels_button(
    root: &Ui,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
    within: Rect,
) {
    let strip = Rect::from_min_size(within.min, vec2(within.width(), STRIP_HEIGHT));
    let near = root.input(|input| input.pointer.hover_pos().is_some_and(|at| strip.contains(at)));
    if !near {
        return;
    }
    Area::new(Id::new("show panels"))
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
    // A modal dialog over the sculpture has priority.
    let enabled = !state.dialogs.is_modal();
    let frame = Frame::central_panel(root.style()).inner_margin(Margin::same(8));
    CentralPanel::default().frame(frame).show(root, |ui| {
        ui.add_enabled_ui(enabled, |ui| {
            panel_head::head(ui, panel, &state.layout, context, requests);
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
