//! What the interface shows of head tracking: a switch with the state of the tracker, a word in the
//! status line, and the window that leads through the calibration by four touches.

use egui::{Align2, Key, RichText, Ui, Window, vec2};
use tracking::Presence;

use super::buttons::{action_button, explain};
use super::{UiContext, UiRequest, UiState};
use crate::input::Action;

/// What the interface reads of the head.
#[derive(Clone, PartialEq, Debug)]
pub struct HeadStatus {
    /// The view follows it.
    pub on: bool,
    pub source: String,
    /// Why no poses can come, if none can.
    pub state: Option<String>,
    pub presence: Presence,
    /// Between the eyes, on the screen's axes.
    pub position_m: [f64; 3],
    pub rate_hz: f64,
    pub losses: u32,
    /// Messages that were broken or came too late to be read.
    pub dropped: u64,
    /// Width and height of the screen, and whether they are a guess.
    pub screen_m: [f32; 2],
    pub guessed: bool,
    /// While the tracker is being calibrated.
    pub calibration: Option<CalibrationStatus>,
}

/// How far the calibration has come.
#[derive(Clone, PartialEq, Debug)]
pub struct CalibrationStatus {
    /// Corners touched.
    pub taken: usize,
    /// How well the touches fit, once all were taken.
    pub rms_mm: Option<f64>,
    pub problem: Option<String>,
}

/// What the window of the calibration asks for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CalibrationStep {
    /// The corner at hand is being touched.
    Take,
    Again,
    Keep,
    Cancel,
}

impl HeadStatus {
    /// In a word.
    pub fn label(&self) -> &'static str {
        match self.presence {
            Presence::Tracked => "Head tracked",
            Presence::Returning => "Head found",
            Presence::Leaving => "Head lost",
            Presence::Absent => "No head",
        }
    }

    fn details(&self) -> String {
        let [x, y, z] = self.position_m.map(|v| v * 100.0);
        let [width, height] = self.screen_m.map(|v| v * 100.0);
        let guess = if self.guessed { " (estimated)" } else { "" };
        let state = self.state.as_deref().unwrap_or("connected");
        format!(
            "{}: {state}\n{:.0} poses per second, lost {} times, {} messages dropped\n\
             Head {x:.0} cm right, {y:.0} up, {z:.0} in front of the {width:.0} × {height:.0} cm screen\
             {guess}",
            self.source, self.rate_hz, self.losses, self.dropped
        )
    }
}

/// Its part of the options.
pub fn options(ui: &mut Ui, state: &UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let mut on = context.head.on;
    let follow = ui.checkbox(&mut on, "Head tracking");
    if explain(follow, state, context, Action::ToggleHead).changed() {
        requests.push(UiRequest::Do(Action::ToggleHead));
    }
    if context.head.on {
        ui.label(context.head.details());
    }
    action_button(ui, state, context, "Calibrate …", Action::CalibrateHead, true, requests);
}

/// Its part of the status line.
pub fn status(ui: &mut Ui, context: &UiContext) {
    if context.head.on {
        ui.separator();
        ui.strong(context.head.label()).on_hover_text(context.head.details());
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
