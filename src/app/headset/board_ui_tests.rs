//! Tests the board's interface with a ray as its mouse: clicks, drags, and text typed on its keyboard.

use egui::{Align, Button, DragValue, Layout, Response, Slider, TextEdit, vec2};
use glam::{Quat, Vec3};

use super::*;
use crate::app::Workspace;
use crate::config::Config;
use crate::input::Bindings;
use crate::input::hands::{Board, HandMapper, HandSettings, HandSide, HandsState};
use crate::input::pad::stick::Response as StickResponse;
use crate::session::Session;
use crate::ui::dialogs::FileTask;
use crate::ui::widgets::keyboard::{Cap, keys};
use crate::view::RoomPose;

const SIZE_PX: UVec2 = UVec2::new(1250, 800);

/// A board with widgets, and a hand that points at it.
struct Hand<S> {
    ui: BoardUi,
    state: S,
    show: fn(&mut Ui, &mut S),
    now_s: f64,
}

impl<S> Hand<S> {
    fn new(state: S, show: fn(&mut Ui, &mut S)) -> Hand<S> {
        let ui = BoardUi::new(SIZE_PX, 1.25, 4096);
        let mut hand = Hand { ui, state, show, now_s: 0.0 };
        hand.run_passes();
        hand
    }

    /// Runs passes until none is due at once.
    fn run_passes(&mut self) {
        for _ in 0..3 {
            self.now_s += 0.05;
            let (state, show) = (&mut self.state, self.show);
            let mut output = self.ui.pass(self.now_s, |root| show(root, state));
            // Nothing is drawn.
            output.textures_delta.clear();
        }
    }

    fn point(&mut self, at: Pos2) {
        let size = self.ui.size_points();
        self.ui.handle(&HandEvent::Point(Vec2::new(at.x / size.x, at.y / size.y)));
        self.run_passes();
    }

    fn press(&mut self, down: bool) {
        self.ui.handle(&HandEvent::Click(down));
        self.run_passes();
    }

    fn click(&mut self, at: Pos2) {
        self.point(at);
        self.press(true);
        self.press(false);
    }

    fn key(&mut self, cap: Cap) {
        let rect = self.ui.keyboard.key(cap).unwrap_or_else(|| panic!("no key {cap:?}"));
        self.click(rect.center());
    }

    fn write(&mut self, text: &str) {
        for char in text.chars() {
            let has = |cap: &Cap| matches!(cap, Cap::Char(a, b) if *a == char || *b == char);
            let (cap, _) = keys(Rect::ZERO).find(|(cap, _)| has(cap)).unwrap();
            if matches!(cap, Cap::Char(plain, _) if plain != char) {
                self.key(Cap::Shift);
            }
            self.key(cap);
        }
    }

    fn has_keyboard(&self) -> bool {
        self.ui.keyboard.key(Cap::Space).is_some()
    }
}

/// A form at an edge of the board.
struct Form {
    layout: Layout,
    text: String,
    number: f64,
    entered: usize,
    fields: Vec<Response>,
    /// Fills the rest of the board.
    button: Option<Response>,
    clicks: usize,
}

fn form(layout: Layout) -> Hand<Form> {
    let form = Form {
        layout,
        text: String::new(),
        number: 7.0,
        entered: 0,
        fields: Vec::new(),
        button: None,
        clicks: 0,
    };
    Hand::new(form, |root, form| {
        root.with_layout(form.layout, |ui| {
            let text = ui.add(TextEdit::singleline(&mut form.text));
            let enter = ui.input(|input| input.key_pressed(egui::Key::Enter));
            form.entered += usize::from(text.lost_focus() && enter);
            let number = ui.add(DragValue::new(&mut form.number));
            form.fields = vec![text, number];
            let button = ui.add_sized(ui.available_size(), Button::new("below"));
            form.clicks += usize::from(button.clicked());
            form.button = Some(button);
        });
    })
}

fn upper() -> Hand<Form> {
    form(Layout::top_down(Align::Min))
}

#[test]
fn keys_fill_a_field_that_keeps_its_focus() {
    for layout in [Layout::top_down(Align::Min), Layout::bottom_up(Align::Min)] {
        let mut hand = form(layout);
        assert!(!hand.has_keyboard(), "no text field has the focus");
        let field = hand.state.fields[0].rect;
        hand.click(field.center());
        assert!(hand.has_keyboard());
        assert!(
            !hand.ui.keyboard.covers(hand.state.fields[0].rect.center()),
            "the field stays visible"
        );
        hand.write("ab_1");
        assert_eq!(hand.state.text, "ab_1");
        assert!(hand.state.fields[0].has_focus());
        hand.write("aBc");
        hand.key(Cap::Backspace);
        hand.key(Cap::Space);
        hand.key(Cap::Left);
        hand.write("-/.");
        hand.key(Cap::Right);
        assert_eq!(hand.state.text, "ab_1aB-/. ");
        assert!(hand.state.fields[0].has_focus());
        // Two presses lock capitals.
        hand.key(Cap::Shift);
        hand.key(Cap::Shift);
        hand.key(Cap::Char('x', 'X'));
        hand.key(Cap::Char('y', 'Y'));
        hand.key(Cap::Shift);
        hand.key(Cap::Char('z', 'Z'));
        assert_eq!(hand.state.text, "ab_1aB-/. XYz");
        assert_eq!((hand.state.entered, hand.state.clicks), (0, 0));
        hand.key(Cap::Enter);
        assert_eq!(hand.state.entered, 1);
        assert!(!hand.has_keyboard() && !hand.state.fields[0].has_focus());
    }
}

#[test]
fn a_number_is_typed_over_the_former_one() {
    let mut hand = upper();
    let number = hand.state.fields[1].rect.center();
    hand.click(number);
    assert!(hand.has_keyboard());
    hand.write("-42.5");
    hand.key(Cap::Enter);
    assert_eq!(hand.state.number, -42.5);
    assert!(!hand.has_keyboard());
    // A drag changes it as usual, without a keyboard.
    hand.point(number);
    hand.press(true);
    hand.point(number + vec2(30.0, 0.0));
    assert!(!hand.has_keyboard());
    hand.press(false);
    assert!(hand.state.number > -42.5 && !hand.has_keyboard());
}

#[test]
fn widgets_under_the_keyboard_receive_no_events() {
    let mut hand = upper();
    hand.click(hand.state.fields[0].rect.center());
    let key = hand.ui.keyboard.key(Cap::Char('k', 'K')).unwrap();
    let button = hand.state.button.clone().unwrap().rect;
    assert!(button.contains_rect(key));
    hand.point(key.center());
    assert!(!hand.state.button.as_ref().unwrap().hovered());
    hand.press(true);
    hand.press(false);
    assert_eq!((hand.state.text.as_str(), hand.state.clicks), ("k", 0));
    // The same between two keys, and released beside the keyboard.
    hand.point(key.right_center() + vec2(1.0, 0.0));
    hand.press(true);
    hand.point(button.center_top() + vec2(0.0, 5.0));
    hand.press(false);
    assert_eq!((hand.state.text.as_str(), hand.state.clicks), ("k", 0));
    assert!(hand.state.fields[0].has_focus());
    // Once it is closed, the button can be clicked again.
    hand.key(Cap::Close);
    assert!(!hand.has_keyboard());
    assert_eq!(hand.state.text, "k");
    hand.click(key.center());
    assert_eq!(hand.state.clicks, 1);
}

#[test]
fn a_press_beside_field_and_keyboard_leaves_the_field() {
    let mut hand = upper();
    hand.click(hand.state.fields[0].rect.center());
    hand.click(hand.state.button.clone().unwrap().rect.center_top() + vec2(0.0, 5.0));
    assert!(!hand.has_keyboard());
    assert_eq!(hand.state.clicks, 1);
}

#[test]
fn a_drag_that_began_in_the_field_presses_no_key() {
    let mut hand = upper();
    let field = hand.state.fields[0].rect.center();
    hand.click(field);
    hand.write("ab");
    let key = hand.ui.keyboard.key(Cap::Char('q', 'Q')).unwrap().center();
    hand.point(field);
    hand.press(true);
    hand.point(key);
    hand.press(false);
    assert!(hand.has_keyboard());
    assert_eq!(hand.state.text, "ab");
    hand.press(true);
    hand.press(false);
    assert!(hand.state.text.contains('q'), "the next press does: {:?}", hand.state.text);
}

#[test]
fn a_key_stops_repeating_when_the_hand_is_gone() {
    let mut hand = upper();
    hand.click(hand.state.fields[0].rect.center());
    hand.write("abcdefghijkl");
    let key = hand.ui.keyboard.key(Cap::Backspace).unwrap().center();
    hand.point(key);
    hand.press(true);
    (0..8).for_each(|_| hand.run_passes());
    let left = hand.state.text.len();
    assert!(left < 10, "a held key repeats: {:?}", hand.state.text);
    hand.ui.handle(&HandEvent::Click(false));
    hand.ui.handle(&HandEvent::PointAway);
    (0..8).for_each(|_| hand.run_passes());
    assert_eq!(hand.state.text.len(), left);
}

#[test]
fn the_interface_fills_the_board_at_every_text_size() {
    let mut hand = upper();
    for zoom in [1.0, 1.5, 0.5] {
        hand.ui.context.set_zoom_factor(zoom);
        hand.run_passes();
        let points = hand.ui.context.pixels_per_point();
        let filled = hand.ui.context.content_rect().size() * points;
        assert!((filled - vec2(1250.0, 800.0)).length() < 1.0, "{zoom}: {filled:?}");
        let clicks = hand.state.clicks;
        hand.click(hand.state.button.clone().unwrap().rect.right_bottom() - vec2(9.0, 9.0));
        assert_eq!(hand.state.clicks, clicks + 1, "{zoom}");
    }
}

/// Small widgets to click and to drag.
#[derive(Default)]
struct Things {
    clicks: [usize; 2],
    value: f64,
    number: f64,
    places: Vec<Rect>,
}

fn things() -> Hand<Things> {
    Hand::new(Things::default(), |root, things| {
        root.with_layout(Layout::top_down(Align::Min), |ui| {
            ui.add_space(300.0);
            let names = ["one", "two"];
            let mut places = Vec::new();
            ui.horizontal(|ui| {
                for (clicks, name) in things.clicks.iter_mut().zip(names) {
                    let button = ui.add_sized(vec2(40.0, 24.0), Button::new(name));
                    *clicks += usize::from(button.clicked());
                    places.push(button.rect);
                }
            });
            let slider = ui.add(Slider::new(&mut things.value, 0.0..=1.0).show_value(false));
            let number = ui.add(DragValue::new(&mut things.number));
            places.extend([slider.rect, number.rect]);
            things.places = places;
        });
    })
}

/// A hand half a metre before the board that points at it with a ray.
struct Ray {
    mapper: HandMapper,
    board: Board,
    state: HandsState,
}

impl Ray {
    fn new() -> Ray {
        let response = StickResponse { dead_zone: 0.2, curve: 1.0 };
        let settings = HandSettings { main: HandSide::Right, response, reach_m: 0.08 };
        let pose = RoomPose { position: Vec3::new(0.0, 0.0, -0.5), rotation: Quat::IDENTITY };
        Ray {
            mapper: HandMapper::new(settings),
            board: Board { pose, size_m: Vec2::new(0.5, 0.32) },
            state: HandsState::default(),
        }
    }

    /// Runs a frame in which the hand points at a place on the board, off by `off_deg`, with this trigger.
    fn frame(&mut self, hand: &mut Hand<Things>, at: Pos2, off_deg: f32, trigger: f32) {
        let size = hand.ui.size_points();
        let share = Vec2::new(at.x / size.x - 0.5, 0.5 - at.y / size.y);
        let to = (share * self.board.size_m).extend(-0.5);
        let rotation = Quat::from_rotation_arc(Vec3::NEG_Z, to.normalize());
        let rotation = Quat::from_rotation_y(off_deg.to_radians()) * rotation;
        let aim = Some(RoomPose { position: Vec3::ZERO, rotation });
        let main = &mut self.state.hands[HandSide::Right.index()];
        (main.aim, main.trigger) = (aim, trigger);
        self.state.time_s += 1.0 / 20.0;
        for event in self.mapper.update(&self.state, Some(&self.board)) {
            hand.ui.handle(&event);
        }
        hand.now_s = self.state.time_s;
        let (state, show) = (&mut hand.state, hand.show);
        hand.ui.pass(hand.now_s, |root| show(root, state)).textures_delta.clear();
    }

    /// Pulls and releases the trigger in `length_s`, while the hand turns by `drift_deg`.
    fn pull(&mut self, hand: &mut Hand<Things>, at: Pos2, drift_deg: f32, length_s: f32) {
        (0..4).for_each(|_| self.frame(hand, at, 0.0, 0.0));
        let frames = (length_s * 20.0) as u32;
        for i in 0..=frames {
            let share = i as f32 / frames as f32;
            let trigger = (4.0 * share).min(4.0 - 4.0 * share).min(1.0);
            self.frame(hand, at, drift_deg * share, trigger);
        }
        (0..4).for_each(|_| self.frame(hand, at, drift_deg, 0.0));
    }
}

#[test]
fn slow_pulls_that_turn_the_hand_are_clicks() {
    let (mut hand, mut ray) = (things(), Ray::new());
    let button = hand.state.places[0].center();
    let mut clicks = 0;
    for length_s in [0.3, 1.0, 2.8] {
        for drift_deg in [0.0, 0.5, -0.5, 1.2] {
            ray.pull(&mut hand, button, drift_deg, length_s);
            clicks += 1;
            assert_eq!(hand.state.clicks, [clicks, 0], "{length_s} s, {drift_deg} degrees");
        }
    }
    // Not if it is held much longer, or ends on another widget or beside all widgets.
    ray.pull(&mut hand, button, 0.0, 6.0);
    ray.pull(&mut hand, button, -5.0, 0.5);
    ray.pull(&mut hand, button, 8.0, 0.5);
    assert_eq!(hand.state.clicks, [clicks, 0]);
    // A pull across the whole button is a click as well: it ends in the same widget.
    let edge = hand.state.places[1].left_center() + vec2(2.0, 0.0);
    ray.pull(&mut hand, edge, -1.9, 1.0);
    assert_eq!(hand.state.clicks, [clicks, 1]);
}

#[test]
fn draggable_widgets_are_dragged_beyond_a_small_distance() {
    let (mut hand, mut ray) = (things(), Ray::new());
    let slider = hand.state.places[2];
    ray.pull(&mut hand, slider.left_center() + vec2(6.0, 0.0), -1.0, 1.0);
    assert!(hand.state.value < 0.05, "{}", hand.state.value);
    ray.pull(&mut hand, slider.left_center() + vec2(6.0, 0.0), -4.0, 1.0);
    assert!((0.4..0.95).contains(&hand.state.value), "{}", hand.state.value);
    // A number is typed after a click, and changed by a longer drag.
    let number = hand.state.places[3].center();
    ray.pull(&mut hand, number, -4.0, 1.0);
    assert!(hand.state.number > 10.0 && !hand.has_keyboard(), "{}", hand.state.number);
    ray.pull(&mut hand, number, -0.5, 1.0);
    assert!(hand.has_keyboard());
}

/// Returns the whole board with a sculpture in a folder of its own.
fn desk(folder: &std::path::Path) -> Hand<Workspace> {
    let mut config = Config::default();
    config.new.dims = [16; 3];
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let save = format!("save {}", folder.join("first.vsc").display());
    session.execute(&save.parse().unwrap(), &()).unwrap();
    let workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
    Hand::new(workspace, |root, workspace| workspace.show_on_board(root))
}

#[test]
fn a_file_is_saved_under_a_name_typed_on_the_board() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = desk(folder.path());
    let first = folder.path().join("first.vsc");
    hand.state.ui.dialogs.files.open(FileTask::SaveAs(None), Some(&first));
    hand.run_passes();
    assert!(hand.has_keyboard(), "the field of the name has the focus");
    // The proposed name is selected without its extension, and typed over.
    hand.write("ab_1");
    assert!(hand.state.ui.dialogs.files.is_open());
    hand.key(Cap::Enter);
    assert!(!hand.state.ui.dialogs.files.is_open() && !hand.has_keyboard());
    hand.state.finish_job();
    assert!(folder.path().join("ab_1.vsc").exists());
}

#[test]
fn closing_the_keyboard_leaves_the_dialog_open() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = desk(folder.path());
    let first = folder.path().join("first.vsc");
    hand.state.ui.dialogs.files.open(FileTask::SaveAs(None), Some(&first));
    hand.run_passes();
    hand.write("x");
    hand.key(Cap::Close);
    assert!(hand.state.ui.dialogs.files.is_open() && !hand.has_keyboard());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn the_palette_on_the_board_takes_text_from_its_keyboard() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = desk(folder.path());
    hand.state.ui.dialogs.palette.open();
    hand.run_passes();
    hand.write("clear");
    assert_ne!(hand.state.session().document().grid().opaque_count(), 0);
    hand.key(Cap::Enter);
    assert!(!hand.state.ui.dialogs.palette.open);
    assert_eq!(hand.state.session().document().grid().opaque_count(), 0);
}
