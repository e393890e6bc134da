//! Events of a source (poses, motion, buttons, analog channels, dials, texts, found and lost) and the bounded queue
//! in which a source's thread leaves them for the program.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;

use crate::pose::{HeadPose, Velocity};

/// Severity of an [`Event::Text`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Severity {
    Normal,
    Warning,
    Error,
}

/// A report of a source. `source` is the device's name as in [`HeadPose::source`]; times are seconds on the host's
/// clock.
#[derive(Clone, PartialEq, Debug)]
pub enum Event {
    Pose(HeadPose),
    Velocity {
        source: Arc<str>,
        sensor: u32,
        velocity: Velocity,
        time_s: f64,
    },
    Acceleration {
        source: Arc<str>,
        sensor: u32,
        linear_m_s2: DVec3,
        time_s: f64,
    },
    /// A change: a button is never reported twice in a row in the same state.
    Button {
        source: Arc<str>,
        button: u32,
        pressed: bool,
        time_s: f64,
    },
    Analog {
        source: Arc<str>,
        channel: u32,
        value: f64,
        time_s: f64,
    },
    /// A dial turned by `revolutions` since its last report.
    Dial {
        source: Arc<str>,
        dial: u32,
        revolutions: f64,
        time_s: f64,
    },
    Text {
        source: Arc<str>,
        severity: Severity,
        level: u32,
        text: String,
        time_s: f64,
    },
    /// The device has started to answer.
    Found {
        source: Arc<str>,
        time_s: f64,
    },
    /// The device is gone; its buttons have been reported as released.
    Lost {
        source: Arc<str>,
        time_s: f64,
    },
}

impl Event {
    /// Returns whether a later event of the same kind supersedes this one.
    fn is_stream(&self) -> bool {
        matches!(
            self,
            Self::Pose(_) | Self::Velocity { .. } | Self::Acceleration { .. } | Self::Analog { .. }
        )
    }
}

/// Capacity of an [`Inbox`].
pub const INBOX_CAPACITY: usize = 4096;

/// Queue from a source's thread to the program. If the program does not fetch, old stream events are dropped
/// first, so that button changes survive a pause.
#[derive(Default, Debug)]
pub struct Inbox {
    inner: Mutex<EventQueue>,
}

#[derive(Default, Debug)]
struct EventQueue {
    events: VecDeque<Event>,
    dropped: u64,
}

impl Inbox {
    /// Moves `events` in, leaving the vector empty.
    pub fn put(&self, events: &mut Vec<Event>) {
        let mut queue = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        queue.events.extend(events.drain(..));
        if queue.events.len() <= INBOX_CAPACITY {
            return;
        }
        let before = queue.events.len();
        // Keep the newer half and, of the older half, the events that later ones do not supersede.
        let newer = before - INBOX_CAPACITY / 2;
        let mut place = 0;
        queue.events.retain(|event| {
            place += 1;
            place > newer || !event.is_stream()
        });
        while queue.events.len() > INBOX_CAPACITY {
            queue.events.pop_front();
        }
        queue.dropped += (before - queue.events.len()) as u64;
    }

    /// Moves all waiting events to the end of `events`, oldest first.
    pub fn take(&self, events: &mut Vec<Event>) {
        let mut queue = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        events.extend(queue.events.drain(..));
    }

    /// Returns the number of events dropped so far because they were not fetched.
    pub fn dropped(&self) -> u64 {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner).dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unread_inbox_stays_bounded_and_keeps_buttons() {
        let source: Arc<str> = "Wand0".into();
        let inbox = Inbox::default();
        for i in 0..50_000u32 {
            let mut events = vec![Event::Analog {
                source: source.clone(),
                channel: 0,
                value: f64::from(i),
                time_s: 0.0,
            }];
            if i == 7 {
                events.push(Event::Button {
                    source: source.clone(),
                    button: 3,
                    pressed: true,
                    time_s: 0.0,
                });
            }
            inbox.put(&mut events);
        }
        let mut events = Vec::new();
        inbox.take(&mut events);
        assert!(events.len() <= INBOX_CAPACITY);
        assert_eq!(inbox.dropped(), 50_001 - events.len() as u64);
        assert!(matches!(events[0], Event::Button { button: 3, pressed: true, .. }));
        assert!(matches!(events.last(), Some(Event::Analog { value, .. }) if *value == 49_999.0));
    }
}
