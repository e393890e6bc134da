//! The questions about a mesh: its size, its up axis, and the treatment of its inside. Its outline is shown in the box
//! of its grid.
//!
//! Takes a sample of its triangles; changes the options of the import.

use egui::{ComboBox, DragValue, Grid, RichText, Sense, Shape, Stroke, Ui, Vec2};

use super::box_view::{self, BoxView};
use super::histogram::CLAY;
use super::widths::OPTIONS_WIDTH;
use crate::format::MeshStudy;
use crate::format::options::{Colouring, ImportOptions, MeshFill, MeshSize};
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::orientation::Up;
use crate::ui::memory::upright;
use crate::ui::widgets::names::capital;

/// Edges of a voxel, in millimetres.
pub const EDGE_MM: std::ops::RangeInclusive<f32> = 0.001..=1000.0;

/// Shows all questions in `room` points.
pub fn show(
    ui: &mut Ui,
    study: &MeshStudy,
    options: &mut ImportOptions,
    view: &mut [f32; 2],
    room: Vec2,
) {
    ui.weak(format!("{}, {} triangles", study.kind, study.count));
    for note in &study.notes {
        ui.label(RichText::new(capital(note)).small());
    }
    let side = (room.x - OPTIONS_WIDTH - 16.0).min(room.y - 80.0).max(120.0);
    ui.horizontal_top(|ui| {
        outline(ui, study, options, view, side);
        ui.add_space(4.0);
        ui.vertical(|ui| questions(ui, study, options));
    });
}

/// Shows the mesh in the box of its grid, which is rotated by dragging.
fn outline(
    ui: &mut Ui,
    study: &MeshStudy,
    options: &ImportOptions,
    view: &mut [f32; 2],
    side: f32,
) {
    let (square, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::drag());
    box_view::turn(view, &response);
    let painter = ui.painter_at(square);
    painter.rect_filled(square, 3.0, ui.visuals().extreme_bg_color);
    response.on_hover_text("The mesh in its grid. Drag to turn it");
    let Ok(frame) = study.frame(options) else { return };
    let seen = BoxView::new(*view, frame.dims.as_vec3(), square);
    let line = Stroke::new(1.0, CLAY.gamma_multiply(0.55));
    let mut shapes = Vec::with_capacity(3 * study.sample.len());
    for triangle in &study.sample {
        let [a, b, c] = triangle.map(|corner| seen.at(frame.in_grid(corner)));
        shapes.extend([[a, b], [b, c], [c, a]].map(|edge| Shape::line_segment(edge, line)));
    }
    painter.extend(shapes);
    seen.draw_box(&painter, ui.visuals());
}

fn questions(ui: &mut Ui, study: &MeshStudy, options: &mut ImportOptions) {
    ui.set_width(OPTIONS_WIDTH - 12.0);
    Grid::new("import mesh").num_columns(2).spacing([10.0, 6.0]).show(ui, |ui| {
        size(ui, study, options);
        inside(ui, options);
        up(ui, study, options);
        if study.has_colours {
            ui.label("Colours");
            let mut coloured = options.colouring != Colouring::None;
            ui.checkbox(&mut coloured, "Of the mesh").on_hover_text(
                "Colours of vertices and textures; otherwise the sculpture has none",
            );
            options.colouring = if coloured { Colouring::Auto } else { Colouring::None };
            ui.end_row();
        }
    });
}

/// Asks for the size of the mesh: the voxels of its longest side, or the edge of a voxel.
fn size(ui: &mut Ui, study: &MeshStudy, options: &mut ImportOptions) {
    let now = study.frame(options).ok();
    let longest = now.map_or(256, |frame| frame.dims.max_element()).clamp(1, MAX_AXIS_VX);
    let edge = now.map_or(1.0, |frame| frame.voxel_size.x).clamp(*EDGE_MM.start(), *EDGE_MM.end());
    let label = ui.label("Size");
    let by_voxels = matches!(options.mesh_size, MeshSize::LongestVx(_));
    ui.horizontal(|ui| {
        if ui.radio(by_voxels, "Longest side").clicked() {
            options.mesh_size = MeshSize::LongestVx(longest);
        }
        let mut voxels = longest;
        let field = DragValue::new(&mut voxels).range(1..=MAX_AXIS_VX).suffix(" voxels");
        let field = ui.add_enabled(by_voxels, field).labelled_by(label.id);
        if field.on_hover_text("Number of voxels along the longest side of the mesh").changed() {
            options.mesh_size = MeshSize::LongestVx(voxels);
        }
    });
    ui.end_row();
    ui.label("");
    ui.horizontal(|ui| {
        if ui.radio(!by_voxels, "Voxel of").clicked() {
            options.mesh_size = MeshSize::VoxelMm(edge);
        }
        let mut edge_mm = edge;
        let field = DragValue::new(&mut edge_mm).range(EDGE_MM).speed(0.01).suffix(" mm");
        let field = ui.add_enabled(!by_voxels, field).labelled_by(label.id);
        if field.on_hover_text("Edge length of a voxel; the mesh keeps its dimensions").changed() {
            options.mesh_size = MeshSize::VoxelMm(edge_mm);
        }
    });
    ui.end_row();
}

fn inside(ui: &mut Ui, options: &mut ImportOptions) {
    let help = |fill: MeshFill| match fill {
        MeshFill::Auto => "Solid; only the surface if the mesh has large holes",
        MeshFill::Solid => "Solid, even if there are large holes",
        MeshFill::Shell => "Only the surface, two voxels thick",
    };
    let label = ui.label("Inside");
    ComboBox::from_id_salt("fill")
        .width(120.0)
        .selected_text(capital(&options.mesh_fill.to_string()))
        .show_ui(ui, |ui| {
            for (fill, name) in MeshFill::NAMED {
                ui.selectable_value(&mut options.mesh_fill, fill, capital(name))
                    .on_hover_text(help(fill));
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text(help(options.mesh_fill));
    ui.end_row();
}

fn up(ui: &mut Ui, study: &MeshStudy, options: &mut ImportOptions) {
    let label = ui.label("Up");
    let mut up = study.up(options);
    let before = up;
    ui.add_enabled_ui(!study.knows_up(), |ui| {
        ComboBox::from_id_salt("up")
            .width(120.0)
            .selected_text(upright::label(up))
            .show_ui(ui, |ui| {
                for (axis, _) in Up::NAMED {
                    ui.selectable_value(&mut up, axis, upright::label(axis));
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text("The axis of the file that points up")
            .on_disabled_hover_text("The file says that y points up");
    });
    if up != before {
        options.upright = Some(up);
    }
    ui.end_row();
}
