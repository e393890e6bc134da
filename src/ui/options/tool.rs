//! The options of the tool in hand. A solid has size, rotation, colour and position; brushes and the marker have panels
//! of their own.

use egui::{Color32, DragValue, Response, Sense, Slider, Ui, vec2};
use glam::Vec3;

use crate::editor::tool::{HALF_RANGE, NextPress, RECENT, ToolEdit, ToolKind, ToolState};
use crate::input::{Action, ToolMode};
use crate::sculpture::{ColourDepth, Rgb};
use crate::ui::context::UiContext;
use crate::ui::dialogs::shared::FileTask;
use crate::ui::options::{brush, draw, marker, pen};
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::tasks::PasteAs;
use crate::ui::widgets::buttons::{action_button, explain};
use crate::ui::widgets::names::mode_name;
use crate::ui::widgets::spot::{self, Spot};
use crate::ui::widgets::theme;

const AXES: [&str; 3] = ["X", "Y", "Z"];
/// The greatest distance of a solid's centre from the corner of the grid, in voxels.
const FARTHEST_VX: f32 = 8192.0;
/// Radius of the corners of a colour's button, in points.
const SWATCH_CORNER: f32 = 3.0;
/// Colours of stone, metal, plants and water, and signal colours.
const PALETTE: [Rgb; 14] = [
    Rgb::new(0xf2, 0xee, 0xe6),
    Rgb::new(0xc8, 0xbe, 0xaa),
    Rgb::new(0x8c, 0x84, 0x78),
    Rgb::new(0x3c, 0x3a, 0x38),
    Rgb::new(0x6e, 0x46, 0x2a),
    Rgb::new(0xb9, 0x7a, 0x45),
    Rgb::new(0xd0, 0x5a, 0x32),
    Rgb::new(0xb8, 0x26, 0x2e),
    Rgb::new(0xe8, 0xb4, 0x3a),
    Rgb::new(0x7c, 0xa6, 0x3c),
    Rgb::new(0x2f, 0x6b, 0x3a),
    Rgb::new(0x4f, 0xa8, 0xb8),
    Rgb::new(0x2c, 0x5f, 0xa8),
    Rgb::new(0x7a, 0x4c, 0x9c),
];

pub fn show(ui: &mut Ui, state: &mut UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let tool = context.tool;
    match tool.kind {
        ToolKind::Solid => {
            let mode = mode_name(tool.mode).to_lowercase();
            ui.horizontal(|ui| {
                ui.label(format!("{} — {mode}", tool.solid.spec().label));
                ui.weak("with its centre at");
            });
            position(ui, context, requests);
            size(ui, tool, requests);
            rotation(ui, context, requests);
            colour(ui, context, requests);
            if tool.mode == ToolMode::Recolour {
                picture(ui, state, context, requests);
            }
            place(ui, context, requests);
            // By default a pen has no effect on a solid, and the column stays short.
            if context.in_headset || state.pen.is_there() {
                pen::leads(ui, context, requests);
            }
        }
        ToolKind::Brush(brush) => {
            brush::show(ui, brush, context, requests);
            pen::leads(ui, context, requests);
            if brush.spec().gives_colour {
                colour(ui, context, requests);
            }
            if brush.spec().image_spacing.is_some() {
                picture(ui, state, context, requests);
                if tool.stencil.is_some() {
                    let through = tool.through_stencil;
                    switch(ui, through, "Colour through it", ToolEdit::ThroughStencil, requests)
                        .on_hover_text(
                            "Paint the colour where the image is bright, instead of the image itself",
                        );
                }
            }
        }
        ToolKind::Draw(kind) => {
            draw::show(ui, kind, context, requests);
            colour(ui, context, requests);
        }
        ToolKind::Marker => {
            ui.label("Marker");
            marker::show(ui, context, requests);
            colour(ui, context, requests);
        }
    }
}

/// Shows a switch of the tool that is `on`. Requests `edit` when it is flipped.
fn switch(
    ui: &mut Ui,
    mut on: bool,
    text: &str,
    edit: fn(bool) -> ToolEdit,
    requests: &mut Vec<UiRequest>,
) -> egui::Response {
    let response = ui.checkbox(&mut on, text);
    if response.changed() {
        requests.push(UiRequest::Tool(edit(on)));
    }
    response
}

/// Shows the position of the tool.
fn place(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    if !context.in_headset {
        follow(ui, context, requests);
    }
    ui.horizontal(|ui| {
        let snap = switch(ui, context.tool.snap, "Snap to voxels", ToolEdit::Snap, requests);
        explain(snap, context, Action::ToggleSnap);
        action_button(ui, context, "Reset tool", Action::ResetTool, true, requests);
    });
}

/// Shows how the tool follows a pointer. In a headset it is where the hand is.
fn follow(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let tool = context.tool;
    let follow = switch(ui, tool.follow, "Follow the pointer", ToolEdit::Follow, requests);
    explain(follow, context, Action::ToggleFollow);
    ui.add_enabled_ui(tool.follow, |ui| {
        switch(ui, tool.stand, "Rest on the surface", ToolEdit::Stand, requests)
            .on_hover_text("The tool rests on the surface instead of being half sunk into it");
        switch(ui, tool.lean, "Align with the surface", ToolEdit::Lean, requests)
            .on_hover_text("The tool's y axis points out of the surface");
    });
}

/// Shows the picture that a solid paints with instead of one colour.
fn picture(ui: &mut Ui, state: &mut UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let tool = context.tool;
    let row = ui.horizontal(|ui| {
        if ui
            .button("Image …")
            .on_hover_text("Paint with a PNG or JPEG image wrapped around a solid, or held under the brush as a stencil")
            .clicked()
        {
            state.dialogs.files.open(FileTask::Picture, tool.picture_in_use().map(|p| p.as_path()));
        }
        // In a headset, no picture can have been copied.
        if !context.in_headset
            && ui.button("Paste").on_hover_text("Paint with the image on the clipboard").clicked()
        {
            state.window_tasks.paste = Some(PasteAs::ToolPicture);
        }
        let Some(picture) = tool.picture_in_use() else {
            ui.weak("Plain colour");
            return;
        };
        let name = picture.file_name().unwrap_or(picture.as_os_str()).to_string_lossy();
        ui.add(egui::Label::new(name).truncate()).on_hover_text(picture.display().to_string());
        if ui.button("✖").on_hover_text("Paint with the plain colour again").clicked() {
            requests.push(UiRequest::Tool(ToolEdit::Picture(None)));
        }
    });
    spot::mark(&row.response, Spot::Stencil);
}

/// Shows the position of a solid as numbers, in signed coordinates.
fn position(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    ui.horizontal(|ui| {
        let origin = context.document.origin().as_vec3();
        let mut centre_vx = context.tool.centre_vx + origin;
        let mut changed = false;
        for (axis, name) in AXES.iter().enumerate() {
            let value = DragValue::new(&mut centre_vx[axis])
                .range(-FARTHEST_VX..=FARTHEST_VX)
                .speed(0.25)
                .max_decimals(1)
                .prefix(format!("{name} "));
            let hint = format!(
                "Centre along the grid's {name} axis in voxels; the tool then stays there instead of following the pointer"
            );
            changed |= ui.add(value).on_hover_text(hint).changed();
        }
        if changed {
            requests.push(UiRequest::Tool(ToolEdit::Place(centre_vx - origin)));
        }
    });
}

fn size(ui: &mut Ui, tool: &ToolState, requests: &mut Vec<UiRequest>) {
    let range = 2.0 * HALF_RANGE.start()..=2.0 * HALF_RANGE.end();
    ui.horizontal(|ui| {
        let label = ui.label("Size");
        let longest = 2.0 * tool.half().max_element();
        let mut size = longest;
        let slider = Slider::new(&mut size, 1.0..=512.0)
            .logarithmic(true)
            .clamping(egui::SliderClamping::Never)
            .max_decimals(1);
        let response = ui.add(slider).labelled_by(label.id);
        if response.on_hover_text("Longest side in voxels").changed() {
            requests.push(UiRequest::Tool(ToolEdit::Scale(size / longest)));
        }
    });
    ui.horizontal(|ui| {
        for (axis, name) in AXES.iter().enumerate() {
            let mut size = 2.0 * tool.half()[axis];
            let speed = 0.02 * size.max(1.0);
            let value = DragValue::new(&mut size)
                .range(range.clone())
                .speed(speed)
                .max_decimals(1)
                .prefix(format!("{name} "));
            let hint = format!("Size along the tool's {name} axis in voxels");
            if ui.add(value).on_hover_text(hint).changed() {
                requests.push(UiRequest::Tool(ToolEdit::Half { axis, half: 0.5 * size }));
            }
        }
    });
    ui.horizontal(|ui| {
        switch(ui, tool.uniform, "Keep proportions", ToolEdit::Uniform, requests)
            .on_hover_text("Scale all sides together");
        let sides = tool.half();
        let even = sides.max_element() - sides.min_element() < 1e-3;
        if ui
            .add_enabled(!even, egui::Button::new("Equal"))
            .on_hover_text("Make all sides equal")
            .clicked()
        {
            requests.push(UiRequest::Tool(ToolEdit::EvenOut));
        }
    });
}

fn rotation(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let mut turn_deg = context.tool.turn_deg();
    ui.horizontal(|ui| {
        ui.label("Rotation");
        let turned = turn_deg != Vec3::ZERO;
        action_button(ui, context, "Reset", Action::AlignTool, turned, requests);
    });
    ui.horizontal(|ui| {
        let mut changed = false;
        for (axis, name) in AXES.iter().enumerate() {
            let value = DragValue::new(&mut turn_deg[axis])
                .range(-180.0..=180.0)
                .speed(1.0)
                // Without the minus sign of values that round to zero.
                .custom_formatter(|deg, _| format!("{:.0}", deg.round() + 0.0))
                .prefix(format!("{name} "))
                .suffix("°");
            let hint = format!("Rotation about the grid's {name} axis");
            changed |= ui.add(value).on_hover_text(hint).changed();
        }
        if changed {
            requests.push(UiRequest::Tool(ToolEdit::Turn(turn_deg)));
        }
    });
}

fn colour(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    if context.document.material().depth() == ColourDepth::None {
        ui.weak("This sculpture has only one colour");
        return;
    }
    let tool = context.tool;
    let mut colour = tool.colour;
    ui.horizontal(|ui| {
        let label = ui.label("Colour");
        let button = ui.color_edit_button_srgb(&mut colour.0).labelled_by(label.id);
        button.on_hover_text(tool.colour.to_string());
        let keys = |action| match context.shortcut(action) {
            Some(keys) => format!(" ({keys})"),
            None => String::new(),
        };
        let pick =
            format!("The next press picks the colour of the surface{}", keys(Action::PickColour));
        next_press(ui, tool, NextPress::Pick, "🖊 Pick", &pick, requests);
        let flood = format!(
            "The next press recolours the patch of one colour that it hits{}",
            keys(Action::Flood)
        );
        next_press(ui, tool, NextPress::Flood, "💧 Flood", &flood, requests);
    });
    swatches(ui, &PALETTE, PALETTE.len(), &mut colour);
    ui.label(egui::RichText::new("Recent").small().weak());
    swatches(ui, tool.recent(), RECENT, &mut colour);
    if colour != tool.colour {
        requests.push(UiRequest::Tool(ToolEdit::Colour(colour)));
    }
}

/// Shows a button that sets the action of the next press.
fn next_press(
    ui: &mut Ui,
    tool: &ToolState,
    next: NextPress,
    label: &str,
    help: &str,
    requests: &mut Vec<UiRequest>,
) {
    let mut on = tool.next_press == Some(next);
    if ui.toggle_value(&mut on, label).on_hover_text(help).changed() {
        requests.push(UiRequest::Tool(ToolEdit::NextPress(on.then_some(next))));
    }
}

/// Shows colours to choose from. Reserves room for `most` of them, so that nothing below moves when there are more.
fn swatches(ui: &mut Ui, colours: &[Rgb], most: usize, chosen: &mut Rgb) {
    const GAP: f32 = 4.0;
    let side = theme::LEAST_TARGET;
    let in_row = (((ui.available_width() + GAP) / (side + GAP)) as usize).max(1);
    let rows = most.div_ceil(in_row);
    let before = *chosen;
    let size = vec2(ui.available_width(), rows as f32 * (side + GAP) - GAP);
    let (room, all) = ui.allocate_exact_size(size, Sense::hover());
    for i in 0..most {
        let (x, y) = ((i % in_row) as f32, (i / in_row) as f32);
        let at = room.min + vec2(x, y) * (side + GAP);
        let rect = egui::Rect::from_min_size(at, vec2(side, side));
        let Some(colour) = colours.get(i) else {
            let rim = ui.visuals().widgets.noninteractive.bg_stroke;
            ui.painter().rect_stroke(rect, SWATCH_CORNER, rim, egui::StrokeKind::Inside);
            continue;
        };
        // Not allocated one by one: the room would end at the last of them.
        let response = ui.interact(rect, all.id.with(i), Sense::click());
        if swatch(ui, response, *colour, *colour == before) {
            *chosen = *colour;
        }
    }
}

fn swatch(ui: &Ui, response: Response, colour: Rgb, chosen: bool) -> bool {
    let rect = response.rect;
    let [r, g, b] = colour.0;
    let rim = if chosen || response.hovered() {
        egui::Stroke::new(2.0, ui.visuals().strong_text_color())
    } else {
        egui::Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color)
    };
    let fill = Color32::from_rgb(r, g, b);
    ui.painter().rect(rect, SWATCH_CORNER, fill, rim, egui::StrokeKind::Inside);
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::WidgetType::ColorButton, true, chosen, colour.to_string())
    });
    response.on_hover_text(colour.to_string()).clicked()
}
