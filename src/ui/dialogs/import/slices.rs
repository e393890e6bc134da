//! Three slices of a volume in its final orientation, with existing voxels coloured, the region as a frame, and
//! cross-hairs to drag.
//!
//! Takes a volume and the options; changes the shown slices. The pictures are textures of the interface that shows
//! them, remade when their contents have changed.

use std::sync::Arc;

use egui::{
    Color32, ColorImage, Context, Id, PointerButton, Pos2, Rect, Sense, Slider, Stroke, StrokeKind,
    TextureHandle, TextureOptions, Ui, Vec2, pos2, vec2,
};
use glam::{UVec2, UVec3, Vec3};

use super::histogram::CLAY;
use crate::format::options::{Colouring, ImportOptions, ScanRegion};
use crate::format::{Existing, VolumeStudy};
use crate::sculpture::orientation::Orientation;

/// Most voxels drawn along a side of a slice; larger slices are sampled.
const MOST_PX: u32 = 512;
/// Share of the voxels below the brightest grey.
const BRIGHTEST: f64 = 0.999;
/// The axes across which the slices lie, and their names.
const SLICES: [(usize, &str, &str); 3] = [
    (1, "Axial", "Horizontal, seen from below, the front at the top"),
    (2, "Coronal", "Upright, seen from the front"),
    (0, "Sagittal", "Upright, seen from the right, the front at the left"),
];

/// A slice as cut last, and its picture.
#[derive(Clone)]
struct SlicePicture {
    cut: SlicePosition,
    look: SlicePictureKey,
    size: UVec2,
    values: Arc<Vec<f32>>,
    texture: TextureHandle,
}

/// The position of a slice.
#[derive(Clone, Copy, PartialEq)]
struct SlicePosition {
    turn: Orientation,
    axis: usize,
    at: u32,
}

/// The values that the colours of the slice depend on.
#[derive(Clone, Copy, PartialEq)]
struct SlicePictureKey {
    existing: Existing,
    colouring: Colouring,
    region: ScanRegion,
    at: u32,
}

/// Forgets the pictures of the last volume.
pub fn forget(ctx: &Context) {
    SLICES
        .iter()
        .for_each(|(axis, ..)| ctx.data_mut(|data| data.remove::<SlicePicture>(id(*axis))));
}

fn id(axis: usize) -> Id {
    Id::new(("slice", axis))
}

/// Shows the slices side by side, each in a square of `side` points.
pub fn show(
    ui: &mut Ui,
    study: &VolumeStudy,
    options: &mut ImportOptions,
    at: &mut UVec3,
    side: f32,
) {
    let turn = study.turn(options);
    let dims = study.upright_dims(turn);
    *at = at.min(dims - 1);
    let region = study.upright_region(turn, options.region.unwrap_or(study.whole()));
    ui.horizontal_top(|ui| {
        for (axis, name, help) in SLICES {
            ui.vertical(|ui| {
                ui.set_width(side);
                let cut = SlicePosition { turn, axis, at: at[axis] };
                let texture = picture(ui, study, options, cut, region);
                let (square, response) =
                    ui.allocate_exact_size(Vec2::splat(side), Sense::click_and_drag());
                let pane = Pane::new(study, turn, axis, square);
                if let Some(to) = response.interact_pointer_pos() {
                    let framed = response.dragged_by(PointerButton::Secondary);
                    match ui.input(|input| input.pointer.press_origin()).filter(|_| framed) {
                        Some(from) => {
                            let region = study.region_in_file(turn, pane.framed(region, from, to));
                            options.region = (region != study.whole()).then_some(region);
                        }
                        None if ui.input(|input| input.pointer.primary_down()) => {
                            pane.point_at(to, at);
                        }
                        None => {}
                    }
                }
                draw(ui, &pane, &texture, region, *at);
                response.on_hover_text(format!("{help}. Drag to move the other two slices, or drag with the right button to frame the part to read"));
                ui.horizontal(|ui| {
                    let label = ui.label(name).on_hover_text(help);
                    ui.spacing_mut().slider_width = (side - label.rect.width() - 54.0).max(24.0);
                    ui.add(Slider::new(&mut at[axis], 0..=dims[axis] - 1)).labelled_by(label.id);
                });
            });
        }
    });
}

/// Returns the picture of a slice.
fn picture(
    ui: &Ui,
    study: &VolumeStudy,
    options: &ImportOptions,
    cut: SlicePosition,
    region: ScanRegion,
) -> TextureHandle {
    let existing = study.existing(options);
    let look = SlicePictureKey { existing, colouring: options.colouring, region, at: cut.at };
    let before = ui.data(|data| data.get_temp::<SlicePicture>(id(cut.axis)));
    if let Some(shown) = &before
        && shown.cut == cut
        && shown.look == look
    {
        return shown.texture.clone();
    }
    let (size, values) = match before.as_ref().filter(|shown| shown.cut == cut) {
        Some(shown) => (shown.size, shown.values.clone()),
        None => {
            let (size, values) = study.slice(cut.turn, cut.axis, cut.at, MOST_PX);
            (size, Arc::new(values))
        }
    };
    let image = coloured(study, options, cut, region, size, &values);
    let texture = match before {
        Some(SlicePicture { mut texture, .. }) => {
            texture.set(image, TextureOptions::LINEAR);
            texture
        }
        None => ui.ctx().load_texture("slice", image, TextureOptions::LINEAR),
    };
    let shown = SlicePicture { cut, look, size, values, texture: texture.clone() };
    ui.data_mut(|data| data.insert_temp(id(cut.axis), shown));
    texture
}

/// Colours densities grey, and existing ones in their colour or like clay.
fn coloured(
    study: &VolumeStudy,
    options: &ImportOptions,
    cut: SlicePosition,
    region: ScanRegion,
    size: UVec2,
    values: &[f32],
) -> ColorImage {
    let histogram = &study.densities.histogram;
    let dark = histogram.min;
    let bright = (histogram.quantile(BRIGHTEST) as f32).max(dark.next_up());
    let existing = study.existing(options);
    let colour = study.colour(options);
    let dims = study.upright_dims(cut.turn);
    let ([across, down], reversed) = VolumeStudy::picture_axes(cut.axis);
    let in_depth = (region.low[cut.axis]..=region.high[cut.axis]).contains(&cut.at);
    let inside = |i: u32, axis: usize, size: u32, reversed: bool| {
        let at = (u64::from(i) * u64::from(dims[axis]) / u64::from(size)) as u32;
        let at = if reversed { dims[axis] - 1 - at } else { at };
        (region.low[axis]..=region.high[axis]).contains(&at)
    };
    let mut pixels = Vec::with_capacity(values.len());
    let columns: Vec<bool> = (0..size.x).map(|i| inside(i, across, size.x, reversed[0])).collect();
    for (j, row) in (0..size.y).zip(values.chunks(size.x as usize)) {
        let in_row = in_depth && inside(j, down, size.y, reversed[1]);
        for (value, in_column) in row.iter().zip(&columns) {
            let grey = ((value - dark) / (bright - dark)).clamp(0.0, 1.0);
            let grey = if grey.is_nan() { 0.0 } else { grey };
            let is_inside = in_row && *in_column;
            pixels.push(match (&colour, is_inside && existing.contains(*value)) {
                (_, false) => {
                    Color32::from_gray((grey * if is_inside { 190.0 } else { 80.0 }) as u8)
                }
                (Some(colour), true) => {
                    let [r, g, b] = colour(*value).0;
                    Color32::from_rgb(r, g, b)
                }
                (None, true) => {
                    let light = 0.45 + 0.55 * grey;
                    let [r, g, b, _] = CLAY.to_array().map(|c| (f32::from(c) * light) as u8);
                    Color32::from_rgb(r, g, b)
                }
            });
        }
    }
    ColorImage::new([size.x as usize, size.y as usize], pixels)
}

/// The area of a slice on the screen.
struct Pane {
    square: Rect,
    picture: Rect,
    axes: [usize; 2],
    reversed: [bool; 2],
    dims: UVec3,
}

impl Pane {
    /// Centres the slice in a square, with the proportions of the voxels.
    fn new(study: &VolumeStudy, turn: Orientation, axis: usize, square: Rect) -> Pane {
        let dims = study.upright_dims(turn);
        let edges = Vec3::from(turn.permuted(study.volume.voxel_size.to_array()));
        let extent = dims.as_vec3() * edges;
        let (axes, reversed) = VolumeStudy::picture_axes(axis);
        let [width, height] = axes.map(|axis| extent[axis]);
        let scale = square.width() / width.max(height);
        // A slice of a single row stays visible.
        let size = vec2(width * scale, height * scale).max(Vec2::splat(2.0));
        Pane {
            square,
            picture: Rect::from_center_size(square.center(), size),
            axes,
            reversed,
            dims,
        }
    }

    /// Returns the coordinate in voxels of a position along an axis of the picture (0 or 1).
    fn along(&self, side: usize, place_vx: f32) -> f32 {
        let share = place_vx / self.dims[self.axes[side]] as f32;
        let share = if self.reversed[side] { 1.0 - share } else { share };
        let range = if side == 0 { self.picture.x_range() } else { self.picture.y_range() };
        range.min + share * range.span()
    }

    fn corner(&self, voxel: UVec3) -> Pos2 {
        let [x, y] = [0, 1].map(|side| self.along(side, voxel[self.axes[side]] as f32));
        pos2(x, y)
    }

    /// Returns the region between two points of the picture, with its depth unchanged.
    fn framed(&self, region: ScanRegion, from: Pos2, to: Pos2) -> ScanRegion {
        let (mut a, mut b) = (region.low, region.high);
        self.point_at(from, &mut a);
        self.point_at(to, &mut b);
        ScanRegion { low: a.min(b), high: a.max(b) }
    }

    /// Moves the other two slices to a point of the picture.
    fn point_at(&self, to: Pos2, at: &mut UVec3) {
        let shares = (to - self.picture.min) / self.picture.size();
        for (side, share) in [shares.x, shares.y].into_iter().enumerate() {
            let share = if self.reversed[side] { 1.0 - share } else { share };
            let axis = self.axes[side];
            let count = self.dims[axis];
            at[axis] = ((share.clamp(0.0, 1.0) * count as f32) as u32).min(count - 1);
        }
    }
}

fn draw(ui: &Ui, pane: &Pane, texture: &TextureHandle, region: ScanRegion, at: UVec3) {
    let painter = ui.painter_at(pane.square);
    painter.rect_filled(pane.square, 3.0, Color32::BLACK);
    let uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    painter.image(texture.id(), pane.picture, uv, Color32::WHITE);
    let line = Stroke::new(1.0, Color32::from_rgba_unmultiplied(0x80, 0xc0, 0xff, 0x90));
    let [x, y] = [0, 1].map(|side| pane.along(side, at[pane.axes[side]] as f32 + 0.5));
    painter.vline(x, pane.square.y_range(), line);
    painter.hline(pane.square.x_range(), y, line);
    let whole = ScanRegion { low: UVec3::ZERO, high: pane.dims - 1 };
    if region != whole {
        let frame = Rect::from_two_pos(pane.corner(region.low), pane.corner(region.high + 1));
        let stroke = Stroke::new(1.5, Color32::from_rgb(0xff, 0xe0, 0x60));
        painter.rect_stroke(frame, 0.0, stroke, StrokeKind::Inside);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_of_the_picture_is_the_voxel_that_is_drawn_there() {
        let square = Rect::from_min_size(pos2(10.0, 20.0), Vec2::splat(100.0));
        for axis in 0..3 {
            let (axes, reversed) = VolumeStudy::picture_axes(axis);
            let dims = UVec3::new(8, 5, 3);
            let pane = Pane { square, picture: square, axes, reversed, dims };
            let voxel = UVec3::new(6, 1, 2);
            let middle = pane.corner(voxel).lerp(pane.corner(voxel + 1), 0.5);
            let mut at = voxel;
            at[axes[0]] = 0;
            at[axes[1]] = 0;
            pane.point_at(middle, &mut at);
            assert_eq!(at, voxel, "across {axis}");
            let whole = ScanRegion { low: UVec3::ZERO, high: dims - 1 };
            let other = pane.corner(voxel + 1).lerp(pane.corner(voxel), -0.4);
            let part = pane.framed(whole, middle, other);
            assert_eq!(
                (part.low[axes[0]], part.high[axes[1]]),
                (voxel[axes[0]], (voxel[axes[1]] + 1).min(dims[axes[1]] - 1))
            );
            assert_eq!((part.low[axis], part.high[axis]), (0, dims[axis] - 1));
            pane.point_at(pos2(-1e6, 1e6), &mut at);
            assert!(at.cmplt(dims).all());
        }
    }
}
