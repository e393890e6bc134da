//! The options of the tool in hand that draws solids. Each tool shows those that it uses.

use std::ops::RangeInclusive;

use egui::{Grid, Slider, TextEdit, Ui};

use crate::editor::draw::DrawOptions;
use crate::editor::draw::glyphs::{Font, MOST_LETTERS};
use crate::editor::draw::options::{LENGTHS, RADII};
use crate::editor::tool::ToolEdit;
use crate::input::{DrawKind, ToolMode};
use crate::ui::context::UiContext;
use crate::ui::options::draw_progress;
use crate::ui::request::UiRequest;
use crate::ui::widgets::names::mode_name;
use crate::ui::widgets::numbers;

/// Leaves room for a name before it and a number with its unit after it.
const SLIDER_WIDTH: f32 = 80.0;

pub fn show(ui: &mut Ui, kind: DrawKind, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let mode = context.tool.mode;
    ui.label(format!("{} — {}", kind.spec().label, mode_name(mode).to_lowercase()));
    let before = &context.tool.draws;
    let mut options = before.clone();
    ui.spacing_mut().slider_width = SLIDER_WIDTH;
    if kind == DrawKind::Text {
        let hint = "The text to write";
        let field = ui.add(
            TextEdit::singleline(&mut options.text)
                .hint_text("Text")
                .char_limit(MOST_LETTERS)
                .desired_width(f32::INFINITY),
        );
        numbers::words(&field);
        field.on_hover_text(hint);
    }
    if kind == DrawKind::Box {
        ui.checkbox(&mut options.height_by_pointer, "Height by the pointer").on_hover_text(
            "After the base is dragged, the pointer raises or lowers the box, and a click finishes it. Off: the height is a number",
        );
    }
    let has_numbers = match kind {
        DrawKind::Lasso | DrawKind::Rectangle => mode == ToolMode::Add,
        DrawKind::Plane | DrawKind::Lathe => false,
        DrawKind::Box => !options.height_by_pointer,
        DrawKind::Line | DrawKind::Curve | DrawKind::Text => true,
    };
    if has_numbers {
        Grid::new("draw").num_columns(2).show(ui, |ui| numbers(ui, kind, mode, &mut options));
    }
    match kind {
        DrawKind::Line | DrawKind::Curve if !context.in_headset => {
            ui.checkbox(&mut options.on_surface, "Follow the surface").on_hover_text(
                "Off: the tube stays in the view plane through its start, whatever lies under the pointer",
            );
        }
        DrawKind::Lathe => {
            ui.checkbox(&mut options.upright, "Along the grid").on_hover_text(
                "Uses the grid axis that points up in the view. Off: the vertical of the picture",
            );
        }
        DrawKind::Text => {
            ui.horizontal(|ui| {
                ui.label("Font");
                for (font, name) in
                    [(Font::Bold, "Bold"), (Font::Light, "Light"), (Font::Mono, "Mono")]
                {
                    ui.selectable_value(&mut options.font, font, name);
                }
            });
        }
        _ => {}
    }
    let advice = match context.drawn {
        Some(drawn) => draw_progress::advice(drawn, context),
        None => advice(kind, mode, before).to_string(),
    };
    ui.add(egui::Label::new(egui::RichText::new(advice).small().weak()).wrap());
    if options != *before {
        requests.push(UiRequest::Tool(ToolEdit::Draw(options)));
    }
}

/// Shows the lengths that a tool uses.
fn numbers(ui: &mut Ui, kind: DrawKind, mode: ToolMode, options: &mut DrawOptions) {
    let mut number = |name: &str, value: &mut f32, range: RangeInclusive<f32>, hint: &str| {
        let label = ui.label(name);
        let slider = Slider::new(value, range).logarithmic(true).max_decimals(1).suffix(" vx");
        ui.add(slider).labelled_by(label.id).on_hover_text(hint);
        ui.end_row();
    };
    match kind {
        DrawKind::Lasso | DrawKind::Rectangle => {
            let hint =
                "Thickness of the slab along the line of sight, half of it behind the surface";
            number("Thickness", &mut options.thickness, LENGTHS, hint);
        }
        DrawKind::Box => {
            let hint = match mode {
                ToolMode::Add => "Height of the box above the face",
                _ => "Depth of the box below the face",
            };
            number("Height", &mut options.height, LENGTHS, hint);
        }
        DrawKind::Line | DrawKind::Curve => {
            let [start, end] = &mut options.radii;
            number("Start radius", start, RADII, "Radius of the tube where it begins");
            number("End radius", end, RADII, "Radius of the tube where it ends");
        }
        DrawKind::Text => {
            let hint = "Height of capital letters";
            number("Height", &mut options.text_height, LENGTHS, hint);
            let hint = "How far the letters rise above the surface, or cut into it";
            number("Depth", &mut options.text_depth, LENGTHS, hint);
        }
        DrawKind::Plane | DrawKind::Lathe => {}
    }
}

/// Returns advice on using the tool.
fn advice(kind: DrawKind, mode: ToolMode, options: &DrawOptions) -> &'static str {
    match (kind, mode) {
        (DrawKind::Lasso | DrawKind::Rectangle, ToolMode::Add) => {
            "Drag an outline over the picture: a slab of this shape is added where the drag begins."
        }
        (DrawKind::Lasso | DrawKind::Rectangle, _) => {
            "Drag an outline over the picture: it affects everything behind it."
        }
        (DrawKind::Plane, _) => {
            "Drag a line over the picture: it affects the hatched side, with Ctrl the other. Escape cancels."
        }
        (DrawKind::Box, _) if options.height_by_pointer => {
            "Drag the base on a face from corner to corner, let go, set the height, click."
        }
        (DrawKind::Box, _) => "Drag the base on a face from corner to corner.",
        (DrawKind::Line, _) => "Drag from end to end. A click makes a ball.",
        (DrawKind::Curve, _) => {
            "Draw the path of the tube, or click from point to point. Beside the sculpture it keeps its depth."
        }
        (DrawKind::Lathe, _) => {
            "Press on the axis and draw half of the outline; straight lines connect it to the axis."
        }
        (DrawKind::Text, _) => {
            "Press on the surface; the letters follow while you hold the button."
        }
    }
}
