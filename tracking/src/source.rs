//! The common interface of sources of poses (sockets, files and headsets) for the [`crate::Tracker`], and the host's
//! clock, which only the program and the sources' threads read.

use std::time::Instant;

use crate::event::Event;
use crate::pose::HeadPose;

/// Room for any datagram. Windows reports an error for one longer than the buffer; with this buffer it is received, and
/// refused by its length.
pub(crate) const ANY_DATAGRAM_BYTES: usize = 65536;

/// State of a source.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SourceState {
    /// Not found yet, or lost and being sought, with a text for people.
    Seeking(String),
    Running,
    /// Will never report again, with a text for people.
    Ended(String),
}

/// Counts of received and dropped messages since the start of the source.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Counters {
    /// Messages or datagrams understood and used.
    pub accepted: u64,
    /// Broken messages: wrong lengths, absurd indices, bad text.
    pub malformed: u64,
    /// Messages longer than the protocol allows.
    pub oversized: u64,
    /// Messages with a number that is not finite or absurdly large.
    pub not_finite: u64,
    /// Messages of a type or sender that has not been described yet.
    pub undescribed: u64,
    /// Valid but irrelevant messages: of another device, of an unknown type.
    pub ignored: u64,
    /// Messages from an unexpected address.
    pub strangers: u64,
    /// Events dropped because they were not fetched in time.
    pub unread: u64,
    /// Connections made.
    pub connections: u64,
}

impl Counters {
    /// Returns the total of messages dropped as broken or hostile.
    pub fn rejected(&self) -> u64 {
        self.malformed + self.oversized + self.not_finite + self.strangers
    }
}

/// A source of poses. None of these calls blocks: a source waits on a thread of its own.
pub trait Source: Send {
    /// Returns a description for people, with its place.
    fn name(&self) -> &str;

    /// Appends the events since the last call, oldest first. `now_s` is the host's clock.
    fn poll(&mut self, now_s: f64, events: &mut Vec<Event>);

    fn state(&self) -> SourceState;

    fn counters(&self) -> Counters;

    /// Returns the pose that the source itself predicts for `display_time_s`, which replaces filter and prediction. For
    /// runtimes (OpenXR) that predict better than this crate.
    fn located(&mut self, _sensor: u32, _display_time_s: f64) -> Option<HeadPose> {
        None
    }
}

/// Seconds since an instant chosen by the program, the same for all sources.
#[derive(Clone, Copy, Debug)]
pub struct HostClock(Instant);

impl HostClock {
    pub fn starting_at(zero: Instant) -> Self {
        Self(zero)
    }

    pub fn starting_now() -> Self {
        Self(Instant::now())
    }

    pub fn now_s(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }

    pub fn seconds_at(&self, instant: Instant) -> f64 {
        instant.saturating_duration_since(self.0).as_secs_f64()
    }
}
