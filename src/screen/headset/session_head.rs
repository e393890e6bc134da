//! The head of the headset in use as a source of poses for the off-axis view through a screen. A
//! program has only one connection to a runtime, so this headset cannot be tracked by a second
//! session.
//!
//! While there is an [`super::XrSession`], it shares its session with this source. Queries run on a
//! thread of their own, so that callers never wait longer than [`RESPONSE_TIMEOUT`] for a runtime
//! that hangs.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use openxr as xr;
use tracking::{Counters, Event, HeadPose, HostClock, Source, SourceState};

use super::error::{HeadsetError, Result};
use super::head_locator::{HeadLocation, HeadLocator, LocatorOptions};
use super::room_space::RoomOrigin;
use super::runtime_thread::RuntimeThread;

/// Longest wait for an answer.
const RESPONSE_TIMEOUT: Duration = Duration::from_millis(100);

/// The head of the headset in use, with or without a session.
#[derive(Clone)]
pub struct SessionHead {
    options: LocatorOptions,
    shared: Arc<Mutex<SharedHead>>,
}

enum SharedHead {
    /// No session, for this reason.
    Nothing(String),
    /// A session, with the names of its runtime and headset.
    Session(LocatorThread, String),
}

/// Queries a locator on a thread of its own.
struct LocatorThread {
    /// Times to predict for; `None` once the thread should end.
    queries: Option<Sender<f64>>,
    answers: Receiver<Result<HeadLocation>>,
    /// The last query has not been answered in time.
    late: bool,
    thread: RuntimeThread,
}

impl LocatorThread {
    fn new(locator: HeadLocator) -> Result<LocatorThread> {
        let (queries, received) = channel();
        let (answer, answers) = channel();
        let work = move || {
            while let Ok(time_s) = received.recv() {
                if answer.send(locator.locate(time_s)).is_err() {
                    return;
                }
            }
        };
        let thread = RuntimeThread::start("headset's head", work).map_err(HeadsetError::Thread)?;
        Ok(LocatorThread { queries: Some(queries), answers, late: false, thread })
    }

    /// Returns the head pose at `time_s`; not tracked while the runtime does not answer.
    fn locate(&mut self, time_s: f64) -> Result<HeadLocation> {
        if self.late && self.answers.try_recv().is_err() {
            return Ok(HeadLocation::NotTracked);
        }
        let sent = self.queries.as_ref().is_some_and(|queries| queries.send(time_s).is_ok());
        let answer = self.answers.recv_timeout(RESPONSE_TIMEOUT);
        self.late = sent && answer.is_err();
        answer.unwrap_or(Ok(HeadLocation::NotTracked))
    }
}

impl Drop for LocatorThread {
    fn drop(&mut self) {
        self.queries = None;
        self.thread.join_or_detach();
    }
}

impl SessionHead {
    /// Creates it without a session. `label`: [`HeadPose::source`] of the poses.
    pub fn new(label: &str, origin: RoomOrigin, clock: HostClock) -> SessionHead {
        SessionHead {
            options: LocatorOptions { label: Arc::from(label), origin, clock },
            shared: Arc::new(Mutex::new(SharedHead::Nothing(not_connected()))),
        }
    }

    fn shared(&self) -> MutexGuard<'_, SharedHead> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shares a session of the runtime and headset called `name` until the result is dropped. `converts_time`: the
    /// runtime's clock can be converted to the program's.
    pub(super) fn share<G: xr::Graphics>(
        &self,
        session: &xr::Session<G>,
        name: &str,
        converts_time: bool,
    ) -> Result<HeadShare> {
        let shared = match converts_time {
            true => {
                let locator = HeadLocator::new(session, &self.options)?;
                SharedHead::Session(LocatorThread::new(locator)?, name.to_owned())
            }
            false => {
                SharedHead::Nothing(format!("{name} does not report its time; update the runtime"))
            }
        };
        *self.shared() = shared;
        Ok(HeadShare(self.clone()))
    }

    pub fn source(&self) -> SessionHeadSource {
        SessionHeadSource {
            head: self.clone(),
            has_session: false,
            state: SourceState::Seeking(not_connected()),
            counters: Counters::default(),
        }
    }
}

fn not_connected() -> String {
    "the headset is not connected".to_owned()
}

/// A shared session. Spaces keep their session alive, so this is dropped before it.
pub(super) struct HeadShare(SessionHead);

impl Drop for HeadShare {
    fn drop(&mut self) {
        *self.0.shared() = SharedHead::Nothing(not_connected());
    }
}

/// Reports the poses of a [`SessionHead`].
pub struct SessionHeadSource {
    head: SessionHead,
    /// A session was shared at the last poll.
    has_session: bool,
    state: SourceState,
    counters: Counters,
}

impl Source for SessionHeadSource {
    fn name(&self) -> &str {
        "headset in use"
    }

    fn poll(&mut self, now_s: f64, events: &mut Vec<Event>) {
        let source = self.head.options.label.clone();
        let mut shared = self.head.shared();
        let has_session = matches!(*shared, SharedHead::Session(..));
        if has_session != std::mem::replace(&mut self.has_session, has_session) {
            self.counters.connections += u64::from(has_session);
            let time_s = now_s;
            events.push(match has_session {
                true => Event::Found { source, time_s },
                false => Event::Lost { source, time_s },
            });
        }
        self.state = match &mut *shared {
            SharedHead::Nothing(reason) => SourceState::Seeking(reason.clone()),
            SharedHead::Session(thread, name) => match thread.locate(now_s) {
                Ok(HeadLocation::Tracked(pose)) => {
                    self.counters.accepted += 1;
                    events.push(Event::Pose(pose));
                    SourceState::Running
                }
                Ok(HeadLocation::NotTracked) => {
                    SourceState::Seeking(format!("{name} does not track the head at present"))
                }
                Ok(HeadLocation::NotFinite) => {
                    self.counters.not_finite += 1;
                    SourceState::Running
                }
                Err(error) => SourceState::Seeking(error.to_string()),
            },
        };
    }

    fn state(&self) -> SourceState {
        self.state.clone()
    }

    fn counters(&self) -> Counters {
        self.counters
    }

    fn located(&mut self, _sensor: u32, display_time_s: f64) -> Option<HeadPose> {
        let SharedHead::Session(thread, _) = &mut *self.head.shared() else { return None };
        match thread.locate(display_time_s) {
            Ok(HeadLocation::Tracked(pose)) => Some(pose),
            // The owner of the session gets errors as well, and reports them.
            Ok(HeadLocation::NotTracked | HeadLocation::NotFinite) | Err(_) => None,
        }
    }
}
