//! The column of tools on the left: which solid, and what it does.

use egui::{Frame, Margin, Panel, Rect, Sense, Ui, WidgetInfo, WidgetType, vec2};

use super::buttons::explain;
use super::top_bar::capital;
use super::{Facts, Intent, UiState, icons, theme};
use crate::input::{Action, ToolMode};
use crate::tools::construct::Solid;

const ICON: f32 = 26.0;

pub fn show(root: &mut Ui, state: &mut UiState, facts: &Facts, intents: &mut Vec<Intent>) {
    let frame = Frame::side_top_panel(root.style()).inner_margin(Margin::symmetric(6, 8));
    Panel::left("toolbox").frame(frame).resizable(false).exact_size(theme::TOOLBOX_WIDTH).show(
        root,
        |ui| {
            for solid in Solid::ALL {
                let chosen = state.hand.solid == solid;
                let name = capital(solid.name());
                tool(ui, state, facts, &name, chosen, Action::Solid(solid), intents);
            }
            ui.separator();
            for mode in ToolMode::ALL {
                let chosen = state.hand.mode == mode;
                tool(ui, state, facts, mode_name(mode), chosen, Action::Mode(mode), intents);
            }
        },
    );
}

/// What the interface calls a mode.
pub fn mode_name(mode: ToolMode) -> &'static str {
    match mode {
        ToolMode::Add => "Add",
        ToolMode::Subtract => "Cut",
        ToolMode::Recolour => "Paint",
    }
}

/// A button with a picture over its name.
fn tool(
    ui: &mut Ui,
    state: &UiState,
    facts: &Facts,
    name: &str,
    chosen: bool,
    action: Action,
    intents: &mut Vec<Intent>,
) {
    let size = vec2(ui.available_width(), ICON + 28.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| {
        WidgetInfo::selected(WidgetType::SelectableLabel, ui.is_enabled(), chosen, name)
    });
    let visuals = ui.style().interact_selectable(&response, chosen);
    if chosen || response.hovered() || response.has_focus() {
        ui.painter().rect(
            rect,
            visuals.corner_radius,
            if chosen { visuals.bg_fill } else { visuals.weak_bg_fill },
            visuals.bg_stroke,
            egui::StrokeKind::Inside,
        );
    }
    let icon =
        Rect::from_center_size(rect.center_top() + vec2(0.0, 7.0 + ICON / 2.0), vec2(ICON, ICON));
    let colour = visuals.text_color();
    match action {
        Action::Solid(solid) => icons::solid(ui.painter(), icon, solid, colour),
        Action::Mode(mode) => {
            let tint = if mode == ToolMode::Recolour && !chosen {
                let [r, g, b] = state.hand.colour.0;
                egui::Color32::from_rgb(r, g, b)
            } else {
                colour
            };
            icons::mode(ui.painter(), icon.shrink(2.0), mode, tint);
        }
        _ => {}
    }
    let below = rect.center_bottom() - vec2(0.0, 5.0);
    let font = egui::TextStyle::Small.resolve(ui.style());
    ui.painter().text(below, egui::Align2::CENTER_BOTTOM, name, font, colour);
    if explain(response, state, facts, action).clicked() {
        intents.push(Intent::Do(action));
    }
}
