//! What is asked about a mesh: its size, which way is up, what becomes of its inside, with its outline in the box of
//! the grid that it would lie in.
//!
//! Takes a sample of its triangles; changes the options of the import.

use egui::{
    Color32, ComboBox, DragValue, Grid, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui, Vec2, pos2,
};
use glam::{Mat3, Vec3};

use super::OPTIONS_WIDTH;
use super::histogram::CLAY;
use crate::format::MeshStudy;
use crate::format::options::{Colouring, ImportOptions, MeshFill, MeshSize};
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::orientation::Up;
use crate::ui::top_bar::capital;
use crate::ui::upright;

/// From where a mesh is looked at first.
pub const VIEW: [f32; 2] = [0.6, 0.35];
/// Radians for each point that the pointer is dragged.
const TURN: f32 = 0.01;
const EDGE_MM: std::ops::RangeInclusive<f32> = 0.001..=1000.0;

/// Shows all that is asked in `room` points.
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

/// The mesh in the box of its grid, which is turned by dragging.
fn outline(
    ui: &mut Ui,
    study: &MeshStudy,
    options: &ImportOptions,
    view: &mut [f32; 2],
    side: f32,
) {
    let (square, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::drag());
    let by = response.drag_delta();
    view[0] = (view[0] + by.x * TURN) % std::f32::consts::TAU;
    view[1] = (view[1] + by.y * TURN).clamp(-1.5, 1.5);
    let painter = ui.painter_at(square);
    painter.rect_filled(square, 3.0, ui.visuals().extreme_bg_color);
    response.on_hover_text("The mesh in its grid. Drag to turn it");
    let Ok(frame) = study.frame(options) else { return };
    let dims = frame.dims.as_vec3();
    let seen = Seen::new(*view, dims, square);
    let line = Stroke::new(1.0, CLAY.gamma_multiply(0.55));
    let mut shapes = Vec::with_capacity(3 * study.sample.len());
    for triangle in &study.sample {
        let [a, b, c] = triangle.map(|corner| seen.at(frame.in_grid(corner)));
        shapes.extend([[a, b], [b, c], [c, a]].map(|edge| Shape::line_segment(edge, line)));
    }
    painter.extend(shapes);
    let edge = Stroke::new(1.0, ui.visuals().strong_text_color());
    painter
        .extend(box_edges(dims).map(|ends| Shape::line_segment(ends.map(|at| seen.at(at)), edge)));
    let floor = Color32::from_rgb(0x58, 0xa0, 0xe8);
    let up = [
        Vec3::ZERO,
        Vec3::new(dims.x, 0.0, 0.0),
        Vec3::new(dims.x, 0.0, dims.z),
        dims.with_y(0.0).with_x(0.0),
    ];
    painter.add(Shape::closed_line(up.map(|at| seen.at(at)).to_vec(), Stroke::new(2.0, floor)));
}

/// A parallel view of a box.
struct Seen {
    turn: Mat3,
    middle: Vec3,
    scale: f32,
    centre: Pos2,
}

impl Seen {
    /// `view`: angles about the vertical and from above.
    fn new([about, above]: [f32; 2], dims: Vec3, square: Rect) -> Seen {
        let turn = Mat3::from_rotation_x(above) * Mat3::from_rotation_y(about);
        // However it is turned, the box stays in the square.
        let scale = 0.95 * square.width() / dims.length().max(1.0);
        Seen { turn, middle: dims / 2.0, scale, centre: square.center() }
    }

    fn at(&self, point: Vec3) -> Pos2 {
        let seen = self.turn * (point - self.middle) * self.scale;
        pos2(self.centre.x + seen.x, self.centre.y - seen.y)
    }
}

/// The twelve edges of a box.
fn box_edges(dims: Vec3) -> impl Iterator<Item = [Vec3; 2]> {
    (0..3).flat_map(move |axis| {
        (0..4).map(move |corner| {
            let mut from = Vec3::ZERO;
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            from[u] = if corner & 1 == 0 { 0.0 } else { dims[u] };
            from[v] = if corner & 2 == 0 { 0.0 } else { dims[v] };
            let mut to = from;
            to[axis] = dims[axis];
            [from, to]
        })
    })
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
            ui.checkbox(&mut coloured, "Of the mesh")
                .on_hover_text("Colours of corners and textures; else the sculpture has none");
            options.colouring = if coloured { Colouring::Auto } else { Colouring::None };
            ui.end_row();
        }
    });
}

/// How large the mesh becomes: by the voxels of its longest side, or by the edge of a voxel.
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
        if field.on_hover_text("Voxels of the longest side of the mesh").changed() {
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
        if field.on_hover_text("Edge of a voxel; lengths of the mesh are kept").changed() {
            options.mesh_size = MeshSize::VoxelMm(edge_mm);
        }
    });
    ui.end_row();
}

fn inside(ui: &mut Ui, options: &mut ImportOptions) {
    let help = |fill: MeshFill| match fill {
        MeshFill::Auto => "Solid; of a mesh with large holes the surface alone",
        MeshFill::Solid => "Solid, even if there are large holes",
        MeshFill::Shell => "The surface alone, two voxels thick",
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_stays_in_its_square_however_it_is_turned_and_up_is_up() {
        let square = Rect::from_min_size(pos2(5.0, 7.0), Vec2::splat(100.0));
        let dims = Vec3::new(30.0, 200.0, 4.0);
        for step in 0..24 {
            let about = step as f32 * 0.3;
            let seen = Seen::new([about, 0.1 * step as f32 - 1.2], dims, square);
            assert!(box_edges(dims).flatten().all(|at| square.contains(seen.at(at))));
            assert!(seen.at(dims).y < seen.at(dims.with_y(0.0)).y);
        }
        assert_eq!(box_edges(dims).count(), 12);
    }
}
