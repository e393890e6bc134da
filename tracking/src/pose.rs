//! Poses: position and orientation of a tracked object, with time and source. Takes arbitrary numbers, gives poses
//! whose numbers are finite, bounded and normalised. Reads no clock: time is a value in seconds on the host's
//! monotonic clock, whose zero the program chooses (see [`crate::HostClock`]).

use std::sync::Arc;
use std::time::Duration;

use glam::{DQuat, DVec3};

/// Positions further away than this, in metres, are rejected.
pub const MAX_POSITION_M: f64 = 1.0e5;
/// Speeds above this, in metres per second, are rejected.
pub const MAX_SPEED_M_S: f64 = 1.0e3;
/// Angular speeds above this, in radians per second, are rejected.
pub const MAX_ANGULAR_SPEED_RAD_S: f64 = 1.0e3;

/// A rigid placement: position in metres and unit orientation, both in the axes of the tracker or of the screen.
/// Axes are right-handed: x right, y up, z towards the viewer.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Placement {
    pub position_m: DVec3,
    pub orientation: DQuat,
}

impl Placement {
    pub const IDENTITY: Self = Self { position_m: DVec3::ZERO, orientation: DQuat::IDENTITY };

    /// Checks and normalises. Returns `None` if a number is not finite, the position is further away than
    /// [`MAX_POSITION_M`], or the quaternion is (nearly) zero.
    pub fn checked(position_m: DVec3, orientation: DQuat) -> Option<Self> {
        let length = orientation.length();
        let sound = position_m.is_finite()
            && position_m.abs().max_element() <= MAX_POSITION_M
            && length.is_finite()
            && length > 1.0e-6;
        sound.then(|| Self { position_m, orientation: (orientation / length).normalize() })
    }

    /// Interpolates: `share` 0 gives `self`, 1 gives `other`; rotates the shorter way.
    pub fn blend(self, other: Self, share: f64) -> Self {
        Self {
            position_m: self.position_m.lerp(other.position_m, share),
            orientation: self.orientation.slerp(other.orientation, share).normalize(),
        }
    }

    /// Returns the angle in radians, 0 to pi, between the two orientations.
    pub fn angle_to(self, other: Self) -> f64 {
        rotation_vector(other.orientation * self.orientation.inverse()).length()
    }
}

/// Returns the rotation vector: axis times angle in radians, the angle at most pi.
pub fn rotation_vector(rotation: DQuat) -> DVec3 {
    let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    let axis = DVec3::new(rotation.x, rotation.y, rotation.z) * sign;
    let sine = axis.length();
    if sine < 1.0e-12 {
        return axis * 2.0;
    }
    axis / sine * (2.0 * sine.atan2(rotation.w * sign))
}

/// The velocity of a tracked object, in the axes of its placement.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Velocity {
    pub linear_m_s: DVec3,
    /// Axis times radians per second, in the fixed axes (not those of the moving object).
    pub angular_rad_s: DVec3,
}

impl Velocity {
    /// Checks the numbers. Returns `None` if one is not finite or exceeds the limits of this module.
    pub fn checked(linear_m_s: DVec3, angular_rad_s: DVec3) -> Option<Self> {
        let sound = linear_m_s.is_finite()
            && angular_rad_s.is_finite()
            && linear_m_s.abs().max_element() <= MAX_SPEED_M_S
            && angular_rad_s.abs().max_element() <= MAX_ANGULAR_SPEED_RAD_S;
        sound.then_some(Self { linear_m_s, angular_rad_s })
    }
}

/// One report about one tracked object.
#[derive(Clone, PartialEq, Debug)]
pub struct HeadPose {
    pub placement: Placement,
    /// Time of the pose: seconds on the host's clock.
    pub time_s: f64,
    /// The sender's own wall clock since 1970, if it sends one.
    pub sender_time: Option<Duration>,
    /// The source's name for the reporting device: a VRPN device, `opentrack`, a script's name.
    pub source: Arc<str>,
    pub sensor: u32,
    /// 0 (a guess) to 1 (measured).
    pub confidence: f64,
    /// The velocity, if the tracker measures it.
    pub velocity: Option<Velocity>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn garbage_is_refused() {
        let p = DVec3::ONE;
        assert!(Placement::checked(DVec3::new(f64::NAN, 0.0, 0.0), DQuat::IDENTITY).is_none());
        assert!(Placement::checked(DVec3::splat(1e300), DQuat::IDENTITY).is_none());
        assert!(Placement::checked(p, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0)).is_none());
        assert!(Placement::checked(p, DQuat::from_xyzw(1e200, 1e200, 0.0, 0.0)).is_none());
        assert!(Placement::checked(p, DQuat::from_xyzw(0.0, f64::INFINITY, 0.0, 1.0)).is_none());
        assert!(Velocity::checked(DVec3::splat(1e9), DVec3::ZERO).is_none());
        assert!(Velocity::checked(DVec3::ZERO, DVec3::splat(f64::NAN)).is_none());
        assert!(Velocity::checked(DVec3::ONE, DVec3::ONE).is_some());
    }

    proptest! {
        #[test]
        fn rotation_vector_inverts_the_exponential(x in -1.8..1.8f64, y in -1.8..1.8f64, z in -1.7..1.7f64) {
            let v = DVec3::new(x, y, z);
            prop_assume!(v.length() < 3.1);
            let q = DQuat::from_scaled_axis(v);
            prop_assert!(rotation_vector(q).distance(v) < 1e-9);
            prop_assert!(rotation_vector(-q).distance(v) < 1e-9);
        }

        #[test]
        fn checked_normalises(x in -9.0..9.0f64, y in -9.0..9.0f64, z in -9.0..9.0f64, w in 0.1..9.0f64) {
            let placement = Placement::checked(DVec3::ZERO, DQuat::from_xyzw(x, y, z, w)).unwrap();
            prop_assert!((placement.orientation.length() - 1.0).abs() < 1e-12);
        }
    }
}
