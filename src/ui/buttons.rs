//! Owns the buttons that stand for an action: their tooltip says what it does and which key does
//! the same, where there are keys.

use egui::{Response, RichText, Ui, WidgetText};

use super::{Facts, Intent, UiState};
use crate::input::Action;

/// A button for `action`. Adds the action to `intents` when clicked.
pub fn action_button(
    ui: &mut Ui,
    state: &UiState,
    facts: &Facts,
    label: impl Into<WidgetText>,
    action: Action,
    enabled: bool,
    intents: &mut Vec<Intent>,
) -> Response {
    let button = egui::Button::new(label.into());
    let response = explain(ui.add_enabled(enabled, button), state, facts, action);
    if response.clicked() {
        intents.push(Intent::Do(action));
    }
    response
}

/// Gives a widget the tooltip of an action.
pub fn explain(response: Response, state: &UiState, facts: &Facts, action: Action) -> Response {
    let tip = |ui: &mut Ui| {
        ui.label(action.help().text);
        if let Some(keys) = facts.shortcut(state, action) {
            ui.label(RichText::new(keys).weak());
        }
    };
    response.on_hover_ui(tip).on_disabled_hover_ui(tip)
}
