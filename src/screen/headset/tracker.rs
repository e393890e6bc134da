//! Owns a headset that shows nothing and only says where the head is (`XR_MND_headless`): a source of
//! poses for the view through a screen.
//!
//! Takes the origin; gives poses on the room's axes, a runtime that is missing or has gone as a text,
//! and looks for it again. Everything happens on a thread of its own. Must not know screens.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use glam::{DQuat, DVec3};
use openxr as xr;
use tracking::pose::Velocity;
use tracking::{Counters, Event, HeadPose, HostClock, Inbox, Placement, Source, SourceState};

use super::error::{Doing, HeadsetError, Result};
use super::lifecycle::{Answer, Lifecycle};
use super::link::{RoomOrigin, make_room};
use super::runtime::{VIEWS, enter, reach};

/// Between two looks for the head: more often than any screen shows pictures.
const LOOK_EVERY: Duration = Duration::from_millis(4);
/// Between two looks for a runtime.
const SEEK_EVERY: Duration = Duration::from_secs(2);
/// Confidence in a head whose place the runtime only guesses.
const GUESSED: f64 = 0.5;

/// What the thread shares with the program.
struct Shared {
    inbox: Inbox,
    stop: AtomicBool,
    state: Mutex<SourceState>,
    accepted: AtomicU64,
    not_finite: AtomicU64,
    connections: AtomicU64,
}

impl Shared {
    fn enter(&self, state: SourceState) {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) = state;
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Says where the head in a headset is. Dropping it ends the session.
pub struct HeadsetTracker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl HeadsetTracker {
    /// `label`: [`HeadPose::source`] of the poses. Fails if there is no thread to be had.
    pub fn start(
        label: &str,
        origin: RoomOrigin,
        clock: HostClock,
    ) -> std::io::Result<HeadsetTracker> {
        let shared = Arc::new(Shared {
            inbox: Inbox::default(),
            stop: AtomicBool::new(false),
            state: Mutex::new(SourceState::Seeking("looking for an OpenXR runtime".to_owned())),
            accepted: AtomicU64::new(0),
            not_finite: AtomicU64::new(0),
            connections: AtomicU64::new(0),
        });
        let (theirs, label) = (shared.clone(), Arc::from(label));
        let thread = thread::Builder::new()
            .name("headset tracker".to_owned())
            .spawn(move || seek(&theirs, &label, origin, clock))?;
        Ok(HeadsetTracker { shared, thread: Some(thread) })
    }
}

/// Connects, follows the head until the runtime goes, and connects again.
fn seek(shared: &Shared, label: &Arc<str>, origin: RoomOrigin, clock: HostClock) {
    while !shared.stops() {
        let why = match Session::connect(origin) {
            Ok(mut session) => {
                shared.connections.fetch_add(1, Ordering::Relaxed);
                let (source, time_s) = (label.clone(), clock.now_s());
                shared.inbox.put(&mut vec![Event::Found { source, time_s }]);
                let why = match session.follow(shared, label, clock) {
                    Ok(()) => format!("{} has ended the session", session.name),
                    Err(error) => error.to_string(),
                };
                let (source, time_s) = (label.clone(), clock.now_s());
                shared.inbox.put(&mut vec![Event::Lost { source, time_s }]);
                why
            }
            Err(error) => error.to_string(),
        };
        shared.enter(SourceState::Seeking(why));
        let start = Instant::now();
        while start.elapsed() < SEEK_EVERY && !shared.stops() {
            thread::sleep(Duration::from_millis(20));
        }
    }
}

/// A session without pictures.
struct Session {
    head: xr::Space,
    room: xr::Space,
    session: xr::Session<xr::Headless>,
    instance: xr::Instance,
    /// The runtime's name and the headset's.
    name: String,
}

impl Session {
    fn connect(origin: RoomOrigin) -> Result<Session> {
        let (entry, offered) = reach()?;
        let mut extensions = xr::ExtensionSet::default();
        extensions.mnd_headless = true;
        let tells_time = ask_for_clock(&mut extensions, &offered);
        if !offered.mnd_headless || !tells_time {
            return Err(HeadsetError::Unsuitable {
                runtime: "of this machine".to_string(),
                lack: "has no headset that only tracks (XR_MND_headless and a clock); take Monado \
                       or SteamVR"
                    .to_string(),
            });
        }
        let (instance, system, name) = enter(&entry, &extensions)?;
        let info = xr::headless::SessionCreateInfo {};
        // SAFETY: without graphics there are no handles that could be wrong.
        let (session, ..) = unsafe { instance.create_session::<xr::Headless>(system, &info) }
            .doing("begin a session without pictures")?;
        let head = session
            .create_reference_space(xr::ReferenceSpaceType::VIEW, xr::Posef::IDENTITY)
            .doing("find the head")?;
        let room = make_room(&session, origin)?;
        tracing::info!("headset as a tracker: {name}");
        Ok(Session { head, room, session, instance, name })
    }

    /// Reports the head until the program has enough, or the runtime ends the session.
    fn follow(&mut self, shared: &Shared, label: &Arc<str>, clock: HostClock) -> Result<()> {
        let mut lifecycle = Lifecycle::default();
        let mut events = xr::EventDataBuffer::new();
        let mut reports = Vec::new();
        while !shared.stops() {
            while let Some(event) =
                self.instance.poll_event(&mut events).doing("hear the runtime")?
            {
                let answer = match event {
                    xr::Event::SessionStateChanged(event) => lifecycle.enter(event.state()),
                    xr::Event::InstanceLossPending(_) => Answer::Leave { again: true },
                    _ => Answer::Nothing,
                };
                match answer {
                    Answer::Begin => {
                        self.session.begin(VIEWS).doing("begin to track")?;
                    }
                    Answer::End => {
                        self.session.end().doing("end tracking")?;
                    }
                    Answer::Leave { .. } => return Ok(()),
                    Answer::Nothing => {}
                }
            }
            if lifecycle.is_running() {
                self.look(shared, label, clock, &mut reports)?;
                shared.inbox.put(&mut reports);
            } else {
                let why = format!("{} is not ready: is the headset on?", self.name);
                shared.enter(SourceState::Seeking(why));
            }
            thread::sleep(LOOK_EVERY);
        }
        Ok(())
    }

    /// Where the head is now, if that is known.
    fn look(
        &self,
        shared: &Shared,
        label: &Arc<str>,
        clock: HostClock,
        reports: &mut Vec<Event>,
    ) -> Result<()> {
        let (now, time_s) = (self.instance.now().doing("tell the time")?, clock.now_s());
        let (at, moves) = self.head.relate(&self.room, now).doing("find the head")?;
        use xr::SpaceLocationFlags as Flags;
        if !at.location_flags.contains(Flags::ORIENTATION_VALID | Flags::POSITION_VALID) {
            let why = format!("{} does not see where it is", self.name);
            shared.enter(SourceState::Seeking(why));
            return Ok(());
        }
        let tracked = Flags::ORIENTATION_TRACKED | Flags::POSITION_TRACKED;
        let q = at.pose.orientation;
        let orientation = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into());
        let Some(placement) = Placement::checked(vector(at.pose.position), orientation) else {
            shared.not_finite.fetch_add(1, Ordering::Relaxed);
            return Ok(());
        };
        use xr::SpaceVelocityFlags as Known;
        let velocity = moves
            .velocity_flags
            .contains(Known::LINEAR_VALID | Known::ANGULAR_VALID)
            .then(|| {
                Velocity::checked(vector(moves.linear_velocity), vector(moves.angular_velocity))
            })
            .flatten();
        reports.push(Event::Pose(HeadPose {
            placement,
            time_s,
            sender_time: None,
            source: label.clone(),
            sensor: 0,
            confidence: if at.location_flags.contains(tracked) { 1.0 } else { GUESSED },
            velocity,
        }));
        shared.accepted.fetch_add(1, Ordering::Relaxed);
        shared.enter(SourceState::Running);
        Ok(())
    }
}

/// Asks for the extension that tells the runtime's time; whether it is offered.
#[cfg(not(windows))]
fn ask_for_clock(extensions: &mut xr::ExtensionSet, offered: &xr::ExtensionSet) -> bool {
    extensions.khr_convert_timespec_time = true;
    offered.khr_convert_timespec_time
}

#[cfg(windows)]
fn ask_for_clock(extensions: &mut xr::ExtensionSet, offered: &xr::ExtensionSet) -> bool {
    extensions.khr_win32_convert_performance_counter_time = true;
    offered.khr_win32_convert_performance_counter_time
}

fn vector(v: xr::Vector3f) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

impl Source for HeadsetTracker {
    fn name(&self) -> &str {
        "headset by OpenXR"
    }

    fn poll(&mut self, _now_s: f64, events: &mut Vec<Event>) {
        self.shared.inbox.take(events);
    }

    fn state(&self) -> SourceState {
        self.shared.state.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn counters(&self) -> Counters {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Counters {
            accepted: count(&self.shared.accepted),
            not_finite: count(&self.shared.not_finite),
            connections: count(&self.shared.connections),
            unread: self.shared.inbox.dropped(),
            ..Default::default()
        }
    }
}

impl Drop for HeadsetTracker {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic there has been reported by its thread.
            let _ = thread.join();
        }
    }
}
