//! Owns what it means to be a source of poses, so that sockets, files and headsets look alike to
//! the [`crate::Tracker`]; and the host's clock, which only the threads of sources and the program
//! read.

use std::time::Instant;

use crate::event::Event;
use crate::pose::HeadPose;

/// Room for any datagram there is. Windows makes an error of one that is longer than its buffer; here
/// it is received, and refused by its length.
pub(crate) const ANY_DATAGRAM_BYTES: usize = 65536;

/// Where a source stands.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SourceState {
    /// Not there yet, or gone and being sought again; the text says why, for people.
    Seeking(String),
    Running,
    /// Will never report again; the text says why, for people.
    Ended(String),
}

/// What came in and was not used. All count from the start of the source.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Counters {
    /// Messages or datagrams understood and used.
    pub accepted: u64,
    /// Broken: wrong lengths, absurd indices, bad text.
    pub malformed: u64,
    /// Longer than the protocol allows.
    pub oversized: u64,
    /// With a number that is not finite or absurdly large.
    pub not_finite: u64,
    /// Of a type or sender that has not been described yet.
    pub undescribed: u64,
    /// Sound, but of no interest here: another device, an unknown type.
    pub ignored: u64,
    /// From an address that has no business here.
    pub strangers: u64,
    /// Events dropped because the program did not fetch them in time.
    pub unread: u64,
    /// Connections made.
    pub connections: u64,
}

impl Counters {
    /// Everything that was dropped as broken or hostile.
    pub fn rejected(&self) -> u64 {
        self.malformed + self.oversized + self.not_finite + self.strangers
    }
}

/// Something that reports poses. Whatever waits does so on a thread of the source's own: none of
/// these calls blocks.
pub trait Source: Send {
    /// For people: what and where.
    fn name(&self) -> &str;

    /// Appends what has happened since the last call, oldest first. `now_s` is the host's clock.
    fn poll(&mut self, now_s: f64, events: &mut Vec<Event>);

    fn state(&self) -> SourceState;

    fn counters(&self) -> Counters;

    /// The pose that the source itself foresees for `display_time_s`, which is used in place of
    /// our own filter and prediction. For runtimes (OpenXR) that predict better than we can.
    fn located(&mut self, _sensor: u32, _display_time_s: f64) -> Option<HeadPose> {
        None
    }
}

/// Seconds since an instant that the program chose, the same for all sources.
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
