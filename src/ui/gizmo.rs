//! The axis gizmo: the axes of the grid in a corner of the picture, in their present orientation. A click on an end
//! views the sculpture from that side, a drag rotates it.

use egui::{Align2, Area, Color32, FontId, Id, Order, Pos2, Rect, Response, Sense, Stroke, Ui};
use egui::{WidgetInfo, WidgetType, vec2};
use glam::{Vec2, Vec3};

use crate::input::Action;
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::buttons::explain;
use crate::ui::widgets::theme;
use crate::ui::window_options::Theme;
use crate::viewpoint::turntable::side_facing;

/// Distance from the centre to the ends of the axes, in points.
const RADIUS: f32 = 32.0;
/// The radius of the discs at the ends.
const KNOB_RADIUS: f32 = 8.0;
/// Half the side of the click area around them.
const HIT_RADIUS: f32 = theme::LEAST_TARGET / 2.0;
/// Distance from the corner of the picture.
const MARGIN: f32 = 6.0;
/// The smallest picture that has room for it.
const LEAST_PICTURE: f32 = 240.0;

/// An end of an axis.
struct Knob {
    label: &'static str,
    axis: usize,
    /// A unit vector along the axis in the grid.
    towards: Vec3,
    /// Its direction in the picture: x right, y up, z to the viewer.
    seen: Vec3,
}

/// Shows the gizmo in the upper right corner of `within`.
pub fn show(
    root: &Ui,
    state: &UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
    within: Rect,
) {
    if within.width().min(within.height()) < LEAST_PICTURE {
        return;
    }
    let reach = RADIUS + HIT_RADIUS;
    Area::new(Id::new("axis gizmo"))
        // Below windows.
        .order(Order::Background)
        .fixed_pos(within.right_top() + vec2(-MARGIN - 2.0 * reach, MARGIN))
        .constrain(false)
        .show(root.ctx(), |ui| {
            let size = vec2(2.0 * reach, 2.0 * reach);
            let (rect, disc) = ui.allocate_exact_size(size, Sense::drag());
            if disc.hovered() || disc.dragged() {
                let fill = ui.visuals().text_color().gamma_multiply(0.12);
                ui.painter().circle_filled(rect.center(), reach, fill);
            }
            turn(&disc, requests);
            let mut knobs = knobs(&context.axes_in_picture);
            // Ends in front are drawn last, and receive a click first.
            knobs.sort_by(|a, b| a.seen.z.total_cmp(&b.seen.z));
            for knob in &knobs {
                knob.show(ui, rect.center(), state, context, requests);
            }
        });
}

fn knobs(axes_in_picture: &[Vec3; 3]) -> Vec<Knob> {
    let knob = |axis: usize, label, sign: f32| Knob {
        label,
        axis,
        towards: Vec3::AXES[axis] * sign,
        seen: axes_in_picture[axis] * sign,
    };
    let names = [["+X", "−X"], ["+Y", "−Y"], ["+Z", "−Z"]];
    (0..3)
        .flat_map(|axis| [knob(axis, names[axis][0], 1.0), knob(axis, names[axis][1], -1.0)])
        .collect()
}

/// Requests the rotation of a drag over the gizmo: the point under the pointer follows it, as on a ball.
fn turn(response: &Response, requests: &mut Vec<UiRequest>) {
    let by = response.drag_delta() / RADIUS;
    if response.dragged() && by != egui::Vec2::ZERO {
        requests.push(UiRequest::Turn(Vec2::new(by.x, by.y)));
    }
}

impl Knob {
    fn show(
        &self,
        ui: &Ui,
        middle: Pos2,
        state: &UiState,
        context: &UiContext,
        requests: &mut Vec<UiRequest>,
    ) {
        let at = middle + vec2(self.seen.x, -self.seen.y) * RADIUS;
        let rect = Rect::from_center_size(at, vec2(2.0, 2.0) * HIT_RADIUS);
        let response =
            ui.interact(rect, ui.id().with(("axis", self.label)), Sense::click_and_drag());
        response
            .widget_info(|| WidgetInfo::labeled(WidgetType::Button, ui.is_enabled(), self.label));
        turn(&response, requests);
        let action = side_facing(self.towards, state.view.up).map(Action::LookFrom);
        self.paint(ui, middle, at, state.appearance.theme, response.hovered());
        let Some(action) = action else { return };
        if explain(response, context, action).clicked() {
            requests.push(UiRequest::Do(action));
        }
    }

    /// Draws an end. Positive ends have a line and a letter; an end that points away from the viewer is fainter.
    fn paint(&self, ui: &Ui, middle: Pos2, at: Pos2, theme: Theme, hovered: bool) {
        let colour = colour(self.axis, theme);
        let strength = 0.7 + 0.3 * self.seen.z;
        let painter = ui.painter();
        let positive = self.towards.max_element() > 0.5;
        if positive {
            painter.line_segment([middle, at], Stroke::new(2.0, colour.gamma_multiply(strength)));
            painter.circle_filled(at, KNOB_RADIUS, colour.gamma_multiply(strength));
        } else {
            let fill = colour.gamma_multiply(0.25 * strength);
            let line = Stroke::new(1.2, colour.gamma_multiply(strength));
            painter.circle(at, KNOB_RADIUS - 1.0, fill, line);
        }
        if positive || hovered {
            let text = if positive { &self.label[1..] } else { self.label };
            let ink = if positive { Color32::BLACK } else { ui.visuals().text_color() };
            painter.text(at, Align2::CENTER_CENTER, text, FontId::proportional(11.0), ink);
        }
        if hovered {
            let ring = Stroke::new(1.5, ui.visuals().strong_text_color());
            painter.circle_stroke(at, KNOB_RADIUS, ring);
        }
    }
}

/// Returns red, green or blue, as is usual.
fn colour(axis: usize, theme: Theme) -> Color32 {
    let [dark, light] = [
        [(0xf0, 0x6a, 0x62), (0x86, 0xcf, 0x5a), (0x6a, 0xa4, 0xf4)],
        [(0xd6, 0x4a, 0x42), (0x4f, 0x9c, 0x2e), (0x3c, 0x78, 0xd8)],
    ];
    let (r, g, b) = match theme {
        Theme::Dark => dark[axis],
        Theme::Light => light[axis],
    };
    Color32::from_rgb(r, g, b)
}
