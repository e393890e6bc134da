//! The questions about a voxel model: its up axis, and the treatment of its colours. A picture of it and its palette
//! are shown.
//!
//! Takes its surface and palette; changes the options of the import. The picture is a texture of the interface that
//! shows it, remade when its contents have changed.

use egui::{
    Color32, ColorImage, ComboBox, Context, DragValue, Grid, Id, Pos2, Rect, RichText, Sense,
    TextureHandle, TextureOptions, Ui, Vec2, pos2,
};

use super::box_view::{self, BoxView};
use super::histogram::CLAY;
use super::mesh::EDGE_MM;
use super::voxel_picture;
use super::widths::OPTIONS_WIDTH;
use crate::format::ModelStudy;
use crate::format::options::{Colouring, ImportOptions, MeshSize};
use crate::sculpture::orientation::Up;
use crate::sculpture::{ColourDepth, Rgb};
use crate::ui::memory::upright;
use crate::ui::widgets::names::capital;

/// The most frequent colours of the palette are shown, so many at most; the second number is the side of each in
/// points.
const MOST_SWATCHES: usize = 96;
const SWATCH: f32 = 14.0;
const SWATCHES_A_ROW: usize = 15;
/// Most pixels of a side of the picture.
const MOST_PX: f32 = 1024.0;
/// The choices for the colours, with their texts.
const COLOURS: [(Option<ColourDepth>, &str, &str); 4] = [
    (Some(ColourDepth::Bits24), "As they are", "24 bits for each voxel"),
    (Some(ColourDepth::Bits16), "16 bits", "65 536 colours; less memory"),
    (Some(ColourDepth::Bits8), "8 bits", "256 colours; least memory"),
    (None, "None", "The whole sculpture has one colour"),
];

/// A picture, and the values that it depends on.
#[derive(Clone)]
struct ModelPicture {
    look: ModelPictureKey,
    texture: TextureHandle,
}

#[derive(Clone, Copy, PartialEq)]
struct ModelPictureKey {
    /// Identifies the model: its surface stays at this address while the dialog is open.
    surface: usize,
    view: [f32; 2],
    options: ImportOptions,
    side_px: usize,
}

fn id() -> Id {
    Id::new("model picture")
}

/// Forgets the picture of the last model.
pub fn forget(ctx: &Context) {
    ctx.data_mut(|data| data.remove::<ModelPicture>(id()));
}

/// Shows all questions in `room` points.
pub fn show(
    ui: &mut Ui,
    study: &ModelStudy,
    options: &mut ImportOptions,
    view: &mut [f32; 2],
    room: Vec2,
) {
    let voxels = if study.voxels == 1 { "voxel" } else { "voxels" };
    ui.weak(format!("{}, {} {voxels}", study.kind, study.voxels));
    for note in &study.notes {
        ui.label(RichText::new(capital(note)).small());
    }
    let side = (room.x - OPTIONS_WIDTH - 16.0).min(room.y - 80.0).max(120.0);
    ui.horizontal_top(|ui| {
        picture(ui, study, options, view, side);
        ui.add_space(4.0);
        ui.vertical(|ui| questions(ui, study, options));
    });
}

/// Shows the model in the box of its grid, which is rotated by dragging.
fn picture(
    ui: &mut Ui,
    study: &ModelStudy,
    options: &ImportOptions,
    view: &mut [f32; 2],
    side: f32,
) {
    let (square, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::drag());
    box_view::turn(view, &response);
    response.on_hover_text("The model in its grid. Drag to turn it");
    let painter = ui.painter_at(square);
    painter.rect_filled(square, 3.0, ui.visuals().extreme_bg_color);
    let seen = BoxView::new(*view, study.dims(options).as_vec3(), square);
    seen.draw_box(&painter, ui.visuals());
    let texture = texture(ui, study, options, *view, side);
    let uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    painter.image(texture.id(), square, uv, Color32::WHITE);
}

fn texture(
    ui: &Ui,
    study: &ModelStudy,
    options: &ImportOptions,
    view: [f32; 2],
    side: f32,
) -> TextureHandle {
    let side_px = (side * ui.pixels_per_point()).clamp(1.0, MOST_PX) as usize;
    let surface = study.surface.as_ptr() as usize;
    let look = ModelPictureKey { surface, view, options: *options, side_px };
    let before = ui.data(|data| data.get_temp::<ModelPicture>(id()));
    if let Some(shown) = before.as_ref().filter(|shown| shown.look == look) {
        return shown.texture.clone();
    }
    let [r, g, b, _] = CLAY.to_array();
    let colour = |rgb: Rgb| match (options.colouring, options.colour_depth) {
        (Colouring::None, _) => Rgb([r, g, b]),
        (_, Some(depth)) => depth.quantise(rgb),
        (_, None) => rgb,
    };
    let rgba = voxel_picture::draw(study, options, view, side_px, &colour);
    let image = ColorImage::from_rgba_unmultiplied([side_px; 2], &rgba);
    let texture = match before {
        Some(ModelPicture { mut texture, .. }) => {
            texture.set(image, TextureOptions::LINEAR);
            texture
        }
        None => ui.ctx().load_texture("model", image, TextureOptions::LINEAR),
    };
    let shown = ModelPicture { look, texture: texture.clone() };
    ui.data_mut(|data| data.insert_temp(id(), shown));
    texture
}

fn questions(ui: &mut Ui, study: &ModelStudy, options: &mut ImportOptions) {
    ui.set_width(OPTIONS_WIDTH - 12.0);
    Grid::new("import model").num_columns(2).spacing([10.0, 6.0]).show(ui, |ui| {
        up(ui, study, options);
        scale(ui, options);
        colours(ui, options);
    });
    ui.add_space(6.0);
    palette(ui, study);
}

fn up(ui: &mut Ui, study: &ModelStudy, options: &mut ImportOptions) {
    let label = ui.label("Up");
    let usual = study.up(&ImportOptions::default());
    let mut up = study.up(options);
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
        .on_hover_text(format!(
            "The axis of the file that points up; {} in this format",
            upright::label(usual)
        ));
    if up != study.up(options) {
        options.upright = Some(up);
    }
    ui.end_row();
}

/// Asks for the edge of a voxel.
fn scale(ui: &mut Ui, options: &mut ImportOptions) {
    let label = ui.label("Voxel");
    let mut edge_mm = match options.mesh_size {
        MeshSize::VoxelMm(edge) => edge,
        MeshSize::LongestVx(_) => 1.0,
    };
    let field = DragValue::new(&mut edge_mm).range(EDGE_MM).speed(0.01).suffix(" mm");
    let field = ui.add(field).labelled_by(label.id);
    if field.on_hover_text("Edge length of a voxel, which the file does not specify").changed() {
        options.mesh_size = MeshSize::VoxelMm(edge_mm);
    }
    ui.end_row();
}

fn colours(ui: &mut Ui, options: &mut ImportOptions) {
    let label = ui.label("Colours");
    let chosen = match options.colouring {
        Colouring::None => None,
        _ => Some(options.colour_depth.unwrap_or(ColourDepth::Bits24)),
    };
    let mut now = chosen;
    let (_, name, help) = COLOURS.iter().find(|(one, ..)| *one == chosen).unwrap_or(&COLOURS[0]);
    ComboBox::from_id_salt("colours")
        .width(120.0)
        .selected_text(*name)
        .show_ui(ui, |ui| {
            for (one, name, help) in COLOURS {
                ui.selectable_value(&mut now, one, name).on_hover_text(help);
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text(*help);
    if now != chosen {
        options.colouring = if now.is_some() { Colouring::Auto } else { Colouring::None };
        options.colour_depth = now;
    }
    ui.end_row();
}

/// Shows the most frequent colours with their number of voxels.
fn palette(ui: &mut Ui, study: &ModelStudy) {
    let count = study.palette.len();
    let colours = if count == 1 { "colour" } else { "colours" };
    ui.label(match count {
        ..=MOST_SWATCHES => format!("Palette: {count} {colours}"),
        _ => format!("Palette: {count} colours, of which these are the most frequent"),
    });
    for row in study.palette[..count.min(MOST_SWATCHES)].chunks(SWATCHES_A_ROW) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing = Vec2::splat(1.0);
            for (rgb, voxels) in row {
                let [r, g, b] = rgb.0;
                let (swatch, response) =
                    ui.allocate_exact_size(Vec2::splat(SWATCH), Sense::hover());
                ui.painter().rect_filled(swatch, 2.0, Color32::from_rgb(r, g, b));
                response.on_hover_text(format!("{rgb}: {voxels} voxels"));
            }
        });
    }
}
