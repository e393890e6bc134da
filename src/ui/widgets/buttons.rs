//! Owns the buttons of actions. Their tooltips describe the action and its key, if there is a keyboard.

use egui::{
    Atom, Button, Checkbox, Response, RichText, Ui, WidgetInfo, WidgetText, WidgetType, vec2,
};

use crate::input::Action;
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

/// Shows a button for `action`. Adds the action to `requests` when clicked.
pub fn action_button(
    ui: &mut Ui,
    context: &UiContext,
    label: impl Into<WidgetText>,
    action: Action,
    enabled: bool,
    requests: &mut Vec<UiRequest>,
) -> Response {
    // A label of one letter is wide enough, too.
    let button = Button::new(label.into()).min_size(vec2(theme::LEAST_TARGET, 0.0));
    let response = explain(ui.add_enabled(enabled, button), context, action);
    if response.clicked() {
        requests.push(UiRequest::Do(action));
    }
    response
}

/// Shows the menu entry of `action`, with its key at the right. Adds the action to `requests` when clicked.
pub fn menu_entry(
    ui: &mut Ui,
    context: &UiContext,
    label: &str,
    action: Action,
    requests: &mut Vec<UiRequest>,
) -> Response {
    let mut button = Button::new(label);
    if let Some(keys) = context.shortcut(action) {
        button = button.shortcut_text(keys);
    }
    let response = ui.add(button).on_hover_text(action.help().text);
    // The key is no part of its name.
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, ui.is_enabled(), label));
    if response.clicked() {
        requests.push(UiRequest::Do(action));
    }
    response
}

/// Shows the menu entry of an action that switches something on and off. Changes `on` instead of requesting the action.
pub fn menu_switch(
    ui: &mut Ui,
    context: &UiContext,
    on: &mut bool,
    label: &str,
    action: Action,
) -> Response {
    let keys = RichText::new(context.shortcut(action).unwrap_or_default()).weak();
    let response = ui.add(Checkbox::new(on, (label, Atom::grow(), keys)));
    let (is_enabled, on) = (ui.is_enabled(), *on);
    response.widget_info(|| WidgetInfo::selected(WidgetType::Checkbox, is_enabled, on, label));
    response.on_hover_text(action.help().text)
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
