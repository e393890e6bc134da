//! Tools that draw solids, without a window: drags over the picture leave the right voxels, as one step each.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use glam::{IVec3, Vec3};
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::input::{DrawKind, ToolMode};
use virtual_sculpture::sculpture::Rgb;

use super::bench::{self, Bench, key, look, middle, rest, run, screen, send, voxels};

pub const FULL: u64 = 64 * 64 * 64;

/// A solid block of 64^3 voxels, seen from the front, with a tool that draws.
pub fn front(kind: DrawKind, mode: ToolMode) -> Bench {
    let mut harness = bench::bench();
    rest(&mut harness);
    run(&mut harness, "place");
    let tool = &mut harness.state_mut().editor.tool;
    (tool.kind, tool.mode) = (ToolKind::Draw(kind), mode);
    harness
}

pub fn press(harness: &mut Bench, modifiers: Modifiers, pos: Pos2, pressed: bool) {
    let button = PointerButton::Primary;
    send(harness, Event::PointerButton { pos, button, pressed, modifiers });
}

/// Presses where a path begins and goes along it, without a release.
pub fn draw_half(harness: &mut Bench, modifiers: Modifiers, path: &[Pos2]) {
    send(harness, Event::PointerMoved(path[0]));
    press(harness, modifiers, path[0], true);
    path.iter().for_each(|pos| send(harness, Event::PointerMoved(*pos)));
}

pub fn draw_with(harness: &mut Bench, modifiers: Modifiers, path: &[Pos2]) {
    draw_half(harness, modifiers, path);
    press(harness, modifiers, path[path.len() - 1], false);
    look(harness);
}

pub fn draw(harness: &mut Bench, path: &[Pos2]) {
    draw_with(harness, Modifiers::NONE, path);
}

/// A path between places of the grid, in small steps.
pub fn through(harness: &Bench, places: &[[f32; 3]]) -> Vec<Pos2> {
    let places: Vec<Vec3> = places.iter().map(|p| Vec3::from(*p)).collect();
    let step = |pair: &[Vec3], i: u32| pair[0].lerp(pair[1], i as f32 / 12.0);
    let steps = places.windows(2).flat_map(|pair| (0..=12).map(move |i| step(pair, i)));
    steps.map(|place| screen(harness, place)).collect()
}

pub fn has(harness: &Bench, v: [i32; 3]) -> bool {
    harness.state().session().document().grid().get(IVec3::from(v))
}

pub fn steps(harness: &Bench) -> Vec<String> {
    harness.state().session().document().history().undo_labels().map(String::from).collect()
}

pub fn told(harness: &Bench, text: &str) -> bool {
    harness.state().ui.toasts.texts().any(|(_, toast)| toast.contains(text))
}

/// Checks that the drawing was one step, and that undo takes all of it back.
pub fn is_one_step(harness: &mut Bench, before: u64) {
    assert_eq!(steps(harness).len(), 1, "{:?}", steps(harness));
    key(harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(voxels(harness), before);
}

/// A ring of voxels on the front, seen from the front.
fn square(harness: &Bench, half: f32) -> Vec<Pos2> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let corners = corners.map(|[x, y]| [32.0 + half * x, 32.0 + half * y, 64.0]);
    through(harness, &corners)
}

#[test]
fn every_tool_is_taken_by_its_button_and_by_its_key() {
    let mut harness = front(DrawKind::Lasso, ToolMode::Subtract);
    harness.state_mut().editor.tool.kind = ToolKind::Solid;
    for (button, modifiers, letter, kind) in [
        ("Lasso", Modifiers::ALT, Key::L, DrawKind::Lasso),
        ("Rectangle", Modifiers::ALT, Key::Q, DrawKind::Rectangle),
        ("Plane cut", Modifiers::ALT, Key::P, DrawKind::Plane),
        ("Box", Modifiers::ALT, Key::B, DrawKind::Box),
        ("Line", Modifiers::ALT, Key::I, DrawKind::Line),
        ("Curve", Modifiers::ALT, Key::U, DrawKind::Curve),
        ("Lathe", Modifiers::ALT, Key::W, DrawKind::Lathe),
        ("Text", Modifiers::ALT, Key::Y, DrawKind::Text),
    ] {
        key(&mut harness, Modifiers::NONE, Key::E);
        harness.get_by_label(button).click();
        rest(&mut harness);
        assert_eq!(harness.state().editor.tool.kind, ToolKind::Draw(kind), "{button}");
        // The mode is chosen for the tool in hand.
        key(&mut harness, Modifiers::NONE, Key::T);
        assert_eq!(harness.state().editor.tool.kind, ToolKind::Draw(kind));
        key(&mut harness, Modifiers::NONE, Key::E);
        assert_eq!(harness.state().editor.tool.kind, ToolKind::Solid);
        key(&mut harness, modifiers, letter);
        assert_eq!(harness.state().editor.tool.kind, ToolKind::Draw(kind), "{letter:?}");
    }
}

#[test]
fn a_lasso_and_a_rectangle_cut_through_all_that_lies_behind_them() {
    for kind in [DrawKind::Lasso, DrawKind::Rectangle] {
        let mut harness = front(kind, ToolMode::Subtract);
        let path = match kind {
            DrawKind::Lasso => square(&harness, 8.0),
            _ => through(&harness, &[[24.0, 24.0, 64.0], [40.0, 40.0, 64.0]]),
        };
        draw(&mut harness, &path);
        assert!((0..64).all(|z| !has(&harness, [32, 32, z])), "a hole through all");
        assert!(!has(&harness, [25, 38, 63]) && has(&harness, [22, 32, 63]));
        let gone = FULL - voxels(&harness);
        // Perspective: what is behind is wider.
        assert!((15_000..30_000).contains(&gone), "{kind:?} {gone}");
        is_one_step(&mut harness, FULL);
    }
}

#[test]
fn a_lasso_paints_and_its_inverse_adds_a_slab() {
    let mut harness = front(DrawKind::Lasso, ToolMode::Recolour);
    harness.state_mut().editor.tool.colour = Rgb::new(9, 8, 7);
    let path = square(&harness, 8.0);
    draw(&mut harness, &path);
    let colour = |harness: &Bench, v: [u32; 3]| {
        harness.state().session().document().contents().rgb(v.into())
    };
    assert_eq!((colour(&harness, [32, 32, 63]), voxels(&harness)), (Rgb::new(9, 8, 7), FULL));
    assert_ne!(colour(&harness, [10, 32, 63]), Rgb::new(9, 8, 7));

    run(&mut harness, "subtract cuboid at=32,32,48 half=32,32,16");
    harness.state_mut().editor.tool.draws.thickness = 8.0;
    let path = through(&harness, &[[20.0, 20.0, 32.0], [44.0, 20.0, 32.0], [32.0, 44.0, 32.0]]);
    draw_with(&mut harness, Modifiers::COMMAND, &path);
    assert!(has(&harness, [32, 30, 35]) && !has(&harness, [32, 30, 37]), "half before the face");
}

#[test]
fn a_plane_takes_the_hatched_side_and_with_ctrl_the_other() {
    for (modifiers, low_stays) in [(Modifiers::NONE, false), (Modifiers::COMMAND, true)] {
        let mut harness = front(DrawKind::Plane, ToolMode::Subtract);
        // From left to right: what is below goes.
        let path = through(&harness, &[[-20.0, 32.0, 32.0], [80.0, 32.0, 32.0]]);
        draw_with(&mut harness, modifiers, &path);
        assert_eq!(
            (has(&harness, [32, 10, 32]), has(&harness, [32, 50, 32])),
            (low_stays, !low_stays)
        );
        let gone = FULL - voxels(&harness);
        assert!(gone.abs_diff(FULL / 2) < FULL / 50, "{gone}");
        is_one_step(&mut harness, FULL);
    }
}

#[test]
fn a_box_grows_out_of_the_face_or_into_it() {
    let mut harness = front(DrawKind::Box, ToolMode::Subtract);
    let draws = &mut harness.state_mut().editor.tool.draws;
    (draws.height_by_pointer, draws.height) = (false, 5.0);
    let path = through(&harness, &[[20.5, 20.5, 64.0], [29.5, 24.5, 64.0]]);
    draw(&mut harness, &path);
    assert_eq!(FULL - voxels(&harness), 10 * 5 * 5);
    assert!(
        !has(&harness, [20, 20, 63]) && !has(&harness, [29, 24, 59]) && has(&harness, [29, 24, 58])
    );
    is_one_step(&mut harness, FULL);
    // On the bottom of a hole, outwards, and mirrored.
    run(&mut harness, "subtract cuboid at=32,32,48 half=32,32,16");
    run(&mut harness, "symmetry x=even");
    let before = voxels(&harness);
    let path = through(&harness, &[[10.5, 20.5, 32.0], [11.5, 20.5, 32.0]]);
    draw_with(&mut harness, Modifiers::COMMAND, &path);
    assert_eq!(voxels(&harness) - before, 2 * 2 * 5);
    assert!(
        has(&harness, [10, 20, 36]) && has(&harness, [53, 20, 36]) && !has(&harness, [53, 20, 37])
    );
}

#[test]
fn a_box_is_added_to_an_empty_grid_on_the_wall_that_is_seen() {
    let mut harness = front(DrawKind::Box, ToolMode::Add);
    harness.state_mut().editor.tool.draws.height_by_pointer = false;
    run(&mut harness, "clear");
    let path = through(&harness, &[[20.5, 20.5, 0.0], [24.5, 22.5, 0.0]]);
    draw(&mut harness, &path);
    assert_eq!(voxels(&harness), 5 * 3 * 12);
    assert!(has(&harness, [20, 20, 0]) && has(&harness, [24, 22, 11]));
}

#[test]
fn a_line_is_a_rod_from_surface_to_surface_and_a_click_a_ball() {
    let mut harness = front(DrawKind::Line, ToolMode::Subtract);
    harness.state_mut().editor.tool.draws.radii = [3.0, 3.0];
    let path = through(&harness, &[[12.0, 32.0, 64.0], [52.0, 32.0, 64.0]]);
    draw(&mut harness, &path);
    assert!((12..52).all(|x| !has(&harness, [x, 32, 62]) && has(&harness, [x, 32, 60])));
    assert!(!has(&harness, [10, 32, 63]) && has(&harness, [7, 32, 63]), "round ends");
    is_one_step(&mut harness, FULL);
    let at = middle(&harness);
    draw(&mut harness, &[at]);
    let ball = FULL - voxels(&harness);
    assert!((50..75).contains(&ball), "half a ball of radius 3: {ball}");
}

#[test]
fn a_curve_follows_the_surface_tapers_and_is_mirrored() {
    let mut harness = front(DrawKind::Curve, ToolMode::Add);
    // A step: the curve goes down it.
    run(&mut harness, "subtract cuboid at=48,32,48 half=16,32,16");
    run(&mut harness, "subtract cuboid at=16,32,56 half=16,32,8");
    run(&mut harness, "symmetry y=even");
    harness.state_mut().editor.tool.draws.radii = [4.0, 2.0];
    let before = voxels(&harness);
    let path = through(&harness, &[[8.0, 48.0, 48.0], [30.0, 48.0, 48.0]]);
    let on = through(&harness, &[[36.0, 48.0, 32.0], [58.0, 48.0, 32.0]]);
    draw(&mut harness, &[path, on].concat());
    assert!(has(&harness, [12, 48, 50]) && has(&harness, [54, 48, 32]), "on both levels");
    assert!(!has(&harness, [54, 48, 35]), "thinner at its end");
    assert!(has(&harness, [12, 15, 50]) && has(&harness, [54, 15, 32]), "mirrored");
    assert_eq!(steps(&harness).len(), 3);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(voxels(&harness), before);
    // In the plane of the view it goes straight on.
    harness.state_mut().editor.tool.draws.on_surface = false;
    let path = through(&harness, &[[8.0, 48.0, 48.0], [58.0, 48.0, 48.0]]);
    draw(&mut harness, &path);
    assert!(has(&harness, [56, 48, 48]), "over the step");
}

#[test]
fn a_profile_is_turned_about_the_vertical_through_the_press() {
    let mut harness = front(DrawKind::Lathe, ToolMode::Add);
    run(&mut harness, "clear");
    run(&mut harness, "add cuboid at=32,2,32 half=30,2,30");
    let before = voxels(&harness);
    // A cylinder of radius 12 and height 20 around x = 32, in the plane z = 40 of the face it begins on.
    run(&mut harness, "add cuboid at=32,4.5,39.5 half=0.5");
    let profile = [[32.0, 5.0, 40.0], [44.0, 5.0, 40.0], [44.0, 25.0, 40.0], [32.0, 25.0, 40.0]];
    let path = through(&harness, &profile);
    draw(&mut harness, &path);
    let solid = voxels(&harness) - before;
    let ideal = std::f32::consts::PI * 144.0 * 20.0;
    assert!((solid as f32 - ideal).abs() < 0.06 * ideal, "{solid}");
    assert!(
        has(&harness, [32, 15, 50]) && has(&harness, [22, 15, 40]) && !has(&harness, [32, 15, 54])
    );
}

#[test]
fn letters_stand_on_the_face_and_are_one_step() {
    let mut harness = front(DrawKind::Text, ToolMode::Subtract);
    let draws = &mut harness.state_mut().editor.tool.draws;
    (draws.text, draws.text_height, draws.text_depth) = ("HI".to_string(), 24.0, 3.0);
    let at = middle(&harness);
    draw(&mut harness, &[at - vec2(30.0, 0.0), at]);
    let gone = FULL - voxels(&harness);
    assert!((300..1500).contains(&gone), "{gone}");
    let grid = harness.state().session().document().grid();
    let cut: Vec<IVec3> = (0..64 * 64 * 64)
        .map(|i| grid.voxel_coords(i).as_ivec3())
        .filter(|v| !grid.get(*v))
        .collect();
    assert!(cut.iter().all(|v| v.z >= 61 && (19..45).contains(&v.y)), "upright, 24 high, 3 deep");
    let across = |x: i32| cut.iter().filter(|v| v.x == x && v.z == 63).count();
    assert!((0..64).any(|x| across(x) > 20), "the strokes of H and I are vertical");
    is_one_step(&mut harness, FULL);
    // Nothing to write, and what no font has.
    harness.state_mut().editor.tool.draws.text = "  ".to_string();
    draw(&mut harness, &[at]);
    assert!(told(&harness, "Enter some text"));
    harness.state_mut().editor.tool.draws.text = "字".to_string();
    draw(&mut harness, &[at]);
    assert!(told(&harness, "字"));
    assert_eq!(voxels(&harness), FULL);
}

#[test]
fn escape_gives_up_and_the_button_does_nothing_more() {
    for kind in DrawKind::ALL {
        let mut harness = front(kind, ToolMode::Subtract);
        let path = square(&harness, 8.0);
        draw_half(&mut harness, Modifiers::NONE, &path);
        assert!(harness.state().editor.is_drawing(), "{kind:?}");
        key(&mut harness, Modifiers::NONE, Key::Escape);
        assert!(!harness.state().editor.is_drawing());
        let placed = *harness.state().session().document().placement();
        send(&mut harness, Event::PointerMoved(path[0] + vec2(50.0, 0.0)));
        press(&mut harness, Modifiers::NONE, path[0], false);
        assert_eq!((voxels(&harness), steps(&harness).len()), (FULL, 0), "{kind:?}");
        assert_eq!(*harness.state().session().document().placement(), placed);
        // The next drag draws again.
        draw_half(&mut harness, Modifiers::NONE, &path);
        assert!(harness.state().editor.is_drawing(), "{kind:?}");
    }
}

#[test]
fn a_click_that_means_nothing_says_what_to_do() {
    for (kind, said) in [
        (DrawKind::Lasso, "Drag around"),
        (DrawKind::Rectangle, "one corner"),
        (DrawKind::Plane, "Drag a line"),
        (DrawKind::Lathe, "Press on the axis"),
    ] {
        let mut harness = front(kind, ToolMode::Subtract);
        let at = middle(&harness);
        draw(&mut harness, &[at]);
        assert!(told(&harness, said), "{kind:?}");
        assert_eq!((voxels(&harness), steps(&harness).len()), (FULL, 0));
    }
}

#[test]
fn beside_the_sculpture_lines_are_drawn_in_the_air_and_boxes_rotate_it() {
    let mut harness = front(DrawKind::Line, ToolMode::Add);
    run(&mut harness, "clear");
    run(&mut harness, "add cuboid at=32,32,32 half=4");
    let before = voxels(&harness);
    let path = through(&harness, &[[10.0, 10.0, 32.0], [20.0, 10.0, 32.0]]);
    draw(&mut harness, &path);
    assert!(has(&harness, [15, 10, 32]) && voxels(&harness) > before, "at the depth of the middle");
    let placed = *harness.state().session().document().placement();
    let tool = &mut harness.state_mut().editor.tool;
    (tool.kind, tool.mode) = (ToolKind::Draw(DrawKind::Box), ToolMode::Subtract);
    draw(&mut harness, &[path[0] - vec2(0.0, 90.0), path[0] - vec2(40.0, 90.0)]);
    assert_ne!(*harness.state().session().document().placement(), placed);
}

#[test]
fn a_key_held_draws_with_the_hovering_pointer() {
    let mut harness = front(DrawKind::Curve, ToolMode::Subtract);
    let path = through(&harness, &[[12.0, 32.0, 64.0], [52.0, 32.0, 64.0]]);
    let space = |pressed| Event::Key {
        key: Key::Space,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    send(&mut harness, Event::PointerMoved(path[0]));
    send(&mut harness, space(true));
    path.iter().for_each(|pos| send(&mut harness, Event::PointerMoved(*pos)));
    send(&mut harness, space(false));
    assert!((14..50).all(|x| !has(&harness, [x, 32, 62])));
    is_one_step(&mut harness, FULL);
}

#[test]
fn the_wheel_and_keys_change_the_size_of_what_is_drawn() {
    let mut harness = front(DrawKind::Curve, ToolMode::Add);
    let radii = harness.state().editor.tool.draws.radii;
    let at = middle(&harness);
    bench::wheel(&mut harness, Modifiers::COMMAND, at, 1.0);
    key(&mut harness, Modifiers::NONE, Key::CloseBracket);
    assert!(harness.state().editor.tool.draws.radii[0] > radii[0]);
}

/// A mug with a handle: three acts with the profile, the handle and its colour, each of them seen.
#[test]
fn a_mug_is_made_in_few_acts() {
    let mut harness = front(DrawKind::Lathe, ToolMode::Subtract);
    let mut acts = 0;
    // An empty grid; Alt+W, T.
    for (modifiers, letter) in
        [(Modifiers::COMMAND, Key::Delete), (Modifiers::ALT, Key::W), (Modifiers::NONE, Key::T)]
    {
        key(&mut harness, modifiers, letter);
        acts += 1;
    }
    // Along the bottom, up the outside, over the rim and down the inside to the axis.
    let profile = [
        [28.0, 12.0, 32.0],
        [42.0, 12.0, 32.0],
        [43.0, 50.0, 32.0],
        [40.0, 50.0, 32.0],
        [39.0, 15.0, 32.0],
        [28.0, 15.0, 32.0],
    ];
    let path = through(&harness, &profile);
    draw(&mut harness, &path);
    acts += 1;
    assert!(!has(&harness, [28, 30, 32]) && has(&harness, [28, 13, 32]), "hollow, with a bottom");
    assert!(has(&harness, [41, 30, 32]) && has(&harness, [15, 30, 32]), "a wall around");
    let cup = voxels(&harness);
    // The handle: from the wall through the air and back to it.
    key(&mut harness, Modifiers::ALT, Key::U);
    acts += 1;
    harness.state_mut().editor.tool.draws.radii = [2.5, 2.5];
    acts += 2;
    let handle = [
        [42.5, 44.0, 32.0],
        [52.0, 44.0, 32.0],
        [55.0, 32.0, 32.0],
        [50.0, 20.0, 32.0],
        [42.0, 19.0, 32.0],
    ];
    let path = through(&harness, &handle);
    draw(&mut harness, &path);
    acts += 1;
    // It begins where the wall is seen: a little before its middle.
    assert!([[50, 43, 34], [54, 32, 34], [46, 20, 34]].iter().all(|v| has(&harness, *v)));
    assert!(!has(&harness, [47, 32, 34]), "a gap for fingers");
    assert!(!has(&harness, [28, 30, 32]) && voxels(&harness) > cup + 500);
    assert!(acts < 15, "{acts}");
    assert_eq!(steps(&harness).len(), 3, "clear, lathe, curve");
}

#[test]
fn letters_beyond_the_face_are_named() {
    let mut harness = front(DrawKind::Text, ToolMode::Add);
    run(&mut harness, "subtract cuboid at=32,32,54 half=32,32,10");
    let draws = &mut harness.state_mut().editor.tool.draws;
    (draws.text, draws.text_height, draws.text_depth) = ("HIJK".to_string(), 20.0, 2.0);
    let at = screen(&harness, Vec3::new(52.0, 32.0, 44.0));
    draw(&mut harness, &[at]);
    assert!(told(&harness, "“K” floats: there is no surface there"));
}
