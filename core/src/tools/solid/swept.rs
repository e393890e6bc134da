//! Intersects rows with the volume that an ellipsoid sweeps in straight motion: the convex hull of its first and last
//! position.
//!
//! With the names of [`super::quadric`]: at time t the remainder of a row is a parabola in t, `most - (tau - tau0)^2`
//! with tau = t times the speed across rows. `most` is a quadratic form in (dy, dz); tau0 is linear. The lower end of
//! the row at that time, `middle + drift tau - half_length sqrt(rest)`, is convex in tau. Its minimum is therefore
//! where the slope is 0, at tau0 - lead sqrt(most), or at the end of the displacement nearest to there. The same holds
//! for the upper end.

use fearless_simd::{Simd, f32x8, prelude::*};
use glam::{DMat3, DVec3};

use super::ends::{Bracket, Ends, Magnitudes, ROUNDING, ROUNDING_32, RowSolver, STEPS};

/// Rows with a smaller remainder are decided one by one, as for an ellipsoid at rest.
const SHORT_ROW: f64 = 2e-3;
/// A displacement whose component across rows is smaller than this, in tool space, counts as parallel to them.
const ALONG: f64 = 1e-7;

/// A number that is linear in the row's offset from the centre.
#[derive(Clone, Copy, Debug)]
struct Linear {
    constant: f64,
    y: f64,
    z: f64,
}

impl Linear {
    #[inline(always)]
    fn at(&self, dy: f64, dz: f64) -> f64 {
        self.constant + self.y * dy + self.z * dz
    }

    /// Returns a bound on the terms of the sum, in a row of bricks that begins at `dy`, `dz`.
    fn largest(&self, dy: f64, dz: f64) -> f64 {
        self.constant.abs() + self.y.abs() * (dy.abs() + 8.0) + self.z.abs() * (dz.abs() + 8.0)
    }
}

/// A swept ellipsoid prepared for its rows.
#[derive(Clone, Copy, Debug)]
pub struct SweptQuadric {
    /// Position of the first centre in voxel indices.
    centre: DVec3,
    /// `most = 1 - yy dy^2 - yz dy dz - zz dz^2`
    yy: f64,
    yz: f64,
    zz: f64,
    tau0: Linear,
    /// Tau at the end of the displacement.
    end: f64,
    /// Motion of the row's middle along x, in voxels, for each unit of tau.
    drift: f64,
    lead: f64,
    /// Offset of the lower and the upper end: the displacement, where it is parallel to rows.
    along: [f64; 2],
    /// Middle of a row at the first position.
    middle: Linear,
    half_length: f64,
    /// Bound on the error of the remainder and of tau, relative to the exact test too.
    error: f64,
    /// Bound on the error of the middle and of the sums with it, in voxels.
    middle_error: f64,
    /// Whether the errors are small enough for quick decisions.
    tame: bool,
}

/// Values for one row of bricks: those of the first of every eight rows, for each step along z, and their change with
/// each step along y.
#[derive(Clone, Copy, Debug)]
pub struct LocalSwept {
    most: [f32; 8],
    most_y: [f32; 8],
    tau0: [f32; 8],
    middle: [f32; 8],
    /// Remainders below this are short.
    short: f32,
}

impl SweptQuadric {
    /// Prepares an ellipsoid for its rows. `displacement`: in tool space, not 0.
    pub fn new(
        tool_from_vx: &DMat3,
        centre_vx: DVec3,
        displacement: DVec3,
        sizes: &Magnitudes,
    ) -> SweptQuadric {
        let DMat3 { x_axis: m0, y_axis: m1, z_axis: m2 } = *tool_from_vx;
        let length_sq = m0.length_squared();
        let half_length = 1.0 / length_sq.sqrt();
        // The components across the rows of the steps from row to row, and of the displacement.
        let across = |v: DVec3| v - m0 * (v.dot(m0) / length_sq);
        let (y, z, side) = (across(m1), across(m2), across(displacement));
        let middle = Linear {
            constant: centre_vx.x - 0.5,
            y: -m0.dot(m1) / length_sq,
            z: -m0.dot(m2) / length_sq,
        };
        let goes = displacement.dot(m0) / length_sq;
        let speed = side.length();
        let is_along = speed <= ALONG;
        let error = sizes.error() + if is_along { 4.0 * ALONG } else { 0.0 };
        let mut swept = SweptQuadric {
            centre: centre_vx - 0.5,
            yy: y.length_squared(),
            yz: 2.0 * y.dot(z),
            zz: z.length_squared(),
            tau0: Linear { constant: 0.0, y: 0.0, z: 0.0 },
            end: 0.0,
            drift: 0.0,
            lead: 0.0,
            along: [goes.min(0.0), goes.max(0.0)],
            middle,
            half_length,
            error,
            middle_error: 32.0
                * ROUNDING
                * (sizes.position * half_length + half_length + sizes.coordinate_vx + goes.abs()),
            tame: error < SHORT_ROW / 8.0,
        };
        if !is_along {
            let side = side / speed;
            // The components across the displacement, too.
            let (y_aside, z_aside) = (y - side * y.dot(side), z - side * z.dot(side));
            swept.yy = y_aside.length_squared();
            swept.yz = 2.0 * y_aside.dot(z_aside);
            swept.zz = z_aside.length_squared();
            swept.tau0 = Linear { constant: 0.0, y: y.dot(side), z: z.dot(side) };
            swept.end = speed;
            swept.drift = goes / speed;
            swept.lead = swept.drift / swept.drift.hypot(half_length);
            swept.along = [0.0; 2];
        }
        swept
    }

    #[inline(always)]
    fn most(&self, dy: f64, dz: f64) -> f64 {
        1.0 - self.zz * dz * dz - (self.yy * dy + self.yz * dz) * dy
    }
}

impl RowSolver for SweptQuadric {
    type Local = LocalSwept;

    #[inline(always)]
    fn local(&self, origin: f64, y: f64, z: f64) -> Option<(LocalSwept, f32)> {
        let (dy, dz) = (y - self.centre.y, z - self.centre.z);
        let most = self.most(dy, dz);
        let most_y = -(2.0 * self.yy * dy + self.yz * dz);
        let most_z = -(2.0 * self.zz * dz + self.yz * dy);
        // The function lies nowhere above its tangent plane, so this exceeds any of the 64 values.
        if most + 8.0 * (most_y.max(0.0) + most_z.max(0.0)) < -SHORT_ROW && self.tame {
            return None;
        }
        // A bound on all partial sums, over steps of up to 7.
        let largest = most.abs()
            + 8.0 * (most_y.abs() + most_z.abs())
            + 64.0 * (self.yy.abs() + self.yz.abs() + self.zz.abs());
        let tau0 = self.tau0.at(dy, dz);
        let largest_tau = tau0.abs() + 8.0 * (self.tau0.y.abs() + self.tau0.z.abs()) + self.end;
        let tau_error = 4.0 * ROUNDING_32 * largest_tau + self.error;
        // Tau at an end of a non-empty row is within 1 of tau0, so the error of its square is twice its own.
        let error = 6.0 * ROUNDING_32 * (largest + 1.0) + self.error + 2.5 * tau_error;
        let short = SHORT_ROW.max(4.0 * error);
        let middle = self.middle.at(dy, dz) - origin;
        let largest_x = middle.abs()
            + 8.0 * (self.middle.y.abs() + self.middle.z.abs())
            + self.half_length
            + self.drift.abs() * self.end
            + self.along[1]
            - self.along[0];
        // Where the slope is 0, an error of tau counts by its square times the curvature, which is below 1 / (short /
        // 2)^(3/2) half lengths.
        let bend = tau_error * tau_error / (0.5 * short * (0.5 * short).sqrt());
        let margin = (error / short.sqrt() + bend) * self.half_length
            + 8.0 * ROUNDING_32 * largest_x
            + self.middle_error;
        let mut local = LocalSwept {
            most: [0.0; 8],
            most_y: [0.0; 8],
            tau0: [0.0; 8],
            middle: [0.0; 8],
            short: short as f32,
        };
        for step in 0..8 {
            let step_z = step as f64;
            local.most[step] = (most + (most_z - self.zz * step_z) * step_z) as f32;
            local.most_y[step] = (most_y - self.yz * step_z) as f32;
            local.tau0[step] = (tau0 + self.tau0.z * step_z) as f32;
            local.middle[step] = (middle + self.middle.z * step_z) as f32;
        }
        // Where a number is too large for f32, nothing is certain.
        let largest = largest.max(largest_tau).max(self.drift.abs()).max(largest_x);
        let tame = self.tame && error < 0.1 && largest < 1e30;
        Some((local, if tame { margin as f32 } else { f32::INFINITY }))
    }

    #[inline(always)]
    fn ends<S: Simd>(&self, simd: S, local: &LocalSwept, step_z: usize) -> Ends<S> {
        let steps = f32x8::load_array(simd, STEPS);
        let most = steps * (local.most_y[step_z] - steps * self.yy as f32) + local.most[step_z];
        let tau0 = steps * self.tau0.y as f32 + local.tau0[step_z];
        let middle = steps * self.middle.y as f32 + local.middle[step_z];
        let lead = most.max(0.0).sqrt() * self.lead as f32;
        let low = (tau0 - lead).max(0.0).min(self.end as f32);
        let high = (tau0 + lead).max(0.0).min(self.end as f32);
        let (off_low, off_high) = (low - tau0, high - tau0);
        let (rest_low, rest_high) = (most - off_low * off_low, most - off_high * off_high);
        let (half_length, drift) = (self.half_length as f32, self.drift as f32);
        let from = middle + low * drift - rest_low.max(0.0).sqrt() * half_length;
        let to = middle + high * drift + rest_high.max(0.0).sqrt() * half_length;
        let (from, to) = (from + self.along[0] as f32, to + self.along[1] as f32);
        Ends {
            from,
            // A row outside ends before it begins.
            to: rest_low.simd_lt(0.0).select(from, to),
            doubtful: rest_low.abs().min(rest_high.abs()).simd_lt(local.short),
        }
    }

    fn bracket(&self, y: f64, z: f64) -> Bracket {
        let (dy, dz) = (y - self.centre.y, z - self.centre.z);
        let (most, tau0) = (self.most(dy, dz), self.tau0.at(dy, dz));
        let middle = self.middle.at(dy, dz);
        let known = most + tau0 + middle + self.drift + self.end + self.error + self.middle_error;
        if !known.is_finite() {
            return Bracket::UNKNOWN;
        }
        let tau_error = 8.0 * ROUNDING * (self.tau0.largest(dy, dz) + self.end) + self.error;
        let error = self.error + 4.0 * tau_error * (1.0 + tau_error);
        let margin = self.middle_error + self.drift.abs() * tau_error;
        let lead = most.max(0.0).sqrt() * self.lead;
        let end = |sign: f64| {
            let tau = (tau0 + sign * lead).clamp(0.0, self.end);
            let rest = most - (tau - tau0) * (tau - tau0);
            let at = middle + self.drift * tau + self.along[usize::from(sign > 0.0)];
            let outer = at + sign * ((rest + error).max(0.0).sqrt() * self.half_length + margin);
            let inner = at + sign * ((rest - error).max(0.0).sqrt() * self.half_length - margin);
            (rest, outer, inner)
        };
        let ((low, outer_low, inner_low), (high, outer_high, inner_high)) = (end(-1.0), end(1.0));
        if low.max(high) < -error {
            return Bracket::OUTSIDE;
        }
        let inner = match low.min(high) > error {
            true => [inner_low, inner_high],
            false => Bracket::NONE,
        };
        Bracket { outer: [outer_low, outer_high], inner }
    }
}
