//! The head of the headset in use as a source of poses for the view through a screen. A program has
//! only one connection to a runtime, so this headset cannot be queried by a second session.
//!
//! The link lends its session while it has one. Queries run on a thread of their own, so that
//! callers wait no longer than [`PATIENCE`] for a runtime that hangs.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use openxr as xr;
use tracking::{Counters, Event, HeadPose, HostClock, Source, SourceState};

use super::error::{HeadsetError, Result};
use super::link::RoomOrigin;
use super::locator::{Locator, Sight, Wish};
use super::parting::Helper;

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_millis(100);

/// The head of the headset in use, whether there is one yet or not.
#[derive(Clone)]
pub struct WornHead {
    wish: Wish,
    lent: Arc<Mutex<Lent>>,
}

enum Lent {
    /// No session, for this reason.
    Nothing(String),
    Session(Asker, String),
}

/// Queries a locator on a thread of its own.
struct Asker {
    /// None once the thread is to end.
    asks: Option<Sender<f64>>,
    answers: Receiver<Result<Sight>>,
    /// It was queried and has not answered in time.
    late: bool,
    thread: Helper,
}

impl Asker {
    fn new(locator: Locator) -> Result<Asker> {
        let (asks, heard) = channel();
        let (tell, answers) = channel();
        let work = move || {
            while let Ok(time_s) = heard.recv() {
                if tell.send(locator.look(time_s)).is_err() {
                    return;
                }
            }
        };
        let thread = Helper::start("headset's head", work).map_err(HeadsetError::Thread)?;
        Ok(Asker { asks: Some(asks), answers, late: false, thread })
    }

    /// The head pose at `time_s`; unknown while the runtime does not answer.
    fn look(&mut self, time_s: f64) -> Result<Sight> {
        if self.late && self.answers.try_recv().is_err() {
            return Ok(Sight::Unknown);
        }
        let asked = self.asks.as_ref().is_some_and(|asks| asks.send(time_s).is_ok());
        let answer = self.answers.recv_timeout(PATIENCE);
        self.late = asked && answer.is_err();
        answer.unwrap_or(Ok(Sight::Unknown))
    }
}

impl Drop for Asker {
    fn drop(&mut self) {
        self.asks = None;
        self.thread.part();
    }
}

impl WornHead {
    /// `label`: [`HeadPose::source`] of the poses.
    pub fn new(label: &str, origin: RoomOrigin, clock: HostClock) -> WornHead {
        WornHead {
            wish: Wish { label: Arc::from(label), origin, clock },
            lent: Arc::new(Mutex::new(Lent::Nothing(away()))),
        }
    }

    fn lent(&self) -> MutexGuard<'_, Lent> {
        self.lent.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lends a session of the runtime and headset called `name` until the result is dropped.
    /// `tells_time`: the runtime's clock can be converted.
    pub(super) fn lend<G: xr::Graphics>(
        &self,
        session: &xr::Session<G>,
        name: &str,
        tells_time: bool,
    ) -> Result<Lending> {
        let lent = match tells_time {
            true => {
                let asker = Asker::new(Locator::new(session, &self.wish)?)?;
                Lent::Session(asker, name.to_owned())
            }
            false => Lent::Nothing(format!("{name} does not report its time; update the runtime")),
        };
        *self.lent() = lent;
        Ok(Lending(self.clone()))
    }

    pub fn source(&self) -> WornSource {
        WornSource {
            head: self.clone(),
            here: false,
            state: SourceState::Seeking(away()),
            counters: Counters::default(),
        }
    }
}

fn away() -> String {
    "the headset is not connected".to_owned()
}

/// A lent session. Spaces keep their session alive, so this is dropped before it.
pub(super) struct Lending(WornHead);

impl Drop for Lending {
    fn drop(&mut self) {
        *self.0.lent() = Lent::Nothing(away());
    }
}

/// Says where the head is.
pub struct WornSource {
    head: WornHead,
    /// A session was lent at the last poll.
    here: bool,
    state: SourceState,
    counters: Counters,
}

impl Source for WornSource {
    fn name(&self) -> &str {
        "headset that is worn"
    }

    fn poll(&mut self, now_s: f64, events: &mut Vec<Event>) {
        let source = self.head.wish.label.clone();
        let mut lent = self.head.lent();
        let here = matches!(*lent, Lent::Session(..));
        if here != std::mem::replace(&mut self.here, here) {
            self.counters.connections += u64::from(here);
            let time_s = now_s;
            events.push(match here {
                true => Event::Found { source, time_s },
                false => Event::Lost { source, time_s },
            });
        }
        self.state = match &mut *lent {
            Lent::Nothing(why) => SourceState::Seeking(why.clone()),
            Lent::Session(asker, name) => match asker.look(now_s) {
                Ok(Sight::Seen(pose)) => {
                    self.counters.accepted += 1;
                    events.push(Event::Pose(pose));
                    SourceState::Running
                }
                Ok(Sight::Unknown) => {
                    SourceState::Seeking(format!("{name} does not see where it is"))
                }
                Ok(Sight::NotFinite) => {
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
        let Lent::Session(asker, _) = &mut *self.head.lent() else { return None };
        match asker.look(display_time_s) {
            Ok(Sight::Seen(pose)) => Some(pose),
            // The owner of the session gets errors, too, and reports them.
            Ok(Sight::Unknown | Sight::NotFinite) | Err(_) => None,
        }
    }
}
