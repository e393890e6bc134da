//! Queries of a session for the head pose at a time of the program's clock: the runtime predicts
//! it.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use openxr as xr;
use tracking::pose::Velocity;
use tracking::{HeadPose, HostClock, Placement};

use super::error::{Doing, Result};
use super::link::{RoomOrigin, make_room};

/// Confidence in a head whose position the runtime only estimates.
const GUESSED: f64 = 0.5;
/// Longest prediction, in seconds.
const FARTHEST_S: f64 = 0.1;

/// The parameters of a query, whoever owns the session.
#[derive(Clone, Debug)]
pub(super) struct Wish {
    /// [`HeadPose::source`] of the poses.
    pub label: Arc<str>,
    pub origin: RoomOrigin,
    pub clock: HostClock,
}

/// The result of a query.
pub(super) enum Sight {
    Seen(HeadPose),
    /// The runtime does not track the head.
    Unknown,
    /// A number is not finite.
    NotFinite,
}

/// Queries a session.
pub(super) struct Locator {
    head: xr::Space,
    room: xr::Space,
    instance: xr::Instance,
    wish: Wish,
}

impl Locator {
    /// The instance must have the extension for time conversion ([`ask_for_clock`]).
    pub fn new<G: xr::Graphics>(session: &xr::Session<G>, wish: &Wish) -> Result<Locator> {
        let head = session
            .create_reference_space(xr::ReferenceSpaceType::VIEW, xr::Posef::IDENTITY)
            .doing("find the head")?;
        Ok(Locator {
            head,
            room: make_room(session, wish.origin)?,
            instance: session.instance().clone(),
            wish: wish.clone(),
        })
    }

    /// The head pose at `time_s`.
    pub fn look(&self, time_s: f64) -> Result<Sight> {
        let now = self.instance.now().doing("tell the time")?;
        let ahead_s = (time_s - self.wish.clock.now_s()).clamp(-FARTHEST_S, FARTHEST_S);
        let time = xr::Time::from_nanos(now.as_nanos() + (ahead_s * 1e9).round() as i64);
        let (at, moves) = self.head.relate(&self.room, time).doing("find the head")?;
        use xr::SpaceLocationFlags as Flags;
        if !at.location_flags.contains(Flags::ORIENTATION_VALID | Flags::POSITION_VALID) {
            return Ok(Sight::Unknown);
        }
        let tracked = Flags::ORIENTATION_TRACKED | Flags::POSITION_TRACKED;
        let q = at.pose.orientation;
        let orientation = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into());
        let Some(placement) = Placement::checked(vector(at.pose.position), orientation) else {
            return Ok(Sight::NotFinite);
        };
        use xr::SpaceVelocityFlags as Known;
        let velocity = moves
            .velocity_flags
            .contains(Known::LINEAR_VALID | Known::ANGULAR_VALID)
            .then(|| {
                Velocity::checked(vector(moves.linear_velocity), vector(moves.angular_velocity))
            })
            .flatten();
        Ok(Sight::Seen(HeadPose {
            placement,
            time_s,
            sender_time: None,
            source: self.wish.label.clone(),
            sensor: 0,
            confidence: if at.location_flags.contains(tracked) { 1.0 } else { GUESSED },
            velocity,
        }))
    }

    /// The runtime's prediction, if it tracks the head.
    pub fn foreseen(&self, time_s: f64) -> Option<HeadPose> {
        match self.look(time_s) {
            Ok(Sight::Seen(pose)) => Some(pose),
            Ok(Sight::Unknown | Sight::NotFinite) => None,
            Err(error) => {
                // The owner of the session gets this error, too, and reports it.
                tracing::debug!("the head is not found: {error}");
                None
            }
        }
    }
}

/// Enables the extension for time conversion; whether it is available.
#[cfg(not(windows))]
pub(super) fn ask_for_clock(extensions: &mut xr::ExtensionSet, offered: &xr::ExtensionSet) -> bool {
    extensions.khr_convert_timespec_time = offered.khr_convert_timespec_time;
    offered.khr_convert_timespec_time
}

#[cfg(windows)]
pub(super) fn ask_for_clock(extensions: &mut xr::ExtensionSet, offered: &xr::ExtensionSet) -> bool {
    let offers = offered.khr_win32_convert_performance_counter_time;
    extensions.khr_win32_convert_performance_counter_time = offers;
    offers
}

fn vector(v: xr::Vector3f) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}
