//! A picture of a voxel model: its open faces in a parallel view, with depth, lit from above at the left.
//!
//! Takes the surface of a model; gives pixels. Knows no interface.

use egui::{Pos2, Rect, Vec2};
use glam::{Vec2 as Vector, Vec3};

use super::box_view::BoxView;
use crate::format::ModelStudy;
use crate::format::options::ImportOptions;
use crate::sculpture::Rgb;

/// Direction to the light: to the right, up, towards the viewer.
const LIGHT: Vec3 = Vec3::new(-0.36, 0.72, 0.6);
/// Share of the light on faces turned away from it.
const AMBIENT: f32 = 0.4;
/// Enlarges faces by so many pixels, so that no pixel between two is missed.
const SEAM_PX: f32 = 0.02;

/// Returns a square of `side_px` pixels, each red, green, blue, opacity; transparent outside the model.
pub fn draw(
    study: &ModelStudy,
    options: &ImportOptions,
    view: [f32; 2],
    side_px: usize,
    colour: &dyn Fn(Rgb) -> Rgb,
) -> Vec<u8> {
    let square = Rect::from_min_size(Pos2::ZERO, Vec2::splat(side_px as f32));
    let seen = BoxView::new(view, study.dims(options).as_vec3(), square);
    let in_grid = study.in_grid(options);
    let sides = sides(&seen, &in_grid);
    let mut canvas = Canvas {
        side_px,
        depths: vec![f32::NEG_INFINITY; side_px * side_px],
        rgba: vec![0; 4 * side_px * side_px],
    };
    for voxel in &study.surface {
        let rgb = colour(voxel.colour).0;
        let corner = voxel.at.as_vec3();
        for side in sides.iter().filter(|side| voxel.open_sides >> side.number & 1 != 0) {
            let at = in_grid(corner + side.corner);
            let depth = seen.seen(at).z;
            let lit = rgb.map(|level| (f32::from(level) * side.light) as u8);
            canvas.fill(seen.at(at), depth, side, lit);
        }
    }
    canvas.rgba
}

/// A side of every voxel that faces the viewer.
struct VoxelSide {
    /// Number of the side in `SurfaceVoxel::open_sides`.
    number: usize,
    /// Its lowest corner, in a voxel.
    corner: Vec3,
    /// Its edges in the picture, y downwards, with their change of depth in z.
    edges: [Vec3; 2],
    light: f32,
}

/// Returns the sides that face the viewer: three at most.
fn sides(seen: &BoxView, in_grid: &impl Fn(Vec3) -> Vec3) -> Vec<VoxelSide> {
    let direction = |axis: Vec3| seen.seen(in_grid(axis) - in_grid(Vec3::ZERO));
    (0..6)
        .filter_map(|number| {
            let (axis, is_high) = (number / 2, number % 2 != 0);
            let outward = direction(Vec3::AXES[axis]) * if is_high { 1.0 } else { -1.0 };
            let normal = outward.normalize_or_zero();
            if normal.z <= 1e-4 {
                return None;
            }
            let edges = [(axis + 1) % 3, (axis + 2) % 3].map(|edge| {
                let edge = direction(Vec3::AXES[edge]);
                Vec3::new(edge.x, -edge.y, edge.z)
            });
            let corner = if is_high { Vec3::AXES[axis] } else { Vec3::ZERO };
            let light = AMBIENT + (1.0 - AMBIENT) * normal.dot(LIGHT.normalize()).max(0.0);
            Some(VoxelSide { number, corner, edges, light })
        })
        .collect()
}

struct Canvas {
    side_px: usize,
    depths: Vec<f32>,
    rgba: Vec<u8>,
}

impl Canvas {
    /// Fills the pixels with centres in a side that begins at `from`.
    fn fill(&mut self, from: Pos2, depth: f32, side: &VoxelSide, [r, g, b]: [u8; 3]) {
        let [u, v] = side.edges.map(|edge| Vector::new(edge.x, edge.y));
        let area = u.perp_dot(v);
        if area.abs() < 1e-6 {
            return;
        }
        let from = Vector::new(from.x, from.y);
        let (low, high) = (
            from + u.min(Vector::ZERO) + v.min(Vector::ZERO),
            from + u.max(Vector::ZERO) + v.max(Vector::ZERO),
        );
        let slack = SEAM_PX / area.abs().sqrt();
        let inside = -slack..=1.0 + slack;
        let range = |low: f32, high: f32| {
            let last = self.side_px as f32;
            (low - 0.5).floor().clamp(0.0, last) as usize
                ..(high + 0.5).ceil().clamp(0.0, last) as usize
        };
        for y in range(low.y, high.y) {
            for x in range(low.x, high.x) {
                let by = Vector::new(x as f32 + 0.5, y as f32 + 0.5) - from;
                let (s, t) = (by.perp_dot(v) / area, u.perp_dot(by) / area);
                if !(inside.contains(&s) && inside.contains(&t)) {
                    continue;
                }
                let at = y * self.side_px + x;
                let depth = depth + s * side.edges[0].z + t * side.edges[1].z;
                if depth > self.depths[at] {
                    self.depths[at] = depth;
                    self.rgba[4 * at..4 * at + 4].copy_from_slice(&[r, g, b, 255]);
                }
            }
        }
    }
}
