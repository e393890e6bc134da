//! A headset that is only tracked (`XR_MND_headless`): a source of head poses for the off-axis view through a screen,
//! from a session without graphics.
//!
//! Takes the origin; returns poses in the space of the room, and a message while it tries to connect to a runtime
//! again. Everything happens on a thread of its own, except for predictions, which run on the caller's thread. Must not
//! know screens.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use openxr as xr;
use tracking::{Counters, Event, HeadPose, HostClock, Inbox, Source, SourceState};

use super::error::{Doing, HeadsetError, Result};
use super::head_locator::{HeadLocation, HeadLocator, LocatorOptions, enable_time_conversion};
use super::lifecycle::{Lifecycle, Transition};
use super::room_space::RoomOrigin;
use super::runtime::{VIEWS, create_instance, load_entry};
use super::runtime_thread::RuntimeThread;

/// Interval of pose queries: shorter than the frame time of any screen.
const POLL_INTERVAL: Duration = Duration::from_millis(4);
/// Interval between attempts to connect.
const RETRY_INTERVAL: Duration = Duration::from_secs(2);

/// Shared by the thread and the program.
struct SharedPose {
    inbox: Inbox,
    stop: AtomicBool,
    /// `None` without a session.
    locator: Mutex<Option<HeadLocator>>,
    state: Mutex<SourceState>,
    accepted: AtomicU64,
    not_finite: AtomicU64,
    connections: AtomicU64,
}

impl SharedPose {
    fn set_state(&self, state: SourceState) {
        *self.state.lock().unwrap_or_else(PoisonError::into_inner) = state;
    }

    fn locator(&self) -> MutexGuard<'_, Option<HeadLocator>> {
        self.locator.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_stopping(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// A source of head poses. Dropping it ends the session.
pub struct HeadsetTracker {
    shared: Arc<SharedPose>,
    thread: RuntimeThread,
}

impl HeadsetTracker {
    /// Starts the source. `label`: [`HeadPose::source`] of the poses. Fails if no thread can be started.
    pub fn start(
        label: &str,
        origin: RoomOrigin,
        clock: HostClock,
    ) -> std::io::Result<HeadsetTracker> {
        let shared = Arc::new(SharedPose {
            inbox: Inbox::default(),
            stop: AtomicBool::new(false),
            locator: Mutex::new(None),
            state: Mutex::new(SourceState::Seeking("looking for an OpenXR runtime".to_owned())),
            accepted: AtomicU64::new(0),
            not_finite: AtomicU64::new(0),
            connections: AtomicU64::new(0),
        });
        let options = LocatorOptions { label: Arc::from(label), origin, clock };
        let state = shared.clone();
        let thread = RuntimeThread::start("headset tracker", move || run(&state, &options))?;
        Ok(HeadsetTracker { shared, thread })
    }
}

/// Connects, reports the head until the session ends, and connects again.
fn run(shared: &SharedPose, options: &LocatorOptions) {
    let LocatorOptions { label, clock, .. } = options;
    while !shared.is_stopping() {
        let reason = match HeadlessSession::connect() {
            Ok(mut session) => {
                shared.connections.fetch_add(1, Ordering::Relaxed);
                let (source, time_s) = (label.clone(), clock.now_s());
                shared.inbox.put(&mut vec![Event::Found { source, time_s }]);
                let result = session.track(shared, options);
                // No more predictions from this session, which is destroyed on this thread.
                *shared.locator() = None;
                let reason = match result {
                    Ok(()) => format!("{} has ended the session", session.name),
                    Err(error) => error.to_string(),
                };
                let (source, time_s) = (label.clone(), clock.now_s());
                shared.inbox.put(&mut vec![Event::Lost { source, time_s }]);
                reason
            }
            Err(error) => error.to_string(),
        };
        shared.set_state(SourceState::Seeking(reason));
        let start = Instant::now();
        while start.elapsed() < RETRY_INTERVAL && !shared.is_stopping() {
            thread::sleep(Duration::from_millis(20));
        }
    }
}

/// A session without graphics.
struct HeadlessSession {
    session: xr::Session<xr::Headless>,
    instance: xr::Instance,
    /// The names of runtime and headset.
    name: String,
}

impl HeadlessSession {
    fn connect() -> Result<HeadlessSession> {
        let (entry, offered) = load_entry()?;
        let mut extensions = xr::ExtensionSet::default();
        extensions.mnd_headless = true;
        let converts_time = enable_time_conversion(&mut extensions, &offered);
        if !offered.mnd_headless || !converts_time {
            return Err(HeadsetError::Unsuitable {
                runtime: "of this machine".to_string(),
                problem: "cannot track a headset without showing pictures (XR_MND_headless and a \
                       clock); use Monado or SteamVR"
                    .to_string(),
            });
        }
        let (instance, system, name) = create_instance(&entry, &extensions)?;
        let info = xr::headless::SessionCreateInfo {};
        // SAFETY: without graphics there are no handles that could be wrong.
        let (session, ..) = unsafe { instance.create_session::<xr::Headless>(system, &info) }
            .doing("create a session without graphics")?;
        tracing::info!("headset as a tracker: {name}");
        Ok(HeadlessSession { session, instance, name })
    }

    /// Reports the head until the source is dropped, or the runtime ends the session.
    fn track(&mut self, shared: &SharedPose, options: &LocatorOptions) -> Result<()> {
        *shared.locator() = Some(HeadLocator::new(&self.session, options)?);
        let mut lifecycle = Lifecycle::default();
        let mut events = xr::EventDataBuffer::new();
        let mut poses = Vec::new();
        while !shared.is_stopping() {
            while let Some(event) = self.instance.poll_event(&mut events).doing("poll events")? {
                let transition = match event {
                    xr::Event::SessionStateChanged(event) => lifecycle.enter(event.state()),
                    xr::Event::InstanceLossPending(_) => Transition::Destroy { retry: true },
                    _ => Transition::None,
                };
                match transition {
                    Transition::Begin => {
                        self.session.begin(VIEWS).doing("begin the session")?;
                    }
                    Transition::End => {
                        self.session.end().doing("end the session")?;
                    }
                    Transition::Destroy { .. } => return Ok(()),
                    Transition::None => {}
                }
            }
            if lifecycle.is_running() {
                self.report_pose(shared, options.clock, &mut poses)?;
                shared.inbox.put(&mut poses);
            } else {
                let reason = format!("{} is not ready: is the headset on?", self.name);
                shared.set_state(SourceState::Seeking(reason));
            }
            thread::sleep(POLL_INTERVAL);
        }
        Ok(())
    }

    /// Appends the present head pose, if the head is tracked.
    fn report_pose(
        &self,
        shared: &SharedPose,
        clock: HostClock,
        events: &mut Vec<Event>,
    ) -> Result<()> {
        let location = match &*shared.locator() {
            Some(locator) => locator.locate(clock.now_s())?,
            None => HeadLocation::NotTracked,
        };
        match location {
            HeadLocation::Tracked(pose) => {
                events.push(Event::Pose(pose));
                shared.accepted.fetch_add(1, Ordering::Relaxed);
                shared.set_state(SourceState::Running);
            }
            HeadLocation::NotTracked => {
                let reason = format!("{} does not track the head at present", self.name);
                shared.set_state(SourceState::Seeking(reason));
            }
            HeadLocation::NotFinite => {
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
        self.shared.locator().as_ref()?.predict(display_time_s)
    }
}

impl Drop for HeadsetTracker {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        self.thread.join_or_detach();
    }
}
