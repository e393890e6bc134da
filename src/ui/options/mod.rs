//! The column on the right: options of the tool, the light and the view, and the history.

pub mod ar;
mod brush;
pub mod draw;
pub mod draw_progress;
pub mod gamepad;
pub mod head;
pub mod marker;
pub mod pen;
pub mod stereo;
mod symmetry;
pub mod tool;
pub mod video;

use egui::{ComboBox, DragValue, Frame, Margin, RichText, ScrollArea, Ui};
use glam::Vec3;

use crate::command::Command;
use crate::document::MAX_ARRAY;
use crate::editor::tool::ToolEdit;
use crate::format;
use crate::input::{Action, Panel};
use crate::sculpture::history::SurfaceKind;
use crate::ui::context::UiContext;
use crate::ui::dialogs::light;
use crate::ui::dialogs::shared::FileTask;
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::buttons::{action_button, explain};
use crate::ui::widgets::spot::{self, Spot};
use crate::ui::widgets::{section, theme};
use crate::ui::{history, panel_head};

pub fn show(
    root: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    let docked =
        [Panel::Options, Panel::History].map(|panel| !state.layout.detached.contains(&panel));
    if docked == [false, false] {
        return;
    }
    let frame =
        Frame::side_top_panel(root.style()).inner_margin(Margin { right: 2, ..Margin::same(8) });
    egui::Panel::right("options")
        .frame(frame)
        .resizable(false)
        .exact_size(theme::OPTIONS_WIDTH)
        .show(root, |ui| {
            if docked[1] {
                past(ui, docked[0], state, context, requests);
            }
            if docked[0] {
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    ui.set_width(theme::OPTIONS_WIDTH - 24.0);
                    panel_head::head(ui, Panel::Options, &state.layout, context, requests);
                    content(ui, state, context, requests);
                });
            }
        });
}

/// Shows the history at the foot of the column, visible however long the options are.
fn past(
    ui: &mut Ui,
    shared: bool,
    state: &UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    let rows = ui.text_style_height(&egui::TextStyle::Body) * 9.0;
    let height = if shared { rows.min(0.25 * ui.available_height()) } else { f32::INFINITY };
    egui::Panel::bottom("history foot")
        .frame(Frame::NONE.inner_margin(Margin { top: 4, right: 6, ..Margin::ZERO }))
        .resizable(false)
        .show_separator_line(shared)
        .show(ui, |ui| {
            panel_head::head(ui, Panel::History, &state.layout, context, requests);
            history::show(ui, context, height, requests);
        });
}

/// Shows the options themselves.
pub fn content(
    ui: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    spot::begin(ui.ctx(), &mut state.layout.led_to, true);
    section(ui, "Tool", true, state, |ui, state| tool::show(ui, state, context, requests));
    section(ui, "Symmetry and array", false, state, |ui, _| {
        let symmetry = ui.scope(|ui| symmetry::show(ui, context, requests)).response;
        spot::mark(&symmetry, Spot::Symmetry);
        repeat(ui, context, requests);
    });
    section(ui, "View", false, state, |ui, state| view(ui, state, context, requests));
    if !context.in_headset {
        section(ui, "Head tracking and AR", false, state, |ui, state| {
            head::options(ui, context, requests);
            video::options(ui, state, context, requests);
            ar::options(ui, context, requests);
        });
    }
    if let Some(pad) = context.pad.filter(|_| !context.in_headset) {
        section(ui, "Gamepad", true, state, |ui, _| gamepad::show(ui, pad, requests));
    }
    if state.pen.is_there() && !context.in_headset {
        section(ui, "Pen", true, state, |ui, state| pen::section(ui, &mut state.pen));
    }
    section(ui, "Light", false, state, |ui, state| {
        action_button(ui, context, "Lights …", Action::Lights, true, requests);
        if light::surface(ui, &mut state.view) {
            state.dialogs.files.open(FileTask::Matcap, state.view.light.matcap.path());
        }
    });
}

fn section(
    ui: &mut Ui,
    title: &str,
    open: bool,
    state: &mut UiState,
    content: impl FnOnce(&mut Ui, &mut UiState),
) {
    section::show(ui, RichText::new(title).strong(), open, state, content);
}

/// Shows the repetition of the last operation.
fn repeat(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let mut array = context.tool.array;
    let row = ui.horizontal(|ui| {
        ui.label("Repeat");
        ui.add(DragValue::new(&mut array.count).range(1..=MAX_ARRAY).suffix(" times"))
            .on_hover_text("How many times to repeat the last operation");
        let can = context.document.can_repeat();
        action_button(ui, context, "Apply", Action::Repeat, can, requests);
    });
    spot::mark(&row.response, Spot::Array);
    ui.horizontal(|ui| {
        ui.label("Offset");
        for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
            let value = DragValue::new(&mut array.step[axis]).range(-4096..=4096);
            ui.add(value.prefix(format!("{name} ")).speed(0.5))
                .on_hover_text("Distance in voxels from one copy to the next");
        }
    });
    if array != context.tool.array {
        // Before the button that uses it.
        requests.insert(0, UiRequest::Tool(ToolEdit::Array(array)));
    }
}

fn view(ui: &mut Ui, state: &mut UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    ui.horizontal(|ui| {
        action_button(ui, context, "Frame all", Action::ResetView, true, requests);
        ui.label("Up axis");
        up_axis(ui, &mut state.view.up, requests);
    });
    if !context.in_headset {
        stereo::show(ui, state, context);
    }
    ui.horizontal(|ui| {
        let bounds = ui.checkbox(&mut state.view.bounds, "Grid outline");
        explain(bounds, context, Action::ToggleBounds);
        if !context.in_headset {
            let floor = ui.checkbox(&mut state.view.floor, "Floor grid");
            explain(floor, context, Action::ToggleFloor);
        }
    });
    ui.horizontal(|ui| {
        let mask = ui.checkbox(&mut state.view.mask, "Show mask");
        explain(mask, context, Action::ToggleMask);
        if !context.in_headset {
            let ground = ui.checkbox(&mut state.view.ground, "Ground");
            explain(ground, context, Action::ToggleGround);
        }
    });
    ui.checkbox(&mut state.view.tool, "Tool");
    ui.checkbox(&mut state.view.line, "Line from centre to tool");
    let edges = ui.checkbox(&mut state.view.smooth_edges, "Smooth edges in motion").on_hover_text(
        "Smooths outlines in one pass over the picture while something moves and in the headset; surface colours \
         stay sharp",
    );
    state.view.smooth_edges_is_automatic &= !edges.changed();
    if !context.in_headset {
        ui.horizontal(|ui| {
            let parallel = ui.checkbox(&mut state.view.orthographic, "Orthographic");
            explain(parallel, context, Action::ToggleOrthographic);
            let gizmo = ui.checkbox(&mut state.view.gizmo, "Axis gizmo");
            explain(gizmo, context, Action::ToggleGizmo);
        });
        ui.checkbox(&mut state.view.refine, "Smooth edges at rest").on_hover_text(
            "While nothing moves, the picture is refined to 16 samples per pixel for smooth edges",
        );
    }
    smooth_surface(ui, state, context, requests);
}

/// Chooses between a smooth surface and cubes, which is saved with the sculpture.
fn smooth_surface(
    ui: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    let own = context.document.contents().surface;
    let mut smooth = state.view.smooth_surface && own == SurfaceKind::Smooth;
    let row = ui.checkbox(&mut smooth, "Smooth surface").on_hover_text(format!(
        "Shows a smooth surface instead of cubes where a voxel covers more than a pixel: always in modes that run \
         entirely on a GPU, and in other modes except points once the picture is refined at rest. Saved with the \
         sculpture; off at first for models of cubes ({}). Export suggests the same surface",
        format::models_of_cubes_text()
    ));
    if !row.changed() {
        return;
    }
    // The settings may force cubes.
    state.view.smooth_surface |= smooth;
    let kind = if smooth { SurfaceKind::Smooth } else { SurfaceKind::Cubes };
    if kind != own {
        requests.push(UiRequest::Run(Command::Surface(kind)));
    }
}

const AXES: [(&str, Vec3); 6] = [
    ("x", Vec3::X),
    ("y", Vec3::Y),
    ("z", Vec3::Z),
    ("-x", Vec3::NEG_X),
    ("-y", Vec3::NEG_Y),
    ("-z", Vec3::NEG_Z),
];

fn up_axis(ui: &mut Ui, up: &mut Vec3, requests: &mut Vec<UiRequest>) {
    let name = AXES.iter().find(|(_, axis)| axis == up).map_or("", |(name, _)| name);
    ComboBox::from_id_salt("up").width(48.0).selected_text(name).show_ui(ui, |ui| {
        for (name, axis) in AXES {
            if ui.selectable_value(up, axis, name).clicked() {
                requests.push(UiRequest::Do(Action::ResetView));
            }
        }
    });
}
