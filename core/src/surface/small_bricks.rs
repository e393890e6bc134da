//! Bricks smaller than a pixel, which casters hit as a whole: each ray that meets one sees the same voxel of it
//! ([`stand_in`]). Where a voxel is as large as a pixel, no brick is that small.
//!
//! The distances are those along the view, in which perspective shrinks things. They are compared as integers, so that
//! CPU and device agree on every brick. Takes the rays of a picture; knows no grid.

use glam::{BVec3, DMat3, DVec3, IVec3, UVec3, Vec3};

use crate::sculpture::Brick;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::view::PixelRays;

/// The largest sum of the weights: that of a brick stays below 2^30.
const MOST_WEIGHT: f64 = ((1u64 << 30) / (MAX_AXIS_VX / BRICK_EDGE_VX) as u64) as f64;

/// Tells which bricks of a picture are smaller than a pixel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SmallBricks {
    /// The distance of a brick along the view, per brick on each axis.
    pub weights: IVec3,
    /// The weighted sum of brick coordinates from which on bricks are small.
    pub least: i32,
}

impl SmallBricks {
    /// No brick is small.
    pub const NONE: SmallBricks = SmallBricks { weights: IVec3::ZERO, least: i32::MAX };

    /// Returns the small bricks of a picture.
    pub fn new(rays: &PixelRays) -> SmallBricks {
        let axes = [rays.step_x, rays.step_y, rays.corner].map(Vec3::as_dvec3);
        // Its rows map a point relative to the eye to `x s`, `y s` and `s`: the pixel, and the distance in directions.
        let inverse = DMat3::from_cols(axes[0], axes[1], axes[2]).inverse();
        if !inverse.is_finite() || !rays.origin.is_finite() {
            return SmallBricks::NONE;
        }
        let [x_row, y_row, s_row] = [0, 1, 2].map(|row| inverse.row(row));
        // The longest edge of a voxel at a distance of 1, in pixels: longest in a corner of the picture.
        let size = rays.size.as_dvec2();
        let corners = [(0.0, 0.0), (size.x, 0.0), (0.0, size.y), (size.x, size.y)];
        let edge_px = corners.into_iter().fold(0.0, |longest: f64, (x, y)| {
            let (across, down) = (x_row - s_row * x, y_row - s_row * y);
            (across * across + down * down).max_element().sqrt().max(longest)
        });

        let edge = f64::from(BRICK_EDGE_VX);
        let scale = MOST_WEIGHT / s_row.abs().element_sum();
        let weights = (s_row * scale).round();
        // The nearest corner of a brick, as seen along the view, relative to its lowest.
        let nearest = s_row.min(DVec3::ZERO).element_sum() * edge;
        let least_s = edge * edge_px + s_row.dot(rays.origin.as_dvec3()) - nearest;
        // Rounded weights are off by half a unit per brick.
        let rounding = 1.5 * f64::from(MAX_AXIS_VX / BRICK_EDGE_VX) + 1.0;
        let least = (least_s / edge * scale + rounding).ceil();
        match least.is_finite() && weights.is_finite() {
            true => SmallBricks { weights: weights.as_ivec3(), least: least as i32 },
            false => SmallBricks::NONE,
        }
    }

    /// Returns whether the brick at brick coordinates `b` is small.
    #[inline(always)]
    pub fn contains(&self, b: IVec3) -> bool {
        let sum = self.weights * b;
        sum.x + sum.y + sum.z >= self.least
    }
}

/// Returns the voxel that stands for a non-empty brick with its lowest voxel at `low`, as seen from `eye`, relative to
/// `low`: the first one in the nearest slice along z that has any, there in the nearest row along y, and there along x.
/// No voxel of the brick lies between it and the side of the eye on any axis.
pub(crate) fn stand_in(brick: &Brick, low: IVec3, eye: Vec3) -> UVec3 {
    let beyond = eye_beyond(low, eye);
    let first = |bits: u64, from_above: bool| match from_above {
        true => 63 - bits.leading_zeros(),
        false => bits.trailing_zeros(),
    };
    let slices = brick.to_rows();
    let has_voxels = (0..8).fold(0, |bits, z| bits | u64::from(slices[z] != 0) << z);
    let z = first(has_voxels, beyond.z);
    let slice = slices[z as usize & 7];
    let y = first(slice, beyond.y) / 8;
    let x = first(slice >> (8 * y) & 0xFF, beyond.x);
    UVec3::new(x, y, z)
}

/// Returns [`stand_in`] of a brick without a gap, in a grid of `dims` voxels.
#[inline(always)]
pub(crate) fn full_stand_in(low: IVec3, dims: IVec3, eye: Vec3) -> UVec3 {
    let last = (dims - 1 - low).min(IVec3::splat(BRICK_EDGE_VX as i32 - 1));
    IVec3::select(eye_beyond(low, eye), last, IVec3::ZERO).as_uvec3()
}

/// Returns on which axes the eye lies beyond the middle of the brick with its lowest voxel at `low`.
#[inline(always)]
fn eye_beyond(low: IVec3, eye: Vec3) -> BVec3 {
    eye.cmpge((low + BRICK_EDGE_VX as i32 / 2).as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::Placement;
    use crate::view::Camera;
    use glam::{DVec2, UVec2};
    use proptest::prelude::*;

    /// Returns the longest edge of a brick in a picture, in pixels; `None` if a corner lies outside or behind.
    fn edge_px(rays: &PixelRays, b: IVec3) -> Option<f64> {
        let [x, y, z] = [rays.step_x, rays.step_y, rays.corner].map(Vec3::as_dvec3);
        let inverse = DMat3::from_cols(x, y, z).inverse();
        let pixel = |corner: IVec3| {
            let p = inverse * ((b + corner) * 8).as_dvec3() - inverse * rays.origin.as_dvec3();
            let at = DVec2::new(p.x, p.y) / p.z;
            let is_seen = at.cmpge(DVec2::ZERO).all() && at.cmple(rays.size.as_dvec2()).all();
            (p.z > 0.0 && is_seen).then_some(at)
        };
        let mut longest: f64 = 0.0;
        for corner in 0..8 {
            let from = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            for axis in (0..3).filter(|axis| from[*axis] == 0) {
                let mut to = from;
                to[axis] = 1;
                longest = longest.max(pixel(from)?.distance(pixel(to)?));
            }
        }
        Some(longest)
    }

    proptest! {
        #[test]
        fn small_bricks_are_those_whose_edges_are_shorter_than_a_pixel(
            direction in prop::array::uniform3(-1.0f32..1.0),
            distance in 0.2f32..60.0,
            fov_y_deg in 3.0f32..110.0,
            longest in 40u32..8192,
            shape in prop::array::uniform3(0.1f32..1.0),
            size in prop::array::uniform2(30u32..900),
            places in prop::collection::vec(prop::array::uniform3(0.0f32..1.0), 50),
        ) {
            let direction = Vec3::from(direction);
            prop_assume!(direction.length() > 0.1);
            let dims = (Vec3::from(shape) * longest as f32).ceil().as_uvec3();
            let world_from_grid = Placement::default().world_from_grid(dims, Vec3::ONE);
            let eye = direction.normalize() * distance * longest as f32;
            let fov_y_rad = fov_y_deg.to_radians();
            let up = direction.any_orthonormal_vector();
            let camera = Camera { eye, fov_y_rad, up, ..Camera::default() };
            let rays = camera.eye(UVec2::from(size)).pixel_rays(&world_from_grid);
            let small = SmallBricks::new(&rays);
            // The pixels in a corner of a picture see things longer than those in its middle.
            let [x, y] = size.map(|n| n as f32 / size[1] as f32 * (fov_y_rad * 0.5).tan());
            let stretch = f64::from(1.0 + x * x + y * y).sqrt();
            for place in places {
                let b = (Vec3::from(place) * dims.as_vec3() / 8.0).as_ivec3();
                let Some(edge_px) = edge_px(&rays, b) else { continue };
                if small.contains(b) {
                    prop_assert!(edge_px <= 1.0 + 1e-4, "{b}: {edge_px} px");
                } else {
                    let nearly = 0.97 / stretch * (1.0 - 30.0 / f64::from(distance * longest as f32)).max(0.0);
                    // The longest edge may lie along the view.
                    let least = nearly / 3f64.sqrt();
                    prop_assert!(edge_px >= least, "{b}: {edge_px} px, {least}");
                }
            }
        }
    }

    #[test]
    fn rays_without_a_picture_have_no_small_bricks() {
        let rays = PixelRays {
            origin: Vec3::splat(-1e6),
            corner: Vec3::ONE,
            step_x: Vec3::ONE,
            step_y: Vec3::ZERO,
            size: UVec2::splat(9),
        };
        assert_eq!(SmallBricks::new(&rays), SmallBricks::NONE);
        let far = PixelRays { origin: Vec3::NAN, step_x: Vec3::X, step_y: Vec3::Y, ..rays };
        assert_eq!(SmallBricks::new(&far), SmallBricks::NONE);
    }

    #[test]
    fn the_voxel_for_a_brick_is_the_nearest_in_the_nearest_row() {
        let mut brick = Brick::EMPTY;
        for [x, y, z] in [[1, 2, 3], [6, 2, 3], [3, 5, 3], [2, 4, 6], [5, 0, 6]] {
            brick.set(x, y, z, true);
        }
        let low = IVec3::new(80, 800, 8);
        let seen = |eye: [f32; 3]| stand_in(&brick, low, Vec3::from(eye)).to_array();
        assert_eq!(seen([0.0, 0.0, 0.0]), [1, 2, 3]);
        assert_eq!(seen([1e3, 0.0, 0.0]), [6, 2, 3]);
        assert_eq!(seen([1e3, 1e3, 0.0]), [3, 5, 3]);
        assert_eq!(seen([0.0, 0.0, 1e3]), [5, 0, 6]);
        assert_eq!(seen([0.0, 1e3, 1e3]), [2, 4, 6]);
    }
}
