//! The lasso: an outline is drawn over the picture, and what lies behind it is cut away, painted, or added as a slab.
//!
//! Takes pixels of the picture; gives an [`Form::Extrusion`] along the line of sight through the middle of the outline,
//! as any script may. Knows no window.

use std::sync::Arc;

use glam::{Mat3, Quat, UVec3, Vec2, Vec3};

use super::Editor;
use crate::input::ToolMode;
use crate::picking::{Picker, Sight};
use crate::tools::form::{Form, Pose};

/// Least distance from one point of an outline to the next, in pixels.
const SPACING_PX: f32 = 3.0;
/// Most points of an outline; beyond, every second one goes.
const MOST_POINTS: usize = 512;
/// Smallest outline that is meant, in square pixels.
const LEAST_AREA_PX: f32 = 30.0;

/// An outline that is being drawn.
#[derive(Debug)]
pub(super) struct Lasso {
    points: Vec<Vec2>,
    /// A point of the surface that it began over, or the middle of the grid.
    target_vx: Vec3,
    /// The view in which it is drawn.
    sight: Sight,
}

impl Lasso {
    fn lead(&mut self, at: Vec2) {
        if self.points.last().is_none_or(|last| last.distance(at) >= SPACING_PX) {
            self.points.push(at);
        }
        if self.points.len() > MOST_POINTS {
            let mut keep = false;
            self.points.retain(|_| {
                keep = !keep;
                keep
            });
        }
    }
}

impl Editor {
    /// An outline begins.
    pub(super) fn begin_lasso(&mut self, at: Vec2, picker: &Picker) {
        let grid = self.document().grid();
        let target_vx = picker.target(grid, at).unwrap_or(grid.dims().as_vec3() * 0.5);
        self.lasso = Some(Lasso { points: vec![at], target_vx, sight: *picker.sight() });
    }

    /// It goes on, if there is one.
    pub(super) fn lead_lasso(&mut self, at: Vec2) {
        if let Some(lasso) = &mut self.lasso {
            lasso.lead(at);
        }
    }

    /// It is closed: the tool's mode says what happens to what lies behind it.
    pub(super) fn end_lasso(&mut self) {
        let Some(lasso) = self.lasso.take() else { return };
        if area(&lasso.points).abs() < LEAST_AREA_PX {
            self.note("Draw an outline around what is to go");
            return;
        }
        let grid = self.document().grid();
        let mode = self.tool.mode;
        let depth = match mode {
            ToolMode::Add => Some(2.0 * self.tool.half().element_sum() / 3.0),
            _ => None,
        };
        let Some(form) = prism(&lasso, depth, grid.dims(), grid.voxel_size()) else { return };
        if matches!(mode, ToolMode::Add | ToolMode::Recolour) {
            self.tool.used_colour();
        }
        self.run(self.tool.form_command(mode, form));
    }

    /// Gives up the outline that is being drawn, or the intention to draw one; false if there is neither.
    pub fn cancel_lasso(&mut self) -> bool {
        let was_meant = self.tool.next_press.take().is_some();
        self.lasso.take().is_some() || was_meant
    }

    /// The outline that is being drawn, in pixels of the picture.
    pub fn lasso_outline(&self) -> &[Vec2] {
        self.lasso.as_ref().map_or(&[], |lasso| &lasso.points)
    }
}

/// The area inside an outline, counter-clockwise positive.
fn area(outline: &[Vec2]) -> f32 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f32>() * 0.5
}

/// What an outline covers where it is as large as at the target: along the line of sight through its middle, by `depth`
/// (in units of the smallest edge of a voxel) about the target, or through the whole grid.
fn prism(lasso: &Lasso, depth: Option<f32>, dims: UVec3, voxel_size: Vec3) -> Option<Form> {
    let Lasso { points, target_vx, sight } = lasso;
    // In the space of forms, where voxels have their shape.
    let edges = voxel_size / voxel_size.min_element();
    let rays = &sight.rays;
    let (origin, target) = (rays.origin * edges, *target_vx * edges);
    let direction = |at: Vec2| (rays.direction_at(at.x, at.y) * edges).normalize_or_zero();
    let middle = points.iter().sum::<Vec2>() / points.len() as f32;
    let ahead = direction(middle);
    let right = direction(middle + Vec2::X) - ahead;
    let right = (right - ahead * right.dot(ahead)).try_normalize()?;
    let axes = Mat3::from_cols(right, right.cross(ahead), -ahead);
    let distance = (target - origin).dot(ahead);
    let centre = origin + ahead * distance;
    let outline: Option<Arc<[Vec2]>> = points
        .iter()
        .map(|&at| {
            let way = direction(at);
            let along = way.dot(ahead);
            let point = way * (distance / along) + origin - centre;
            (along > 1e-3).then(|| Vec2::new(point.dot(axes.x_axis), point.dot(axes.y_axis)))
        })
        .collect();
    let size = dims.as_vec3() * edges;
    let through = || {
        let corner =
            |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * size;
        let furthest = (0..8).map(|i| (corner(i) - centre).dot(ahead).abs()).fold(0.0, f32::max);
        2.0 * furthest + 2.0
    };
    Some(Form::Extrusion {
        pose: Pose { at_vx: centre / edges, rotation: Quat::from_mat3(&axes).normalize() },
        outlines: Arc::new([outline?]),
        depth: depth.unwrap_or_else(through),
    })
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;
    use crate::sculpture::Placement;
    use crate::view::Camera;

    fn lasso(points: Vec<Vec2>, rotation: Quat, dims: UVec3, voxel_size: Vec3) -> Lasso {
        let eye =
            Camera { eye: Vec3::new(0.0, 0.0, 3.0 * dims.as_vec3().length()), ..Camera::default() }
                .eye(UVec2::new(200, 100));
        let placement = Placement { rotation, ..Placement::default() };
        let sight = Sight::new(&eye, &placement.world_from_grid(dims, voxel_size));
        Lasso { points, target_vx: dims.as_vec3() * 0.5, sight }
    }

    #[test]
    fn the_prism_is_seen_as_the_outline_from_any_side() {
        let outline = vec![
            Vec2::new(90.0, 40.0),
            Vec2::new(120.0, 45.0),
            Vec2::new(110.0, 65.0),
            Vec2::new(95.0, 60.0),
        ];
        for (turn, voxel_size) in [
            (Quat::IDENTITY, Vec3::ONE),
            (Quat::from_rotation_y(2.0), Vec3::ONE),
            (Quat::from_rotation_x(-1.5) * Quat::from_rotation_z(3.0), Vec3::new(1.0, 2.0, 3.0)),
        ] {
            let lasso = lasso(outline.clone(), turn, UVec3::new(60, 40, 50), voxel_size);
            let form = prism(&lasso, None, UVec3::new(60, 40, 50), voxel_size).unwrap();
            form.check().unwrap();
            let Form::Extrusion { pose, outlines, depth } = form else { panic!() };
            for (point, pixel) in outlines[0].iter().zip(&outline) {
                let place = pose.at_vx
                    + pose.rotation * point.extend(0.0) / (voxel_size / voxel_size.min_element());
                let seen = lasso.sight.pixel_of(place).unwrap();
                assert!(seen.distance(*pixel) < 0.05, "{seen} {pixel}");
            }
            assert!(depth > 60.0 && depth < 400.0, "{depth}");
        }
    }

    #[test]
    fn outlines_keep_their_shape_and_have_an_end() {
        let mut lasso = lasso(vec![Vec2::ZERO], Quat::IDENTITY, UVec3::splat(8), Vec3::ONE);
        for i in 0..10_000 {
            lasso.lead(Vec2::from_angle(i as f32 * 0.01) * 300.0);
        }
        assert!(lasso.points.len() <= MOST_POINTS && lasso.points.len() > MOST_POINTS / 4);
        let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|p| p * 10.0);
        assert_eq!(area(&square), 100.0);
        assert_eq!(area(&[Vec2::ONE]), 0.0);
    }
}
