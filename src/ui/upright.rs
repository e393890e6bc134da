//! The question about the up axis of a volume, asked after opening a file that does not state it. One click turns the
//! sculpture, and later files of that format are read the same way.
//!
//! Shows a small bar over the picture, or in a headset above the options, while the sculpture is unchanged.
//! [`crate::ui::memory::upright`] remembers the answers. Reads no file.

use std::path::Path;

use egui::{Align2, Area, Button, Frame, Id, Margin, Order, Panel, Rect, Ui, vec2};
use glam::Vec3;

use crate::command::Command;
use crate::sculpture::history::State;
use crate::sculpture::orientation::Up;
use crate::ui::context::UiContext;
use crate::ui::memory::upright::{ending, label};
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;

/// From the upper edge of the picture, in points.
const MARGIN: f32 = 8.0;

/// Shows the question in a bar at the upper edge of `within`, if it applies.
pub fn show(
    root: &Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
    within: Rect,
) {
    let Some(asked) = Asked::now(state, context) else { return };
    let area = Area::new(Id::new("upright"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(within.center_top() + vec2(0.0, MARGIN))
        .constrain_to(within);
    let answer = area.show(root.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| ui.horizontal(|ui| asked.show(ui)).inner).inner
    });
    asked.take(answer.inner, state, requests);
}

/// Shows the question in a strip along the top of `root`, if it applies.
pub fn strip(
    root: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    let Some(asked) = Asked::now(state, context) else { return };
    let frame = Frame::side_top_panel(root.style()).inner_margin(Margin::symmetric(8, 5));
    let answer = Panel::top("upright")
        .frame(frame)
        .show(root, |ui| ui.horizontal(|ui| asked.show(ui)).inner)
        .inner;
    asked.take(answer, state, requests);
}

/// The question.
struct Asked<'a> {
    path: &'a Path,
    ending: String,
    assumed: Up,
    /// The state of the sculpture in question.
    sculpture: State,
}

#[derive(Clone, Copy, PartialEq)]
enum UprightAnswer {
    None,
    Up(Up),
    Dismissed,
}

impl<'a> Asked<'a> {
    /// Returns the question; `None` if the file states its axis, the sculpture has been changed, or the question was
    /// dismissed.
    fn now(state: &UiState, context: &UiContext<'a>) -> Option<Asked<'a>> {
        let (assumed, path) = (context.assumed_up?, context.path?);
        let sculpture = context.document.state();
        let upright = &state.known_files.upright;
        let put_off =
            upright.dismissed == Some(sculpture) || upright.answered.as_deref() == Some(path);
        let ending = ending(path).unwrap_or_default();
        let asked = !put_off && !state.dialogs.is_modal();
        asked.then_some(Asked { path, ending, assumed, sculpture })
    }

    fn show(&self, ui: &mut Ui) -> UprightAnswer {
        let mut answer = UprightAnswer::None;
        ui.label("Which axis points up?");
        for (up, _) in Up::NAMED {
            let button = Button::selectable(up == self.assumed, label(up));
            let what = match up == self.assumed {
                true => "It stands upright as it is",
                false => "Turn the sculpture so that this axis points up",
            };
            let hint = format!("{what}; .{} files open that way from now on", self.ending);
            if ui.add(button).on_hover_text(hint).clicked() {
                answer = UprightAnswer::Up(up);
            }
        }
        let close = ui.add(Button::new("✖").frame(false));
        if close.on_hover_text("Leave it as it is").clicked() {
            answer = UprightAnswer::Dismissed;
        }
        answer
    }

    fn take(&self, answer: UprightAnswer, state: &mut UiState, requests: &mut Vec<UiRequest>) {
        let Asked { path, ending, assumed, sculpture } = self;
        if let UprightAnswer::Up(up) = answer {
            state.known_files.upright.remember(path, up);
            state.known_files.recent.set_upright(path, up);
            state.toasts.note(format!(".{ending} files open with {} from now on", label(up)));
            if up != *assumed {
                // After this turn, y points up.
                state.view.up = Vec3::Y;
                let lying = assumed.turned_upright().inverse();
                requests.push(UiRequest::Run(Command::Orient(lying.then(up.turned_upright()))));
            }
        }
        if answer == UprightAnswer::Dismissed || answer == UprightAnswer::Up(*assumed) {
            state.known_files.upright.dismissed = Some(*sculpture);
        }
    }
}
