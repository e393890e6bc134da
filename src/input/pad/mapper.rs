//! Gamepads to events: the active pad, its mode, held buttons, and the movement by sticks since the last frame.
//!
//! Takes states of pads with their times, and a key table; returns [`PadEvent`]s in order. The movement of a stick is
//! its speed integrated over time, from state to state instead of from frame to frame, so that it does not depend on
//! the frame rate.

use glam::{Vec2, Vec3};

use super::stick::Response;
use super::{PadButton, PadButtons, PadId, PadMode, PadState};
use crate::input::action::{Action, TriggerKind};
use crate::input::bindings::Bindings;
use crate::input::mapper::ActionEvent;
use crate::input::trigger::Trigger;

/// Longest counted pause between two frames, in seconds, which prevents jumps.
const LONGEST_STEP_S: f64 = 0.5;
/// Seconds until a held button repeats, and between repeats.
const REPEAT_AFTER_S: f64 = 0.4;
const REPEAT_EVERY_S: f64 = 0.1;

/// The movement of sticks and shoulder buttons over a time: seconds at full speed.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Glide {
    pub mode: PadMode,
    /// Right, up and towards the viewer, as seen on the screen.
    pub shift: Vec3,
    /// About the axes that point right, up and towards the viewer, counter-clockwise seen from
    /// their tips.
    pub turn: Vec3,
}

impl Glide {
    /// Returns the same movement in equal parts of at most `step_s` seconds at full speed.
    pub fn parts(self, step_s: f32) -> impl Iterator<Item = Glide> {
        let length = self.shift.abs().max(self.turn.abs()).max_element();
        let count = (length / step_s).ceil().max(1.0);
        let part = Glide { shift: self.shift / count, turn: self.turn / count, ..self };
        std::iter::repeat_n(part, count as usize)
    }
}

/// An event of a pad.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum PadEvent {
    Glide(Glide),
    /// The action of a button.
    Action(ActionEvent),
    /// The pointer's first button goes down or up.
    Press(bool),
    DoubleClick,
}

#[derive(Clone, PartialEq, Debug)]
struct Pad {
    id: PadId,
    name: String,
    state: PadState,
}

/// A held button that repeats.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Repeat {
    button: PadButton,
    action: Action,
    next_s: f64,
}

/// The state between events.
#[derive(Debug)]
pub struct PadMapper {
    pub response: Response,
    mode: PadMode,
    pads: Vec<Pad>,
    /// The pad used last.
    leader: Option<PadId>,
    /// Buttons that are bound in the key table.
    bound: PadButtons,
    /// Another program has the focus: pads control that one.
    deaf: bool,
    /// Actions held by buttons.
    holds: Vec<(PadButton, Action)>,
    repeat: Option<Repeat>,
    /// The pad holds down the pointer's button.
    presses: bool,
    /// Sticks are integrated up to this time, in seconds.
    counted_s: f64,
    /// And at most for this much longer.
    since_s: f64,
    events: Vec<PadEvent>,
}

impl PadMapper {
    pub fn new(response: Response, mode: PadMode) -> PadMapper {
        PadMapper {
            response,
            mode,
            pads: Vec::new(),
            leader: None,
            bound: PadButtons::NONE,
            deaf: false,
            holds: Vec::new(),
            repeat: None,
            presses: false,
            counted_s: 0.0,
            since_s: 0.0,
            events: Vec::new(),
        }
    }

    pub fn mode(&self) -> PadMode {
        self.mode
    }

    /// Returns the pad used last, or else the first one, with its name.
    pub fn leader(&self) -> Option<(PadId, &str)> {
        let leader = self.leader?;
        self.pads.iter().find(|pad| pad.id == leader).map(|pad| (pad.id, pad.name.as_str()))
    }

    /// Returns whether something moves over time, so that frames are needed.
    pub fn is_active(&self) -> bool {
        !self.events.is_empty()
            || self.repeat.is_some()
            || self.leading().is_some_and(|s| {
                let (shift, turn) = self.speeds(&s);
                shift != Vec3::ZERO || turn != Vec3::ZERO
            })
    }

    /// Returns whether the pad uses the tool or clicks, so that it should rumble.
    pub fn is_holding(&self) -> bool {
        self.presses || self.holds.iter().any(|(_, action)| *action == Action::Apply)
    }

    /// Adds a connected pad.
    pub fn came(&mut self, id: PadId, name: String) {
        self.pads.retain(|pad| pad.id != id);
        self.pads.push(Pad { id, name, state: PadState::default() });
        self.leader.get_or_insert(id);
    }

    /// Removes a disconnected pad and releases the buttons that it held. Returns its name.
    pub fn went(&mut self, id: PadId) -> Option<String> {
        let at = self.pads.iter().position(|pad| pad.id == id)?;
        if self.leader == Some(id) {
            self.release();
            self.leader = None;
        }
        let name = self.pads.remove(at).name;
        if self.leader.is_none() {
            self.leader = self.pads.first().map(|pad| pad.id);
        }
        Some(name)
    }

    /// Returns the buttons that are down in `state` and were up before.
    pub fn newly_down(&self, id: PadId, state: &PadState) -> impl Iterator<Item = PadButton> {
        let before = self.pads.iter().find(|pad| pad.id == id).map(|pad| pad.state.held);
        state.held.without(before.unwrap_or(state.held))
    }

    /// Processes the state of a pad at `now_s` seconds.
    pub fn update(&mut self, id: PadId, state: PadState, now_s: f64, bindings: &Bindings) {
        self.count(now_s, bindings);
        let Some(pad) = self.pads.iter_mut().find(|pad| pad.id == id) else { return };
        if self.deaf {
            pad.state = PadState { held: state.held, ..PadState::default() };
            return;
        }
        let before = std::mem::replace(&mut pad.state, state);
        if self.leader != Some(id) {
            let pushed = [state.left, state.right]
                .into_iter()
                .any(|stick| self.response.speed(stick) != Vec2::ZERO);
            if state.held.without(before.held).next().is_none() && !pushed {
                return;
            }
            self.release();
            self.leader = Some(id);
        }
        for button in before.held.without(state.held) {
            self.released(button);
        }
        for button in state.held.without(before.held) {
            self.pressed(button, now_s, bindings);
        }
    }

    /// Switches to the next mode. Releases everything held.
    pub fn next_mode(&mut self) {
        self.release();
        self.mode = self.mode.next();
        tracing::debug!("gamepad mode {}", self.mode.label());
    }

    /// Releases everything held. Buttons that are down count only when pressed again; sticks
    /// continue.
    pub fn release(&mut self) {
        self.repeat = None;
        if std::mem::take(&mut self.presses) {
            self.events.push(PadEvent::Press(false));
        }
        for (_, action) in std::mem::take(&mut self.holds) {
            self.events.push(PadEvent::Action(ActionEvent::End(action)));
        }
    }

    /// Sets whether pads control this program. If not, everything held is released, and sticks count as centred until
    /// their pad reports them again.
    pub fn set_listening(&mut self, listening: bool) {
        self.deaf = !listening;
        if listening {
            return;
        }
        self.release();
        for pad in &mut self.pads {
            let held = pad.state.held;
            pad.state = PadState { held, ..PadState::default() };
        }
    }

    /// Returns the events up to `now_s` seconds, in order.
    pub fn take(&mut self, now_s: f64, bindings: &Bindings) -> Vec<PadEvent> {
        self.count(now_s, bindings);
        self.since_s = now_s;
        std::mem::take(&mut self.events)
    }

    fn leading(&self) -> Option<PadState> {
        let leader = self.leader?;
        self.pads.iter().find(|pad| pad.id == leader).map(|pad| pad.state)
    }

    fn pressed(&mut self, button: PadButton, now_s: f64, bindings: &Bindings) {
        if self.mode == PadMode::OnlyMouse {
            match button {
                PadButton::South => return self.events.push(PadEvent::DoubleClick),
                PadButton::North => {
                    self.presses = true;
                    return self.events.push(PadEvent::Press(true));
                }
                _ => {}
            }
        }
        let Some(action) = bindings.action(Trigger::Pad { button }) else { return };
        match action {
            Action::NextPadMode => self.next_mode(),
            _ if action.help().kind == TriggerKind::Hold => {
                self.holds.push((button, action));
                self.events.push(PadEvent::Action(ActionEvent::Begin { action, at: None }));
            }
            _ => {
                self.events.push(PadEvent::Action(ActionEvent::Tap(action)));
                let next_s = now_s + REPEAT_AFTER_S;
                self.repeat = action.repeats().then_some(Repeat { button, action, next_s });
            }
        }
    }

    fn released(&mut self, button: PadButton) {
        self.repeat = self.repeat.filter(|repeat| repeat.button != button);
        if button == PadButton::North && std::mem::take(&mut self.presses) {
            self.events.push(PadEvent::Press(false));
        }
        if let Some(at) = self.holds.iter().position(|(held, _)| *held == button) {
            self.events.push(PadEvent::Action(ActionEvent::End(self.holds.remove(at).1)));
        }
    }

    /// Integrates the sticks up to `now_s`.
    fn count(&mut self, now_s: f64, bindings: &Bindings) {
        let bound =
            |button: &PadButton| bindings.action(Trigger::Pad { button: *button }).is_some();
        self.bound =
            PadButton::ALL.into_iter().filter(bound).fold(PadButtons::NONE, PadButtons::with);
        if !self.is_active() {
            // From rest: the time before does not count.
            self.since_s = now_s;
            self.counted_s = now_s;
            return;
        }
        let until = now_s.min(self.since_s + LONGEST_STEP_S);
        let dt_s = (until - self.counted_s).max(0.0) as f32;
        self.counted_s = now_s.max(self.counted_s);
        let Some(state) = self.leading() else { return };
        let (shift, turn) = self.speeds(&state);
        if dt_s > 0.0 && (shift != Vec3::ZERO || turn != Vec3::ZERO) {
            self.glide(Glide { mode: self.mode, shift: shift * dt_s, turn: turn * dt_s });
        }
        if let Some(repeat) = self.repeat.as_mut().filter(|repeat| repeat.next_s <= now_s) {
            self.events.push(PadEvent::Action(ActionEvent::Tap(repeat.action)));
            repeat.next_s = (repeat.next_s + REPEAT_EVERY_S).max(now_s);
        }
    }

    /// Adds a movement to the one before it, if nothing is in between.
    fn glide(&mut self, more: Glide) {
        match self.events.last_mut() {
            Some(PadEvent::Glide(glide)) if glide.mode == more.mode => {
                glide.shift += more.shift;
                glide.turn += more.turn;
            }
            _ => self.events.push(PadEvent::Glide(more)),
        }
    }

    /// Returns the speeds of moving and rotating in this mode, each 0 to 1. Shoulder buttons bound in the key table
    /// move nothing.
    fn speeds(&self, state: &PadState) -> (Vec3, Vec3) {
        let left = self.response.speed(state.left);
        if self.mode == PadMode::OnlyMouse {
            return (left.extend(0.0), Vec3::ZERO);
        }
        let pull = |button: PadButton, deflection: f32| {
            if self.bound.contains(button) { 0.0 } else { self.response.pull(deflection) }
        };
        let down = |button| f32::from(u8::from(state.held.contains(button)));
        let near = pull(PadButton::LeftTrigger, state.triggers.x)
            - pull(PadButton::LeftShoulder, down(PadButton::LeftShoulder));
        let roll = pull(PadButton::RightTrigger, state.triggers.y)
            - pull(PadButton::RightShoulder, down(PadButton::RightShoulder));
        let right = self.response.speed(state.right);
        // Pushing right turns the front of the sculpture to the right, pushing up turns it upwards.
        (left.extend(near), Vec3::new(-right.y, right.x, roll))
    }
}

#[cfg(test)]
#[path = "mapper_tests.rs"]
mod tests;
