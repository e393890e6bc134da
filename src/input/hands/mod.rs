//! The controllers of a headset: from poses, triggers, grips and sticks with their times to controller events
//! ([`mapper`]), carrying and scaling with the grips ([`grab`]), the board on the off hand and the ray that points at
//! it ([`board`]).
//!
//! Pure, in metres and seconds: knows no headset, no clock and no sculpture.

pub mod board;
pub mod grab;
pub mod mapper;

use glam::Vec2;
use serde::Deserialize;

pub use board::Board;
pub use mapper::{HandEvent, HandMapper, HandSettings};

use crate::view::RoomPose;

/// The side of a hand.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HandSide {
    Left,
    #[default]
    Right,
}

impl HandSide {
    pub const ALL: [HandSide; 2] = [HandSide::Left, HandSide::Right];

    pub const fn index(self) -> usize {
        self as usize
    }

    /// Returns the name in the interface.
    pub const fn label(self) -> &'static str {
        match self {
            HandSide::Left => "left hand",
            HandSide::Right => "right hand",
        }
    }

    pub const fn other(self) -> HandSide {
        match self {
            HandSide::Left => HandSide::Right,
            HandSide::Right => HandSide::Left,
        }
    }
}

/// The state of a hand. A hand that is not tracked has no poses.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct HandState {
    /// The pose of the palm.
    pub grip: Option<RoomPose>,
    /// The pose of the pointing ray.
    pub aim: Option<RoomPose>,
    /// 0 to 1.
    pub trigger: f32,
    /// 0 to 1.
    pub squeeze: f32,
    /// Right and up are positive, -1 to 1 each.
    pub stick: Vec2,
    pub menu: bool,
    /// The button that picks a colour.
    pub pick: bool,
}

impl HandState {
    /// Returns the state without invalid values: poses that are not finite, sticks out of range.
    fn plausible(&self) -> HandState {
        let valid = |x: f32| if x.is_finite() { x.clamp(-1.0, 1.0) } else { 0.0 };
        HandState {
            grip: self.grip.filter(RoomPose::is_plausible),
            aim: self.aim.filter(RoomPose::is_plausible),
            stick: Vec2::new(valid(self.stick.x), valid(self.stick.y)),
            ..*self
        }
    }
}

/// The state of both hands.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct HandsState {
    /// Seconds of any monotonic clock.
    pub time_s: f64,
    /// By [`HandSide::index`].
    pub hands: [HandState; 2],
}

impl HandsState {
    /// Returns the state without invalid values.
    fn plausible(&self) -> HandsState {
        HandsState { hands: self.hands.map(|hand| hand.plausible()), ..*self }
    }

    pub fn hand(&self, side: HandSide) -> &HandState {
        &self.hands[side.index()]
    }
}

/// An analog input as a switch with hysteresis: on from `PRESS`, off below `RELEASE`, so that a
/// trembling finger presses once.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
struct AnalogSwitch {
    down: bool,
}

/// A change of an [`AnalogSwitch`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Change {
    Pressed,
    Released,
}

impl AnalogSwitch {
    const PRESS: f32 = 0.6;
    const RELEASE: f32 = 0.4;

    /// Updates the switch. `travel`: 0 to 1; NaN counts as released.
    fn feed(&mut self, travel: f32) -> Option<Change> {
        let down = if self.down { travel > Self::RELEASE } else { travel >= Self::PRESS };
        let change = match (self.down, down) {
            (false, true) => Some(Change::Pressed),
            (true, false) => Some(Change::Released),
            _ => None,
        };
        self.down = down;
        change
    }

    /// Returns the pressure beyond the release point, 0 to 1; 1 while it is off.
    fn pressure(&self, travel: f32) -> f32 {
        match self.down {
            true => ((travel - Self::RELEASE) / (1.0 - Self::RELEASE)).clamp(0.0, 1.0),
            false => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trembling_finger_presses_once() {
        let mut switch = AnalogSwitch::default();
        let travels = [0.0, 0.5, 0.61, 0.55, 0.65, 0.45, 0.39, 0.59, f32::NAN, 1.0, f32::NAN];
        let changes: Vec<_> = travels.iter().filter_map(|&travel| switch.feed(travel)).collect();
        use Change::{Pressed, Released};
        assert_eq!(changes, [Pressed, Released, Pressed, Released]);
    }

    #[test]
    fn pressure_grows_from_where_a_switch_is_released() {
        let mut switch = AnalogSwitch::default();
        for (travel, pressure) in
            [(0.3, 1.0), (0.7, 0.5), (1.0, 1.0), (0.46, 0.1), (f32::INFINITY, 1.0), (0.4, 1.0)]
        {
            switch.feed(travel);
            assert!((switch.pressure(travel) - pressure).abs() < 1e-6, "{travel}");
        }
    }

    #[test]
    fn each_side_has_an_index_and_another() {
        for side in HandSide::ALL {
            assert_ne!(side, side.other());
            assert_eq!(side.other().other(), side);
            assert_eq!(HandSide::ALL[side.index()], side);
        }
    }
}
