//! Owns the head of the headset that the program is shown in, as a source of poses for the view
//! through a screen. A program has one connection to a runtime, so a headset that is worn cannot
//! be asked by a second session.
//!
//! The link lends its session while it has one; the source asks it on whatever thread it is on.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use openxr as xr;
use tracking::{Counters, Event, HeadPose, HostClock, Source, SourceState};

use super::error::Result;
use super::link::RoomOrigin;
use super::locator::{Locator, Sight, Wish};

/// The head of the headset that the program is shown in, whether there is one yet or not.
#[derive(Clone)]
pub struct WornHead {
    wish: Wish,
    lent: Arc<Mutex<Lent>>,
}

enum Lent {
    /// Nothing, for this reason.
    Nothing(String),
    Session(Locator, String),
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

    /// Lends a session of the runtime and headset called `name` until what it gives is dropped.
    /// `tells_time`: the runtime's clock can be asked.
    pub(super) fn lend<G: xr::Graphics>(
        &self,
        session: &xr::Session<G>,
        name: &str,
        tells_time: bool,
    ) -> Result<Lending> {
        let lent = match tells_time {
            true => Lent::Session(Locator::new(session, &self.wish)?, name.to_owned()),
            false => Lent::Nothing(format!("{name} does not tell its time; update the runtime")),
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

/// A session is lent. Spaces keep their session alive: this is dropped before it.
pub(super) struct Lending(WornHead);

impl Drop for Lending {
    fn drop(&mut self) {
        *self.0.lent() = Lent::Nothing(away());
    }
}

/// Says where the head is.
pub struct WornSource {
    head: WornHead,
    /// A session was lent at the last look.
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
        let lent = self.head.lent();
        let here = matches!(*lent, Lent::Session(..));
        if here != std::mem::replace(&mut self.here, here) {
            self.counters.connections += u64::from(here);
            let time_s = now_s;
            events.push(match here {
                true => Event::Found { source, time_s },
                false => Event::Lost { source, time_s },
            });
        }
        self.state = match &*lent {
            Lent::Nothing(why) => SourceState::Seeking(why.clone()),
            Lent::Session(locator, name) => match locator.look(now_s) {
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
        match &*self.head.lent() {
            Lent::Session(locator, _) => locator.foreseen(display_time_s),
            Lent::Nothing(_) => None,
        }
    }
}
