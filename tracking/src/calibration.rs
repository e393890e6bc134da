//! Calibration: the transform from a tracker's axes to those of the screen (rotation, translation, scale) and the
//! offset from the sensor to the eyes. Comes from settings or is fitted to touches of the screen's corners; knows
//! nothing of particular trackers.
//!
//! Screen axes: origin at the centre of the screen, x right, y up, z towards the viewer, metres.

use glam::{DMat3, DQuat, DVec3, EulerRot};
use thiserror::Error;

use crate::eigen::symmetric_eigen;
use crate::pose::{Placement, Velocity};

/// The reason why a calibration is refused.
#[derive(Clone, Copy, PartialEq, Debug, Error)]
pub enum CalibrationError {
    #[error("a calibration needs 3 to 64 touches, not {0}")]
    Count(usize),
    #[error("a number of the calibration is not finite or is absurdly large")]
    NotFinite,
    #[error("the {side} points lie on one spot or one line (breadth {breadth_m:.4} m)")]
    Degenerate { side: &'static str, breadth_m: f64 },
    #[error("the touches do not determine the rotation; touch four different corners")]
    Ambiguous,
    #[error("the scale {0} is outside 0.01 to 100")]
    Scale(f64),
}

/// If the touched points spread less than this across their longest direction (root mean square, metres), the
/// rotation about that direction is determined by noise.
pub const MIN_BREADTH_M: f64 = 0.01;

/// The transform from tracker to screen, and the offset from sensor to eyes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Calibration {
    /// Rotation from tracker axes to screen axes.
    pub rotation: DQuat,
    /// The tracker's origin in screen axes, metres.
    pub translation_m: DVec3,
    /// Screen metres per tracker metre; 1 if the tracker reports true metres.
    pub scale: f64,
    /// The point between the eyes, and the head's axes, in the axes of the sensor, metres.
    pub sensor_from_eyes: Placement,
}

impl Default for Calibration {
    fn default() -> Self {
        Self {
            rotation: DQuat::IDENTITY,
            translation_m: DVec3::ZERO,
            scale: 1.0,
            sensor_from_eyes: Placement::IDENTITY,
        }
    }
}

/// Returns the rotation by yaw about +y, then pitch about the turned x, then roll about the turned z, in degrees, all
/// counter-clockwise seen against the axis.
pub fn rotation_from_degrees(yaw: f64, pitch: f64, roll: f64) -> DQuat {
    DQuat::from_euler(EulerRot::YXZ, yaw.to_radians(), pitch.to_radians(), roll.to_radians())
}

impl Calibration {
    /// Creates it from values of a config file; angles as in [`rotation_from_degrees`].
    pub fn from_values(
        translation_m: DVec3,
        yaw_pitch_roll_deg: [f64; 3],
        scale: f64,
    ) -> Result<Self, CalibrationError> {
        let [yaw, pitch, roll] = yaw_pitch_roll_deg;
        let placement = Placement::checked(translation_m, rotation_from_degrees(yaw, pitch, roll))
            .ok_or(CalibrationError::NotFinite)?;
        Ok(Self {
            rotation: placement.orientation,
            translation_m: placement.position_m,
            scale: checked_scale(scale)?,
            sensor_from_eyes: Placement::IDENTITY,
        })
    }

    /// Transforms a point from tracker axes to screen axes.
    pub fn point(&self, tracker_m: DVec3) -> DVec3 {
        self.rotation * (tracker_m * self.scale) + self.translation_m
    }

    /// Returns the eyes in screen axes, from the sensor in tracker axes.
    pub fn apply(&self, sensor: Placement) -> Placement {
        let turned = (self.rotation * sensor.orientation).normalize();
        Placement {
            position_m: self.point(sensor.position_m) + turned * self.sensor_from_eyes.position_m,
            orientation: (turned * self.sensor_from_eyes.orientation).normalize(),
        }
    }

    /// Returns the velocity for the result of [`Self::apply`] of the same sensor.
    pub fn apply_velocity(&self, sensor: Placement, velocity: Velocity) -> Velocity {
        let angular_rad_s = self.rotation * velocity.angular_rad_s;
        let arm_m = self.rotation * sensor.orientation * self.sensor_from_eyes.position_m;
        Velocity {
            linear_m_s: self.rotation * (velocity.linear_m_s * self.scale)
                + angular_rad_s.cross(arm_m),
            angular_rad_s,
        }
    }
}

fn checked_scale(scale: f64) -> Result<f64, CalibrationError> {
    if (0.01..=100.0).contains(&scale) { Ok(scale) } else { Err(CalibrationError::Scale(scale)) }
}

/// One touch: a point of the screen, and the tracked position of the pointing tip at that time, metres.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Touch {
    pub tracker_m: DVec3,
    pub screen_m: DVec3,
}

impl Touch {
    /// Returns a touch with a tip at `tip_m` in sensor axes.
    pub fn with_tip(sensor: Placement, tip_m: DVec3, screen_m: DVec3) -> Self {
        Self { tracker_m: sensor.position_m + sensor.orientation * tip_m, screen_m }
    }
}

/// Returns the corners to touch, in order: top left, top right, bottom right, bottom left.
pub fn screen_corners_m(width_m: f64, height_m: f64) -> [DVec3; 4] {
    let (x, y) = (width_m / 2.0, height_m / 2.0);
    [DVec3::new(-x, y, 0.0), DVec3::new(x, y, 0.0), DVec3::new(x, -y, 0.0), DVec3::new(-x, -y, 0.0)]
}

/// A fitted calibration and its residuals.
#[derive(Clone, PartialEq, Debug)]
pub struct CalibrationFit {
    pub calibration: Calibration,
    /// Distance in screen axes between each touched point and its fitted position, metres.
    pub residuals_m: Vec<f64>,
    /// Root mean square of the residuals.
    pub rms_m: f64,
}

impl CalibrationFit {
    /// Returns the largest residual, metres.
    pub fn max_m(&self) -> f64 {
        self.residuals_m.iter().copied().fold(0.0, f64::max)
    }
}

/// Returns the rigid transform, with scale if `with_scale`, that fits the touches' tracker points to their screen
/// points by least squares. Needs three or more touches that are not collinear; the corners of a screen, which are
/// coplanar, are enough.
///
/// B. K. P. Horn: "Closed-form solution of absolute orientation using unit quaternions", 1987.
pub fn fit_touches(
    touches: &[Touch],
    with_scale: bool,
) -> Result<CalibrationFit, CalibrationError> {
    if !(3..=64).contains(&touches.len()) {
        return Err(CalibrationError::Count(touches.len()));
    }
    for touch in touches {
        for point in [touch.tracker_m, touch.screen_m] {
            Placement::checked(point, DQuat::IDENTITY).ok_or(CalibrationError::NotFinite)?;
        }
    }
    let count = touches.len() as f64;
    let tracker_centre = touches.iter().map(|t| t.tracker_m).sum::<DVec3>() / count;
    let screen_centre = touches.iter().map(|t| t.screen_m).sum::<DVec3>() / count;
    let pairs: Vec<(DVec3, DVec3)> = touches
        .iter()
        .map(|t| (t.tracker_m - tracker_centre, t.screen_m - screen_centre))
        .collect();
    check_breadth("tracker", pairs.iter().map(|pair| pair.0))?;
    check_breadth("screen", pairs.iter().map(|pair| pair.1))?;

    let rotation = best_rotation(&pairs)?;
    let scale = if with_scale {
        let along: f64 = pairs.iter().map(|(a, b)| b.dot(rotation * *a)).sum();
        checked_scale(along / pairs.iter().map(|(a, _)| a.length_squared()).sum::<f64>())?
    } else {
        1.0
    };
    let calibration = Calibration {
        rotation,
        translation_m: screen_centre - rotation * (tracker_centre * scale),
        scale,
        sensor_from_eyes: Placement::IDENTITY,
    };
    let residuals_m: Vec<f64> =
        touches.iter().map(|t| calibration.point(t.tracker_m).distance(t.screen_m)).collect();
    let rms_m = (residuals_m.iter().map(|r| r * r).sum::<f64>() / count).sqrt();
    Ok(CalibrationFit { calibration, residuals_m, rms_m })
}

/// Refuses centred points whose spread across their longest direction is below [`MIN_BREADTH_M`].
fn check_breadth(
    side: &'static str,
    points: impl ExactSizeIterator<Item = DVec3>,
) -> Result<(), CalibrationError> {
    let count = points.len() as f64;
    let outer = |p: DVec3| DMat3::from_cols(p * p.x, p * p.y, p * p.z);
    let covariance = points.map(outer).sum::<DMat3>() * (1.0 / count);
    let breadth_m = symmetric_eigen(covariance.to_cols_array_2d())[1].0.max(0.0).sqrt();
    if breadth_m < MIN_BREADTH_M {
        return Err(CalibrationError::Degenerate { side, breadth_m });
    }
    Ok(())
}

/// Returns Horn's quaternion: the eigenvector of the largest eigenvalue of his matrix N.
fn best_rotation(pairs: &[(DVec3, DVec3)]) -> Result<DQuat, CalibrationError> {
    // Column j holds the sum of a times component j of b.
    let sums: DMat3 =
        pairs.iter().map(|(a, b)| DMat3::from_cols(*a * b.x, *a * b.y, *a * b.z)).sum();
    let s = |a: usize, b: usize| sums.col(b)[a];
    let n = [
        [s(0, 0) + s(1, 1) + s(2, 2), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0)],
        [0.0, s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2)],
        [0.0, 0.0, s(1, 1) - s(0, 0) - s(2, 2), s(1, 2) + s(2, 1)],
        [0.0, 0.0, 0.0, s(2, 2) - s(0, 0) - s(1, 1)],
    ];
    let eigen = symmetric_eigen(n);
    if eigen[0].0 - eigen[1].0 <= 1.0e-6 * eigen[0].0.abs() {
        return Err(CalibrationError::Ambiguous);
    }
    let [w, x, y, z] = eigen[0].1;
    Ok(DQuat::from_xyzw(x, y, z, w).normalize())
}

#[cfg(test)]
#[path = "calibration_tests.rs"]
mod tests;
