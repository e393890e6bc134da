//! Asks a session for the head pose that the runtime predicts for a time of the program's clock. Used by any session
//! that tracks the head; knows no threads.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use openxr as xr;
use tracking::pose::Velocity;
use tracking::{HeadPose, HostClock, Placement};

use super::error::{Doing, Result};
use super::room_space::{RoomOrigin, create_room_space};

/// Confidence of a pose that the runtime only estimates.
const ESTIMATED_CONFIDENCE: f64 = 0.5;
/// Longest prediction, in seconds.
const MAX_PREDICTION_S: f64 = 0.1;

/// The parameters of head queries, independent of the session.
#[derive(Clone, Debug)]
pub(super) struct LocatorOptions {
    /// [`HeadPose::source`] of the poses.
    pub label: Arc<str>,
    pub origin: RoomOrigin,
    pub clock: HostClock,
}

/// The result of a query.
pub(super) enum HeadLocation {
    Tracked(HeadPose),
    /// The runtime does not track the head.
    NotTracked,
    /// A number is not finite.
    NotFinite,
}

/// Locates the head in a session.
pub(super) struct HeadLocator {
    head: xr::Space,
    room: xr::Space,
    instance: xr::Instance,
    options: LocatorOptions,
}

impl HeadLocator {
    /// Creates a locator. The instance must have the extension for time conversion ([`enable_time_conversion`]).
    pub fn new<G: xr::Graphics>(
        session: &xr::Session<G>,
        options: &LocatorOptions,
    ) -> Result<HeadLocator> {
        let head = session
            .create_reference_space(xr::ReferenceSpaceType::VIEW, xr::Posef::IDENTITY)
            .doing("find the head")?;
        Ok(HeadLocator {
            head,
            room: create_room_space(session, options.origin)?,
            instance: session.instance().clone(),
            options: options.clone(),
        })
    }

    /// Returns the head pose at `time_s`.
    pub fn locate(&self, time_s: f64) -> Result<HeadLocation> {
        let now = self.instance.now().doing("read its clock")?;
        let ahead_s =
            (time_s - self.options.clock.now_s()).clamp(-MAX_PREDICTION_S, MAX_PREDICTION_S);
        let time = xr::Time::from_nanos(now.as_nanos() + (ahead_s * 1e9).round() as i64);
        let (location, motion) = self.head.relate(&self.room, time).doing("find the head")?;
        use xr::SpaceLocationFlags as Flags;
        if !location.location_flags.contains(Flags::ORIENTATION_VALID | Flags::POSITION_VALID) {
            return Ok(HeadLocation::NotTracked);
        }
        let tracked = Flags::ORIENTATION_TRACKED | Flags::POSITION_TRACKED;
        let q = location.pose.orientation;
        let orientation = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into());
        let Some(placement) = Placement::checked(vector(location.pose.position), orientation)
        else {
            return Ok(HeadLocation::NotFinite);
        };
        use xr::SpaceVelocityFlags as VelocityFlags;
        let velocity = motion
            .velocity_flags
            .contains(VelocityFlags::LINEAR_VALID | VelocityFlags::ANGULAR_VALID)
            .then(|| {
                Velocity::checked(vector(motion.linear_velocity), vector(motion.angular_velocity))
            })
            .flatten();
        Ok(HeadLocation::Tracked(HeadPose {
            placement,
            time_s,
            sender_time: None,
            source: self.options.label.clone(),
            sensor: 0,
            confidence: if location.location_flags.contains(tracked) {
                1.0
            } else {
                ESTIMATED_CONFIDENCE
            },
            velocity,
        }))
    }

    /// Returns the runtime's prediction, if it tracks the head.
    pub fn predict(&self, time_s: f64) -> Option<HeadPose> {
        match self.locate(time_s) {
            Ok(HeadLocation::Tracked(pose)) => Some(pose),
            Ok(HeadLocation::NotTracked | HeadLocation::NotFinite) => None,
            Err(error) => {
                // The owner of the session gets this error as well, and reports it.
                tracing::debug!("the head cannot be located: {error}");
                None
            }
        }
    }
}

/// Enables the extension that converts between the runtime's clock and the system's. Returns false if the runtime lacks
/// it.
#[cfg(not(windows))]
pub(super) fn enable_time_conversion(
    extensions: &mut xr::ExtensionSet,
    offered: &xr::ExtensionSet,
) -> bool {
    extensions.khr_convert_timespec_time = offered.khr_convert_timespec_time;
    offered.khr_convert_timespec_time
}

#[cfg(windows)]
pub(super) fn enable_time_conversion(
    extensions: &mut xr::ExtensionSet,
    offered: &xr::ExtensionSet,
) -> bool {
    let available = offered.khr_win32_convert_performance_counter_time;
    extensions.khr_win32_convert_performance_counter_time = available;
    available
}

fn vector(v: xr::Vector3f) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}
