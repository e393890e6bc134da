//! The head before the screen: its tracker, and the off-axis eyes from which the sculpture is seen
//! while the view follows it.
//!
//! Time comes in as seconds, so that all of it can be tested without a clock. The sculpture's centre
//! lies in the plane of the screen; the camera's distance, which the wheel changes, is its scale.

use std::path::PathBuf;
use std::time::Duration;

use glam::{DQuat, DVec3, IVec2, Quat, UVec2, Vec2, Vec3};
use tracking::calibration::Calibration;
use tracking::controls::{AnalogBinding, AnalogUse, ButtonBinding, Control, ControlMap};
use tracking::{
    BodyId, Event, HostClock, Placement, Predicted, Presence, Source, SourceState, Tracker,
};

use super::Viewport;
use super::calibration::{self, Calibrating};
use super::turntable::Turntable;
use crate::head_tracking::{ScreenOptions, SourceAddress, TrackingOptions, source};
use crate::input::action::Kind;
use crate::input::{Action, ActionEvent};
use crate::notice::Notice;
use crate::screen::headset::WornHead;
use crate::view::Eye;
use crate::view::off_axis::{Head as HeadPlace, ScreenInWorld, ScreenPlane};

pub use super::head_status::{CalibrationStatus, CalibrationStep, HeadStatus};

/// Of a screen whose size nobody told: 24 inches across, in metres.
const GUESSED_DIAGONAL_M: f32 = 0.61;
/// Between two looks for a head that is not there.
const SEEK_EVERY: Duration = Duration::from_millis(100);
/// Notches of the wheel a second with an analog at its end.
const NOTCHES_PER_S: f64 = 10.0;
/// Of analogs around their middle.
const DEAD_ZONE: f64 = 0.15;

/// Where on the screen the program's window is, in pixels of the screen.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Monitor {
    pub size_px: UVec2,
    /// Upper left corner of the window's contents; None where the system does not tell.
    pub window_px: Option<IVec2>,
    /// Size of the window's contents.
    pub window_size_px: UVec2,
}

/// The head and who tracks it.
pub struct Head {
    settings: TrackingOptions,
    screen: ScreenOptions,
    clock: HostClock,
    /// The head of the headset that the program is shown in, where that is to be followed.
    worn: Option<WornHead>,
    /// While the view follows the head.
    tracker: Option<Tracker>,
    calibration: Calibration,
    calibration_file: Option<PathBuf>,
    calibrating: Option<Calibrating>,
    controls: ControlMap<Action>,
    /// What analogs do for as long as they are moved.
    axes: Vec<(Action, f64)>,
    shown: Predicted,
    monitor: Option<Monitor>,
    now_s: f64,
    /// Between the last two updates.
    elapsed_s: f64,
    losses: u32,
    rate: Rate,
}

/// Reports a second.
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

impl Head {
    /// `headset_enabled`: a headset may report the head that wears it.
    pub fn new(tracking: &TrackingOptions, screen: &ScreenOptions, headset_enabled: bool) -> Head {
        let (settings, screen) = (tracking.clone(), screen.clone());
        let clock = HostClock::starting_now();
        let device = settings.controls().map_or(settings.source.label(), |d| d.to_string());
        let button = |(button, action)| ButtonBinding { source: device.clone(), button, action };
        let analog = |(channel, action): (u32, Action)| AnalogBinding {
            source: device.clone(),
            channel,
            action,
            meaning: match action.help().kind {
                Kind::Wheel => AnalogUse::Axis { scale: 1.0, dead_zone: DEAD_ZONE },
                _ => AnalogUse::Press { press: 0.6, release: 0.4 },
            },
        };
        Head {
            controls: ControlMap::new(
                TrackingOptions::bound(&settings.buttons).map(button).collect(),
                TrackingOptions::bound(&settings.analogs).map(analog).collect(),
            ),
            worn: match settings.source {
                SourceAddress::Openxr(origin) if headset_enabled => {
                    Some(WornHead::new(&settings.source.label(), origin, clock))
                }
                _ => None,
            },
            calibration: settings.calibration(),
            calibration_file: None,
            calibrating: None,
            shown: Predicted {
                placement: rest(&screen),
                confidence: 0.0,
                presence: Presence::Absent,
            },
            settings,
            screen,
            clock,
            tracker: None,
            axes: Vec::new(),
            monitor: None,
            now_s: 0.0,
            elapsed_s: 0.0,
            losses: 0,
            rate: Rate::default(),
        }
    }

    pub fn is_on(&self) -> bool {
        self.tracker.is_some()
    }

    /// Whether the program begins with it.
    pub fn wanted(&self) -> bool {
        self.settings.on
    }

    fn open(&mut self) -> Result<(), source::SourceError> {
        let TrackingOptions { source: address, .. } = &self.settings;
        let controls = self.settings.controls();
        let worn = self.worn.as_ref();
        let signs = self.settings.signs();
        let sources = source::open(address, controls.as_ref(), signs, worn, self.clock)?;
        let body = self.settings.body(self.screen.rest_m.into(), self.calibration);
        let mut tracker = Tracker::new(body);
        sources.into_iter().for_each(|source| tracker.add_source(source));
        self.tracker = Some(tracker);
        self.losses = 0;
        self.rate = Rate { since_s: self.now_s, ..Rate::default() };
        Ok(())
    }

    /// Lets the view follow the head from now on, as the settings say. Returns what is to be said.
    pub fn start(&mut self) -> Vec<Notice> {
        let mut notices = Vec::new();
        if self.settings.source == SourceAddress::None {
            notices.push(Notice::note(
                "No head tracker is set, so the view stays still. Set tracking.source in the settings",
            ));
        }
        let (screen, guessed) = self.whole_screen();
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
        self.tracker = None;
        self.calibrating = None;
        self.axes.clear();
    }

    /// Seconds on the tracker's clock.
    pub fn clock_s(&self) -> f64 {
        self.clock.now_s()
    }

    /// Polls the sources at `now_s`. Returns what their buttons ask for, in order.
    pub fn update(&mut self, now_s: f64) -> Vec<ActionEvent> {
        self.elapsed_s = (now_s - self.now_s).clamp(0.0, 0.1);
        self.now_s = now_s;
        let Some(tracker) = &mut self.tracker else { return Vec::new() };
        let mut events = Vec::new();
        tracker.update(now_s, &mut events);
        self.shown = tracker.predicted(now_s + self.settings.prediction_ms * 1e-3);
        self.rate.count(tracker.sources().map(|source| source.counters().accepted).sum(), now_s);
        if let Some(calibrating) = &mut self.calibrating {
            calibrating.hear(tracker.raw_of(BodyId::HEAD).next().flatten(), now_s);
        }
        let mut controls = Vec::new();
        for event in &events {
            match (event, &mut self.calibrating) {
                (Event::Lost { .. }, _) => self.losses += 1,
                // Whoever touches the screen has no hand for the keyboard.
                (Event::Button { pressed: true, .. }, Some(calibrating)) => calibrating.take(),
                _ => {}
            }
            self.controls.take(event, &mut controls);
        }
        controls.into_iter().filter_map(|control| self.action_of(control)).collect()
    }

    fn action_of(&mut self, control: Control<Action>) -> Option<ActionEvent> {
        let is_hold = |action: Action| action.help().kind == Kind::Hold;
        match control {
            Control::Pressed(action) if is_hold(action) => {
                Some(ActionEvent::Begin { action, at: None })
            }
            Control::Pressed(action) => Some(ActionEvent::Tap(action)),
            Control::Released(action) => is_hold(action).then_some(ActionEvent::End(action)),
            Control::Axis(action, value) => {
                self.axes.retain(|(other, _)| *other != action);
                self.axes.push((action, value));
                None
            }
        }
    }

    /// What analogs have done since the last update: wheels turned at the pixel `at`.
    pub fn wheels(&self, at: Vec2) -> Vec<ActionEvent> {
        let turned = self.axes.iter().filter(|(_, value)| *value != 0.0);
        let notches = |value: f64| (value * self.elapsed_s * NOTCHES_PER_S) as f32;
        turned
            .map(|&(action, value)| ActionEvent::Wheel { action, notches: notches(value), at })
            .collect()
    }

    /// When the next picture is needed, with nothing else going on.
    pub fn repaint_after(&self) -> Option<Duration> {
        self.tracker.as_ref()?;
        let here = self.shown.presence != Presence::Absent || self.calibrating.is_some();
        Some(if here { Duration::ZERO } else { SEEK_EVERY })
    }

    /// Where the head is before the screen, in metres, while it is tracked.
    pub fn position_m(&self) -> Option<Vec3> {
        let tracked = matches!(self.shown.presence, Presence::Tracked | Presence::Returning);
        (self.is_on() && tracked).then(|| self.shown.placement.position_m.as_vec3())
    }

    /// The whole screen, and whether its size is a guess.
    fn whole_screen(&self) -> (ScreenPlane, bool) {
        let [width_m, height_m] = self.screen.size_m;
        if width_m > 0.0 {
            return (ScreenPlane::new(width_m, height_m), false);
        }
        let pixels = self.monitor.map_or(Vec2::new(16.0, 9.0), |m| m.size_px.as_vec2());
        let size = pixels * (GUESSED_DIAGONAL_M / pixels.length().max(1.0));
        (ScreenPlane::new(size.x, size.y), true)
    }

    /// The part of the screen in which the picture is.
    pub fn plane(&self, viewport: Viewport) -> ScreenPlane {
        let (whole, _) = self.whole_screen();
        let Some(monitor) = self.monitor else { return whole };
        // A window whose place nobody tells is taken to be in the middle.
        let middle = (monitor.size_px.as_ivec2() - monitor.window_size_px.as_ivec2()) / 2;
        let window = monitor.window_px.unwrap_or(middle).as_vec2();
        let screen = monitor.size_px.max(UVec2::ONE).as_vec2();
        let share = |corner: Vec2| (window + corner) / screen;
        whole.part(share(viewport.corner_px), share(viewport.corner_px + viewport.size_px))
    }

    /// The left and the right eye of the head, `eye_distance_m` metres apart, while the view follows
    /// it.
    pub fn eyes(
        &self,
        viewport: Viewport,
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
        let near = turntable.camera().near;
        Some(plane.eyes(&head, &world, turntable.eye().size, near))
    }

    /// Where the head is shown, on the screen's axes.
    pub fn placement(&self) -> Placement {
        self.shown.placement
    }

    /// The head that a headset reports to this tracker, if it is to.
    pub fn worn(&self) -> Option<&WornHead> {
        self.worn.as_ref()
    }

    /// Takes where the program's window is on the screen.
    pub fn set_monitor(&mut self, monitor: Option<Monitor>) {
        self.monitor = monitor;
    }

    pub fn is_calibrating(&self) -> bool {
        self.calibrating.is_some()
    }

    /// Keeps calibrations in a file, and takes the one that is there or that the settings name.
    pub fn keep_calibration_in(&mut self, path: PathBuf) -> Option<Notice> {
        let named = &self.settings.calibration;
        let path = if named.is_empty() { path } else { PathBuf::from(named) };
        let mut notice = None;
        if path.exists() || !named.is_empty() {
            match calibration::read(&path, self.settings.eyes()) {
                Ok(calibration) => self.keep(calibration),
                Err(error) => notice = Some(Notice::error(error.to_string())),
            }
        }
        self.calibration_file = Some(path);
        notice
    }

    /// Begins the calibration by four touches.
    pub fn begin_calibration(&mut self) -> Vec<Notice> {
        let notices = if self.is_on() { Vec::new() } else { self.start() };
        let (screen, _) = self.whole_screen();
        let tip_m = self.settings.tip_m.into();
        self.calibrating = Some(Calibrating::new(screen.width_m, screen.height_m, tip_m));
        notices
    }

    /// Takes a step of the calibration.
    pub fn calibrate(&mut self, step: CalibrationStep) -> Option<Notice> {
        let calibrating = self.calibrating.as_mut()?;
        match step {
            CalibrationStep::Take => calibrating.take(),
            CalibrationStep::Again => calibrating.again(),
            CalibrationStep::Cancel => self.calibrating = None,
            CalibrationStep::Keep => {
                let fit = calibrating.fit.take()?;
                self.keep(fit.calibration);
                let file = self.calibration_file.as_ref();
                return Some(match file.map(|path| calibration::write(path, &self.calibration)) {
                    Some(Err(error)) => Notice::error(error.to_string()),
                    Some(Ok(())) | None => Notice::note("Head tracker calibrated"),
                });
            }
        }
        None
    }

    pub fn status(&self) -> HeadStatus {
        let (screen, guessed) = self.whole_screen();
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
            rate_hz: self.rate.hz,
            losses: self.losses,
            dropped: counters.map(|counters| counters.rejected() + counters.unread).sum(),
            screen_m: [screen.width_m, screen.height_m],
            guessed,
            calibration: self.calibrating.as_ref().map(|calibrating| CalibrationStatus {
                taken: calibrating.taken(),
                rms_mm: calibrating.fit.as_ref().map(|fit| fit.rms_m * 1e3),
                problem: calibrating.problem.clone(),
            }),
        }
    }

    fn sources(&self) -> impl Iterator<Item = &dyn Source> {
        self.tracker.iter().flat_map(Tracker::sources)
    }

    /// Takes the calibration that four touches have led to.
    fn keep(&mut self, calibration: Calibration) {
        self.calibration = Calibration { sensor_from_eyes: self.settings.eyes(), ..calibration };
        if let Some(tracker) = &mut self.tracker {
            tracker.set_calibration(BodyId::HEAD, 0, self.calibration, self.now_s);
        }
        self.calibrating = None;
    }
}

fn rest(screen: &ScreenOptions) -> Placement {
    Placement { position_m: DVec3::from(screen.rest_m), orientation: DQuat::IDENTITY }
}
