//! From the state of two hands to controller events: who holds the sculpture, where the tool is,
//! what a press is for.
//!
//! The **main** hand has the tool: its trigger uses it, its stick resizes it. The **off** hand has
//! the board, undo and redo. Either grip holds the sculpture, both scale it; the off hand's trigger
//! holds it, too, for controllers without a grip. A tap of the off trigger or of a menu button
//! toggles the board, a long press of a menu button brings everything in front of the person. Over
//! the board the main trigger clicks and the main stick scrolls. A button of the main hand picks
//! the colour that the tool touches.

use glam::Vec2;

use super::board::Pointing;
use super::grab::Grab;
use super::{Board, Change, HandSide, HandsState, Switch};
use crate::input::pace::{LONGEST_STEP_S, Pace};
use crate::input::pad::stick::Response;
use crate::view::{Pose, Similarity};

/// A press shorter than this is a tap, in seconds.
const TAP_S: f64 = 0.25;
/// A menu button held this long brings everything before the person, in seconds.
const LONG_S: f64 = 1.0;
/// Notches of size a second with the stick at its end.
const RESIZE_PER_S: f32 = 8.0;
/// Points of scrolling a second with the stick at its end.
const SCROLL_PER_S: f32 = 900.0;
/// Seconds after which a stick that stays to the side asks again, and between asking again.
const REPEAT_AFTER_S: f64 = 0.5;
const REPEAT_EVERY_S: f64 = 0.2;
/// A hand that rests leaves the tool to the mouse: it leads again when it has moved this far.
const REST_M: f32 = 0.002;
const REST_RAD: f32 = 0.02;

/// How hands are heard.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HandSettings {
    /// The hand with the tool.
    pub main: HandSide,
    pub response: Response,
    /// From the main hand to the tool along its ray, in metres.
    pub reach_m: f32,
}

/// A controller event, in the order in which they are to be executed.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum HandEvent {
    /// The sculpture is carried.
    Carry(Similarity),
    /// The position of the tool in the room.
    Tool(Pose),
    /// The use of the tool begins, or ends.
    Press,
    Release,
    /// The tool becomes larger by notches, or smaller below 0.
    Resize(f32),
    /// Picks the colour that the tool touches or points at.
    Pick,
    Undo,
    Redo,
    /// Toggles the board.
    ToggleBoard,
    /// Brings everything in front of the person.
    Recentre,
    /// The ray points at this point of the board, from its upper left corner, 0 to 1 each.
    Point(Vec2),
    /// The ray has left the board.
    PointAway,
    /// The pointer's button goes down or up on the board.
    Click(bool),
    /// Points of scrolling on the board; positive shows what is above and to the left.
    Scroll(Vec2),
}

/// What a press of the main trigger is for, until it is released.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Meant {
    Tool,
    /// The tool, which is lifted until tracking of the hand is calm again.
    Lifted,
    Board,
}

/// A stick that triggers once for each push to the side, and repeats while it stays there.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct Flick {
    /// The side, -1 or 1, and when it repeats.
    held: Option<(f32, f64)>,
}

impl Flick {
    const PUSHED: f32 = 0.7;
    const BACK: f32 = 0.4;

    /// The side that was triggered, -1 or 1.
    fn feed(&mut self, way: f32, now_s: f64) -> Option<f32> {
        match self.held {
            None if way.abs() >= Self::PUSHED => {
                self.held = Some((way.signum(), now_s + REPEAT_AFTER_S));
                Some(way.signum())
            }
            Some((side, _)) if way.is_nan() || way * side <= Self::BACK => {
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
    /// When it was pressed; none after a long press has been reported.
    since_s: Option<f64>,
    switch: Switch,
}

/// The state of both hands between calls.
#[derive(Clone, PartialEq, Debug)]
pub struct HandMapper {
    settings: HandSettings,
    /// The time of the last call.
    heard_s: Option<f64>,
    grab: Grab,
    /// By [`HandSide::index`].
    grips: [Switch; 2],
    menu: [Hold; 2],
    main_trigger: Switch,
    off_trigger: Hold,
    meant: Option<Meant>,
    pointing: bool,
    /// The position on the board.
    pointer: Pointing,
    undo: Flick,
    /// The last position of the tool.
    led: Option<Pose>,
    /// The pace of the tool in the main hand.
    pace: Pace,
}

impl HandMapper {
    pub fn new(settings: HandSettings) -> HandMapper {
        HandMapper {
            settings,
            heard_s: None,
            grab: Grab::default(),
            grips: Default::default(),
            menu: Default::default(),
            main_trigger: Switch::default(),
            off_trigger: Hold::default(),
            meant: None,
            pointing: false,
            pointer: Pointing::default(),
            undo: Flick::default(),
            led: None,
            pace: Pace::default(),
        }
    }

    pub fn settings(&self) -> &HandSettings {
        &self.settings
    }

    /// Moves the tool to a hand; everything held is released.
    pub fn set_main(&mut self, main: HandSide, events: &mut Vec<HandEvent>) {
        if self.settings.main != main {
            self.let_go(events);
            *self = HandMapper::new(HandSettings { main, ..self.settings });
        }
    }

    /// The hands are no longer tracked: everything held is released.
    pub fn let_go(&mut self, events: &mut Vec<HandEvent>) {
        match self.meant.take() {
            Some(Meant::Tool) => events.push(HandEvent::Release),
            Some(Meant::Board) => events.push(HandEvent::Click(false)),
            Some(Meant::Lifted) | None => {}
        }
        if std::mem::take(&mut self.pointing) {
            events.push(HandEvent::PointAway);
        }
        *self = HandMapper::new(self.settings);
    }

    /// Whether a hand holds the sculpture.
    pub fn is_carrying(&self) -> bool {
        self.grab.is_holding()
    }

    /// The events of the hands. `board`: where the board is, while it is open.
    pub fn hear(&mut self, state: &HandsState, board: Option<&Board>) -> Vec<HandEvent> {
        let mut events = Vec::new();
        let state = &state.plausible();
        let now_s = state.time_s;
        let dt_s = self.heard_s.map_or(0.0, |heard| (now_s - heard).clamp(0.0, LONGEST_STEP_S));
        self.heard_s = Some(now_s);
        let (main, off) = (self.settings.main, self.settings.main.other());

        self.hear_menus(state, &mut events);
        let off_holds = self.hear_off_trigger(state.hand(off).trigger, now_s, &mut events);
        let mut gripping = HandSide::ALL.map(|side| {
            let switch = &mut self.grips[side.index()];
            switch.feed(state.hand(side).squeeze);
            switch.down
        });
        gripping[off.index()] |= off_holds;
        let carried = self.grab.step(gripping, state, dt_s);
        events.extend(carried.map(HandEvent::Carry));

        let aim = state.hand(main).aim;
        self.follow_pace(aim, now_s, dt_s, &mut events);
        // A stroke that has begun continues in front of the board, too.
        let open = board.filter(|_| !matches!(self.meant, Some(Meant::Tool | Meant::Lifted)));
        // A hand that is lost releases everything.
        let way = if aim.is_some() { state.hand(main).trigger } else { 0.0 };
        let change = self.main_trigger.feed(way);
        let hit = match open.zip(aim) {
            Some((board, aim)) => {
                self.pointer.step(board, &aim, way, change, self.main_trigger.down)
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
            self.lead_tool(aim, carried.is_some(), &mut events);
        }
        self.hear_main_trigger(change, aim, now_s, &mut events);
        if state.hand(main).pick && !self.pointing && self.meant != Some(Meant::Tool) {
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

    fn hear_menus(&mut self, state: &HandsState, events: &mut Vec<HandEvent>) {
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

    /// True while the trigger of the off hand has been held long enough to carry the sculpture.
    fn hear_off_trigger(&mut self, way: f32, now_s: f64, events: &mut Vec<HandEvent>) -> bool {
        let hold = &mut self.off_trigger;
        match hold.switch.feed(way) {
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

    /// The tool's pose for this pointing pose of a hand.
    fn tool_of(&self, aim: &Pose) -> Pose {
        let position = aim.position + aim.forward() * self.settings.reach_m;
        Pose { position, rotation: aim.rotation }
    }

    /// Lifts the tool from its stroke where tracking leaps, instead of cutting along the leap.
    fn follow_pace(
        &mut self,
        aim: Option<Pose>,
        now_s: f64,
        dt_s: f64,
        events: &mut Vec<HandEvent>,
    ) {
        let at = aim.map(|aim| self.tool_of(&aim).position);
        if self.pace.step(at, now_s, dt_s) && self.meant == Some(Meant::Tool) {
            self.meant = Some(Meant::Lifted);
            events.push(HandEvent::Release);
        }
    }

    /// Moves the tool to the main hand, unless that rests.
    fn lead_tool(&mut self, aim: Option<Pose>, carried: bool, events: &mut Vec<HandEvent>) {
        let Some(aim) = aim else { return };
        let tool = self.tool_of(&aim);
        let rests = self.led.is_some_and(|led| {
            led.position.distance(tool.position) < REST_M
                && led.rotation.angle_between(tool.rotation) < REST_RAD
        });
        if !rests || carried || self.meant == Some(Meant::Tool) {
            self.led = Some(tool);
            events.push(HandEvent::Tool(tool));
        }
    }

    fn hear_main_trigger(
        &mut self,
        change: Option<Change>,
        aim: Option<Pose>,
        now_s: f64,
        events: &mut Vec<HandEvent>,
    ) {
        match change {
            Some(Change::Pressed) if self.pointing => {
                self.meant = Some(Meant::Board);
                events.push(HandEvent::Click(true));
            }
            Some(Change::Pressed) => self.meant = Some(Meant::Lifted),
            Some(Change::Released) => match self.meant.take() {
                Some(Meant::Tool) => events.push(HandEvent::Release),
                Some(Meant::Board) => events.push(HandEvent::Click(false)),
                Some(Meant::Lifted) | None => {}
            },
            None => {}
        }
        if self.meant == Some(Meant::Lifted) && self.pace.is_calm(now_s) {
            self.meant = Some(Meant::Tool);
            // The tool starts where the hand is, however long it has rested.
            self.led = None;
            self.lead_tool(aim, false, events);
            events.push(HandEvent::Press);
        }
    }
}

#[cfg(test)]
#[path = "mapper_tests.rs"]
mod tests;
