//! How tests wait for other threads: for conditions, with deadlines generous enough for a loaded machine.

use std::time::{Duration, Instant};
use tracking::vrpn::{Client, ClientTiming, Mode, ServerAddress};
use tracking::{Event, HostClock, Source};

const DEADLINE: Duration = Duration::from_secs(60);

/// Calls `is_so` until it holds.
pub fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < DEADLINE, "waited in vain: {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A client with its events.
pub struct Heard {
    pub client: Client,
    pub events: Vec<Event>,
}

impl Heard {
    pub fn start(mode: Mode, port: u16) -> Self {
        let server = ServerAddress { mode, host: "127.0.0.1".to_owned(), port };
        let devices = ["Head0".to_owned(), "Wand0".to_owned()];
        let timing = ClientTiming {
            retry_first: Duration::from_millis(20),
            retry_longest: Duration::from_millis(100),
            request_every: Duration::from_millis(100),
            ping_every: Duration::from_millis(200),
            ..Default::default()
        };
        let client = Client::start(server, &devices, timing, HostClock::starting_now()).unwrap();
        Self { client, events: Vec::new() }
    }

    pub fn poll(&mut self) {
        self.client.poll(0.0, &mut self.events);
    }

    /// Polls until `is_so` holds of all events since they were last cleared.
    pub fn until(&mut self, what: &str, is_so: impl Fn(&[Event]) -> bool) {
        until(what, || {
            self.poll();
            is_so(&self.events)
        });
    }

    pub fn count(&self, is_one: impl Fn(&Event) -> bool) -> usize {
        self.events.iter().filter(|event| is_one(event)).count()
    }

    pub fn buttons(&self) -> Vec<(u32, bool)> {
        buttons(&self.events)
    }
}

pub fn buttons(events: &[Event]) -> Vec<(u32, bool)> {
    events
        .iter()
        .filter_map(|event| match event {
            Event::Button { button, pressed, .. } => Some((*button, *pressed)),
            _ => None,
        })
        .collect()
}

pub fn poses(events: &[Event]) -> usize {
    events.iter().filter(|event| matches!(event, Event::Pose(_))).count()
}

pub fn lost(events: &[Event]) -> usize {
    events.iter().filter(|event| matches!(event, Event::Lost { .. })).count()
}
