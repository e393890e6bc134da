//! The buttons and analogs of a tracker, as actions: buttons press, analogs press or turn wheels.
//!
//! Takes events of trackers and times; gives action events. Knows no pose.

use glam::Vec2;
use tracking::Event;
use tracking::controls::{AnalogBinding, AnalogUse, ButtonBinding, Control, ControlMap};

use crate::head_tracking::TrackingOptions;
use crate::input::action::TriggerKind;
use crate::input::{Action, ActionEvent};

/// Notches of the wheel per second with an analog at its limit.
const NOTCHES_PER_S: f64 = 10.0;
/// The dead zone of analogs around their middle.
const DEAD_ZONE: f64 = 0.15;

/// The actions of buttons and analogs, and the moved analogs.
pub struct TrackerControls {
    map: ControlMap<Action>,
    /// The actions of analogs while these are moved.
    axes: Vec<(Action, f64)>,
}

impl TrackerControls {
    /// Uses the bindings of the settings.
    pub fn new(settings: &TrackingOptions) -> TrackerControls {
        let device = settings.controls().map_or(settings.source.label(), |d| d.to_string());
        let button = |(button, action)| ButtonBinding { source: device.clone(), button, action };
        let analog = |(channel, action): (u32, Action)| AnalogBinding {
            source: device.clone(),
            channel,
            action,
            meaning: match action.help().kind {
                TriggerKind::Wheel => AnalogUse::Axis { scale: 1.0, dead_zone: DEAD_ZONE },
                _ => AnalogUse::Press { press: 0.6, release: 0.4 },
            },
        };
        let map = ControlMap::new(
            TrackingOptions::bound(&settings.buttons).map(button).collect(),
            TrackingOptions::bound(&settings.analogs).map(analog).collect(),
        );
        TrackerControls { map, axes: Vec::new() }
    }

    /// Adds the actions of an event to `asked`, in order.
    pub fn hear(&mut self, event: &Event, asked: &mut Vec<ActionEvent>) {
        let mut controls = Vec::new();
        self.map.take(event, &mut controls);
        asked.extend(controls.into_iter().filter_map(|control| self.action_of(control)));
    }

    fn action_of(&mut self, control: Control<Action>) -> Option<ActionEvent> {
        let is_hold = |action: Action| action.help().kind == TriggerKind::Hold;
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

    /// Returns the effect of the analogs within `elapsed_s` seconds: turns of the wheel at the pixel `at`.
    pub fn wheels(&self, at: Vec2, elapsed_s: f64) -> Vec<ActionEvent> {
        let turned = self.axes.iter().filter(|(_, value)| *value != 0.0);
        let notches = |value: f64| (value * elapsed_s * NOTCHES_PER_S) as f32;
        turned
            .map(|&(action, value)| ActionEvent::Wheel { action, notches: notches(value), at })
            .collect()
    }

    /// Forgets all analogs.
    pub fn let_go(&mut self) {
        self.axes.clear();
    }
}
