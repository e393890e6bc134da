//! Intersects rows with an ellipsoid at any pose.
//!
//! With `m0`, `m1`, `m2` the columns of the map to tool space, a row's points are `q + m0 * dx` with `q = m1 * dy + m2
//! * dz`. The squared component of `q` across `m0` is a quadratic form in (dy, dz). One minus it, here called the
//! remainder, is the square of half the row's length relative to that of the row through the centre. Keeping the
//! components of `q` along and across `m0` separate loses no digits, as the usual `b^2 - 4ac` would.

use fearless_simd::{Simd, f32x8, prelude::*};
use glam::{DMat3, DVec3};

use super::ends::{Bracket, Ends, Magnitudes, ROUNDING, ROUNDING_32, RowSolver, STEPS};

/// Rows with a smaller remainder are decided one by one, since their ends move fast. About as many rows are doubtful
/// for this reason as for ends near a voxel's border.
const SHORT_ROW: f64 = 1e-3;

/// An ellipsoid prepared for its rows.
#[derive(Clone, Copy, Debug)]
pub struct EllipsoidRows {
    /// Position of the centre in voxel indices.
    centre: DVec3,
    /// Squared length across `m0`: `yy * dy^2 + yz * dy * dz + zz * dz^2`.
    yy: f64,
    yz: f64,
    zz: f64,
    /// Middle of a row: `centre.x + y * dy + z * dz`.
    middle_y: f64,
    middle_z: f64,
    /// Half length of the row through the centre, in voxels.
    half_length: f64,
    /// Bound on the error of the remainder, relative to the exact test too.
    error: f64,
    /// Bound on the error of the middle and of the sums with it, in voxels.
    middle_error: f64,
    /// Whether the errors are small enough for quick decisions.
    tame: bool,
    /// `-yy * step^2` and `middle_y * step` for the steps of eight rows.
    rest_of_step: [f32; 8],
    middle_of_step: [f32; 8],
}

/// A quadric in one row of bricks.
#[derive(Clone, Copy, Debug)]
pub struct LocalQuadric {
    /// The remainder of the first of every eight rows, for each step along z, and its change with each step along y.
    rest: [f32; 8],
    rest_y: [f32; 8],
    middle: [f32; 8],
    /// Remainders below this are short.
    short: f32,
}

impl EllipsoidRows {
    pub fn new(tool_from_vx: &DMat3, centre_vx: DVec3, sizes: &Magnitudes) -> EllipsoidRows {
        let DMat3 { x_axis: m0, y_axis: m1, z_axis: m2 } = *tool_from_vx;
        let length_sq = m0.length_squared();
        let half_length = 1.0 / length_sq.sqrt();
        let (along1, along2) = (m0.dot(m1) / length_sq, m0.dot(m2) / length_sq);
        let error = sizes.error();
        let yy = m1.length_squared() - m0.dot(m1) * along1;
        EllipsoidRows {
            centre: centre_vx - 0.5,
            yy,
            yz: 2.0 * (m1.dot(m2) - m0.dot(m1) * along2),
            zz: m2.length_squared() - m0.dot(m2) * along2,
            middle_y: -along1,
            middle_z: -along2,
            half_length,
            error,
            tame: error < SHORT_ROW / 8.0,
            middle_error: 32.0
                * ROUNDING
                * (sizes.position * half_length + half_length + sizes.coordinate_vx),
            rest_of_step: STEPS.map(|step| step * step * -yy as f32),
            middle_of_step: STEPS.map(|step| step * -along1 as f32),
        }
    }

    #[inline(always)]
    fn rest(&self, dy: f64, dz: f64) -> f64 {
        1.0 - self.zz * dz * dz - (self.yy * dy + self.yz * dz) * dy
    }

    #[inline(always)]
    fn middle(&self, dy: f64, dz: f64) -> f64 {
        self.centre.x + self.middle_y * dy + self.middle_z * dz
    }
}

impl RowSolver for EllipsoidRows {
    type Local = LocalQuadric;

    #[inline(always)]
    fn local(&self, origin: f64, y: f64, z: f64) -> Option<(LocalQuadric, f32)> {
        let (dy, dz) = (y - self.centre.y, z - self.centre.z);
        let rest = self.rest(dy, dz);
        let rest_y = -(2.0 * self.yy * dy + self.yz * dz);
        let rest_z = -(2.0 * self.zz * dz + self.yz * dy);
        // A remainder lies nowhere above its tangent plane, so this exceeds any of the 64 values.
        let most = rest + 8.0 * (rest_y.max(0.0) + rest_z.max(0.0));
        if most < -SHORT_ROW && self.tame {
            return None;
        }
        // A bound on all partial sums of a remainder, over steps of up to 7.
        let largest = rest.abs()
            + 8.0 * (rest_y.abs() + rest_z.abs())
            + 64.0 * (self.yy.abs() + self.yz.abs() + self.zz.abs());
        let error = 6.0 * ROUNDING_32 * largest + self.error;
        let short = SHORT_ROW.max(4.0 * error);
        let middle = self.middle(dy, dz) - origin;
        // The root of a remainder r with error e is off by less than e / sqrt(r) for r above 4 e. The sums that follow
        // meet no number larger than this one.
        let largest_x =
            middle.abs() + 8.0 * (self.middle_y.abs() + self.middle_z.abs()) + self.half_length;
        let margin = error / short.sqrt() * self.half_length
            + 6.0 * ROUNDING_32 * largest_x
            + self.middle_error;
        let mut local = LocalQuadric {
            rest: [0.0; 8],
            rest_y: [0.0; 8],
            middle: [0.0; 8],
            short: short as f32,
        };
        for step in 0..8 {
            let step_z = step as f64;
            local.rest[step] = (rest + (rest_z - self.zz * step_z) * step_z) as f32;
            local.rest_y[step] = (rest_y - self.yz * step_z) as f32;
            local.middle[step] = (middle + self.middle_z * step_z) as f32;
        }
        // Where a number is too large for f32, nothing is certain.
        let tame = self.tame && largest < 1e30 && largest_x < 1e30;
        Some((local, if tame { margin as f32 } else { f32::INFINITY }))
    }

    #[inline(always)]
    fn ends<S: Simd>(&self, simd: S, local: &LocalQuadric, step_z: usize) -> Ends<S> {
        let rest_of_step = f32x8::load_array_ref(simd, &self.rest_of_step);
        let middle_of_step = f32x8::load_array_ref(simd, &self.middle_of_step);
        let steps = f32x8::load_array(simd, STEPS);
        let rest = steps * local.rest_y[step_z] + rest_of_step + local.rest[step_z];
        let middle = middle_of_step + local.middle[step_z];
        // Both ends of a row outside are in the middle, and so it ends before it begins.
        let half = rest.max(0.0).sqrt() * self.half_length as f32;
        Ends { from: middle - half, to: middle + half, doubtful: rest.abs().simd_lt(local.short) }
    }

    fn bracket(&self, y: f64, z: f64) -> Bracket {
        let (dy, dz) = (y - self.centre.y, z - self.centre.z);
        let (rest, middle) = (self.rest(dy, dz), self.middle(dy, dz));
        if !(rest.is_finite() && middle.is_finite() && self.error.is_finite()) {
            return Bracket::UNKNOWN;
        }
        if rest < -self.error {
            return Bracket::OUTSIDE;
        }
        let ends = |rest: f64, margin: f64| {
            let half = rest.sqrt() * self.half_length + margin;
            [middle - half, middle + half]
        };
        let outer = ends(rest + self.error, self.middle_error);
        let inner = match rest > self.error {
            true => ends(rest - self.error, -self.middle_error),
            false => Bracket::NONE,
        };
        Bracket { outer, inner }
    }
}
