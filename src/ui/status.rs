//! The line along the bottom: the position of the tool, the size of the sculpture, the time of a picture.

use egui::{Align, Frame, Layout, Margin, Panel, Ui};

use crate::editor::tool::ToolKind;
use crate::input::Action;
use crate::ui::context::UiContext;
use crate::ui::options::{ar, draw_progress, gamepad, head};
use crate::ui::widgets::buttons::explain;
use crate::ui::widgets::names::grouped;
use crate::ui::widgets::theme;

pub fn show(root: &mut Ui, context: &UiContext) {
    let frame = Frame::side_top_panel(root.style()).inner_margin(Margin::symmetric(8, 3));
    Panel::bottom("status").frame(frame).show(root, |ui| {
        ui.horizontal(|ui| {
            let name = context.path.and_then(|p| p.file_name()).map(|n| n.to_string_lossy());
            let name = name.as_deref().unwrap_or("untitled");
            let star = if context.modified { " *" } else { "" };
            ui.label(format!("{name}{star}")).on_hover_text(if context.modified {
                "Unsaved changes"
            } else {
                "Saved"
            });
            if let Some(why) = &context.unsafe_because {
                ui.separator();
                let colour = theme::error_colour(ui.visuals());
                ui.colored_label(colour, "⚠ Not kept in the journal").on_hover_text(why);
            }
            ui.separator();
            place(ui, context);
            limit(ui, context);
            if let Some(pad) = context.pad {
                ui.separator();
                ui.strong(pad.mode.label()).on_hover_text(gamepad::mode_hint(pad.mode));
            }
            head::status(ui, context);
            ar::status(ui, context);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| right(ui, context));
        });
    });
}

/// Shows the position of the tool; for a spray, the point under it; for a drawing that waits for a press, its progress.
fn place(ui: &mut Ui, context: &UiContext) {
    if let Some(drawn) = context.drawn {
        ui.strong(draw_progress::line(drawn, context));
        return;
    }
    let origin = context.document.origin().as_vec3();
    let text = |what: &str, at: glam::Vec3| {
        let at = at + origin;
        format!("{what} {:.0} {:.0} {:.0}", at.x, at.y, at.z)
    };
    let (shown, tip) = match context.tool.kind {
        ToolKind::Brush(brush) if brush.spec().is_in_picture() => match context.pointed_vx {
            Some(at) => (text("Brush", at.as_vec3()), "Voxel under the pointer: x, y, z"),
            None => ("Brush".to_string(), "The pointer is not over the sculpture"),
        },
        ToolKind::Solid | ToolKind::Brush(_) => {
            (text("Tool", context.tool.centre_vx), "Centre of the tool in voxels: x, y, z")
        }
        ToolKind::Marker => {
            let marker = context.document.selection().marker();
            (text("Marker", marker.min.as_vec3()), "Lower corner of the marker in voxels: x, y, z")
        }
        ToolKind::Draw(_) => match context.pointed_vx {
            Some(at) => (text("Pointer", at.as_vec3()), "Voxel under the pointer: x, y, z"),
            None => ("Pointer".to_string(), "The pointer is not over the sculpture"),
        },
    };
    ui.monospace(shown).on_hover_text(tip);
}

/// Shows a sign while tools are limited to the selection.
fn limit(ui: &mut Ui, context: &UiContext) {
    if context.document.selection().limit().is_some() {
        ui.separator();
        let sign = ui.colored_label(ui.visuals().warn_fg_color, "Limited");
        explain(sign, context, Action::ToggleLimit);
    }
    if context.document.mask().is_some() {
        ui.separator();
        let sign = ui.colored_label(ui.visuals().warn_fg_color, "Masked");
        explain(sign, context, Action::Masks);
    }
}

fn right(ui: &mut Ui, context: &UiContext) {
    let times = context.times;
    ui.monospace(format!("{:>6.1} ms", times.total_ms)).on_hover_text(format!(
        "Time for the last frame, including {:.1} ms sampling and {:.1} ms shading\n{}",
        times.sample_ms, times.shade_ms, context.device
    ));
    ui.separator();
    let grid = context.document.grid();
    let dims = grid.dims();
    let bits = context.document.material().depth().bits();
    ui.label(format!("{} × {} × {}", dims.x, dims.y, dims.z))
        .on_hover_text(format!("Size of the grid in voxels, {bits} bits of colour per voxel"));
    ui.separator();
    ui.label(format!("{} voxels", grouped(grid.opaque_count()))).on_hover_text("Filled voxels");
}
