//! Boxes and curves that take several presses, without a window: heights and points that the pointer leads between them.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use glam::Vec3;
use tempfile::TempDir;
use virtual_sculpture::editor::draw::{Progress, Sketch};
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::input::{Action, DrawKind, Side, ToolMode};
use virtual_sculpture::picking::{Picker, Sight};

use super::bench::{self, Bench, key, look, middle, rest, run, screen, send, voxels};
use super::draw::{
    FULL, draw, draw_half, draw_with, front, has, is_one_step, press, steps, through,
};

/// The same, seen from the corner above.
fn corner(kind: DrawKind, mode: ToolMode) -> Bench {
    let mut harness = front(kind, mode);
    harness.state_mut().act(Action::LookFrom(Side::Corner));
    look(&mut harness);
    harness
}

fn at(harness: &Bench, place: [f32; 3]) -> Pos2 {
    screen(harness, Vec3::from(place))
}

fn hover(harness: &mut Bench, pos: Pos2) {
    send(harness, Event::PointerMoved(pos));
}

/// Presses and releases where the pointer goes.
fn click(harness: &mut Bench, pos: Pos2) {
    draw(harness, &[pos]);
}

fn progress(harness: &Bench) -> Option<Progress> {
    harness.state().editor.progress()
}

/// Returns the lines that show an unfinished drawing.
fn sketch(harness: &Bench) -> Option<Sketch> {
    let bench = harness.state();
    let sight = Sight::new(&bench.eye(), &bench.world_from_grid());
    bench.editor.sketch(&Picker::new(sight, None, bench.session().document().origin()))
}

/// The lowest and the highest corner of what is shown.
fn shown(harness: &Bench) -> [Vec3; 2] {
    let ends: Vec<Vec3> = sketch(harness).unwrap().lines.into_flattened();
    [Vec3::min, Vec3::max].map(|f| ends.iter().copied().reduce(f).unwrap())
}

/// Drags the base of a box over the top face at this height, of 10 by 5 voxels.
fn drag_base(harness: &mut Bench, modifiers: Modifiers, y: f32) {
    let path = through(harness, &[[20.5, y, 20.5], [29.5, y, 24.5]]);
    draw_with(harness, modifiers, &path);
}

/// Records from the beginning; gives the folder with the script.
fn record(harness: &mut Bench) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    harness.state_mut().session_mut().record_to(&folder.path().join("a.sculpt")).unwrap();
    folder
}

fn recorded(folder: &TempDir) -> Vec<String> {
    let text = std::fs::read_to_string(folder.path().join("a.sculpt")).unwrap();
    text.lines().map(String::from).collect()
}

#[test]
fn a_box_is_as_high_as_the_pointer_goes_after_its_base() {
    let mut harness = corner(DrawKind::Box, ToolMode::Add);
    let script = record(&mut harness);
    run(&mut harness, "subtract cuboid at=32,48,32 half=32,16,32");
    run(&mut harness, "symmetry z=even");
    let (before, lines) = (voxels(&harness), recorded(&script).len());
    drag_base(&mut harness, Modifiers::NONE, 32.0);
    assert_eq!((progress(&harness), voxels(&harness)), (Some(Progress::Raised(1)), before));
    for layers in [3, 12, 7] {
        let top = at(&harness, [29.5, 32.0 + layers as f32, 24.5]);
        hover(&mut harness, top);
        assert_eq!(progress(&harness), Some(Progress::Raised(layers)));
        let corners = [[20.0, 32.0, 20.0], [30.0, 32.0 + layers as f32, 25.0]];
        assert_eq!(shown(&harness), corners.map(Vec3::from));
    }
    rest(&mut harness);
    assert!(bench::has(&harness, "Height 7 vx · Click, Space or Enter: done · Escape: cancel"));
    let top = at(&harness, [29.5, 39.0, 24.5]);
    click(&mut harness, top);
    let made = &recorded(&script)[lines..];
    assert!(made.len() == 1 && made[0].starts_with("add cuboid "), "{made:?}");
    assert_eq!(progress(&harness), None);
    assert_eq!(voxels(&harness) - before, 2 * 10 * 5 * 7, "and mirrored");
    assert!(has(&harness, [20, 38, 20]) && has(&harness, [29, 38, 43]));
    assert!(!has(&harness, [29, 39, 24]));
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(voxels(&harness), before);
    // The press that ended it draws nothing more, and the next one begins a base.
    drag_base(&mut harness, Modifiers::NONE, 32.0);
    assert_eq!(progress(&harness), Some(Progress::Raised(1)));
}

#[test]
fn a_box_that_cuts_or_paints_goes_into_the_face() {
    for mode in [ToolMode::Subtract, ToolMode::Recolour] {
        let mut harness = corner(DrawKind::Box, mode);
        drag_base(&mut harness, Modifiers::NONE, 64.0);
        assert_eq!(progress(&harness), Some(Progress::Raised(-1)));
        let deep = at(&harness, [29.5, 58.0, 24.5]);
        hover(&mut harness, deep);
        assert_eq!(progress(&harness), Some(Progress::Raised(-6)));
        // Enter ends it as a click does.
        key(&mut harness, Modifiers::NONE, Key::Enter);
        match mode {
            ToolMode::Subtract => assert_eq!(FULL - voxels(&harness), 10 * 5 * 6),
            _ => {
                let colour = harness.state().editor.tool.colour;
                let contents = harness.state().session().document().contents();
                assert_eq!(contents.rgb([29, 58, 24].into()), colour);
                assert_ne!(contents.rgb([29, 57, 24].into()), colour);
            }
        }
        is_one_step(&mut harness, FULL);
    }
    // With Ctrl at the press of the base, the inverse, to the end.
    let mut harness = corner(DrawKind::Box, ToolMode::Subtract);
    run(&mut harness, "subtract cuboid at=32,48,32 half=32,16,32");
    let before = voxels(&harness);
    drag_base(&mut harness, Modifiers::COMMAND, 32.0);
    let top = at(&harness, [29.5, 36.0, 24.5]);
    click(&mut harness, top);
    assert_eq!(voxels(&harness) - before, 10 * 5 * 4);
}

#[test]
fn a_box_on_a_face_that_looks_at_the_eye_is_raised_by_going_up() {
    let mut harness = front(DrawKind::Box, ToolMode::Subtract);
    let path = through(&harness, &[[20.5, 20.5, 64.0], [29.5, 24.5, 64.0]]);
    draw(&mut harness, &path);
    let end = path[path.len() - 1];
    let voxel_px = at(&harness, [30.5, 24.5, 64.0]).x - at(&harness, [29.5, 24.5, 64.0]).x;
    let deep = end + vec2(0.0, 5.0 * voxel_px);
    hover(&mut harness, deep);
    assert_eq!(progress(&harness), Some(Progress::Raised(-5)));
    click(&mut harness, deep);
    assert_eq!(FULL - voxels(&harness), 10 * 5 * 5);
    is_one_step(&mut harness, FULL);
}

#[test]
fn the_view_may_be_turned_before_a_box_is_ended() {
    let mut harness = front(DrawKind::Box, ToolMode::Subtract);
    let path = through(&harness, &[[20.5, 20.5, 64.0], [29.5, 24.5, 64.0]]);
    draw(&mut harness, &path);
    harness.state_mut().act(Action::LookFrom(Side::Corner));
    look(&mut harness);
    let button = PointerButton::Secondary;
    let from = middle(&harness);
    hover(&mut harness, from);
    let before = (progress(&harness), shown(&harness));
    let placed = *harness.state().session().document().placement();
    bench::drag(&mut harness, button, Modifiers::NONE, &[from, from + vec2(9.0, 4.0)]);
    assert_ne!(*harness.state().session().document().placement(), placed);
    assert_eq!((progress(&harness), shown(&harness)), before, "turning leads nothing");
    let deep = at(&harness, [29.5, 24.5, 55.0]);
    click(&mut harness, deep);
    assert_eq!(FULL - voxels(&harness), 10 * 5 * 9);
}

#[test]
fn escape_backspace_undo_and_another_tool_give_a_box_up() {
    for (modifiers, letter) in [
        (Modifiers::NONE, Key::Escape),
        (Modifiers::NONE, Key::Backspace),
        (Modifiers::COMMAND, Key::Z),
        (Modifiers::NONE, Key::E),
        (Modifiers::ALT, Key::B),
    ] {
        let mut harness = corner(DrawKind::Box, ToolMode::Subtract);
        run(&mut harness, "subtract ellipsoid at=32,32,0 half=6");
        let before = voxels(&harness);
        drag_base(&mut harness, Modifiers::NONE, 64.0);
        key(&mut harness, modifiers, letter);
        assert_eq!((progress(&harness), harness.state().editor.is_drawing()), (None, false));
        assert_eq!((voxels(&harness), steps(&harness).len()), (before, 1), "{letter:?}");
        // The next drag draws at once.
        harness.state_mut().act(Action::Draw(DrawKind::Box));
        drag_base(&mut harness, Modifiers::NONE, 64.0);
        let deep = at(&harness, [29.5, 62.0, 24.5]);
        hover(&mut harness, deep);
        assert_eq!(progress(&harness), Some(Progress::Raised(-2)), "{letter:?}");
    }
}

#[test]
fn a_box_of_a_fixed_height_is_one_drag() {
    let mut harness = corner(DrawKind::Box, ToolMode::Subtract);
    rest(&mut harness);
    bench::click(&mut harness, "Height by the pointer");
    harness.state_mut().editor.tool.draws.height = 3.0;
    drag_base(&mut harness, Modifiers::NONE, 64.0);
    assert_eq!((progress(&harness), FULL - voxels(&harness)), (None, 10 * 5 * 3));
    is_one_step(&mut harness, FULL);
}

/// Places on the front of the block.
const POINTS: [[f32; 3]; 3] = [[12.0, 40.0, 64.0], [30.0, 50.0, 64.0], [48.0, 36.0, 64.0]];

#[test]
fn clicks_and_enter_draw_a_curve_through_points() {
    let mut harness = front(DrawKind::Curve, ToolMode::Subtract);
    let script = record(&mut harness);
    run(&mut harness, "symmetry y=even");
    let lines = recorded(&script).len();
    harness.state_mut().editor.tool.draws.radii = [3.0, 3.0];
    for (i, place) in POINTS.into_iter().enumerate() {
        let pos = at(&harness, place);
        click(&mut harness, pos);
        assert_eq!(progress(&harness), Some(Progress::Points(i + 1)));
    }
    rest(&mut harness);
    let said =
        "3 points · Double-click, Space or Enter: done · Backspace: undo point · Escape: cancel";
    assert!(bench::has(&harness, said));
    // The preview goes on to the pointer, the curve does not.
    let before = shown(&harness)[1].x;
    let beyond = at(&harness, [60.0, 36.0, 64.0]);
    hover(&mut harness, beyond);
    assert!(shown(&harness)[1].x > before + 8.0);
    assert_eq!(voxels(&harness), FULL);
    key(&mut harness, Modifiers::NONE, Key::Enter);
    let made = &recorded(&script)[lines..];
    assert!(made.len() == 1 && made[0].starts_with("subtract tube points="), "{made:?}");
    for [x, y, _] in POINTS {
        let (x, y) = (x as i32, y as i32);
        assert!(!has(&harness, [x, y, 62]) && has(&harness, [x, y, 60]), "{x} {y}");
        assert!(!has(&harness, [x, 63 - y, 62]), "mirrored: {x} {y}");
    }
    assert!(has(&harness, [56, 36, 63]) && progress(&harness).is_none());
    is_one_step(&mut harness, FULL);
}

#[test]
fn a_double_click_ends_a_curve_where_it_is() {
    let mut harness = front(DrawKind::Curve, ToolMode::Subtract);
    let [first, last] = [POINTS[0], POINTS[2]].map(|place| at(&harness, place));
    for pos in [first, last, last + vec2(1.0, 1.0)] {
        click(&mut harness, pos);
    }
    assert!(progress(&harness).is_none() && !has(&harness, [30, 38, 63]));
    is_one_step(&mut harness, FULL);
    // The rest of the last press draws nothing and rotates nothing.
    let placed = *harness.state().session().document().placement();
    for pos in [first, last] {
        click(&mut harness, pos);
    }
    draw_half(&mut harness, Modifiers::NONE, &[last, first]);
    assert!(progress(&harness).is_none() && steps(&harness).len() == 1);
    press(&mut harness, Modifiers::NONE, first, false);
    assert_eq!(*harness.state().session().document().placement(), placed);
    assert!(!harness.state().editor.is_drawing());
    // Twice on one place: a ball.
    let before = voxels(&harness);
    let pos = at(&harness, [32.0, 12.0, 64.0]);
    click(&mut harness, pos);
    click(&mut harness, pos);
    assert!((80..180).contains(&(before - voxels(&harness))), "{}", before - voxels(&harness));
}

#[test]
fn points_are_taken_back_and_a_curve_is_given_up() {
    let back = [(Modifiers::NONE, Key::Backspace), (Modifiers::COMMAND, Key::Z)];
    for (modifiers, letter) in back {
        let mut harness = front(DrawKind::Curve, ToolMode::Subtract);
        run(&mut harness, "select add");
        for place in POINTS {
            let pos = at(&harness, place);
            click(&mut harness, pos);
        }
        for left in [2, 1] {
            key(&mut harness, modifiers, letter);
            assert_eq!(progress(&harness), Some(Progress::Points(left)));
        }
        key(&mut harness, modifiers, letter);
        assert_eq!((progress(&harness), steps(&harness).len()), (None, 0));
        let boxes =
            |harness: &Bench| harness.state().session().document().selection().boxes().len();
        assert_eq!((boxes(&harness), voxels(&harness)), (1, FULL), "the selection stays");
        // One is taken back, and another comes in its place.
        for place in [POINTS[0], [12.0, 10.0, 64.0]] {
            let pos = at(&harness, place);
            click(&mut harness, pos);
        }
        key(&mut harness, modifiers, letter);
        let pos = at(&harness, POINTS[1]);
        click(&mut harness, pos);
        key(&mut harness, Modifiers::NONE, Key::Space);
        assert!(!has(&harness, [29, 49, 63]) && has(&harness, [12, 12, 63]), "{letter:?}");
    }
    let mut harness = front(DrawKind::Curve, ToolMode::Subtract);
    for place in POINTS {
        let pos = at(&harness, place);
        click(&mut harness, pos);
    }
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!((progress(&harness), voxels(&harness)), (None, FULL));
    assert_eq!(steps(&harness).len(), 0);
    // A drag draws by hand as it always did.
    let path = through(&harness, &[[12.0, 32.0, 64.0], [52.0, 32.0, 64.0]]);
    draw(&mut harness, &path);
    assert!((14..50).all(|x| !has(&harness, [x, 32, 62])) && progress(&harness).is_none());
}

#[test]
fn a_point_beside_the_sculpture_is_as_deep_as_the_last_and_a_press_may_be_dragged() {
    let mut harness = front(DrawKind::Curve, ToolMode::Add);
    run(&mut harness, "clear");
    run(&mut harness, "add cuboid at=16,32,20 half=16,32,20");
    harness.state_mut().editor.tool.draws.radii = [2.0, 2.0];
    let first = at(&harness, [20.0, 32.0, 40.0]);
    click(&mut harness, first);
    let astray = at(&harness, [60.0, 8.0, 40.0]);
    let meant = at(&harness, [56.0, 32.0, 40.0]);
    draw(&mut harness, &[astray, meant]);
    assert_eq!(progress(&harness), Some(Progress::Points(2)));
    let placed = *harness.state().session().document().placement();
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert!((24..56).all(|x| has(&harness, [x, 32, 40])), "straight through the air");
    assert!(!has(&harness, [58, 10, 40]));
    assert_eq!(*harness.state().session().document().placement(), placed);
}

#[test]
fn the_tools_of_another_table_take_presses_too() {
    let mut harness = front(DrawKind::Curve, ToolMode::Subtract);
    let presets = harness.state().controls.presets();
    let thesis = presets.iter().position(|table| table.name == "thesis").unwrap();
    harness.state_mut().controls.preset = thesis;
    let pos = at(&harness, POINTS[0]);
    hover(&mut harness, pos);
    key(&mut harness, Modifiers::NONE, Key::Space);
    assert_eq!(progress(&harness), Some(Progress::Points(1)));
    assert_eq!(harness.state().editor.tool.kind, ToolKind::Draw(DrawKind::Curve));
    for place in [POINTS[1], POINTS[2]] {
        let pos = at(&harness, place);
        click(&mut harness, pos);
    }
    assert_eq!(progress(&harness), Some(Progress::Points(3)));
    key(&mut harness, Modifiers::NONE, Key::Space);
    assert!(!has(&harness, [48, 36, 62]));
    is_one_step(&mut harness, FULL);
}
