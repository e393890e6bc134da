//! The head before the screen: its tracker, and the off-axis eyes while the view follows it.
//!
//! Time comes in as seconds, so that all of it can be tested without a clock. The sculpture's centre lies in the plane
//! of the screen; the camera's distance, which the wheel changes, is its scale.

use std::path::PathBuf;
use std::time::Duration;

use glam::{Quat, Vec2, Vec3};
use tracking::calibration::Calibration;
use tracking::{
    BodyId, Event, HostClock, Placement, Predicted, Presence, Source, SourceState, Tracker,
};

use super::ViewportRect;
use super::head_calibration::HeadCalibration;
use super::head_screen::HeadScreen;
use super::tracker_controls::TrackerControls;
use super::turntable::Turntable;
use crate::head_tracking::{ScreenOptions, SourceAddress, TrackingOptions, source};
use crate::input::ActionEvent;
use crate::notice::Notice;
use crate::screen::headset::SessionHead;
use crate::view::Eye;
use crate::view::off_axis::{Head as HeadPlace, ScreenInWorld, ScreenPlane};

pub use super::head_screen::Monitor;
pub use super::head_status::{CalibrationStatus, CalibrationStep, HeadStatus};

/// Time between two looks for a missing head.
const SEEK_EVERY: Duration = Duration::from_millis(100);

/// The head and its tracker.
pub struct TrackedHead {
    settings: TrackingOptions,
    screen: HeadScreen,
    time: Time,
    /// The head in the program's own headset, if that should be followed.
    session_head: Option<SessionHead>,
    /// `None` while the view does not follow the head.
    tracking: Option<Tracking>,
    calibration: HeadCalibration,
    controls: TrackerControls,
    shown: Predicted,
}

/// The tracker's clock and its last two readings.
struct Time {
    clock: HostClock,
    now_s: f64,
    /// Time between the last two updates.
    elapsed_s: f64,
}

/// A tracker in use, with its quality.
struct Tracking {
    tracker: Tracker,
    losses: u32,
    rate: Rate,
}

/// Reports per second.
#[derive(Clone, Copy, Default)]
struct Rate {
    since_s: f64,
    accepted: u64,
    hz: f64,
}

impl Rate {
    fn count(&mut self, accepted: u64, now_s: f64) {
        let elapsed_s = now_s - self.since_s;
        if elapsed_s >= 1.0 {
            self.hz = accepted.saturating_sub(self.accepted) as f64 / elapsed_s;
            (self.since_s, self.accepted) = (now_s, accepted);
        }
    }
}

impl TrackedHead {
    /// Creates it without a tracker. `headset_enabled`: a headset may report the head of its wearer.
    pub fn new(
        tracking: &TrackingOptions,
        screen: &ScreenOptions,
        headset_enabled: bool,
    ) -> TrackedHead {
        let settings = tracking.clone();
        let screen = HeadScreen::new(screen);
        let clock = HostClock::starting_now();
        TrackedHead {
            session_head: match settings.source {
                SourceAddress::Openxr(origin) if headset_enabled => {
                    Some(SessionHead::new(&settings.source.label(), origin, clock))
                }
                _ => None,
            },
            calibration: HeadCalibration::new(&settings),
            controls: TrackerControls::new(&settings),
            shown: Predicted {
                placement: screen.rest(),
                confidence: 0.0,
                presence: Presence::Absent,
            },
            settings,
            screen,
            time: Time { clock, now_s: 0.0, elapsed_s: 0.0 },
            tracking: None,
        }
    }

    pub fn is_on(&self) -> bool {
        self.tracking.is_some()
    }

    /// Returns whether it is enabled at the start.
    pub fn wanted(&self) -> bool {
        self.settings.on
    }

    fn open(&mut self) -> Result<(), source::SourceError> {
        let TrackingOptions { source: address, .. } = &self.settings;
        let controls = self.settings.controls();
        let session_head = self.session_head.as_ref();
        let signs = self.settings.signs();
        let clock = self.time.clock;
        let sources = source::open(address, controls.as_ref(), signs, session_head, clock)?;
        let body = self.settings.body(self.screen.rest().position_m, self.calibration.now());
        let mut tracker = Tracker::new(body);
        sources.into_iter().for_each(|source| tracker.add_source(source));
        let rate = Rate { since_s: self.time.now_s, ..Rate::default() };
        self.tracking = Some(Tracking { tracker, losses: 0, rate });
        Ok(())
    }

    /// Lets the view follow the head from now on, as configured. Returns notices for the person.
    pub fn start(&mut self) -> Vec<Notice> {
        let mut notices = Vec::new();
        if self.settings.source == SourceAddress::None {
            notices.push(Notice::note(
                "No head tracker is set, so the view stays still. Set tracking.source in the settings",
            ));
        }
        let (screen, guessed) = self.screen.whole();
        if guessed {
            let (width, height) = (screen.width_m * 100.0, screen.height_m * 100.0);
            notices.push(Notice::note(format!(
                "The screen is assumed to be {width:.0} × {height:.0} cm; if it is not, set \
                 screen.size_m in the settings"
            )));
        }
        if let Err(error) = self.open() {
            notices.push(Notice::error(error.to_string()));
        }
        notices
    }

    pub fn stop(&mut self) {
        self.tracking = None;
        self.calibration.cancel();
        self.controls.let_go();
    }

    /// Returns the time on the tracker's clock, in seconds.
    pub fn clock_s(&self) -> f64 {
        self.time.clock.now_s()
    }

    /// Polls the sources at `now_s`. Returns the actions of their buttons, in order.
    pub fn update(&mut self, now_s: f64) -> Vec<ActionEvent> {
        self.time.elapsed_s = (now_s - self.time.now_s).clamp(0.0, 0.1);
        self.time.now_s = now_s;
        let Some(Tracking { tracker, losses, rate }) = &mut self.tracking else {
            return Vec::new();
        };
        let mut events = Vec::new();
        tracker.update(now_s, &mut events);
        self.shown = tracker.predicted(now_s + self.settings.prediction_ms * 1e-3);
        rate.count(tracker.sources().map(|source| source.counters().accepted).sum(), now_s);
        self.calibration.hear(tracker.raw_of(BodyId::HEAD).next().flatten(), now_s);
        let mut asked = Vec::new();
        for event in &events {
            match event {
                Event::Lost { .. } => *losses += 1,
                // A person who touches the screen has no hand free for the keyboard.
                Event::Button { pressed: true, .. } => self.calibration.touch(),
                _ => {}
            }
            self.controls.hear(event, &mut asked);
        }
        asked
    }

    /// Returns the effect of the analogs since the last update: turns of the wheel at the pixel `at`.
    pub fn wheels(&self, at: Vec2) -> Vec<ActionEvent> {
        self.controls.wheels(at, self.time.elapsed_s)
    }

    /// Returns when the next picture is needed if nothing else happens.
    pub fn repaint_after(&self) -> Option<Duration> {
        self.tracking.as_ref()?;
        let here = self.shown.presence != Presence::Absent || self.is_calibrating();
        Some(if here { Duration::ZERO } else { SEEK_EVERY })
    }

    /// Returns the position of the head before the screen, in metres, while it is tracked.
    pub fn position_m(&self) -> Option<Vec3> {
        let tracked = matches!(self.shown.presence, Presence::Tracked | Presence::Returning);
        (self.is_on() && tracked).then(|| self.shown.placement.position_m.as_vec3())
    }

    /// Returns the part of the screen that shows the picture.
    pub fn plane(&self, viewport: ViewportRect) -> ScreenPlane {
        self.screen.plane(viewport)
    }

    /// Returns the left and the right eye of the head, `eye_distance_m` metres apart, while the view follows it.
    pub fn eyes(
        &self,
        viewport: ViewportRect,
        turntable: &Turntable,
        eye_distance_m: f32,
    ) -> Option<[Eye; 2]> {
        if !self.is_on() {
            return None;
        }
        let plane = self.plane(viewport);
        let Placement { position_m, orientation } = self.shown.placement;
        let head = HeadPlace {
            position_m: position_m.as_vec3(),
            orientation: orientation.as_quat(),
            eye_distance_m,
        };
        let world = ScreenInWorld {
            centre: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            units_per_m: turntable.window_height() / plane.height_m.max(1e-3),
        };
        let near = turntable.near();
        Some(plane.eyes(&head, &world, turntable.eye().size, near))
    }

    /// Returns the displayed pose of the head, in the screen's axes.
    pub fn placement(&self) -> Placement {
        self.shown.placement
    }

    /// Returns the head that a headset should report to this tracker, if any.
    pub fn session_head(&self) -> Option<&SessionHead> {
        self.session_head.as_ref()
    }

    /// Sets the position of the program's window on the screen.
    pub fn set_monitor(&mut self, monitor: Option<Monitor>) {
        self.screen.set_monitor(monitor);
    }

    pub fn is_calibrating(&self) -> bool {
        self.calibration.is_under_way()
    }

    /// Keeps calibrations in a file, and loads the one there or the one that the settings name.
    pub fn keep_calibration_in(&mut self, path: PathBuf) -> Option<Notice> {
        let before = self.calibration.now();
        let notice = self.calibration.keep_in(path, &self.settings);
        self.calibrate_tracker(before);
        notice
    }

    /// Starts the calibration by four touches.
    pub fn begin_calibration(&mut self) -> Vec<Notice> {
        let notices = if self.is_on() { Vec::new() } else { self.start() };
        self.calibration.begin(&self.screen.whole().0, &self.settings);
        notices
    }

    /// Executes a step of the calibration.
    pub fn calibrate(&mut self, step: CalibrationStep) -> Option<Notice> {
        let before = self.calibration.now();
        let notice = self.calibration.step(step, &self.settings);
        self.calibrate_tracker(before);
        notice
    }

    pub fn status(&self) -> HeadStatus {
        let (screen, guessed) = self.screen.whole();
        let tracking = self.tracking.as_ref();
        let counters = self.sources().map(|source| source.counters());
        let state = self.sources().find_map(|source| match source.state() {
            SourceState::Running => None,
            SourceState::Seeking(why) | SourceState::Ended(why) => Some(why),
        });
        HeadStatus {
            on: self.is_on(),
            source: self.settings.source.label(),
            state,
            presence: self.shown.presence,
            position_m: self.shown.placement.position_m.to_array(),
            rate_hz: tracking.map_or(0.0, |tracking| tracking.rate.hz),
            losses: tracking.map_or(0, |tracking| tracking.losses),
            dropped: counters.map(|counters| counters.rejected() + counters.unread).sum(),
            screen_m: [screen.width_m, screen.height_m],
            guessed,
            calibration: self.calibration.status(),
        }
    }

    fn sources(&self) -> impl Iterator<Item = &dyn Source> {
        self.tracking.iter().flat_map(|tracking| tracking.tracker.sources())
    }

    /// Gives the tracker the calibration in use, if it has changed.
    fn calibrate_tracker(&mut self, before: Calibration) {
        let now = self.calibration.now();
        if let Some(Tracking { tracker, .. }) = &mut self.tracking
            && now != before
        {
            tracker.set_calibration(BodyId::HEAD, 0, now, self.time.now_s);
        }
    }
}
