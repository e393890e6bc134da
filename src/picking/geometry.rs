//! The geometry of picking: from a pixel of the picture to a point of the grid and back, and the grid axes that lie
//! across, up and into the screen. Pure functions of rays, grid and index map.

use std::sync::Arc;

use glam::{Affine3A, IVec3, Mat4, UVec3, Vec2, Vec3, Vec4Swizzles};

use crate::input::ScreenDirection;
use crate::sculpture::Grid;
use crate::surface::{IndexMap, raycast};
use crate::view::{Eye, PixelRays};

/// A point of the surface with its voxel face.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SurfacePoint {
    pub point: Vec3,
    /// A unit vector along an axis, out of the voxel.
    pub face: Vec3,
}

/// Returns the point where the ray through `at` (pixels) meets the visible face there.
///
/// The picture has one ray per pixel, through its centre, which determines the face. The ray through `at` may miss that
/// face, or come from behind a neighbour; then the result is the point of the face nearest to the ray's hit on the
/// face's plane.
pub fn surface_point(map: &IndexMap, grid: &Grid, at: Vec2) -> Option<SurfacePoint> {
    shifted_surface_point(map, grid, at, IVec3::ZERO)
}

/// As [`surface_point`], for a map of a picture since which the coordinates of the grid have moved by `shift_vx`.
pub fn shifted_surface_point(
    map: &IndexMap,
    grid: &Grid,
    at: Vec2,
    shift_vx: IVec3,
) -> Option<SurfacePoint> {
    let voxel = voxel_at(map, grid, at)?;
    let low = voxel.as_vec3();
    let PixelRays { origin, .. } = map.rays;
    let middle = at.floor() + 0.5;
    let axis = seen_face(grid, voxel, shift_vx, origin, map.rays.direction_at(middle.x, middle.y));
    let direction = map.rays.direction_at(at.x, at.y);
    let outwards = if direction[axis] > 0.0 { -1.0 } else { 1.0 };
    let plane = low[axis] + 0.5 + 0.5 * outwards;
    let t = (plane - origin[axis]) / direction[axis];
    // A ray along the face has no such point: uses the voxel's centre.
    let met = if t.is_finite() { origin + direction * t.max(0.0) } else { low + 0.5 };
    let mut point = met.clamp(low, low + 1.0);
    point[axis] = plane;
    point += shift_vx.as_vec3();
    Some(SurfacePoint { point, face: Vec3::AXES[axis] * outwards })
}

/// Returns the axis of the face by which a ray enters a visible voxel: the last plane that it crosses among the open
/// faces. A ray that reaches the voxel only by rounding crosses them in nearly the same order.
fn seen_face(grid: &Grid, voxel: UVec3, shift_vx: IVec3, origin: Vec3, direction: Vec3) -> usize {
    let enter = |axis: usize| {
        let near = voxel[axis] as f32 + if direction[axis] < 0.0 { 1.0 } else { 0.0 };
        match direction[axis] {
            0.0 => f32::NEG_INFINITY,
            along => (near - origin[axis]) / along,
        }
    };
    let is_open = |axis: usize| {
        let mut before = voxel.as_ivec3() + shift_vx;
        before[axis] -= direction[axis].signum() as i32;
        !grid.get(before)
    };
    let mut axes = [0, 1, 2];
    axes.sort_by(|a, b| enter(*b).total_cmp(&enter(*a)));
    // If an edit has buried the voxel meanwhile, uses its former face.
    axes.into_iter().find(|axis| direction[*axis] != 0.0 && is_open(*axis)).unwrap_or(axes[0])
}

/// Returns the point of the ray through `at` at the depth of `last`, or the nearest one in the grid's box.
pub fn box_point(sight: &Sight, dims: UVec3, at: Vec2, last: Vec3) -> Option<Vec3> {
    let rays = &sight.rays;
    let direction = rays.direction_at(at.x, at.y);
    let (enter, leave) = enter_box(rays.origin, direction, Vec3::ZERO, dims.as_vec3())?;
    let depth = sight.depth(last).clamp(enter.max(0.0), leave);
    Some(sight.at_depth(at, depth))
}

/// Returns the voxel seen at `at` (pixels). If only the device knows it, casts the pixel's ray into the
/// grid.
pub fn voxel_at(map: &IndexMap, grid: &Grid, at: Vec2) -> Option<UVec3> {
    if at.cmplt(Vec2::ZERO).any() || at.cmpge(map.rays.size.as_vec2()).any() {
        return None;
    }
    let (x, y) = (at.x as u32, at.y as u32);
    if map.is_known() {
        return map.voxel(x, y);
    }
    Some(raycast::cast_pixel(grid, &map.rays, x, y)?.voxel)
}

/// Returns a map of the present picture that is independent of later changes of the grid.
pub fn lasting(map: &Arc<IndexMap>, grid: &Grid) -> Arc<IndexMap> {
    if map.is_known() {
        return map.clone();
    }
    let mut known = IndexMap::new(map.rays);
    raycast::sample(grid, &map.rays, &mut known);
    Arc::new(known)
}

/// Returns where a ray from outside enters a box, in lengths of its direction, and the face of entry, as a unit vector
/// out of the box.
pub fn entered_face(origin: Vec3, direction: Vec3, min: Vec3, max: Vec3) -> Option<(f32, Vec3)> {
    let (enter, _) = enter_box(origin, direction, min, max).filter(|(enter, _)| *enter > 0.0)?;
    let entered = ((min - origin) / direction).min((max - origin) / direction);
    let axis = (0..3).find(|axis| entered[*axis] == enter)?;
    Some((enter, Vec3::AXES[axis] * -direction[axis].signum()))
}

/// Returns where a ray enters and leaves a box, in lengths of its direction; `None` if it misses it.
fn enter_box(origin: Vec3, direction: Vec3, min: Vec3, max: Vec3) -> Option<(f32, f32)> {
    let (a, b) = ((min - origin) / direction, (max - origin) / direction);
    let enter = a.min(b).max_element();
    let leave = a.max(b).min_element();
    (enter <= leave && leave >= 0.0).then_some((enter, leave))
}

/// The grid axes as the screen shows them, each a unit vector along plus or minus x, y or z.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ScreenAxes {
    pub right: Vec3,
    pub up: Vec3,
    /// Towards the viewer.
    pub near: Vec3,
}

impl ScreenAxes {
    /// Returns the axis and sense of a step.
    pub fn step(&self, step: ScreenDirection) -> Vec3 {
        match step {
            ScreenDirection::Left => -self.right,
            ScreenDirection::Right => self.right,
            ScreenDirection::Up => self.up,
            ScreenDirection::Down => -self.up,
            ScreenDirection::Nearer => self.near,
            ScreenDirection::Farther => -self.near,
        }
    }
}

/// One eye's view of one grid.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    eye_from_grid: Affine3A,
    clip_from_grid: Mat4,
    pub rays: PixelRays,
}

impl Sight {
    pub fn new(eye: &Eye, world_from_grid: &Affine3A) -> Sight {
        Sight {
            eye_from_grid: eye.eye_from_world * *world_from_grid,
            clip_from_grid: eye.clip_from_grid(world_from_grid),
            rays: eye.pixel_rays(world_from_grid),
        }
    }

    /// Returns the directions of the grid axes in the picture, as unit vectors: x right, y up, z to the viewer.
    pub fn axes_in_picture(&self) -> [Vec3; 3] {
        let m = self.eye_from_grid.matrix3;
        [m.x_axis, m.y_axis, m.z_axis].map(|column| Vec3::from(column).normalize_or_zero())
    }

    /// Returns the distance of a grid point from the eye plane, in world units.
    pub fn depth(&self, point: Vec3) -> f32 {
        -self.eye_from_grid.transform_point3(point).z
    }

    /// Returns the pixel of a grid point; `None` behind the eye.
    pub fn pixel_of(&self, point: Vec3) -> Option<Vec2> {
        let clip = self.clip_from_grid * point.extend(1.0);
        let seen = clip.w > 0.0;
        seen.then(|| (clip.xy() / clip.w * 0.5 + 0.5) * self.rays.size.as_vec2())
    }

    /// Returns the grid point seen at `at` (pixels) in the plane `depth` before the eye.
    pub fn at_depth(&self, at: Vec2, depth: f32) -> Vec3 {
        self.rays.origin + self.rays.direction_at(at.x, at.y) * depth
    }

    /// Returns the best assignment of grid axes to screen axes: of the six, the one with the largest sum of cosines.
    pub fn screen_axes(&self) -> ScreenAxes {
        let columns = self.axes_in_picture();
        let cosine = |grid: usize, screen: usize| columns[grid][screen];
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let fit = |order: &[usize; 3]| -> f32 {
            (0..3).map(|screen| cosine(order[screen], screen).abs()).sum()
        };
        let best = orders
            .into_iter()
            .reduce(|best, order| if fit(&order) > fit(&best) + 1e-6 { order } else { best })
            .unwrap_or([0, 1, 2]);
        let axis = |screen: usize| {
            let grid = best[screen];
            Vec3::AXES[grid] * if cosine(grid, screen) < 0.0 { -1.0 } else { 1.0 }
        };
        ScreenAxes { right: axis(0), up: axis(1), near: axis(2) }
    }

    /// Returns how far along a grid axis a drag of `pixels` moves something at `point`, in voxels: as far as the
    /// pointer moves at that depth.
    pub fn along(&self, axis: Vec3, pixels: f32, point: Vec3) -> f32 {
        let world_per_pixel = {
            let step = self.eye_from_grid.transform_vector3(self.rays.step_y);
            step.length() * self.depth(point).max(0.0)
        };
        let world_per_voxel = self.eye_from_grid.transform_vector3(axis).length();
        pixels * world_per_pixel / world_per_voxel.max(f32::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::Placement;
    use crate::view::Camera;
    use glam::{IVec3, Quat, UVec2};
    use proptest::prelude::*;

    fn sight(rotation: Quat, dims: UVec3) -> Sight {
        let eye = Camera { eye: Vec3::new(0.0, 0.0, 60.0), ..Camera::default() }
            .eye(UVec2::new(200, 100));
        let placement = Placement { rotation, ..Placement::default() };
        Sight::new(&eye, &placement.world_from_grid(dims, Vec3::ONE))
    }

    #[test]
    fn the_point_under_the_pointer_lies_on_the_face_of_the_voxel_seen() {
        let dims = UVec3::splat(16);
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 20).unwrap();
        grid.set(IVec3::new(8, 8, 10), true);
        let sight = sight(Quat::IDENTITY, dims);
        let mut map = IndexMap::new(sight.rays);
        map.reset(dims, sight.rays);
        let middle = Vec2::new(100.5, 49.5);
        assert_eq!(surface_point(&map, &grid, middle), None);
        map.voxels[100 + 49 * 200] = grid.voxel_index(UVec3::new(8, 8, 10));
        let SurfacePoint { point, face } = surface_point(&map, &grid, middle).unwrap();
        assert_eq!(face, Vec3::Z);
        assert!((point.z - 11.0).abs() < 1e-4, "{point}");
        // Half a pixel right of and above the axis, 57 before the eye.
        let half_pixel = 22.5f32.to_radians().tan() * 57.0 / 100.0;
        let expected = Vec3::new(8.0 + half_pixel, 8.0 + half_pixel, 11.0);
        assert!(point.abs_diff_eq(expected, 1e-4), "{point}");
        assert_eq!(surface_point(&map, &grid, Vec2::new(-1.0, 5.0)), None);
        assert_eq!(surface_point(&map, &grid, Vec2::new(200.0, 5.0)), None);
    }

    #[test]
    fn an_empty_grid_is_entered_at_its_middle() {
        let sight = sight(Quat::IDENTITY, UVec3::splat(16));
        let dims = UVec3::splat(16);
        let at = |x, last| box_point(&sight, dims, Vec2::new(x, 50.0), last).unwrap();
        let point = at(100.0, Vec3::splat(8.0));
        assert!(point.abs_diff_eq(Vec3::splat(8.0), 1e-3), "{point}");
        // Across the picture its depth stays, even if the ray leaves the box by a side.
        for x in 90..110 {
            assert!((at(x as f32, Vec3::splat(8.0)).z - 8.0).abs() < 1e-3);
            assert!((at(x as f32, Vec3::new(0.0, 0.0, 13.0)).z - 13.0).abs() < 1e-3);
        }
        // A depth outside of the box leads to its border.
        assert!((at(100.0, Vec3::new(8.0, 8.0, 40.0)).z - 16.0).abs() < 1e-3);
        assert_eq!(box_point(&sight, dims, Vec2::ZERO, Vec3::splat(8.0)), None);
    }

    #[test]
    fn screen_axes_of_an_upright_and_of_a_turned_grid() {
        let axes = sight(Quat::IDENTITY, UVec3::splat(8)).screen_axes();
        assert_eq!((axes.right, axes.up, axes.near), (Vec3::X, Vec3::Y, Vec3::Z));
        let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
        let axes = sight(quarter, UVec3::splat(8)).screen_axes();
        assert_eq!((axes.right, axes.up, axes.near), (Vec3::Z, Vec3::Y, Vec3::NEG_X));
    }

    proptest! {
        /// Checks that the three axes are different in every pose, and none points the wrong way.
        #[test]
        fn screen_axes_are_a_frame(x in -3.0f32..3.0, y in -3.0f32..3.0, z in -3.0f32..3.0) {
            let rotation = Quat::from_euler(glam::EulerRot::XYZ, x, y, z);
            let axes = sight(rotation, UVec3::splat(8)).screen_axes();
            let sum = axes.right.abs() + axes.up.abs() + axes.near.abs();
            prop_assert_eq!(sum, Vec3::ONE);
            prop_assert!((rotation * axes.right).x >= -1e-5);
            prop_assert!((rotation * axes.up).y >= -1e-5);
            prop_assert!((rotation * axes.near).z >= -1e-5);
        }

        #[test]
        fn a_point_at_a_depth_is_seen_where_it_was_asked_for(
            px in 0.0f32..200.0, py in 0.0f32..100.0, depth in 1.0f32..100.0, turn in -3.0f32..3.0,
        ) {
            let sight = sight(Quat::from_rotation_y(turn), UVec3::splat(8));
            let point = sight.at_depth(Vec2::new(px, py), depth);
            prop_assert!((sight.depth(point) - depth).abs() < depth * 1e-4);
        }
    }

    #[test]
    fn dragging_across_the_picture_moves_as_far_as_the_pointer() {
        let sight = sight(Quat::IDENTITY, UVec3::splat(8));
        let centre = Vec3::splat(4.0);
        let moved = centre + Vec3::X * sight.along(Vec3::X, 40.0, centre);
        let there = sight.at_depth(Vec2::new(140.0, 50.0), sight.depth(centre));
        assert!(moved.abs_diff_eq(there, 1e-3), "{moved} {there}");
    }
}
