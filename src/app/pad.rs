//! Owns what gamepads do to the work: what they ask for moves the tool, the sculpture or the
//! pointer, and what the tool bites off shakes the pad.
//!
//! Time comes in as seconds since the program's start; the pointer goes out as events for egui,
//! by the same door as the mouse.

use egui::{Color32, Context, Event, Id, LayerId, Order, PointerButton, Pos2, Stroke};
use glam::{Quat, Vec2, Vec3};

use super::workspace::Workspace;
use crate::input::pad::device::{Motor, PadChange, PadNews};
use crate::input::pad::rumble::Rumble;
use crate::input::pad::{GamepadOptions, Glide, PadEvent, PadId, PadMapper, PadMode};
use crate::input::{Action, ActionEvent, Trigger};
use crate::sculpture::Placement;
use crate::ui::PadStatus;

/// The pointer was moved by something else if it is farther than this from where the pad put it.
const POINTER_SLACK: f32 = 2.0;

/// Movements are done in steps of so many seconds at full speed: how far a step across goes
/// depends on the depth, so the way would else depend on the rate of pictures.
const STEP_S: f32 = 1.0 / 60.0;

/// The gamepads and what they need to know between pictures.
pub(super) struct Pads {
    settings: GamepadOptions,
    pub(super) mapper: PadMapper,
    motors: Vec<(PadId, Box<dyn Motor>)>,
    rumble: Rumble,
    /// Voxels that the tool has changed since the pad last shook.
    pub(super) bitten: u64,
    /// When the pad was last given its strength, in seconds.
    shaken_s: f64,
    /// Where the pad has put the pointer, in points: finer than the window keeps it.
    pointer: Option<Pos2>,
    /// The system does not let its own pointer be moved, so that one is drawn.
    draws_pointer: bool,
}

impl Pads {
    pub(super) fn new(settings: &GamepadOptions) -> Pads {
        Pads {
            settings: settings.clone(),
            mapper: PadMapper::new(settings.response(), settings.mode),
            motors: Vec::new(),
            rumble: Rumble::default(),
            bitten: 0,
            shaken_s: 0.0,
            pointer: None,
            draws_pointer: false,
        }
    }

    /// What the interface says of the pad that leads.
    pub(super) fn status(&self) -> Option<PadStatus<'_>> {
        let (id, name) = self.mapper.leader()?;
        let rumbles = self.motors.iter().any(|(motor, _)| *motor == id);
        Some(PadStatus { name, mode: self.mapper.mode(), rumbles })
    }

    fn shake(&mut self, strength: f32) {
        let leader = self.mapper.leader().map(|(id, _)| id);
        for (id, motor) in &mut self.motors {
            motor.shake(if leader == Some(*id) { strength } else { 0.0 });
        }
    }
}

impl Workspace {
    /// Hears of a pad at `now_s` seconds.
    pub fn hear_pad(&mut self, news: PadNews, now_s: f64) {
        match news.change {
            PadChange::Came { name, motor } => {
                self.ui.toasts.note(format!("Gamepad connected: {name}"));
                self.pads.mapper.came(news.pad, name);
                self.pads.motors.retain(|(id, _)| *id != news.pad);
                self.pads.motors.extend(motor.map(|motor| (news.pad, motor)));
            }
            PadChange::Went => {
                self.pads.motors.retain(|(id, _)| *id != news.pad);
                if let Some(name) = self.pads.mapper.went(news.pad) {
                    tracing::info!("gamepad disconnected: {name}");
                    self.ui.toasts.note(format!("Gamepad disconnected: {name}"));
                }
            }
            PadChange::State(state) => {
                if self.ui.keys.is_catching() {
                    let pressed = self.pads.mapper.newly_down(news.pad, &state).next();
                    self.ui.keys.hear(pressed.map(|button| Trigger::Pad { button }));
                }
                if let Some(bindings) = self.presets.get(self.ui.preset) {
                    self.pads.mapper.hear(news.pad, state, now_s, bindings);
                }
            }
        }
    }

    /// Whether pads are meant for this program, or for another that has the keyboard.
    pub fn listen_to_pads(&mut self, listening: bool) {
        self.pads.mapper.set_listening(listening);
    }

    /// Whether the pad needs pictures in which nothing else happens.
    pub fn pad_is_active(&self) -> bool {
        self.pads.mapper.is_active() || self.pads.rumble.is_shaking()
    }

    /// The next mode of the pad, if there is one.
    pub(super) fn next_pad_mode(&mut self) {
        if self.pads.mapper.leader().is_some() {
            self.pads.mapper.next_mode();
        }
    }

    pub(super) fn toggle_rumble(&mut self) {
        self.ui.rumble = !self.ui.rumble;
        self.ui.toasts.note(if self.ui.rumble { "Rumble on" } else { "Rumble off" });
    }

    /// Does what the pad has asked for up to `now_s`, and gives what it does with the pointer.
    pub fn play_pad(&mut self, now_s: f64, ctx: &Context) -> Vec<Event> {
        let mut events = Vec::new();
        let Some(bindings) = self.presets.get(self.ui.preset) else { return events };
        let catching = self.ui.keys.is_catching();
        for event in self.pads.mapper.take(now_s, bindings) {
            // What is pressed is heard as a trigger and does nothing else.
            if catching && !matches!(event, PadEvent::Action(ActionEvent::End(_))) {
                continue;
            }
            match event {
                PadEvent::Glide(glide) if glide.mode == PadMode::OnlyMouse => {
                    events.push(Event::PointerMoved(self.move_pointer(&glide, ctx)));
                }
                PadEvent::Glide(glide) if !self.ui.is_modal() => {
                    for part in glide.parts(STEP_S) {
                        self.glide(&part);
                    }
                }
                PadEvent::Glide(_) => {}
                PadEvent::Action(event) => {
                    // A window that asks for an answer is closed or answered with the pointer.
                    let meant =
                        matches!(event, ActionEvent::Tap(Action::Cancel) | ActionEvent::End(_));
                    if meant || !self.ui.is_modal() {
                        self.answer(&event);
                    }
                }
                PadEvent::Press(down) => self.click(&[down], ctx, &mut events),
                PadEvent::DoubleClick => self.click(&[true, false, true, false], ctx, &mut events),
            }
        }
        events
    }

    /// Lets the pad shake as the tool has bitten since the last call.
    pub fn shake_pad(&mut self, now_s: f64) {
        let pads = &mut self.pads;
        let dt_s = (now_s - pads.shaken_s).clamp(0.0, 1.0) as f32;
        pads.shaken_s = now_s;
        let bitten = std::mem::take(&mut pads.bitten);
        let felt = self.ui.rumble && self.stroke.is_some() && pads.mapper.is_holding();
        let before = pads.rumble.is_shaking();
        let strength =
            pads.rumble.step(felt.then_some(bitten), dt_s, &pads.settings.rumble_curve());
        if before || strength > 0.0 {
            pads.shake(strength);
        }
    }

    /// Draws a pointer where the system does not move its own.
    pub(super) fn draw_pad_pointer(&self, ctx: &Context) {
        if let (true, Some(at)) = (self.pads.draws_pointer, self.pads.pointer) {
            let painter = ctx.layer_painter(LayerId::new(Order::Debug, Id::new("pad pointer")));
            painter.circle_stroke(at, 6.0, Stroke::new(3.0, Color32::BLACK));
            painter.circle_stroke(at, 6.0, Stroke::new(1.5, Color32::WHITE));
            painter.circle_filled(at, 1.5, Color32::WHITE);
        }
    }

    /// Whether the system has moved its own pointer to where the pad wants it.
    pub fn pointer_follows(&mut self, follows: bool) {
        self.pads.draws_pointer = !follows;
    }

    /// Forgets where the pad has put the pointer once the mouse has moved it elsewhere.
    fn pointer(&mut self, ctx: &Context) -> Pos2 {
        let latest = ctx.input(|input| input.pointer.latest_pos());
        let at = match (self.pads.pointer, latest) {
            (Some(ours), Some(latest)) if ours.distance(latest) > POINTER_SLACK => latest,
            (Some(ours), _) => ours,
            (None, Some(latest)) => latest,
            (None, None) => self.picture().center(),
        };
        self.pads.pointer = Some(at);
        at
    }

    fn move_pointer(&mut self, glide: &Glide, ctx: &Context) -> Pos2 {
        let by = glide.shift.truncate() * self.pads.settings.pointer_speed;
        let at = self.pointer(ctx) + egui::vec2(by.x, -by.y);
        let window = ctx.content_rect().shrink(1.0);
        let at = at.clamp(window.min, window.max);
        self.pads.pointer = Some(at);
        at
    }

    fn click(&mut self, presses: &[bool], ctx: &Context, events: &mut Vec<Event>) {
        let modifiers = ctx.input(|input| input.modifiers);
        let pos = match events.last() {
            Some(Event::PointerMoved(at)) => *at,
            _ => self.pointer(ctx),
        };
        // Where the mouse has never been the pointer comes first.
        events.push(Event::PointerMoved(pos));
        let button = PointerButton::Primary;
        events.extend(presses.iter().map(|&pressed| Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers,
        }));
    }

    /// Moves and turns the tool or the sculpture.
    fn glide(&mut self, glide: &Glide) {
        let settings = &self.pads.settings;
        let pixels = glide.shift * settings.move_speed * self.turntable.eye().size.y as f32;
        // About axes of the screen, which are those of the world.
        let turn = glide.turn * settings.turn_speed_deg.to_radians();
        let placement = *self.session.document().placement();
        if glide.mode == PadMode::UseTool {
            if turn != Vec3::ZERO {
                let rotation = placement.rotation;
                let turn = rotation.inverse() * Quat::from_scaled_axis(turn) * rotation;
                self.ui.hand.turn_by(turn);
            }
            if pixels.truncate() != Vec2::ZERO {
                self.drag_tool(Vec2::new(pixels.x, -pixels.y), false);
            }
            if pixels.z != 0.0 {
                self.drag_tool(Vec2::new(0.0, pixels.z), true);
            }
            return;
        }
        let turntable = &self.turntable;
        let mut to = turntable.shifted(&placement, Vec2::new(pixels.x, -pixels.y));
        to = turntable.brought_nearer(&to, pixels.z);
        to = turntable.turned_by(&to, Vec2::new(turn.y, turn.x), self.ui.view.up);
        let rotation = (Quat::from_rotation_z(turn.z) * to.rotation).normalize();
        self.place(Placement { rotation, ..to });
    }
}

#[cfg(test)]
#[path = "pad_tests.rs"]
mod tests;
