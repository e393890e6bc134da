//! The window that leads through the calibration of a tracker by four touches of the screen's corners.
//!
//! Asks with the steps of the calibration; knows no tracker.

use egui::{Align2, Key, RichText, Ui, Window, vec2};

use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::viewpoint::head::CalibrationStep;

/// The window's own state.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Calibration {
    /// Set by the viewpoint.
    pub open: bool,
}

const CORNERS: [&str; 4] = ["top left", "top right", "bottom right", "bottom left"];

impl Dialog for Calibration {
    fn is_open(&self) -> bool {
        self.open
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let DialogContext { context, requests, .. } = shared;
        let Some(calibration) = &context.head.calibration else { return };
        let mut ask = |step| requests.push(UiRequest::Calibrate(step));
        let frame = Window::new("Calibrate the head tracker").collapsible(false).resizable(false);
        frame.anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0)).show(root.ctx(), |ui| {
            ui.set_width(360.0);
            if let Some(corner) = CORNERS.get(calibration.taken) {
                ui.label(
                    "Touch this corner of the screen with the tracked object and hold it still:",
                );
                ui.label(
                    RichText::new(format!("{} of 4: {corner}", calibration.taken + 1)).heading(),
                );
                screen(ui, calibration.taken);
                ui.label("Then press Space, Record, or a button on the tracker.");
                let space =
                    ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Space));
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
}

/// Draws the screen with the corner to touch.
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
