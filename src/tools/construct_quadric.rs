//! Owns rows cut by an ellipsoid at any pose.
//!
//! With `m0`, `m1`, `m2` the columns of the map to tool space, a row's points are
//! `q + m0 * dx` with `q = m1 * dy + m2 * dz`. The square of the part of `q` across `m0` is a
//! quadratic form in (dy, dz); what is left of 1 is the square of half the row's length. Keeping
//! the two parts apart loses no digits, as the usual `b^2 - 4ac` would.

use glam::{DMat3, DVec3};
use wide::f64x4;

use super::construct_ends::{Bracket, Ends, Magnitudes, ROUNDING, RowSolver};

/// Rows whose squared half length, of 1 at the centre, is below this are settled one by one:
/// there the ends move fast.
const SHORT_ROW: f64 = 1e-6;

/// An ellipsoid prepared for its rows.
#[derive(Clone, Copy, Debug)]
pub struct Quadric {
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
    /// Bound on the error of the squared half length, against the exact test too.
    error: f64,
    /// Bound on the error of the middle and of the sums with it, in voxels.
    middle_error: f64,
    margin: f64,
}

impl Quadric {
    pub fn new(tool_from_vx: &DMat3, centre_vx: DVec3, sizes: &Magnitudes) -> Quadric {
        let DMat3 { x_axis: m0, y_axis: m1, z_axis: m2 } = *tool_from_vx;
        let length_sq = m0.length_squared();
        let half_length = 1.0 / length_sq.sqrt();
        let (along1, along2) = (m0.dot(m1) / length_sq, m0.dot(m2) / length_sq);
        let error = sizes.error();
        let middle_error =
            32.0 * ROUNDING * (sizes.position * half_length + half_length + sizes.coordinate_vx);
        let margin = error / SHORT_ROW.sqrt() * half_length + middle_error;
        // Beyond these sizes a square could overflow: leave every row to the exact test.
        let tame = error < SHORT_ROW / 2.0 && half_length < 1e100 && margin.is_finite();
        Quadric {
            centre: centre_vx - 0.5,
            yy: m1.length_squared() - m0.dot(m1) * along1,
            yz: 2.0 * (m1.dot(m2) - m0.dot(m1) * along2),
            zz: m2.length_squared() - m0.dot(m2) * along2,
            middle_y: -along1,
            middle_z: -along2,
            half_length,
            error,
            middle_error,
            margin: if tame { margin } else { f64::INFINITY },
        }
    }
}

impl RowSolver for Quadric {
    #[inline(always)]
    fn ends(&self, y: f64, z: f64) -> Ends {
        let dz = z - self.centre.z;
        let rest_z = 1.0 - self.zz * dz * dz;
        let middle_z = self.centre.x + self.middle_z * dz;
        let mut ends =
            Ends { from: [f64x4::ZERO; 2], to: [f64x4::ZERO; 2], doubtful: [f64x4::ZERO; 2] };
        for quad in 0..2 {
            let step = f64x4::new([0.0, 1.0, 2.0, 3.0]) + f64x4::splat(4.0 * quad as f64);
            let dy = f64x4::splat(y - self.centre.y) + step;
            let across = (f64x4::splat(self.yy) * dy + f64x4::splat(self.yz * dz)) * dy;
            let rest = f64x4::splat(rest_z) - across;
            let half = rest.fast_max(f64x4::ZERO).sqrt() * f64x4::splat(self.half_length);
            let middle = f64x4::splat(middle_z) + f64x4::splat(self.middle_y) * dy;
            // Rows outside: the upper end falls below any grid.
            let outside = rest.simd_lt(f64x4::splat(-SHORT_ROW));
            ends.from[quad] = middle - half;
            ends.to[quad] = middle + half - (outside & f64x4::splat(1e300));
            ends.doubtful[quad] = rest.abs().simd_lt(f64x4::splat(SHORT_ROW));
        }
        ends
    }

    fn margin(&self) -> f64 {
        self.margin
    }

    fn bracket(&self, y: f64, z: f64) -> Bracket {
        let (dy, dz) = (y - self.centre.y, z - self.centre.z);
        let rest = 1.0 - self.zz * dz * dz - (self.yy * dy + self.yz * dz) * dy;
        let middle = self.centre.x + self.middle_y * dy + self.middle_z * dz;
        let ends = |rest: f64, margin: f64| {
            let half = rest.sqrt() * self.half_length + margin;
            [middle - half, middle + half]
        };
        if !(rest.is_finite() && middle.is_finite() && self.error.is_finite()) {
            return Bracket::UNKNOWN;
        }
        if rest < -self.error {
            return Bracket::OUTSIDE;
        }
        let outer = ends(rest + self.error, self.middle_error);
        let inner = match rest > self.error {
            true => ends(rest - self.error, -self.middle_error),
            false => Bracket::NONE,
        };
        Bracket { outer, inner }
    }
}
