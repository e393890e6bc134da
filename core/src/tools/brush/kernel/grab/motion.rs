//! The motion of clay in a ball ([`crate::tools::brush::kernel::grab`]): pulled along a displacement, twisted about an
//! axis or pinched towards it.
//!
//! From a motion to the shift of eight voxels of a row in one small step. Twist rotates each sphere about the centre as
//! a whole; pinch is the curl of a stream function about its axis. So both preserve volume, up to the rounding of a
//! step.

use glam::{DVec3, Vec3};

use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::tools::brush::falloff::Falloff;
use crate::tools::symmetry::SymmetryTransform;

/// One number along each axis for eight voxels of a row of a brick.
pub type RowVectors = [[f32; EDGE]; 3];
pub const EDGE: usize = BRICK_EDGE_VX as usize;

/// The motion of the clay in a ball.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Motion {
    /// Translates.
    Pull {
        /// The displacement of the centre, in voxels; at most [`crate::tools::brush::limits::MAX_PULL_VX`] along each
        /// axis.
        by_vx: Vec3,
    },
    /// Rotates about an axis through the centre.
    Twist {
        /// The axis, of any length; lengths are in units of the smallest voxel edge.
        normal: Vec3,
        /// The rotation of the centre, in degrees, counter-clockwise seen from where the axis points; at most
        /// [`crate::tools::brush::limits::MAX_TWIST_DEG`] either way.
        angle_deg: f32,
    },
    /// Gathers at an axis through the centre, and yields along it.
    Pinch {
        /// The axis, as for a twist.
        normal: Vec3,
        /// Around the centre, distances from the axis shrink by the factor e^-strength. From -1 to 1; below 0 the clay
        /// spreads.
        strength: f32,
    },
}

/// One small step of a motion.
#[derive(Clone, Copy)]
pub enum MotionStep {
    /// A shift in voxels, with the ball.
    Shift(DVec3),
    /// A rotation about an axis of length 1, by an angle in radians.
    Turn { axis: DVec3, angle: f64 },
    /// A contraction towards an axis of length 1.
    Gather { axis: DVec3, strength: f64 },
}

/// One of several balls of clay moved together, relative to the origin of the flow.
pub struct Pull {
    pub centre: DVec3,
    pub step: MotionStep,
}

impl Motion {
    /// Returns an image of one of `steps` steps of this motion.
    pub fn step(&self, steps: usize, image: &SymmetryTransform) -> MotionStep {
        let share = 1.0 / steps as f64;
        let unit = |normal: Vec3| image.normal(normal.as_dvec3().normalize_or(DVec3::Y));
        match *self {
            Motion::Pull { by_vx } => {
                MotionStep::Shift(image.vector_exactly(by_vx.as_dvec3() * share))
            }
            // A mirror reverses rotations.
            Motion::Twist { normal, angle_deg } => MotionStep::Turn {
                axis: unit(normal) * if image.is_reflection() { -1.0 } else { 1.0 },
                angle: f64::from(angle_deg).to_radians() * share,
            },
            Motion::Pinch { normal, strength } => {
                MotionStep::Gather { axis: unit(normal), strength: f64::from(strength) * share }
            }
        }
    }

    /// Returns the steepest slope of the motion, which is divided among the steps. `stretch`: voxel edges in units of
    /// the smallest.
    pub fn slope(&self, stretch: DVec3, radius: f64, falloff: Falloff) -> f64 {
        match *self {
            Motion::Pull { by_vx } => {
                (by_vx.as_dvec3() * stretch).length() * falloff.steepest() / radius
            }
            Motion::Twist { angle_deg, .. } => {
                f64::from(angle_deg).to_radians().abs() * falloff.steepest_twist()
            }
            Motion::Pinch { strength, .. } => f64::from(strength).abs() * falloff.steepest_pinch(),
        }
    }

    /// Returns whether the clay does not move.
    pub fn is_still(&self) -> bool {
        match *self {
            Motion::Pull { by_vx } => by_vx == Vec3::ZERO,
            Motion::Twist { angle_deg, .. } => angle_deg == 0.0,
            Motion::Pinch { strength, .. } => strength == 0.0,
        }
    }
}

impl Pull {
    /// Returns the displacement of the ball itself in a step, in voxels.
    pub fn displacement(&self) -> DVec3 {
        match self.step {
            MotionStep::Shift(by) => by,
            MotionStep::Turn { .. } | MotionStep::Gather { .. } => DVec3::ZERO,
        }
    }

    /// Returns the greatest displacements of clay in a step, in the negative and positive directions of the axes, in
    /// voxels.
    pub fn furthest(&self, radius: f64, stretch: DVec3, falloff: Falloff) -> [DVec3; 2] {
        let round = |share: f64| [DVec3::splat(share * radius) / stretch; 2];
        match self.step {
            MotionStep::Shift(by) => [(-by).max(DVec3::ZERO), by.max(DVec3::ZERO)],
            MotionStep::Turn { angle, .. } => round(angle.abs() * falloff.widest_twist()),
            // Along the axis it moves up to twice as far as a twist by the same number.
            MotionStep::Gather { strength, .. } => {
                round(2.0 * strength.abs() * falloff.widest_twist())
            }
        }
    }

    /// Returns the displacement of the clay at eight points in a step, in voxels. `from_centre`: the points relative to
    /// the ball's centre, in units of the smallest edge.
    #[inline(always)]
    pub fn shift(
        &self,
        from_centre: &RowVectors,
        stretch: DVec3,
        radius: f64,
        falloff: Falloff,
        shift: &mut RowVectors,
    ) {
        let inverse = (1.0 / radius) as f32;
        let inverse = inverse * inverse;
        let mut squared = [0.0f32; EDGE];
        for along in from_centre {
            for x in 0..EDGE {
                squared[x] += along[x] * along[x];
            }
        }
        match self.step {
            MotionStep::Shift(by) => {
                let by = by.as_vec3().to_array();
                for x in 0..EDGE {
                    let share = falloff.at(squared[x] * inverse);
                    for axis in 0..3 {
                        shift[axis][x] = by[axis] * share;
                    }
                }
            }
            MotionStep::Turn { axis, angle } => {
                let (n, angle) = (axis.as_vec3(), angle as f32);
                for x in 0..EDGE {
                    let a = angle * falloff.at(squared[x] * inverse);
                    // Far below a right angle these series are exact enough.
                    let aa = a * a;
                    let sine = a * (1.0 - aa / 6.0 * (1.0 - aa / 20.0));
                    let less = aa * 0.5 * (1.0 - aa / 12.0 * (1.0 - aa / 30.0));
                    let p = [from_centre[0][x], from_centre[1][x], from_centre[2][x]];
                    let c = cross(n, p);
                    let cc = cross(n, c);
                    for axis in 0..3 {
                        shift[axis][x] = sine * c[axis] + less * cc[axis];
                    }
                }
            }
            MotionStep::Gather { axis, strength } => {
                let (n, strength) = (axis.as_vec3().to_array(), strength as f32);
                for x in 0..EDGE {
                    let p = [from_centre[0][x], from_centre[1][x], from_centre[2][x]];
                    let height = n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
                    let (share, slope) = falloff.at_with_slope(squared[x] * inverse);
                    let slope = slope * inverse;
                    // With the distance rho from the axis and the height z: the curl of rho^2 z share.
                    let across = -strength * (share + 2.0 * height * height * slope);
                    let beside = squared[x] - height * height;
                    let up = 2.0 * strength * height * (share + beside * slope);
                    for axis in 0..3 {
                        shift[axis][x] = (p[axis] - n[axis] * height) * across + n[axis] * up;
                    }
                }
            }
        }
        if !matches!(self.step, MotionStep::Shift(_)) {
            let stretch = stretch.as_vec3().to_array();
            for (shift, edge) in shift.iter_mut().zip(stretch) {
                for along in shift {
                    *along /= edge;
                }
            }
        }
    }
}

#[inline(always)]
fn cross(a: Vec3, b: [f32; 3]) -> [f32; 3] {
    [a.y * b[2] - a.z * b[1], a.z * b[0] - a.x * b[2], a.x * b[1] - a.y * b[0]]
}
