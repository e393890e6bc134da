//! The options of the marker: its position, selection, copies, moves and fills.

use egui::{Button, DragValue, ScrollArea, Ui, vec2};
use glam::IVec3;

use crate::command::Command;
use crate::input::{Action, Axis};
use crate::sculpture::orientation::Orientation;
use crate::sculpture::region::VoxelBox;
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::widgets::buttons::{action_button, explain};
use crate::ui::widgets::names::grouped;
use crate::ui::widgets::theme;

const AXES: [&str; 3] = ["X", "Y", "Z"];
/// Number of selected boxes visible without scrolling.
const ROWS: f32 = 3.0;

pub fn show(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    bounds(ui, context, requests);
    buttons(
        ui,
        context,
        requests,
        &[
            ("Fill", Action::FillMarker),
            ("Recolour", Action::DyeMarker),
            ("Delete", Action::ClearMarker),
            ("Reset", Action::ResetTool),
        ],
    );
    heading(ui, "Selection");
    selection(ui, context, requests);
    heading(ui, "Contents");
    contents(ui, context, requests);
    copy(ui, context, requests);
}

fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(2.0);
    ui.label(egui::RichText::new(text).small().weak());
}

fn buttons(
    ui: &mut Ui,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
    entries: &[(&str, Action)],
) {
    ui.horizontal_wrapped(|ui| {
        for (label, action) in entries {
            action_button(ui, context, *label, *action, true, requests);
        }
    });
}

/// Shows the lower corner and the lengths as numbers.
fn bounds(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let (marker, origin) = (context.document.selection().marker(), context.document.origin());
    let (mut at, mut size) = (marker.min + origin, marker.size().as_ivec3());
    let mut changed = false;
    for (title, hint, values, least) in [
        ("From", "Lower corner of the marker along", &mut at, i32::MIN),
        ("Size", "Length of the marker along", &mut size, 1),
    ] {
        ui.horizontal(|ui| {
            ui.label(title);
            for (axis, name) in AXES.iter().enumerate() {
                let value = DragValue::new(&mut values[axis])
                    .range(least..=1 << 19)
                    .speed(0.5)
                    .prefix(format!("{name} "));
                let hint = format!("{hint} {name}, in voxels");
                changed |= ui.add(value).on_hover_text(hint).changed();
            }
        });
    }
    if changed {
        let far = IVec3::splat(1 << 19);
        let min = at.clamp(-far, far) - origin;
        requests.push(UiRequest::Run(Command::Mark(VoxelBox { min, max: min + size })));
    }
}

fn selection(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let selection = context.document.selection();
    let boxes = selection.boxes();
    ui.horizontal(|ui| {
        action_button(ui, context, "Add", Action::SelectMarker, true, requests);
        action_button(ui, context, "Subtract", Action::DeselectMarker, true, requests);
        let any = !boxes.is_empty();
        action_button(ui, context, "Deselect all", Action::ClearSelection, any, requests);
    });
    // The height does not depend on the number of boxes, so that buttons below keep their place.
    let row = ui.spacing().interact_size.y;
    let height = ROWS * (row + ui.spacing().item_spacing.y);
    ui.allocate_ui(vec2(ui.available_width(), height), |ui| {
        ui.set_min_height(height);
        let list = ScrollArea::vertical().id_salt("selection").auto_shrink(false);
        list.max_height(height).show_rows(ui, row, boxes.len().max(1), |ui, rows| {
            if boxes.is_empty() {
                ui.weak("Nothing selected");
            }
            for i in rows.filter_map(|row| boxes.len().checked_sub(row + 1)) {
                let at = boxes[i].bounds.min + context.document.origin();
                let size = boxes[i].bounds.size();
                let sign = if boxes[i].adds { "+" } else { "−" };
                ui.horizontal(|ui| {
                    ui.monospace(format!("{sign} {}×{}×{}", size.x, size.y, size.z))
                        .on_hover_text(format!("from {} {} {}", at.x, at.y, at.z));
                    if i + 1 == boxes.len() {
                        action_button(ui, context, "Remove", Action::DropBox, true, requests);
                    }
                });
            }
        });
    });
    let mut limits = selection.limits();
    let limit = ui.checkbox(&mut limits, "Limit tools to selection");
    if explain(limit, context, Action::ToggleLimit).changed() {
        requests.push(UiRequest::Do(Action::ToggleLimit));
    }
}

/// Shows the buttons that act on the voxels in the marker in place.
fn contents(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    buttons(ui, context, requests, &[("Copy", Action::Copy), ("Cut", Action::Cut)]);
    type Make = fn(usize) -> Orientation;
    let rows: [(&str, &str, Make); 2] = [
        ("Rotate", "Rotate the marker's contents 90° about", Orientation::quarter_turn),
        ("Mirror", "Mirror the marker's contents along", Orientation::mirroring),
    ];
    for (title, hint, make) in rows {
        ui.horizontal(|ui| {
            ui.label(title);
            for (axis, name) in AXES.into_iter().enumerate() {
                let button = Button::new(name).min_size(vec2(theme::LEAST_TARGET, 0.0));
                if ui.add(button).on_hover_text(format!("{hint} {name}")).clicked() {
                    let command = Command::Move { by: IVec3::ZERO, orientation: make(axis) };
                    requests.push(UiRequest::Run(command));
                }
            }
        });
    }
    let keys = context.shortcut(Action::MoveContents(crate::input::ScreenDirection::Left));
    if let Some(keys) = keys {
        ui.weak(format!("{keys} etc. to move"));
    }
}

/// Shows the copied voxels and the orientation for pasting.
fn copy(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    heading(ui, "Clipboard");
    let clip = context.document.clip();
    ui.horizontal(|ui| {
        action_button(ui, context, "Paste", Action::Paste, clip.is_some(), requests);
        let Some(clip) = clip else {
            ui.weak("Nothing copied");
            return;
        };
        let size = context.tool.paste_orientation.size(clip.size());
        ui.label(format!("{} × {} × {}", size.x, size.y, size.z))
            .on_hover_text(format!("{} voxels", grouped(clip.voxel_count())));
    });
    type Make = fn(Axis) -> Action;
    let rows: [(&str, Make); 2] = [("Rotate", Action::TurnClip), ("Mirror", Action::MirrorClip)];
    for (title, action) in rows {
        ui.horizontal(|ui| {
            ui.label(title);
            for (axis, name) in Axis::ALL.into_iter().zip(AXES) {
                action_button(ui, context, name, action(axis), clip.is_some(), requests);
            }
        });
    }
}
