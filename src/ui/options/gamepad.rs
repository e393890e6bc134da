//! The options of a gamepad, shown while one is connected.

use egui::Ui;

use crate::controls::pads::PadStatus;
use crate::input::Action;
use crate::input::pad::PadMode;
use crate::ui::request::UiRequest;

pub fn show(ui: &mut Ui, pad: PadStatus, requests: &mut Vec<UiRequest>) {
    ui.label(pad.name);
    ui.horizontal(|ui| {
        if ui.button(pad.mode.label()).on_hover_text(Action::NextPadMode.help().text).clicked() {
            requests.push(UiRequest::Do(Action::NextPadMode));
        }
    });
    ui.label(egui::RichText::new(mode_hint(pad.mode)).weak());
    ui.add_enabled_ui(pad.rumbles, |ui| {
        let mut rumble = pad.rumble_on && pad.rumbles;
        let checkbox = ui
            .checkbox(&mut rumble, "Rumble")
            .on_hover_text("The gamepad vibrates while the tool cuts")
            .on_disabled_hover_text("This gamepad has no rumble");
        if checkbox.changed() {
            requests.push(UiRequest::Do(Action::ToggleRumble));
        }
    });
}

/// Returns a sentence that says what the sticks do in a mode.
pub const fn mode_hint(mode: PadMode) -> &'static str {
    match mode {
        PadMode::OnlyMouse => "Left stick: pointer; Y: click; A: double click",
        PadMode::UseTool => "Left stick: move the tool; right stick: rotate it; A: use it",
        PadMode::MoveGrid => "Left stick: move the sculpture; right stick: rotate it",
    }
}
