//! The effects of a pen on the brush in hand, and the section of pens: the devices, and the pressure curve.

use egui::{Color32, Sense, Slider, Stroke, Ui, pos2, vec2};

use crate::editor::pen_use::PenUse;
use crate::editor::tool::ToolEdit;
use crate::input::pen::{EXPONENTS, FULL};
use crate::ui::context::UiContext;
use crate::ui::pens::PenState;
use crate::ui::request::UiRequest;
use crate::ui::widgets::spot::{self, Spot};

/// Leaves room for a name before it and a number after it.
const SLIDER_WIDTH: f32 = 80.0;
/// The size of the picture of the curve, in points.
const CURVE_SIZE: egui::Vec2 = vec2(120.0, 72.0);
/// Number of line segments of the curve.
const CURVE_STEPS: u32 = 40;

/// Shows checkboxes for the pen's effects on the brush in hand, if it has any.
pub fn leads(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let Some(brush) = context.tool.pen_tool() else { return };
    let before = context.tool.pens.of(brush);
    let mut chosen: PenUse = before;
    let (name, what) = match context.in_headset {
        true => ("Trigger", "Trigger travel"),
        false => ("Pressure", "Pen pressure"),
    };
    let row = ui.horizontal(|ui| {
        ui.label(name);
        if brush.has_strength() {
            ui.checkbox(&mut chosen.strength, "strength")
                .on_hover_text(format!("{what} controls strength"));
        }
        ui.checkbox(&mut chosen.size, "size").on_hover_text(format!("{what} controls size"));
    });
    if !context.in_headset {
        ui.horizontal(|ui| {
            ui.label("Tilt");
            ui.checkbox(&mut chosen.tilt, "widens").on_hover_text(
                "Tilting the pen widens the brush: at 45 degrees it is twice as large",
            );
        });
    }
    spot::mark(&row.response, Spot::Pressure);
    if chosen != before {
        requests.push(UiRequest::Tool(ToolEdit::Pen(chosen)));
    }
}

/// Shows the options of all pens.
pub fn section(ui: &mut Ui, pen: &mut PenState) {
    for name in &pen.devices {
        ui.label(name);
    }
    ui.spacing_mut().slider_width = SLIDER_WIDTH;
    egui::Grid::new("pen").num_columns(2).show(ui, |ui| {
        let label = ui.label("Curve");
        let slider = Slider::new(&mut pen.curve.exponent, EXPONENTS).logarithmic(true);
        ui.add(slider.max_decimals(2)).labelled_by(label.id).on_hover_text(
            "1 is linear; lower values strengthen a light touch, higher values weaken it",
        );
        ui.end_row();
        let label = ui.label("Full at");
        let mut percent = pen.curve.full_at * 100.0;
        let range = FULL.start() * 100.0..=FULL.end() * 100.0;
        let slider = Slider::new(&mut percent, range).fixed_decimals(0).suffix(" %");
        let hint = "The pressure that counts as full, as a share of the tablet's range";
        if ui.add(slider).labelled_by(label.id).on_hover_text(hint).changed() {
            pen.curve.full_at = percent / 100.0;
        }
        ui.end_row();
    });
    ui.horizontal(|ui| {
        picture(ui, pen);
        ui.vertical(|ui| {
            // The number of lines does not depend on a touching pen: nothing below moves while one draws.
            let share = |share: f32| format!("{:.0} %", share * 100.0);
            let touch = pen.touch;
            let [pressure, counted, tilt] = [
                touch.map(|touch| share(touch.pressure)),
                touch.map(|touch| share(pen.curve.of(touch.pressure))),
                touch.map(|touch| format!("{:.0}°", touch.lean_deg())),
            ]
            .map(|value| value.unwrap_or_else(|| "–".to_string()));
            let hint = "For the pen that is touching now: press it to see its effect";
            for line in [
                format!("Pressure {pressure}"),
                format!("counts as {counted}"),
                format!("Tilt {tilt}"),
            ] {
                ui.label(line).on_hover_text(hint);
            }
            if ui.button("Reset").clicked() {
                pen.curve = pen.usual;
            }
        });
    });
}

/// Draws the curve, with the present pressure on it.
fn picture(ui: &mut Ui, pen: &PenState) {
    let (rect, response) = ui.allocate_exact_size(CURVE_SIZE, Sense::hover());
    response.on_hover_text(
        "Horizontally the pressure, vertically the value it counts as; the dot is the pen that is touching now",
    );
    let visuals = ui.visuals();
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, visuals.extreme_bg_color);
    let at = |pressure: f32| {
        let counted = pen.curve.of(pressure);
        pos2(rect.min.x + pressure * rect.width(), rect.max.y - counted * rect.height())
    };
    let line = (0..=CURVE_STEPS).map(|i| at(i as f32 / CURVE_STEPS as f32)).collect();
    let colour: Color32 = visuals.text_color();
    painter.line(line, Stroke::new(1.5, colour));
    if let Some(touch) = pen.touch {
        painter.circle_filled(at(touch.pressure), 4.0, visuals.selection.bg_fill);
    }
}
