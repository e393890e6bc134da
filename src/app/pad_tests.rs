//! Tests the gamepad on the workspace, with a device that records rumble.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use egui::{Context, Event, Key, Pos2, RawInput, Rect};
use glam::{Vec2, Vec3};

use super::Workspace;
use crate::config::Config;
use crate::editor::questions::Next;
use crate::input::Action;
use crate::input::Trigger;
use crate::input::pad::device::{Motor, PadChange, PadNews};
use crate::input::pad::{PadButton, PadButtons, PadId, PadMode, PadState};
use crate::sculpture::Placement;
use crate::session::Session;

const PAD: PadId = PadId(0);

/// Rumble strengths in the order in which they were set.
#[derive(Clone, Debug, Default)]
struct Felt(Arc<Mutex<Vec<f32>>>);

impl Motor for Felt {
    fn shake(&mut self, strength: f32) {
        self.0.lock().unwrap().push(strength);
    }
}

/// A workspace with a pad, drawn at a rate, without a screen.
struct Desk {
    workspace: Workspace,
    ctx: Context,
    felt: Felt,
    now_s: f64,
    picture_s: f64,
}

impl Desk {
    fn new(settings: &str, pictures_per_s: f64) -> Desk {
        let toml = format!("[new]\ndims = [32, 32, 32]\n{settings}");
        let config = Config::parse(&toml, std::path::Path::new("test.toml")).unwrap();
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        let workspace =
            Workspace::new(session, &config, crate::input::Bindings::presets().unwrap());
        let (ctx, felt) = (Context::default(), Felt::default());
        let picture_s = 1.0 / pictures_per_s;
        let mut desk = Desk { workspace, ctx, felt, now_s: 1.0, picture_s };
        let motor: Box<dyn Motor> = Box::new(desk.felt.clone());
        desk.news(PadChange::Came { name: "test pad".to_string(), motor: Some(motor) });
        desk.picture(Vec::new());
        desk.picture(Vec::new());
        desk
    }

    fn news(&mut self, change: PadChange) {
        self.workspace.handle_pad(PadNews { pad: PAD, at: Instant::now(), change }, self.now_s);
    }

    fn picture(&mut self, mut events: Vec<Event>) {
        events.extend(self.workspace.play_pad(self.now_s, &self.ctx));
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(1000.0, 700.0)));
        let input = RawInput { screen_rect, time: Some(self.now_s), events, ..Default::default() };
        self.ctx.run_ui(input, |root| self.workspace.show(root)).textures_delta.clear();
        self.workspace.shake_pad(self.now_s);
    }

    /// Holds sticks and buttons for some time.
    fn keep(&mut self, state: PadState, seconds: f64) {
        self.news(PadChange::State(state));
        let until = self.now_s + seconds;
        while self.now_s + self.picture_s < until {
            self.now_s += self.picture_s;
            self.picture(Vec::new());
        }
        self.now_s = until;
    }

    fn press(&mut self, button: PadButton) {
        self.keep(holding(button), 0.1);
        self.keep(PadState::default(), 0.2);
    }

    fn voxels(&self) -> u64 {
        self.workspace.session().document().grid().opaque_count()
    }

    fn felt(&self) -> Vec<f32> {
        std::mem::take(&mut *self.felt.0.lock().unwrap())
    }
}

fn holding(button: PadButton) -> PadState {
    PadState { held: PadButtons::NONE.with(button), ..PadState::default() }
}

fn left(x: f32, y: f32) -> PadState {
    PadState { left: Vec2::new(x, y), ..PadState::default() }
}

#[test]
fn the_tool_cuts_as_it_moves_and_is_felt() {
    let mut desk = Desk::new("[gamepad]\nrumble_limit = 0.5\nrumble_voxels = 40", 60.0);
    let (full, start) = (desk.voxels(), desk.workspace.editor.tool.centre_vx);
    let history = desk.workspace.session().document().history().undo_count();
    desk.keep(PadState { held: holding(PadButton::South).held, ..left(1.0, 0.0) }, 0.4);
    assert!(desk.workspace.controls.pads.is_active());
    desk.keep(PadState::default(), 0.1);
    let ball = 4.0 / 3.0 * std::f32::consts::PI * desk.workspace.editor.tool.half().x.powi(3);
    assert!(full - desk.voxels() > 2 * ball as u64, "a groove, not a hole");
    let moved = desk.workspace.editor.tool.centre_vx - start;
    let right = desk.workspace.picker().sight().screen_axes().right;
    assert!(moved.dot(right) > 2.0 && moved.reject_from(right).length() < 1e-3, "{moved} {right}");
    assert_eq!(desk.workspace.session().document().history().undo_count(), history + 1, "one step");
    let felt = desk.felt();
    assert!(felt.iter().any(|strength| *strength > 0.2), "{felt:?}");
    assert!(felt.iter().all(|strength| *strength <= 0.5));
    assert_eq!(felt.last(), Some(&0.0), "it stops with the stroke");
    assert!(!desk.workspace.controls.pads.is_active());

    desk.press(PadButton::DpadLeft);
    assert_eq!(desk.voxels(), full, "undone");
    assert_eq!(desk.felt(), [0.0; 0], "undo is not felt");
    desk.workspace.act(Action::ToggleRumble);
    desk.press(PadButton::South);
    assert!(desk.voxels() < full);
    assert_eq!(desk.felt(), [0.0; 0], "rumble is off");
}

#[test]
fn the_movement_is_the_same_at_every_rate_of_pictures() {
    let end = |rate: f64| {
        let mut desk = Desk::new("", rate);
        let mut pull = left(0.7, -0.5);
        pull.triggers = Vec2::new(0.6, 0.0);
        pull.right = Vec2::new(0.5, 0.2);
        desk.keep(pull, 0.8);
        desk.keep(PadState::default(), 0.3);
        (desk.workspace.editor.tool.centre_vx, desk.workspace.editor.tool.rotation())
    };
    let (at, turned) = end(120.0);
    for rate in [7.0, 30.0, 61.0] {
        let (other_at, other_turned) = end(rate);
        assert!(at.abs_diff_eq(other_at, 0.05), "{at} {other_at}");
        assert!(turned.angle_between(other_turned) < 1e-3);
    }
}

#[test]
fn in_grid_mode_the_sculpture_moves_and_turns_before_the_viewer() {
    let mut desk = Desk::new("[gamepad]\nmode = \"grid\"", 60.0);
    let placement = |desk: &Desk| *desk.workspace.session().document().placement();
    let (before, tool) = (placement(&desk), desk.workspace.editor.tool.clone());
    desk.keep(left(1.0, 1.0), 0.3);
    let moved = placement(&desk).translation - before.translation;
    assert!(moved.x > 0.0 && (moved.x - moved.y).abs() < 1e-3 && moved.z == 0.0, "{moved}");
    desk.keep(PadState { triggers: Vec2::X, ..PadState::default() }, 0.3);
    assert!(placement(&desk).translation.z > 0.0, "nearer");
    desk.keep(PadState { triggers: Vec2::X, ..PadState::default() }, 30.0);
    let depth = desk.workspace.viewpoint.turntable.camera().eye.z - placement(&desk).translation.z;
    assert!(depth > 0.0, "never behind the viewer");
    desk.keep(PadState { right: Vec2::X, ..PadState::default() }, 0.5);
    desk.keep(PadState::default(), 0.1);
    let front = |placement: Placement| placement.rotation * Vec3::new(0.8, 0.6, 1.0);
    assert!(front(placement(&desk)).x > front(before).x + 0.1, "the front goes right");
    assert_eq!(
        (desk.workspace.editor.tool.centre_vx, desk.workspace.editor.tool.rotation()),
        (tool.centre_vx, tool.rotation())
    );
}

#[test]
fn in_mouse_mode_the_stick_leads_the_pointer_and_clicks() {
    let mut desk = Desk::new("[gamepad]\nmode = \"mouse\"", 60.0);
    desk.workspace.act(Action::Clear);
    desk.workspace.act(Action::Mode(crate::input::ToolMode::Add));
    let middle = desk.workspace.picture().center();
    desk.keep(left(1.0, 0.0), 0.05);
    desk.keep(left(-1.0, 0.0), 0.05);
    desk.keep(PadState::default(), 0.1);
    let at = desk.ctx.input(|input| input.pointer.latest_pos()).unwrap();
    assert!(at.distance(middle) < 3.0, "{at} {middle}");
    desk.press(PadButton::North);
    assert!(desk.voxels() > 0, "a click on the picture is a stroke");
    let steps = desk.workspace.session().document().history().undo_count();
    desk.press(PadButton::South);
    let now = desk.workspace.session().document().history().undo_count();
    assert!(now >= steps, "a double click is two");
    desk.keep(left(0.0, 1.0), 3.0);
    let at = desk.ctx.input(|input| input.pointer.latest_pos()).unwrap();
    assert!(at.y >= 0.0 && at.y < 3.0, "the pointer stays in the window: {at}");
}

#[test]
fn shift_alone_switches_the_mode_while_a_pad_is_there() {
    let shift = |pressed| Event::Key {
        key: Key::ShiftLeft,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: egui::Modifiers::SHIFT,
    };
    let mut desk = Desk::new("", 60.0);
    let mode = |desk: &Desk| desk.workspace.controls.pads.status().map(|context| context.mode);
    assert_eq!(mode(&desk), Some(PadMode::UseTool));
    desk.picture(vec![shift(true), shift(false)]);
    assert_eq!(mode(&desk), Some(PadMode::MoveGrid));
    desk.news(PadChange::Went);
    assert_eq!(mode(&desk), None);
    desk.picture(vec![shift(true), shift(false)]);
    desk.news(PadChange::Came { name: "again".to_string(), motor: None });
    assert_eq!(mode(&desk), Some(PadMode::MoveGrid), "without a pad nothing was switched");
    let texts: Vec<&str> = desk.workspace.ui.toasts.texts().map(|(_, text)| text).collect();
    assert!(texts.contains(&"Gamepad connected: again"), "{texts:?}");
    assert!(texts.contains(&"Gamepad disconnected: test pad"), "{texts:?}");
}

#[test]
fn a_stroke_ends_when_its_pad_is_pulled_out_or_a_question_is_open() {
    let mut desk = Desk::new("", 60.0);
    desk.keep(holding(PadButton::South), 0.1);
    assert!(desk.workspace.editor.is_stroking());
    desk.news(PadChange::Went);
    desk.picture(Vec::new());
    assert!(!desk.workspace.editor.is_stroking());

    let mut asked = Desk::new("", 60.0);
    let (full, at) = (asked.voxels(), asked.workspace.editor.tool.centre_vx);
    asked.workspace.ui.dialogs.unsaved = Some(Next::Leave);
    asked.keep(PadState { held: holding(PadButton::South).held, ..left(1.0, 0.0) }, 0.3);
    assert_eq!((asked.voxels(), asked.workspace.editor.tool.centre_vx), (full, at));
    asked.press(PadButton::Select);
    assert!(asked.workspace.ui.dialogs.unsaved.is_none(), "the question can be put aside");
}

#[test]
fn a_button_is_caught_in_the_table_of_keys() {
    let mut desk = Desk::new("", 60.0);
    let full = desk.voxels();
    let stick = Trigger::Pad { button: PadButton::LeftStick };
    let has = |desk: &Desk, action, trigger| {
        desk.workspace.controls.bindings().unwrap().triggers(action).any(|t| t == trigger)
    };
    desk.press(PadButton::South);
    let cut = desk.voxels();
    assert!(cut < full);
    assert!(!has(&desk, Action::Undo, stick));
    desk.workspace.ui.dialogs.keys.listen_for(Action::Undo);
    desk.press(PadButton::LeftStick);
    assert!(!desk.workspace.ui.dialogs.keys.is_catching() && has(&desk, Action::Undo, stick));
    assert_eq!(desk.voxels(), cut, "what is caught does nothing else");
    desk.press(PadButton::LeftStick);
    assert_eq!(desk.voxels(), full, "from then on it is a key as any other");

    // A button that is bound to another action stays with it until the conflict is resolved.
    let right = Trigger::Pad { button: PadButton::DpadRight };
    desk.workspace.ui.dialogs.keys.listen_for(Action::Fill);
    desk.press(PadButton::DpadRight);
    assert!(desk.workspace.ui.dialogs.keys.is_catching());
    assert!(has(&desk, Action::Redo, right) && !has(&desk, Action::Fill, right));
    assert_eq!(desk.voxels(), full, "nothing was redone");
}
