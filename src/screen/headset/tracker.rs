//! A headset that shows nothing and only reports the head (`XR_MND_headless`): a source of poses
//! for the view through a screen.
//!
//! Takes the origin; returns poses in the space of the room, and a message while the runtime is
//! missing or gone, which it looks for again. Everything happens on a thread of its own, except for
//! predictions, which the caller requests itself. Must not know screens.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use openxr as xr;
use tracking::{Counters, Event, HeadPose, HostClock, Inbox, Source, SourceState};

use super::error::{Doing, HeadsetError, Result};
use super::lifecycle::{Answer, Lifecycle};
use super::link::RoomOrigin;
use super::locator::{Locator, Sight, Wish, ask_for_clock};
use super::parting::Helper;
use super::runtime::{VIEWS, enter, reach};

/// Interval of pose queries: shorter than the frame time of any screen.
const LOOK_EVERY: Duration = Duration::from_millis(4);
/// Interval between attempts to find a runtime.
const SEEK_EVERY: Duration = Duration::from_secs(2);

/// Shared by the thread and the program.
struct Shared {
    inbox: Inbox,
    stop: AtomicBool,
    /// While there is a session.
    locator: Mutex<Option<Locator>>,
    state: Mutex<SourceState>,
    accepted: AtomicU64,
    not_finite: AtomicU64,
    connections: AtomicU64,
}

impl Shared {
    fn enter(&self, state: SourceState) {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) = state;
    }

    fn locator(&self) -> MutexGuard<'_, Option<Locator>> {
        self.locator.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// A source of head poses. Dropping it ends the session.
pub struct HeadsetTracker {
    shared: Arc<Shared>,
    thread: Helper,
}

impl HeadsetTracker {
    /// `label`: [`HeadPose::source`] of the poses. Fails if no thread can be started.
    pub fn start(
        label: &str,
        origin: RoomOrigin,
        clock: HostClock,
    ) -> std::io::Result<HeadsetTracker> {
        let shared = Arc::new(Shared {
            inbox: Inbox::default(),
            stop: AtomicBool::new(false),
            locator: Mutex::new(None),
            state: Mutex::new(SourceState::Seeking("looking for an OpenXR runtime".to_owned())),
            accepted: AtomicU64::new(0),
            not_finite: AtomicU64::new(0),
            connections: AtomicU64::new(0),
        });
        let (theirs, wish) = (shared.clone(), Wish { label: Arc::from(label), origin, clock });
        let thread = Helper::start("headset tracker", move || seek(&theirs, &wish))?;
        Ok(HeadsetTracker { shared, thread })
    }
}

/// Connects, follows the head until the runtime goes, and connects again.
fn seek(shared: &Shared, wish: &Wish) {
    let Wish { label, clock, .. } = wish;
    while !shared.stops() {
        let why = match Session::connect() {
            Ok(mut session) => {
                shared.connections.fetch_add(1, Ordering::Relaxed);
                let (source, time_s) = (label.clone(), clock.now_s());
                shared.inbox.put(&mut vec![Event::Found { source, time_s }]);
                let followed = session.follow(shared, wish);
                // A session that has ended is no longer queried, and is destroyed on this thread.
                *shared.locator() = None;
                let why = match followed {
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
    session: xr::Session<xr::Headless>,
    instance: xr::Instance,
    /// The names of runtime and headset.
    name: String,
}

impl Session {
    fn connect() -> Result<Session> {
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
        tracing::info!("headset as a tracker: {name}");
        Ok(Session { session, instance, name })
    }

    /// Reports the head until the source is dropped, or the runtime ends the session.
    fn follow(&mut self, shared: &Shared, wish: &Wish) -> Result<()> {
        *shared.locator() = Some(Locator::new(&self.session, wish)?);
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
                self.look(shared, wish.clock, &mut reports)?;
                shared.inbox.put(&mut reports);
            } else {
                let why = format!("{} is not ready: is the headset on?", self.name);
                shared.enter(SourceState::Seeking(why));
            }
            thread::sleep(LOOK_EVERY);
        }
        Ok(())
    }

    /// The present head pose, if it is tracked.
    fn look(&self, shared: &Shared, clock: HostClock, reports: &mut Vec<Event>) -> Result<()> {
        let sight = match &*shared.locator() {
            Some(locator) => locator.look(clock.now_s())?,
            None => Sight::Unknown,
        };
        match sight {
            Sight::Seen(pose) => {
                reports.push(Event::Pose(pose));
                shared.accepted.fetch_add(1, Ordering::Relaxed);
                shared.enter(SourceState::Running);
            }
            Sight::Unknown => {
                let why = format!("{} does not see where it is", self.name);
                shared.enter(SourceState::Seeking(why));
            }
            Sight::NotFinite => {
                shared.not_finite.fetch_add(1, Ordering::Relaxed);
            }
        }
        Ok(())
    }
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

    fn located(&mut self, _sensor: u32, display_time_s: f64) -> Option<HeadPose> {
        self.shared.locator().as_ref()?.foreseen(display_time_s)
    }
}

impl Drop for HeadsetTracker {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        self.thread.part();
    }
}
