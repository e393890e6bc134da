//! The switches of the picture: stereo, video, lights, and rumble while a gamepad is connected. They are beside the
//! render mode if the bar along the top is wide enough, else in the menu.

use egui::{Button, Ui};

use crate::input::Action;
use crate::ui::context::UiContext;
use crate::ui::options::stereo;
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::buttons::{explain, menu_switch};
use crate::view::StereoLayout;

/// The widths of the switches in the bar, in points, and of the items to the right of them.
const WIDTH: f32 = 296.0;
const RUMBLE_WIDTH: f32 = 66.0;
const LIGHTS_WIDTH: f32 = 66.0;
const HELP_AND_MENU: f32 = 104.0;

/// Returns whether the bar has room for them.
pub fn fit(ui: &Ui, context: &UiContext) -> bool {
    if context.in_headset {
        return ui.available_width() >= LIGHTS_WIDTH + HELP_AND_MENU;
    }
    let rumble = if context.pad.is_some() { RUMBLE_WIDTH } else { 0.0 };
    ui.available_width() >= WIDTH + rumble + HELP_AND_MENU
}

/// A switch: its name, its state, its action.
type SwitchEntry = (&'static str, bool, Action);

fn switches(state: &UiState, context: &UiContext) -> Vec<SwitchEntry> {
    if context.in_headset {
        return vec![("Lights", state.dialogs.light.open, Action::Lights)];
    }
    let mut all = vec![
        ("Video", state.view.video.on, Action::ToggleVideo),
        ("Lights", state.dialogs.light.open, Action::Lights),
    ];
    if let Some(pad) = context.pad.filter(|pad| pad.rumbles) {
        all.push(("Rumble", pad.rumble_on, Action::ToggleRumble));
    }
    all
}

pub fn bar(ui: &mut Ui, state: &mut UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    ui.separator();
    if !context.in_headset {
        ui.label("Stereo");
        stereo::layouts(ui, state, context);
    }
    for (name, on, action) in switches(state, context) {
        let response = ui.add(Button::selectable(on, name));
        if explain(response, context, action).clicked() {
            requests.push(UiRequest::Do(action));
        }
    }
}

pub fn menu(ui: &mut Ui, state: &mut UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    if !context.in_headset {
        ui.menu_button("Stereo", |ui| {
            for layout in StereoLayout::ALL {
                stereo::layout(ui, state, context, layout);
            }
        });
    }
    for (name, mut on, action) in switches(state, context) {
        if menu_switch(ui, context, &mut on, name, action).changed() {
            requests.push(UiRequest::Do(action));
        }
    }
    ui.separator();
}
