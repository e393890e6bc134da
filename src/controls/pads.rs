//! The gamepads: turns states into events, moves the pointer with a stick, and rumbles with the voxels that the tool
//! changes.
//!
//! Takes times in seconds since the program's start; the pointer's movements are returned as events for egui, like
//! those of the mouse.

use egui::{Color32, Context, Event, Id, LayerId, Order, PointerButton, Pos2, Stroke};

use crate::input::pad::device::{Motor, PadChange, PadNews};
use crate::input::pad::rumble::Rumble;
use crate::input::pad::{GamepadOptions, Glide, PadEvent, PadId, PadMapper, PadMode};
use crate::input::{Bindings, Trigger};
use crate::notice::Notice;

/// If the pointer is farther than this from the pad's last position for it, the mouse has moved it.
const POINTER_SLACK: f32 = 2.0;

/// Movements are divided into steps of so many seconds at full speed: the length of a sideways step depends on the
/// depth, so the path would otherwise depend on the frame rate.
pub const STEP_S: f32 = 1.0 / 60.0;

/// The state of a gamepad for the interface.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PadStatus<'a> {
    pub name: &'a str,
    pub mode: PadMode,
    /// Whether it has rumble motors.
    pub rumbles: bool,
    /// Whether rumble is switched on.
    pub rumble_on: bool,
}

/// The gamepads and their state between frames.
pub struct Pads {
    settings: GamepadOptions,
    mapper: PadMapper,
    motors: Vec<(PadId, Box<dyn Motor>)>,
    rumble: Rumble,
    /// Total number of voxels changed by tools at the last update of the rumble.
    felt_voxels: u64,
    /// Time of the last update of the rumble, in seconds.
    shaken_s: f64,
    /// Position of the pointer by the pad, in points: more precise than the window's.
    pointer: Option<Pos2>,
    /// The system's pointer cannot be moved, so one is drawn.
    draws_pointer: bool,
}

impl Pads {
    pub fn new(settings: &GamepadOptions) -> Pads {
        Pads {
            settings: settings.clone(),
            mapper: PadMapper::new(settings.response(), settings.mode),
            motors: Vec::new(),
            rumble: Rumble::default(),
            felt_voxels: 0,
            shaken_s: 0.0,
            pointer: None,
            draws_pointer: false,
        }
    }

    /// Returns the state of the active pad for the interface.
    pub fn status(&self) -> Option<PadStatus<'_>> {
        let (id, name) = self.mapper.leader()?;
        let rumbles = self.motors.iter().any(|(motor, _)| *motor == id);
        let rumble_on = self.settings.rumble;
        Some(PadStatus { name, mode: self.mapper.mode(), rumbles, rumble_on })
    }

    /// Handles an event of a pad at `now_s` seconds. With `catching`, newly pressed buttons are also returned
    /// as triggers, for a key table that waits for one.
    pub fn handle(
        &mut self,
        news: PadNews,
        now_s: f64,
        bindings: Option<&Bindings>,
        catching: bool,
    ) -> PadReport {
        let mut report = PadReport::default();
        match news.change {
            PadChange::Came { name, motor } => {
                report.notice = Some(Notice::note(format!("Gamepad connected: {name}")));
                self.mapper.came(news.pad, name);
                self.motors.retain(|(id, _)| *id != news.pad);
                self.motors.extend(motor.map(|motor| (news.pad, motor)));
            }
            PadChange::Went => {
                self.motors.retain(|(id, _)| *id != news.pad);
                if let Some(name) = self.mapper.went(news.pad) {
                    tracing::info!("gamepad disconnected: {name}");
                    report.notice = Some(Notice::note(format!("Gamepad disconnected: {name}")));
                }
            }
            PadChange::State(state) => {
                if catching {
                    let pressed = self.mapper.newly_down(news.pad, &state).next();
                    report.caught = pressed.map(|button| Trigger::Pad { button });
                }
                if let Some(bindings) = bindings {
                    self.mapper.update(news.pad, state, now_s, bindings);
                }
            }
        }
        report
    }

    /// Sets whether pads act on this program: not while another one has the keyboard focus.
    pub fn set_listening(&mut self, listening: bool) {
        self.mapper.set_listening(listening);
    }

    /// Returns whether the pad needs frames even if nothing else happens.
    pub fn is_active(&self) -> bool {
        self.mapper.is_active() || self.rumble.is_shaking()
    }

    /// Switches to the next mode of the pad, if there is a pad.
    pub fn next_mode(&mut self) {
        if self.mapper.leader().is_some() {
            self.mapper.next_mode();
        }
    }

    /// Toggles rumble. Returns whether it is now on.
    pub fn toggle_rumble(&mut self) -> bool {
        self.settings.rumble ^= true;
        self.settings.rumble
    }

    /// Returns the pads' events up to `now_s`, in order.
    pub fn take(&mut self, now_s: f64, bindings: &Bindings) -> Vec<PadEvent> {
        self.mapper.take(now_s, bindings)
    }

    /// Returns the response curve and speeds of the sticks.
    pub fn settings(&self) -> &GamepadOptions {
        &self.settings
    }

    /// Updates the rumble by the voxels changed by tools since the last call. `voxels_changed`: in total since the
    /// program's start; `felt`: a tool that causes rumble is in use.
    pub fn shake(&mut self, now_s: f64, voxels_changed: u64, felt: bool) {
        let dt_s = (now_s - self.shaken_s).clamp(0.0, 1.0) as f32;
        self.shaken_s = now_s;
        let before = std::mem::replace(&mut self.felt_voxels, voxels_changed);
        let changed = voxels_changed.saturating_sub(before);
        let felt = (felt && self.settings.rumble && self.mapper.is_holding()).then_some(changed);
        let was_shaking = self.rumble.is_shaking();
        let strength = self.rumble.step(felt, dt_s, &self.settings.rumble_curve());
        if was_shaking || strength > 0.0 {
            let leader = self.mapper.leader().map(|(id, _)| id);
            for (id, motor) in &mut self.motors {
                motor.shake(if leader == Some(*id) { strength } else { 0.0 });
            }
        }
    }

    /// Draws a pointer if the system's cannot be moved.
    pub fn draw_pointer(&self, ctx: &Context) {
        if let (true, Some(at)) = (self.draws_pointer, self.pointer) {
            let painter = ctx.layer_painter(LayerId::new(Order::Debug, Id::new("pad pointer")));
            painter.circle_stroke(at, 6.0, Stroke::new(3.0, Color32::BLACK));
            painter.circle_stroke(at, 6.0, Stroke::new(1.5, Color32::WHITE));
            painter.circle_filled(at, 1.5, Color32::WHITE);
        }
    }

    /// Notes whether the system's pointer could be moved to the pad's position.
    pub fn pointer_follows(&mut self, follows: bool) {
        self.draws_pointer = !follows;
    }

    /// Returns the position of the pad's pointer, in points; `start` if there was no pointer yet. If the mouse has
    /// moved since, its position counts.
    fn pointer_at(&mut self, ctx: &Context, start: Pos2) -> Pos2 {
        let latest = ctx.input(|input| input.pointer.latest_pos());
        let at = match (self.pointer, latest) {
            (Some(ours), Some(latest)) if ours.distance(latest) > POINTER_SLACK => latest,
            (Some(ours), _) => ours,
            (None, Some(latest)) => latest,
            (None, None) => start,
        };
        self.pointer = Some(at);
        at
    }

    /// Moves the pointer within the window. Returns its new position.
    pub fn move_pointer(&mut self, glide: &Glide, ctx: &Context, start: Pos2) -> Event {
        let by = glide.shift.truncate() * self.settings.pointer_speed;
        let at = self.pointer_at(ctx, start) + egui::vec2(by.x, -by.y);
        let window = ctx.content_rect().shrink(1.0);
        let at = at.clamp(window.min, window.max);
        self.pointer = Some(at);
        Event::PointerMoved(at)
    }

    /// Appends a press and a release of the primary button at the pointer's position to `events`.
    pub fn click(&mut self, presses: &[bool], ctx: &Context, start: Pos2, events: &mut Vec<Event>) {
        let modifiers = ctx.input(|input| input.modifiers);
        let pos = match events.last() {
            Some(Event::PointerMoved(at)) => *at,
            _ => self.pointer_at(ctx, start),
        };
        // Without a mouse position, egui first needs one.
        events.push(Event::PointerMoved(pos));
        let button = PointerButton::Primary;
        events.extend(presses.iter().map(|&pressed| Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers,
        }));
    }
}

/// The effects of an event of a pad.
#[derive(Default)]
pub struct PadReport {
    pub notice: Option<Notice>,
    /// While a key table waits for a trigger: the newly pressed one, if any.
    pub caught: Option<Trigger>,
}
