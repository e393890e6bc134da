//! The box of a grid with its floor, in a parallel view that is rotated by dragging.
//!
//! Takes angles and sizes; draws lines. Knows nothing of the contents of the box.

use std::f32::consts::TAU;

use egui::{Color32, Painter, Pos2, Rect, Response, Shape, Stroke, Visuals, pos2};
use glam::{Mat3, Vec3};

/// Initial view of a box: angles in radians about the vertical and from above.
pub const FIRST: [f32; 2] = [0.6, 0.35];
/// Radians per point of a drag.
const TURN: f32 = 0.01;
const FLOOR: Color32 = Color32::from_rgb(0x58, 0xa0, 0xe8);

/// Turns a view by a drag of the pointer.
pub fn turn(view: &mut [f32; 2], response: &Response) {
    let by = response.drag_delta();
    view[0] = (view[0] + by.x * TURN) % TAU;
    view[1] = (view[1] + by.y * TURN).clamp(-1.5, 1.5);
}

/// A parallel view of a box.
pub struct BoxView {
    turn: Mat3,
    middle: Vec3,
    scale: f32,
    centre: Pos2,
}

impl BoxView {
    /// Fits the view into `square`. `view`: angles about the vertical and from above; `dims`: size of the box in
    /// voxels.
    pub fn new([about, above]: [f32; 2], dims: Vec3, square: Rect) -> BoxView {
        let turn = Mat3::from_rotation_x(above) * Mat3::from_rotation_y(about);
        // However it is rotated, the box stays in the square.
        let scale = 0.95 * square.width() / dims.length().max(1.0);
        BoxView { turn, middle: dims / 2.0, scale, centre: square.center() }
    }

    /// Returns the position of a point of the box in the view.
    pub fn at(&self, point: Vec3) -> Pos2 {
        let seen = self.seen(point - self.middle);
        pos2(self.centre.x + seen.x, self.centre.y - seen.y)
    }

    /// Returns a difference of points in the view: to the right, up, and towards the viewer.
    pub fn seen(&self, by: Vec3) -> Vec3 {
        self.turn * by * self.scale
    }

    /// Draws the edges of the box, with the floor in blue.
    pub fn draw_box(&self, painter: &Painter, visuals: &Visuals) {
        let dims = 2.0 * self.middle;
        let edge = Stroke::new(1.0, visuals.strong_text_color());
        painter
            .extend(edges(dims).map(|ends| Shape::line_segment(ends.map(|at| self.at(at)), edge)));
        let floor =
            [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 0.0, 1.0), Vec3::Z].map(|at| self.at(at * dims));
        painter.add(Shape::closed_line(floor.to_vec(), Stroke::new(2.0, FLOOR)));
    }
}

/// Returns the twelve edges of a box.
fn edges(dims: Vec3) -> impl Iterator<Item = [Vec3; 2]> {
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

#[cfg(test)]
mod tests {
    use egui::Vec2;

    use super::*;

    #[test]
    fn the_box_stays_in_its_square_however_it_is_turned_and_up_is_up() {
        let square = Rect::from_min_size(pos2(5.0, 7.0), Vec2::splat(100.0));
        let dims = Vec3::new(30.0, 200.0, 4.0);
        for step in 0..24 {
            let about = step as f32 * 0.3;
            let seen = BoxView::new([about, 0.1 * step as f32 - 1.2], dims, square);
            assert!(edges(dims).flatten().all(|at| square.contains(seen.at(at))));
            assert!(seen.at(dims).y < seen.at(dims.with_y(0.0)).y);
        }
        assert_eq!(edges(dims).count(), 12);
    }
}
