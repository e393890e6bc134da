//! Tests sculpting with tracked hands. Jumps and nonsense from the tracker cut nothing that no hand has touched, and no
//! state grows without bound.

use std::sync::Arc;

use glam::{Quat, UVec3, Vec2, Vec3};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use crate::app::Workspace;
use crate::command::{CanvasChange, Command};
use crate::config::Config;
use crate::editor::pen_use::{PenTool, PenUse};
use crate::editor::sizes::SizeUnit;
use crate::editor::symmetry::SymmetryPart;
use crate::editor::tool::{NextPress, ToolKind};
use crate::input::hands::{HandMapper, HandSettings, HandSide, HandState, HandsState};
use crate::input::pad::stick::Response;
use crate::input::{ActionEvent, Bindings, DrawKind, ToolMode};
use crate::sculpture::Rgb;
use crate::session::Session;
use crate::surface::{IndexMap, raycast};
use crate::tools::brush::BrushId;
use crate::tools::brush::keys::RADIUS;
use crate::view::{Room, RoomPose};

const REACH_M: f32 = 0.08;
const FRAME_S: f64 = 1.0 / 72.0;
/// Edge of the cube in voxels; it is half a metre in the room.
const DIMS: u32 = 64;

/// A person in a room, with a solid cube before them.
struct Person {
    workspace: Workspace,
    mapper: HandMapper,
    room: Room,
    state: HandsState,
}

impl Person {
    fn new(dims: u32) -> Person {
        let mut config = Config::default();
        config.new.dims = [dims; 3];
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        let mut workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
        workspace.stand_upright();
        let response = Response { dead_zone: 0.2, curve: 2.0 };
        let settings = HandSettings { main: HandSide::Right, response, reach_m: REACH_M };
        let head = RoomPose { position: Vec3::Y * 1.6, rotation: Quat::IDENTITY };
        Person {
            workspace,
            mapper: HandMapper::new(settings),
            room: Room::before(&head, 0.7, 0.3, 0.5 / dims as f32),
            state: HandsState::default(),
        }
    }

    /// Holds the tool in the main hand at this point of the room for `frames` frames.
    fn hold(&mut self, tool: Vec3, trigger: f32, frames: usize) {
        let position = tool + Vec3::Z * REACH_M;
        let pose = Some(RoomPose { position, rotation: Quat::IDENTITY });
        let hand = HandState { grip: pose, aim: pose, trigger, ..HandState::default() };
        self.state.hands[HandSide::Right.index()] = hand;
        (0..frames).for_each(|_| self.frame());
    }

    fn frame(&mut self) {
        self.state.time_s += FRAME_S;
        for event in self.mapper.update(&self.state, None) {
            self.workspace.answer_hand(&event, &self.room);
        }
    }

    fn removed_voxels(&self) -> u64 {
        let grid = self.workspace.session().document().grid();
        u64::from(grid.dims().element_product()) - grid.opaque_count()
    }

    fn is_opaque(&self, share: Vec3) -> bool {
        let grid = self.workspace.session().document().grid();
        grid.get((share * grid.dims().as_vec3()).as_ivec3())
    }
}

const GRAB: ToolKind = ToolKind::Brush(BrushId::Grab);
/// The middle of the cube.
const MIDDLE: Vec3 = Vec3::new(0.0, 1.3, -0.7);

#[test]
fn a_jump_of_tracking_cuts_no_tunnel() {
    for tool in [ToolKind::Solid, ToolKind::Brush(BrushId::Devour), GRAB] {
        let mut person = Person::new(DIMS);
        person.workspace.editor.tool.kind = tool;
        let left = MIDDLE - Vec3::X * 0.3;
        person.hold(left, 0.0, 5);
        person.hold(left, 1.0, 2);
        assert!(person.workspace.editor.is_stroking());
        // From one side of the cube to the other between two frames, and back.
        person.hold(MIDDLE + Vec3::X * 0.3, 1.0, 1);
        assert!(!person.workspace.editor.is_stroking(), "the tool is lifted");
        person.hold(left, 1.0, 5);
        assert_eq!(person.removed_voxels(), 0, "{tool:?}");
        assert!(!person.workspace.editor.is_stroking());
        // The hand has been slow for a while.
        person.hold(left, 1.0, 10);
        assert!(person.workspace.editor.is_stroking(), "a new stroke");
        for i in 1..=40 {
            person.hold(left + Vec3::X * (0.0075 * i as f32), 1.0, 1);
        }
        person.hold(MIDDLE, 0.0, 2);
        assert!(!person.workspace.editor.is_stroking());
        if tool == GRAB {
            assert!(person.removed_voxels() > 100, "the clay goes along with the hand");
        }
        if tool == ToolKind::Solid {
            assert!(person.removed_voxels() > 100 && !person.is_opaque(Vec3::new(0.25, 0.5, 0.5)));
            assert!(person.is_opaque(Vec3::new(0.75, 0.5, 0.5)), "not beyond where the hand went");
        }
    }
}

#[test]
fn a_hand_draws_lines_and_curves_as_one_step() {
    for kind in [DrawKind::Line, DrawKind::Curve] {
        let mut person = Person::new(DIMS);
        person.workspace.editor.tool.kind = ToolKind::Draw(kind);
        let left = MIDDLE - Vec3::X * 0.2;
        person.hold(left, 0.0, 5);
        person.hold(left, 1.0, 2);
        for i in 1..=40 {
            let up = Vec3::Y * if (10..30).contains(&i) { 0.1 } else { 0.0 };
            person.hold(left + Vec3::X * (0.01 * i as f32) + up, 1.0, 1);
        }
        assert_eq!(person.removed_voxels(), 0, "it is made when the trigger is let go");
        person.hold(MIDDLE + Vec3::X * 0.2, 0.0, 3);
        assert!(person.removed_voxels() > 1000, "{}", person.removed_voxels());
        let straight = !person.is_opaque(Vec3::splat(0.5));
        assert_eq!(straight, kind == DrawKind::Line, "a curve goes where the hand went");
        assert_eq!(person.workspace.session().document().history().undo_count(), 1);
    }
}

#[test]
fn the_symmetry_goes_with_the_hand_until_the_trigger_is_let_go() {
    for what in [SymmetryPart::Plane, SymmetryPart::Axis] {
        let mut person = Person::new(DIMS);
        person.workspace.editor.tool.next_press = Some(NextPress::Symmetry(what));
        let place = |person: &Person| {
            let symmetry = person.workspace.session().document().symmetry();
            let plane = symmetry.plane.map(|plane| (plane.at_vx, plane.normal));
            plane.or(symmetry.radial.map(|radial| (radial.at_vx, radial.axis)))
        };
        person.hold(MIDDLE, 0.0, 5);
        assert_eq!(place(&person), None);
        person.hold(MIDDLE, 1.0, 3);
        let direction = if what == SymmetryPart::Plane { Vec3::X } else { Vec3::Y };
        let (at, along) = place(&person).unwrap();
        assert_eq!(along, direction);
        assert!(at.distance(Vec3::splat(32.0)) < 1.0, "{at}");
        // It moves with the hand, and stays when the trigger is released.
        for i in 1..=20 {
            person.hold(MIDDLE + Vec3::X * (0.004 * i as f32), 1.0, 1);
        }
        let moved = place(&person).unwrap().0;
        assert!(moved.x > at.x + 8.0, "{moved}");
        person.hold(MIDDLE + Vec3::X * 0.08, 0.0, 2);
        person.hold(MIDDLE, 0.0, 20);
        assert_eq!(place(&person).unwrap().0, moved);
        assert_eq!(person.removed_voxels(), 0, "no tool was used");
        person.hold(MIDDLE + Vec3::Z * 0.25, 0.0, 15);
        person.hold(MIDDLE + Vec3::Z * 0.25, 1.0, 3);
        assert!(person.removed_voxels() > 0, "the next press uses the tool again");
    }
}

#[test]
fn a_brush_is_weaker_while_the_trigger_is_pulled_less() {
    let furrow = |trigger: f32, by_pressure: bool| {
        let mut person = Person::new(DIMS);
        person.workspace.editor.tool.kind = ToolKind::Brush(BrushId::Crease);
        let leads = PenUse { strength: by_pressure, ..PenUse::default() };
        let tool = &mut person.workspace.editor.tool;
        tool.pens.set(PenTool::Brush(BrushId::Crease), leads);
        tool.brushes.set_unit(SizeUnit::Sculpture);
        tool.brushes.of_mut(BrushId::Crease).set(RADIUS, 8.0);
        let front = MIDDLE + Vec3::Z * 0.25;
        person.hold(front, 0.0, 5);
        for i in 0..10 {
            person.hold(front + Vec3::X * (0.005 * i as f32), trigger, 1);
        }
        person.hold(front, 0.0, 2);
        assert!(!person.workspace.editor.is_stroking());
        person.removed_voxels()
    };
    let [light, half, full] = [0.61, 0.7, 1.0].map(|trigger| furrow(trigger, true));
    assert!(0 < light && light < half && half < full, "{light} {half} {full}");
    assert_eq!(furrow(0.61, false), full);
}

#[test]
fn a_pointer_that_moves_over_the_window_leaves_the_tool_to_the_hand_at_work() {
    let mut person = Person::new(DIMS);
    person.workspace.editor.tool.kind = ToolKind::Solid;
    let left = MIDDLE - Vec3::X * 0.3;
    person.hold(left, 0.0, 5);
    person.hold(left, 1.0, 2);
    let eye = person.workspace.eye();
    let mut map = IndexMap::new(eye.pixel_rays(&person.workspace.world_from_grid()));
    let rays = map.rays;
    raycast::sample(person.workspace.session().document().grid(), &rays, &mut map);
    let Workspace { viewpoint, editor, .. } = &mut person.workspace;
    viewpoint.set_pick_map(Arc::new(map), editor.document());
    let tool = person.workspace.editor.tool.centre_vx;
    person.workspace.answer_event(&ActionEvent::Hover(rays.size.as_vec2() * 0.5));
    assert_eq!(person.workspace.editor.tool.centre_vx, tool);
    assert!(person.workspace.editor.is_stroking());
    person.hold(left, 0.0, 2);
    assert_eq!(person.removed_voxels(), 0, "no tunnel from the hand to the pointer");
    person.workspace.answer_event(&ActionEvent::Hover(rays.size.as_vec2() * 0.5));
    assert_ne!(person.workspace.editor.tool.centre_vx, tool, "it is free again");
}

#[test]
fn a_marker_does_not_follow_a_jump() {
    let mut person = Person::new(DIMS);
    person.workspace.editor.tool.kind = ToolKind::Marker;
    person.hold(MIDDLE, 0.0, 5);
    let marker = |person: &Person| person.workspace.session().document().selection().marker();
    let before = marker(&person);
    person.hold(MIDDLE, 1.0, 2);
    person.hold(MIDDLE + Vec3::X * 0.4, 1.0, 20);
    assert_eq!(marker(&person), before);
    // It follows again once the hand moves slowly.
    for i in 1..=20 {
        person.hold(MIDDLE + Vec3::X * (0.4 + 0.01 * i as f32), 1.0, 1);
    }
    let by = marker(&person).min.x - before.min.x;
    assert!((24..=27).contains(&by), "0.2 m are 25.6 voxels, not {by}");
}

#[test]
fn implausible_poses_end_the_stroke() {
    let nonsense = [
        RoomPose { position: Vec3::NAN, rotation: Quat::IDENTITY },
        RoomPose { position: Vec3::INFINITY, rotation: Quat::IDENTITY },
        RoomPose { position: Vec3::X * 1e30, rotation: Quat::IDENTITY },
        RoomPose { position: Vec3::X * 1e7, rotation: Quat::IDENTITY },
        RoomPose { position: MIDDLE, rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0) },
        RoomPose { position: MIDDLE, rotation: Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0) },
        RoomPose { position: MIDDLE, rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 1e20) },
    ];
    for pose in nonsense {
        let mut person = Person::new(DIMS);
        person.hold(MIDDLE, 0.0, 5);
        person.hold(MIDDLE, 1.0, 2);
        let (removed, tool) = (person.removed_voxels(), person.workspace.editor.tool.centre_vx);
        assert!(person.workspace.editor.is_stroking() && removed > 0);
        person.state.hands[HandSide::Right.index()].aim = Some(pose);
        person.frame();
        assert!(!person.workspace.editor.is_stroking(), "{pose:?}");
        assert_eq!(
            (person.removed_voxels(), person.workspace.editor.tool.centre_vx),
            (removed, tool)
        );
    }
}

#[test]
fn the_eyedropper_takes_the_colour_that_the_tool_touches_or_points_at() {
    let mut person = Person::new(DIMS);
    let (red, blue) = (Rgb::new(0xff, 0, 0), Rgb::new(0, 0, 0xff));
    let dye = format!("dye colour={red}");
    let mark = "mark at=0,0,32 size=64,64,32".to_string();
    for command in [dye, mark, format!("dye marker colour={blue}")] {
        assert!(person.workspace.run_now(&command.parse().unwrap()), "{command}");
    }
    let own = person.workspace.editor.tool.colour;
    let pick = |person: &mut Person, at: Vec3| {
        person.hold(at, 0.0, 2);
        person.state.hands[HandSide::Right.index()].pick = true;
        person.frame();
        person.workspace.editor.tool.colour
    };
    // Beside the cube, pointing past it.
    assert_eq!(pick(&mut person, MIDDLE + Vec3::X), own);
    // Before the cube: the colour pointed at. Inside: the colour touched.
    assert_eq!(pick(&mut person, MIDDLE + Vec3::Z * 0.5), blue);
    assert_eq!(pick(&mut person, MIDDLE - Vec3::Z * 0.1), red);
    assert_eq!(pick(&mut person, MIDDLE + Vec3::Z * 0.1), blue);
    // Chosen on the board, the next pull takes a colour and uses no tool.
    person.workspace.editor.tool.next_press = Some(NextPress::Pick);
    person.hold(MIDDLE - Vec3::Z * 0.1, 0.0, 20);
    person.hold(MIDDLE - Vec3::Z * 0.1, 1.0, 2);
    assert_eq!((person.workspace.editor.tool.colour, person.removed_voxels()), (red, 0));
    person.hold(MIDDLE - Vec3::Z * 0.1, 0.0, 1);
    person.hold(MIDDLE - Vec3::Z * 0.1, 1.0, 2);
    assert!(person.removed_voxels() > 0, "the one after that uses the tool");
    person.hold(MIDDLE - Vec3::Z * 0.1, 0.0, 1);
    let removed = person.removed_voxels();
    // The blue half of the surface, pointed at from the front, becomes red.
    person.workspace.editor.tool.next_press = Some(NextPress::Flood);
    person.hold(MIDDLE + Vec3::Z * 0.5, 0.0, 20);
    person.hold(MIDDLE + Vec3::Z * 0.5, 1.0, 2);
    assert_eq!(person.removed_voxels(), removed);
    let contents = person.workspace.session().document().contents();
    assert_eq!(contents.rgb(UVec3::new(5, 5, 63)), red);
    assert_eq!(contents.rgb(UVec3::new(5, 63, 40)), red);
}

/// Numbers as a faulty driver would report them, valid ones among them.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        12 => -1.5f32..1.5,
        2 => -100.0f32..100.0,
        1 => prop::sample::select(vec![
            0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, f32::MAX, 1e7,
            f32::MIN_POSITIVE, 1e-40, -1e-45,
        ]),
    ]
}

fn pose() -> impl Strategy<Value = Option<RoomPose>> {
    let turn = prop_oneof![
        8 => prop::array::uniform3(-3.0f32..3.0).prop_map(|v| Quat::from_scaled_axis(v.into())),
        1 => Just(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        1 => prop::array::uniform4(number()).prop_map(Quat::from_array),
    ];
    let pose = (prop::array::uniform3(number()), turn)
        .prop_map(|(at, rotation)| RoomPose { position: Vec3::from(at), rotation });
    prop_oneof![20 => pose.prop_map(Some), 1 => Just(None)]
}

/// Returns the state of a hand.
fn hand() -> impl Strategy<Value = HandState> {
    (
        pose(),
        pose(),
        number(),
        number(),
        prop::array::uniform2(number()),
        prop::bool::weighted(0.05),
    )
        .prop_map(|(grip, aim, trigger, squeeze, stick, menu)| HandState {
            grip,
            aim,
            trigger,
            squeeze,
            stick: Vec2::from(stick),
            menu,
            pick: menu,
        })
}

/// Combines a stock of ten thousand states to frames of four poses each.
#[test]
fn a_million_nonsensical_poses_do_no_harm() {
    const FRAMES: u32 = 250_000;
    let mut runner = TestRunner::deterministic();
    let mut person = Person::new(8);
    let draw = |runner: &mut TestRunner| hand().new_tree(runner).unwrap().current();
    let stock: Vec<HandState> = (0..10_000).map(|_| draw(&mut runner)).collect();
    let (mut strokes, mut was_stroking) = (0, false);
    // A linear congruential generator of full period chooses the next.
    let mut seed = 1u32;
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as usize
    };
    for frame in 0..FRAMES {
        if frame % 997 == 0 {
            person.workspace.editor.tool.kind = match next() % 6 {
                0..3 => ToolKind::Solid,
                3 => ToolKind::Marker,
                _ => ToolKind::Brush(BrushId::ALL[next() % BrushId::ALL.len()]),
            };
        }
        for hand in 0..2 {
            let new = stock[next() % stock.len()];
            let state = &mut person.state.hands[hand];
            // Mostly the hand moves on a little, which makes strokes.
            match (next() % 8, &mut state.aim) {
                (0, _) => *state = new,
                (1, _) => (state.grip, state.aim) = (new.grip, new.aim),
                (_, Some(aim)) => aim.position += Vec3::splat(0.01),
                _ => {}
            }
        }
        person.state.time_s += match next() % 64 {
            0 => f64::from(stock[next() % stock.len()].trigger),
            _ => FRAME_S,
        };
        if !person.state.time_s.is_finite() {
            person.state.time_s = f64::from(frame);
        }
        let events = person.mapper.update(&person.state, None);
        assert!(events.len() <= 12, "{events:?}");
        for event in &events {
            person.workspace.answer_hand(event, &person.room);
        }
        let now = person.workspace.editor.is_stroking();
        strokes += u32::from(now && !std::mem::replace(&mut was_stroking, now));
        was_stroking = now;
        let (hand, placement) =
            (&person.workspace.editor.tool, person.workspace.session().document().placement());
        assert!(
            hand.centre_vx.is_finite() && hand.rotation().is_finite() && hand.half().is_finite()
        );
        assert!(placement.translation.is_finite() && placement.rotation.is_finite());
    }
    assert!(strokes > 1000, "{strokes} strokes");
}

/// Checks that a person who adds beside the grid or cuts in the air is told so, even while the board is closed.
#[test]
fn a_hand_that_changes_nothing_is_told_why() {
    for (mode, why) in [
        (ToolMode::Add, "Nothing was added: the tool was outside the grid"),
        (ToolMode::Subtract, "Nothing was cut: there is nothing where the tool was"),
    ] {
        let mut person = Person::new(DIMS);
        let stays = Command::Canvas(CanvasChange::Auto(false));
        person.workspace.session_mut().execute(&stays, &()).unwrap();
        person.workspace.editor.tool.set_mode(mode);
        // This choice concerns the pointer, not a hand.
        person.workspace.editor.tool.stand = true;
        let beside = MIDDLE + Vec3::X * 0.6;
        person.hold(beside, 0.0, 5);
        person.hold(beside, 1.0, 3);
        person.hold(beside, 0.0, 3);
        let texts: Vec<_> = person.workspace.ui.toasts.texts().map(|(_, text)| text).collect();
        assert_eq!(texts, [why]);
    }
}
