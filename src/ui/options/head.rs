//! The interface of head tracking: a switch with the state of the tracker, a word in the status
//! line, and the window that leads through the calibration by four touches.

use egui::{Align2, Key, RichText, Ui, Window, vec2};

use crate::input::Action;
use crate::ui::widgets::buttons::{action_button, explain};
use crate::ui::{UiContext, UiRequest};
use crate::viewpoint::head::{CalibrationStep, HeadStatus};

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

/// Its part of the options.
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

/// Its part of the status line.
pub fn status(ui: &mut Ui, context: &UiContext) {
    if context.head.on {
        ui.separator();
        ui.strong(context.head.label()).on_hover_text(details(&context.head));
    }
}

const CORNERS: [&str; 4] = ["top left", "top right", "bottom right", "bottom left"];

/// The window of the calibration.
pub fn calibration(root: &Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let Some(calibration) = &context.head.calibration else { return };
    let mut ask = |step| requests.push(UiRequest::Calibrate(step));
    let frame = Window::new("Calibrate the head tracker").collapsible(false).resizable(false);
    frame.anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0)).show(root.ctx(), |ui| {
        ui.set_width(360.0);
        if let Some(corner) = CORNERS.get(calibration.taken) {
            ui.label("Touch this corner of the screen with the tracked object and hold it still:");
            ui.label(RichText::new(format!("{} of 4: {corner}", calibration.taken + 1)).heading());
            screen(ui, calibration.taken);
            ui.label("Then press Space, Record, or a button on the tracker.");
            let space = ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Space));
            if ui.button("Record").clicked() || space {
                ask(CalibrationStep::Take);
            }
        } else if let Some(rms_mm) = calibration.rms_mm {
            ui.label(format!("The four touches agree to within {rms_mm:.1} mm."));
            if rms_mm > 10.0 {
                ui.label(
                    "That is inaccurate. Check screen.size_m in the settings, then start again.",
                );
            }
            if ui.button("Save").clicked() {
                ask(CalibrationStep::Keep);
            }
        }
        if let Some(problem) = &calibration.problem {
            ui.colored_label(ui.visuals().warn_fg_color, problem);
        }
        ui.separator();
        ui.horizontal(|ui| {
            if ui.button("Start again").clicked() {
                ask(CalibrationStep::Again);
            }
            let escape =
                ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape));
            if ui.button("Cancel").clicked() || escape {
                ask(CalibrationStep::Cancel);
            }
        });
    });
}

/// The screen with the corner to touch.
fn screen(ui: &mut Ui, corner: usize) {
    let (rect, _) = ui.allocate_exact_size(vec2(128.0, 72.0), egui::Sense::hover());
    let rect = rect.shrink(6.0);
    let visuals = ui.visuals();
    ui.painter().rect_stroke(
        rect,
        2.0,
        visuals.widgets.noninteractive.fg_stroke,
        egui::StrokeKind::Inside,
    );
    let at = [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom()];
    ui.painter().circle_filled(at[corner.min(3)], 6.0, visuals.selection.bg_fill);
}
