//! The options of symmetry: mirror planes across the axes of the grid, one anywhere, and rotation around an axis.
//!
//! Gives a command for a change, and the part that the next press should place.

use egui::{DragValue, Ui};
use glam::Vec3;

use crate::command::Command;
use crate::editor::symmetry::{FIRST_COUNT, SymmetryPart};
use crate::editor::tool::{NextPress, ToolEdit};
use crate::input::{Action, Axis};
use crate::tools::symmetry::{MAX_IMAGES, MirrorPlane, Parity, Radial, Symmetry};
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::widgets::buttons::explain;

pub fn show(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    let mut symmetry = context.document.symmetry();
    axes(ui, context, &mut symmetry);
    plane(ui, context, &mut symmetry, requests);
    radial(ui, context, &mut symmetry, requests);
    if symmetry != context.document.symmetry() {
        requests.push(UiRequest::Run(Command::Symmetry(symmetry)));
    }
}

/// Shows a mirror plane across each axis: none, between two voxels, or through one.
fn axes(ui: &mut Ui, context: &UiContext, symmetry: &mut Symmetry) {
    for (axis, name) in Axis::ALL.into_iter().zip(["X", "Y", "Z"]) {
        ui.horizontal(|ui| {
            let parity = &mut symmetry.axes[axis.index()];
            let mut on = parity.is_some();
            let mirror = ui.checkbox(&mut on, format!("Mirror {name}"));
            if explain(mirror, context, Action::Mirror(axis)).changed() {
                *parity = on.then_some(Parity::Even);
            }
            if let Some(parity) = parity {
                ui.selectable_value(parity, Parity::Even, "Even")
                    .on_hover_text("The mirror plane lies between two voxels");
                ui.selectable_value(parity, Parity::Odd, "Odd")
                    .on_hover_text("The mirror plane passes through the middle of a voxel");
            }
        });
    }
}

/// Shows the free mirror plane.
fn plane(ui: &mut Ui, context: &UiContext, symmetry: &mut Symmetry, requests: &mut Vec<UiRequest>) {
    ui.horizontal(|ui| {
        let mut on = symmetry.plane.is_some();
        let switch = ui.checkbox(&mut on, "Plane");
        if explain(switch, context, Action::MirrorPlane).changed() {
            let at_vx = middle(context);
            symmetry.plane = on.then_some(MirrorPlane { at_vx, normal: Vec3::X });
        }
        let help = match context.in_headset {
            true => "Pull the trigger: the plane lies across your hand until you let go",
            false => "The next press on the surface puts the plane there, along the line of sight and upright in the picture",
        };
        place(ui, context, "Place plane", SymmetryPart::Plane, help, requests);
    });
    if let Some(MirrorPlane { at_vx, normal }) = &mut symmetry.plane {
        point(ui, "At", at_vx, "A point of the plane, in voxels");
        direction(ui, "Normal", normal, "Perpendicular to the plane");
    }
}

/// Shows the repetition around an axis.
fn radial(
    ui: &mut Ui,
    context: &UiContext,
    symmetry: &mut Symmetry,
    requests: &mut Vec<UiRequest>,
) {
    let planes = symmetry.axes.iter().flatten().count() + usize::from(symmetry.plane.is_some());
    let most = (MAX_IMAGES >> planes) as u32;
    ui.horizontal(|ui| {
        let mut on = symmetry.radial.is_some();
        let switch = ui.checkbox(&mut on, "Radial");
        if explain(switch, context, Action::Radial).changed() {
            let (at_vx, count) = (middle(context), FIRST_COUNT.min(most));
            symmetry.radial = on.then_some(Radial { at_vx, axis: Vec3::Y, count });
        }
        if let Some(radial) = &mut symmetry.radial {
            let count = DragValue::new(&mut radial.count).range(2..=most).speed(0.05).suffix(" ×");
            ui.add(count).on_hover_text("Number of copies of the tool around the axis");
        }
        let help = match context.in_headset {
            true => "Pull the trigger: the axis follows your hand until you let go",
            false => {
                "The next press on the surface puts the axis there, pointing out of the surface"
            }
        };
        place(ui, context, "Place axis", SymmetryPart::Axis, help, requests);
    });
    if let Some(Radial { at_vx, axis, .. }) = &mut symmetry.radial {
        point(ui, "Through", at_vx, "A point of the axis, in voxels");
        direction(ui, "Axis", axis, "Direction of the axis");
    }
}

fn middle(context: &UiContext) -> Vec3 {
    (context.document.contents().frame.home / 2).as_vec3()
}

/// Shows a button that makes the next press place something.
fn place(
    ui: &mut Ui,
    context: &UiContext,
    name: &str,
    what: SymmetryPart,
    help: &str,
    requests: &mut Vec<UiRequest>,
) {
    let next = NextPress::Symmetry(what);
    let mut on = context.tool.next_press == Some(next);
    if ui.toggle_value(&mut on, name).on_hover_text(help).changed() {
        requests.push(UiRequest::Tool(ToolEdit::NextPress(on.then_some(next))));
    }
}

fn point(ui: &mut Ui, name: &str, at: &mut Vec3, help: &str) {
    ui.horizontal(|ui| {
        ui.label(name);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let number = DragValue::new(&mut at[axis]).speed(0.5).range(-1e6..=1e6);
            ui.add(number.max_decimals(1)).on_hover_text(format!("{help}: {name}"));
        }
    });
}

/// Shows the numbers of a direction, and buttons for those along the grid. A direction without length is not applied.
fn direction(ui: &mut Ui, name: &str, direction: &mut Vec3, help: &str) {
    let before = *direction;
    ui.horizontal(|ui| {
        ui.label(name);
        for axis in 0..3 {
            let number = DragValue::new(&mut direction[axis]).speed(0.01).range(-1.0..=1.0);
            ui.add(number.max_decimals(2)).on_hover_text(help);
        }
    });
    ui.horizontal(|ui| {
        for (axis, name) in Vec3::AXES.into_iter().zip(["Along x", "Along y", "Along z"]) {
            if ui.button(name).on_hover_text(help).clicked() {
                *direction = axis;
            }
        }
    });
    if direction.length() < 1e-3 {
        *direction = before;
    }
}
