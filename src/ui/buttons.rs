//! Owns the buttons that stand for an action: their tooltip says what it does and which key does
//! the same, where there are keys.

use egui::{Response, RichText, Ui, WidgetText};

use super::{UiContext, UiRequest};
use crate::input::Action;

/// A button for `action`. Adds the action to `requests` when clicked.
pub fn action_button(
    ui: &mut Ui,
    context: &UiContext,
    label: impl Into<WidgetText>,
    action: Action,
    enabled: bool,
    requests: &mut Vec<UiRequest>,
) -> Response {
    let button = egui::Button::new(label.into());
    let response = explain(ui.add_enabled(enabled, button), context, action);
    if response.clicked() {
        requests.push(UiRequest::Do(action));
    }
    response
}

/// Gives a widget the tooltip of an action.
pub fn explain(response: Response, context: &UiContext, action: Action) -> Response {
    let tip = |ui: &mut Ui| {
        ui.label(action.help().text);
        if let Some(keys) = context.shortcut(action) {
            ui.label(RichText::new(keys).weak());
        }
    };
    response.on_hover_ui(tip).on_disabled_hover_ui(tip)
}
