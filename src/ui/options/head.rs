//! The interface of head tracking: a switch with the state of the tracker, and a word in the status line.

use egui::Ui;

use crate::input::Action;
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::widgets::buttons::{action_button, explain};
use crate::viewpoint::head::HeadStatus;

fn details(head: &HeadStatus) -> String {
    let [x, y, z] = head.position_m.map(|v| v * 100.0);
    let [width, height] = head.screen_m.map(|v| v * 100.0);
    let guess = if head.guessed { " (estimated)" } else { "" };
    let state = head.state.as_deref().unwrap_or("connected");
    format!(
        "{}: {state}\n{:.0} poses per second, lost {} times, {} messages dropped\n\
             Head {x:.0} cm right, {y:.0} up, {z:.0} in front of the {width:.0} × {height:.0} cm screen\
             {guess}",
        head.source, head.rate_hz, head.losses, head.dropped
    )
}

/// Shows this section of the options.
pub fn options(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let mut on = context.head.on;
    let follow = ui.checkbox(&mut on, "Head tracking");
    if explain(follow, context, Action::ToggleHead).changed() {
        requests.push(UiRequest::Do(Action::ToggleHead));
    }
    if context.head.on {
        ui.label(details(&context.head));
    }
    action_button(ui, context, "Calibrate …", Action::CalibrateHead, true, requests);
}

/// Shows this part of the status line.
pub fn status(ui: &mut Ui, context: &UiContext) {
    if context.head.on {
        ui.separator();
        ui.strong(context.head.label()).on_hover_text(details(&context.head));
    }
}
