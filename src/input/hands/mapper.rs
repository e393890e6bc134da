//! Maps the state of two controllers to controller events: the hand that holds the sculpture, the pose of the tool, and
//! the target of a press.
//!
//! The **main** hand has the tool: its trigger uses it, its stick resizes it. The **off** hand has the board, undo and
//! redo. Either grip holds the sculpture, both scale it; the off hand's trigger also holds it, for controllers without
//! a grip. A tap of the off trigger or of a menu button toggles the board, a long press of a menu button brings
//! everything in front of the person. Over the board the main trigger clicks and the main stick scrolls. A button of
//! the main hand picks the colour that the tool touches.

use glam::Vec2;

use super::board::Pointing;
use super::grab::Grab;
use super::{AnalogSwitch, Board, Change, HandSide, HandsState};
use crate::input::pace::{LONGEST_STEP_S, Pace};
use crate::input::pad::stick::Response;
use crate::view::{RoomPose, Similarity};

/// A press shorter than this is a tap, in seconds.
const TAP_S: f64 = 0.25;
/// Duration of a long press of a menu button, in seconds.
const LONG_S: f64 = 1.0;
/// Notches of size per second at full deflection of the stick.
const RESIZE_PER_S: f32 = 8.0;
/// Points of scrolling per second at full deflection of the stick.
const SCROLL_PER_S: f32 = 900.0;
/// Delay until a stick held to the side repeats, and the interval of repeats, in seconds.
const REPEAT_AFTER_S: f64 = 0.5;
const REPEAT_EVERY_S: f64 = 0.2;
/// A hand at rest leaves the tool to the mouse, until it has moved this far.
const REST_M: f32 = 0.002;
const REST_RAD: f32 = 0.02;

/// The interpretation of controllers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HandSettings {
    /// The hand with the tool.
    pub main: HandSide,
    pub response: Response,
    /// Distance from the main hand to the tool along its ray, in metres.
    pub reach_m: f32,
}

/// A controller event, in order of execution.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum HandEvent {
    /// The sculpture is carried.
    Carry(Similarity),
    /// The position of the tool in the room.
    Tool(RoomPose),
    /// The use of the tool begins or ends.
    Press,
    Release,
    /// Pressure of the tool's trigger, 0 to 1; 1 when it is released.
    Pressure(f32),
    /// Enlarges the tool by notches, or shrinks it below 0.
    Resize(f32),
    /// Picks the colour that the tool touches or points at.
    Pick,
    Undo,
    Redo,
    /// Toggles the board.
    ToggleBoard,
    /// Brings everything in front of the person.
    Recentre,
    /// Position of the ray on the board, from its upper left corner, 0 to 1 each.
    Point(Vec2),
    /// The ray has left the board.
    PointAway,
    /// The trigger is pressed or released as the pointer's button on the board.
    Click(bool),
    /// Scrolls the board by points; positive values reveal the content above and to the left.
    Scroll(Vec2),
}

/// The target of a press of the main trigger until its release.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum PressTarget {
    Tool,
    /// The tool, which is lifted until the tracked hand is slow again.
    Lifted,
    Board,
}

/// A stick that triggers once for each push to the side, and repeats while it stays there.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct Flick {
    /// The side, -1 or 1, and the time of its repetition.
    held: Option<(f32, f64)>,
}

impl Flick {
    const PUSHED: f32 = 0.7;
    const BACK: f32 = 0.4;

    /// Returns the side that was triggered, -1 or 1.
    fn feed(&mut self, deflection: f32, now_s: f64) -> Option<f32> {
        match self.held {
            None if deflection.abs() >= Self::PUSHED => {
                self.held = Some((deflection.signum(), now_s + REPEAT_AFTER_S));
                Some(deflection.signum())
            }
            Some((side, _)) if deflection.is_nan() || deflection * side <= Self::BACK => {
                self.held = None;
                None
            }
            Some((side, again_s)) if now_s >= again_s => {
                self.held = Some((side, now_s + REPEAT_EVERY_S));
                Some(side)
            }
            _ => None,
        }
    }
}

/// A button with a tap and possibly a long press.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct Hold {
    /// Time of the press; `None` after a long press has been reported.
    since_s: Option<f64>,
    switch: AnalogSwitch,
}

/// The state of both hands between calls.
#[derive(Clone, PartialEq, Debug)]
pub struct HandMapper {
    settings: HandSettings,
    /// The time of the last update.
    last_s: Option<f64>,
    grab: Grab,
    /// By [`HandSide::index`].
    grips: [AnalogSwitch; 2],
    menu: [Hold; 2],
    main_trigger: AnalogSwitch,
    /// The last reported pressure of the main trigger.
    pressure: f32,
    off_trigger: Hold,
    press_target: Option<PressTarget>,
    pointing: bool,
    /// The position on the board.
    pointer: Pointing,
    undo: Flick,
    /// The last pose of the tool.
    last_tool: Option<RoomPose>,
    /// Detects jumps of the tool in the main hand.
    pace: Pace,
}

impl HandMapper {
    pub fn new(settings: HandSettings) -> HandMapper {
        HandMapper {
            settings,
            last_s: None,
            grab: Grab::default(),
            grips: Default::default(),
            menu: Default::default(),
            main_trigger: AnalogSwitch::default(),
            pressure: 1.0,
            off_trigger: Hold::default(),
            press_target: None,
            pointing: false,
            pointer: Pointing::default(),
            undo: Flick::default(),
            last_tool: None,
            pace: Pace::default(),
        }
    }

    pub fn settings(&self) -> &HandSettings {
        &self.settings
    }

    /// Moves the tool to a hand. Releases everything held.
    pub fn set_main(&mut self, main: HandSide, events: &mut Vec<HandEvent>) {
        if self.settings.main != main {
            self.release_all(events);
            *self = HandMapper::new(HandSettings { main, ..self.settings });
        }
    }

    /// Releases everything held, since the controllers are no longer read.
    pub fn release_all(&mut self, events: &mut Vec<HandEvent>) {
        match self.press_target.take() {
            Some(PressTarget::Tool) => events.push(HandEvent::Release),
            Some(PressTarget::Board) => events.push(HandEvent::Click(false)),
            Some(PressTarget::Lifted) | None => {}
        }
        if std::mem::take(&mut self.pointing) {
            events.push(HandEvent::PointAway);
        }
        *self = HandMapper::new(self.settings);
    }

    /// Returns whether a hand holds the sculpture.
    pub fn is_carrying(&self) -> bool {
        self.grab.is_holding()
    }

    /// Returns the events since the last update. `board`: its pose, while it is visible.
    pub fn update(&mut self, state: &HandsState, board: Option<&Board>) -> Vec<HandEvent> {
        let mut events = Vec::new();
        let mut state = state.plausible();
        if !state.time_s.is_finite() {
            // As if no time had passed.
            state.time_s = self.last_s.unwrap_or_default();
        }
        let (state, now_s) = (&state, state.time_s);
        let dt_s = self.last_s.map_or(0.0, |last| (now_s - last).clamp(0.0, LONGEST_STEP_S));
        self.last_s = Some(now_s);
        let (main, off) = (self.settings.main, self.settings.main.other());

        self.update_menus(state, &mut events);
        let off_holds = self.update_off_trigger(state.hand(off).trigger, now_s, &mut events);
        let mut gripping = HandSide::ALL.map(|side| {
            let switch = &mut self.grips[side.index()];
            switch.feed(state.hand(side).squeeze);
            switch.down
        });
        gripping[off.index()] |= off_holds;
        let carried = self.grab.step(gripping, state, dt_s);
        events.extend(carried.map(HandEvent::Carry));

        let aim = state.hand(main).aim;
        self.lift_at_jump(aim, now_s, dt_s, &mut events);
        // A stroke that has begun continues in front of the board.
        let open = board.filter(|_| {
            !matches!(self.press_target, Some(PressTarget::Tool | PressTarget::Lifted))
        });
        // A hand that is no longer tracked releases everything.
        let travel = if aim.is_some() { state.hand(main).trigger } else { 0.0 };
        let change = self.main_trigger.feed(travel);
        let hit = match open.zip(aim) {
            Some((board, aim)) => {
                self.pointer.step(board, &aim, travel, change, self.main_trigger.down)
            }
            None => {
                self.pointer = Pointing::default();
                None
            }
        };
        match hit {
            Some(hit) => events.push(HandEvent::Point(hit.at)),
            None if self.pointing => events.push(HandEvent::PointAway),
            None => {}
        }
        self.pointing = hit.is_some();
        if !self.pointing {
            self.move_tool(aim, carried.is_some(), &mut events);
        }
        let pressure = self.main_trigger.pressure(travel);
        if std::mem::replace(&mut self.pressure, pressure) != pressure {
            events.push(HandEvent::Pressure(pressure));
        }
        self.update_main_trigger(change, aim, now_s, &mut events);
        if state.hand(main).pick && !self.pointing && self.press_target != Some(PressTarget::Tool) {
            events.push(HandEvent::Pick);
        }

        let stick = self.settings.response.speed(state.hand(main).stick) * dt_s as f32;
        if self.pointing && stick != Vec2::ZERO {
            events.push(HandEvent::Scroll(Vec2::new(-stick.x, stick.y) * SCROLL_PER_S));
        } else if !self.pointing && stick.y != 0.0 {
            events.push(HandEvent::Resize(stick.y * RESIZE_PER_S));
        }
        match self.undo.feed(state.hand(off).stick.x, now_s) {
            Some(side) if side < 0.0 => events.push(HandEvent::Undo),
            Some(_) => events.push(HandEvent::Redo),
            None => {}
        }
        events
    }

    fn update_menus(&mut self, state: &HandsState, events: &mut Vec<HandEvent>) {
        for side in HandSide::ALL {
            let hold = &mut self.menu[side.index()];
            match hold.switch.feed(f32::from(u8::from(state.hand(side).menu))) {
                Some(Change::Pressed) => hold.since_s = Some(state.time_s),
                Some(Change::Released) if hold.since_s.take().is_some() => {
                    events.push(HandEvent::ToggleBoard);
                }
                _ => {}
            }
            if hold.since_s.is_some_and(|since| state.time_s - since >= LONG_S) {
                hold.since_s = None;
                events.push(HandEvent::Recentre);
            }
        }
    }

    /// Updates the trigger of the off hand. Returns true while it has been held long enough to carry the sculpture.
    fn update_off_trigger(&mut self, travel: f32, now_s: f64, events: &mut Vec<HandEvent>) -> bool {
        let hold = &mut self.off_trigger;
        match hold.switch.feed(travel) {
            Some(Change::Pressed) => hold.since_s = Some(now_s),
            Some(Change::Released) => {
                let tapped = hold.since_s.take().is_some_and(|since| now_s - since < TAP_S);
                if tapped {
                    events.push(HandEvent::ToggleBoard);
                }
            }
            None => {}
        }
        hold.since_s.is_some_and(|since| now_s - since >= TAP_S)
    }

    /// Returns the tool's pose for this pointing pose of a hand.
    fn tool_of(&self, aim: &RoomPose) -> RoomPose {
        let position = aim.position + aim.forward() * self.settings.reach_m;
        RoomPose { position, rotation: aim.rotation }
    }

    /// Ends the stroke at a jump of tracking, instead of cutting along the jump.
    fn lift_at_jump(
        &mut self,
        aim: Option<RoomPose>,
        now_s: f64,
        dt_s: f64,
        events: &mut Vec<HandEvent>,
    ) {
        let at = aim.map(|aim| self.tool_of(&aim).position);
        if self.pace.step(at, now_s, dt_s) && self.press_target == Some(PressTarget::Tool) {
            self.press_target = Some(PressTarget::Lifted);
            events.push(HandEvent::Release);
        }
    }

    /// Moves the tool to the main hand, unless the hand is at rest.
    fn move_tool(&mut self, aim: Option<RoomPose>, carried: bool, events: &mut Vec<HandEvent>) {
        let Some(aim) = aim else { return };
        let tool = self.tool_of(&aim);
        let rests = self.last_tool.is_some_and(|last| {
            last.position.distance(tool.position) < REST_M
                && last.rotation.angle_between(tool.rotation) < REST_RAD
        });
        if !rests || carried || self.press_target == Some(PressTarget::Tool) {
            self.last_tool = Some(tool);
            events.push(HandEvent::Tool(tool));
        }
    }

    fn update_main_trigger(
        &mut self,
        change: Option<Change>,
        aim: Option<RoomPose>,
        now_s: f64,
        events: &mut Vec<HandEvent>,
    ) {
        match change {
            Some(Change::Pressed) if self.pointing => {
                self.press_target = Some(PressTarget::Board);
                events.push(HandEvent::Click(true));
            }
            Some(Change::Pressed) => self.press_target = Some(PressTarget::Lifted),
            Some(Change::Released) => match self.press_target.take() {
                Some(PressTarget::Tool) => events.push(HandEvent::Release),
                Some(PressTarget::Board) => events.push(HandEvent::Click(false)),
                Some(PressTarget::Lifted) | None => {}
            },
            None => {}
        }
        if self.press_target == Some(PressTarget::Lifted) && self.pace.is_calm(now_s) {
            self.press_target = Some(PressTarget::Tool);
            // The tool starts at the hand, however long that was at rest.
            self.last_tool = None;
            self.move_tool(aim, false, events);
            events.push(HandEvent::Press);
        }
    }
}

#[cfg(test)]
#[path = "mapper_tests.rs"]
mod tests;
