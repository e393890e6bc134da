//! Tools resting on the surface, without a window: a tool touches the face under the pointer, and is updated at once when
//! its options change.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use glam::{EulerRot, IVec3, Quat, Vec2, Vec3};
use virtual_sculpture::editor::tool::{ToolEdit, ToolKind};
use virtual_sculpture::input::ToolMode;
use virtual_sculpture::surface::raycast;
use virtual_sculpture::tools::solid::Solid;

use super::bench::{self, Bench, corner, drag, key, middle, rest, run, screen, send, voxels};

fn hover(harness: &mut Bench, at: Pos2) {
    send(harness, Event::PointerMoved(at));
}

/// The face that the pixel under `at` shows, by the exact ray caster: its normal and its plane.
fn face_at(harness: &Bench, at: Pos2) -> Option<(Vec3, f32)> {
    let bench = harness.state();
    let at = at - bench.picture().min;
    let rays = bench.eye().pixel_rays(&bench.world_from_grid());
    let direction = rays.direction_at(at.x.floor() + 0.5, at.y.floor() + 0.5);
    let hit = raycast::cast(bench.session().document().grid(), rays.origin, direction)?;
    let face = hit.face.as_vec3();
    let axis = face.abs().max_position();
    let plane = hit.voxel.as_vec3()[axis] + if face[axis] > 0.0 { 1.0 } else { 0.0 };
    Some((face, plane))
}

/// The distance of the tool from the face under the pointer; below 0 it penetrates the surface.
fn gap(harness: &Bench, at: Pos2) -> Option<f32> {
    let (face, plane) = face_at(harness, at)?;
    let tool = &harness.state().editor.tool;
    let primitive = tool.primitive();
    let corners = (0..8).map(|i| {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        Vec3::new(sign(0), sign(1), sign(2))
    });
    let reach = |n: Vec3| match tool.solid {
        Solid::Cylinder => {
            let n = n * primitive.half;
            n.y.abs() + n.x.hypot(n.z)
        }
        // As high as wide, so that the tube has its greatest thickness: a third.
        Solid::Torus => {
            let radius = primitive.half.x;
            n.x.hypot(n.z) * radius * 2.0 / 3.0 + radius / 3.0
        }
        other @ (Solid::Cone | Solid::Capsule | Solid::RoundedCuboid) => {
            panic!("no reach is known of {other:?}")
        }
        Solid::Ellipsoid => (n * primitive.half).length(),
        Solid::Cuboid => {
            corners.map(|c| -n.dot(c * primitive.half)).fold(f32::NEG_INFINITY, f32::max)
        }
        Solid::Pyramid => corners
            .map(|c| if c.y > 0.0 { Vec3::Y } else { c })
            .map(|c| -n.dot(c * primitive.half))
            .fold(f32::NEG_INFINITY, f32::max),
    };
    let reach = reach(primitive.rotation.inverse() * face);
    let axis = face.abs().max_position();
    Some((primitive.centre_vx[axis] - plane) * face[axis] - reach)
}

/// Steps, a hill, holes and single voxels; it touches the grid's border on all sides.
fn rough(harness: &mut Bench) {
    for line in [
        "subtract cuboid at=48,48,48 half=16",
        "subtract ellipsoid at=10,56,60 half=14",
        "subtract cuboid at=40,60,20 half=9,5,12 turn=0,30,15",
        "add ellipsoid at=50,30,50 half=9,5,7 colour=#808080",
        "add cuboid at=40.5,40.5,32.5 half=0.5 colour=#ffffff",
        "add cuboid at=52.5,44.5,33.5 half=1.5 colour=#ffffff",
    ] {
        run(harness, line);
    }
}

/// Places of the pointer over the picture: at the middle of pixels, between them and elsewhere.
fn places(harness: &Bench) -> Vec<Pos2> {
    let rect = harness.state().picture();
    let mut at = Vec2::ZERO;
    (0..120)
        .map(|i| {
            // A sequence that spreads evenly.
            at = (at + Vec2::new(0.754_877_7, 0.569_840_3)).fract();
            let at = rect.min + vec2(0.15 + 0.7 * at.x, 0.1 + 0.8 * at.y) * rect.size();
            match i % 4 {
                0 => at.floor(),
                1 => at.floor() + vec2(0.5, 0.5),
                2 => at.floor() + vec2(0.999, 0.001),
                _ => at,
            }
        })
        .collect()
}

#[test]
fn a_tool_that_stands_touches_the_face_under_the_pointer_everywhere() {
    let mut harness = bench::bench();
    rest(&mut harness);
    rough(&mut harness);
    harness.state_mut().editor.tool.stand = true;
    let (mut seen, mut faces) = (0, [0; 6]);
    for (yaw, pitch, roll) in
        [(0.0, 0.0, 0.0), (35.0, -25.0, 0.0), (-130.0, 40.0, 10.0), (90.0, 0.0, 0.0)]
    {
        let [yaw, pitch, roll] = [yaw, pitch, roll].map(f32::to_radians);
        let q = Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll);
        run(&mut harness, &format!("place turn={},{},{},{}", q.x, q.y, q.z, q.w));
        for (solid, turn_deg) in [
            (Solid::Cuboid, Vec3::ZERO),
            (Solid::Cuboid, Vec3::new(20.0, -70.0, 45.0)),
            (Solid::Ellipsoid, Vec3::new(90.0, 0.0, 0.0)),
            (Solid::Pyramid, Vec3::ZERO),
            (Solid::Pyramid, Vec3::new(180.0, 0.0, 30.0)),
            (Solid::Cylinder, Vec3::new(70.0, 0.0, 30.0)),
            (Solid::Torus, Vec3::new(20.0, 10.0, -40.0)),
        ] {
            let tool = &mut harness.state_mut().editor.tool;
            (tool.kind, tool.solid) = (ToolKind::Solid, solid);
            tool.set_turn_deg(turn_deg);
            for at in places(&harness) {
                hover(&mut harness, at);
                let Some(gap) = gap(&harness, at) else { continue };
                assert!(gap.abs() < 2e-3, "{solid:?} turned by {turn_deg} at {at}: {gap}");
                let (face, _) = face_at(&harness, at).unwrap();
                let axis = face.abs().max_position();
                faces[2 * axis + usize::from(face[axis] > 0.0)] += 1;
                seen += 1;
            }
        }
    }
    assert!(seen > 600, "{seen}");
    assert!(faces.iter().filter(|count| **count > 20).count() >= 5, "{faces:?}");
}

#[test]
fn a_cuboid_that_stands_is_added_whole_and_so_are_its_mirror_images() {
    // From far away a voxel is less than a pixel wide.
    for (symmetry, copies) in [("x=off", 1), ("x=even", 2)] {
        for notches in [0.0, -12.0] {
            let mut harness = bench::bench();
            rest(&mut harness);
            run(&mut harness, "place");
            run(&mut harness, "subtract cuboid at=32,32,56 half=32,32,8");
            run(&mut harness, &format!("symmetry {symmetry}"));
            let at = middle(&harness);
            bench::wheel(&mut harness, Modifiers::NONE, at, notches);
            let at = screen(&harness, Vec3::new(44.3, 40.2, 48.0));
            let tool = &mut harness.state_mut().editor.tool;
            (tool.solid, tool.mode, tool.stand, tool.snap) =
                (Solid::Cuboid, ToolMode::Add, true, true);
            tool.uniform = true;
            tool.set_half(0, 2.5);
            let before = voxels(&harness);
            drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
            assert_eq!(voxels(&harness) - before, copies * 125, "{symmetry} {notches}");
        }
    }
}

#[test]
fn a_snapping_tool_stands_on_the_surface_and_never_in_it() {
    let mut harness = bench::bench();
    rest(&mut harness);
    rough(&mut harness);
    let tool = &mut harness.state_mut().editor.tool;
    (tool.solid, tool.stand, tool.snap) = (Solid::Cuboid, true, true);
    for at in places(&harness) {
        hover(&mut harness, at);
        let Some(gap) = gap(&harness, at) else { continue };
        assert!((-2e-3..1.0).contains(&gap), "{gap} at {at}");
    }
}

#[test]
fn the_tool_follows_keys_at_once() {
    let mut harness = bench::bench();
    rest(&mut harness);
    run(&mut harness, "place");
    harness.state_mut().editor.tool.stand = true;
    let (here, there) = (middle(&harness), middle(&harness) + vec2(90.0, 50.0));
    let centre = |harness: &Bench| harness.state().editor.tool.centre_vx;
    for (spray, solid, wanted) in [
        (Key::B, Key::C, Solid::Cuboid),
        (Key::D, Key::E, Solid::Ellipsoid),
        (Key::S, Key::P, Solid::Pyramid),
        (Key::Q, Key::C, Solid::Cuboid),
    ] {
        hover(&mut harness, here);
        key(&mut harness, Modifiers::NONE, spray);
        hover(&mut harness, there);
        key(&mut harness, Modifiers::NONE, solid);
        assert_eq!(harness.state().editor.tool.solid, wanted);
        let now = centre(&harness);
        assert!(gap(&harness, there).unwrap().abs() < 2e-3, "{solid:?}");
        hover(&mut harness, there + vec2(0.0, 0.01));
        assert!(centre(&harness).abs_diff_eq(now, 0.05), "{solid:?}: it had not moved");
    }
    // Sizes, by key, by wheel and by number, with the pointer over the picture or gone from it.
    key(&mut harness, Modifiers::NONE, Key::C);
    for grow in [Key::CloseBracket, Key::CloseBracket, Key::OpenBracket] {
        key(&mut harness, Modifiers::NONE, grow);
        assert!(gap(&harness, there).unwrap().abs() < 2e-3);
    }
    bench::wheel(&mut harness, Modifiers::COMMAND, there, 2.0);
    assert!(gap(&harness, there).unwrap().abs() < 2e-3);
    send(&mut harness, Event::PointerGone);
    harness.state_mut().editor.tool.scale_by(1.7);
    harness.step();
    assert!(gap(&harness, there).unwrap().abs() < 2e-3);
    harness.state_mut().editor.tool.set_turn_deg(Vec3::new(0.0, 0.0, 30.0));
    harness.step();
    assert!(gap(&harness, there).unwrap().abs() < 2e-3);
    harness.state_mut().editor.tool.stand = false;
    harness.step();
    let (face, plane) = face_at(&harness, there).unwrap();
    assert!((centre(&harness).dot(face) - plane).abs() < 2e-3, "half in the surface again");
}

#[test]
fn a_tool_moved_by_keys_stays_where_it_was_put() {
    let mut harness = bench::bench();
    rest(&mut harness);
    let at = middle(&harness);
    hover(&mut harness, at);
    key(&mut harness, Modifiers::NONE, Key::ArrowRight);
    let put = harness.state().editor.tool.centre_vx;
    for k in [Key::CloseBracket, Key::T, Key::R, Key::G] {
        key(&mut harness, Modifiers::NONE, k);
        assert_eq!(harness.state().editor.tool.centre_vx, put, "{k:?}");
    }
    key(&mut harness, Modifiers::SHIFT, Key::Home);
    assert_eq!(harness.state().editor.tool.centre_vx, Vec3::splat(32.0));
    // It stays where it is while it does not follow, and comes when it does.
    key(&mut harness, Modifiers::NONE, Key::F);
    key(&mut harness, Modifiers::NONE, Key::C);
    assert_eq!(harness.state().editor.tool.centre_vx, Vec3::splat(32.0));
    key(&mut harness, Modifiers::NONE, Key::F);
    assert!(gap(&harness, at).is_some());
    assert_ne!(harness.state().editor.tool.centre_vx, Vec3::splat(32.0));
    // Beside the sculpture there is nothing to follow.
    let beside = corner(&harness);
    hover(&mut harness, beside);
    let left = harness.state().editor.tool.centre_vx;
    key(&mut harness, Modifiers::NONE, Key::E);
    assert_eq!(harness.state().editor.tool.centre_vx, left);
}

/// A block on the left that ends in a cliff, and a plain far below it on the right, seen from above.
fn cliff() -> Bench {
    let mut harness = bench::bench();
    rest(&mut harness);
    run(&mut harness, "place");
    run(&mut harness, "subtract cuboid at=48,32,36 half=16,32,28");
    let tool = &mut harness.state_mut().editor.tool;
    (tool.kind, tool.solid, tool.mode) = (ToolKind::Solid, Solid::Ellipsoid, ToolMode::Subtract);
    tool.uniform = true;
    tool.set_half(0, 3.0);
    harness
}

fn space(harness: &mut Bench, pressed: bool) {
    let modifiers = Modifiers::NONE;
    let key = Key::Space;
    send(harness, Event::Key { key, physical_key: None, pressed, repeat: false, modifiers });
}

fn is_opaque(harness: &Bench, x: i32, y: i32, z: i32) -> bool {
    harness.state().session().document().grid().get(IVec3::new(x, y, z))
}

#[test]
fn a_leap_of_the_hovering_pointer_with_the_key_held_cuts_what_a_drag_cuts() {
    let (above, below) = (Vec3::new(16.0, 32.0, 64.0), Vec3::new(54.0, 32.0, 8.0));
    let mut dragged = cliff();
    let path = [screen(&dragged, above), screen(&dragged, below)];
    drag(&mut dragged, PointerButton::Primary, Modifiers::NONE, &path);

    let mut held = cliff();
    hover(&mut held, path[0]);
    space(&mut held, true);
    assert!(held.state().editor.is_stroking());
    hover(&mut held, path[1]);
    space(&mut held, false);
    assert!(!held.state().editor.is_stroking() && bench::undo_count(&held) == 2);

    assert!((20..28).all(|x| is_opaque(&held, x, 32, 53)), "no tunnel from one to the other");
    assert!(!is_opaque(&held, 24, 32, 63), "a groove over the block");
    assert!(!is_opaque(&held, 54, 32, 7), "and over the plain");
    let grid = |harness: &Bench| harness.state().session().document().grid().clone();
    assert!(grid(&held) == grid(&dragged), "{} and {}", voxels(&held), voxels(&dragged));
}

#[test]
fn a_hovering_pointer_that_takes_over_from_keys_or_another_view_cuts_no_tunnel() {
    let mut harness = cliff();
    let at = screen(&harness, Vec3::new(16.0, 32.0, 64.0));
    hover(&mut harness, at);
    space(&mut harness, true);
    // Keys move the tool along the surface, the pointer comes from elsewhere.
    (0..4).for_each(|_| key(&mut harness, Modifiers::NONE, Key::ArrowUp));
    assert!(!is_opaque(&harness, 16, 36, 63), "a groove");
    let plain = screen(&harness, Vec3::new(54.0, 36.0, 8.0));
    hover(&mut harness, plain);
    assert!(!is_opaque(&harness, 54, 36, 7) && is_opaque(&harness, 28, 36, 46), "no tunnel");
    // Half a turn about y shows the back.
    run(&mut harness, "place turn=0,1,0,0");
    let back = screen(&harness, Vec3::new(16.0, 32.0, 0.0));
    hover(&mut harness, back);
    space(&mut harness, false);
    assert!(!is_opaque(&harness, 16, 32, 0), "the tool goes on there");
    assert!((0..7).all(|i| is_opaque(&harness, 40 - 4 * i, 34, 5)), "no tunnel");
}

/// In an empty grid the pointer leads the tool at the depth at which it was used or put last, and a number puts it anywhere.
#[test]
fn a_tool_in_an_empty_grid_keeps_its_depth_and_takes_numbers() {
    let mut harness = bench::bench();
    rest(&mut harness);
    bench::run(&mut harness, "clear grid");
    bench::run(&mut harness, "place turn=0,0,0");
    let depth = |harness: &Bench| {
        let bench = harness.state();
        let sight = virtual_sculpture::picking::Sight::new(&bench.eye(), &bench.world_from_grid());
        sight.depth(bench.editor.tool.centre_vx)
    };
    let centre = bench::middle(&harness);
    bench::run(&mut harness, "place turn=25,40,0");
    send(&mut harness, Event::PointerMoved(centre));
    let before = depth(&harness);
    for i in -8..=8 {
        send(&mut harness, Event::PointerMoved(centre + vec2(i as f32 * 14.0, 3.0)));
        let now = depth(&harness);
        assert!((now - before).abs() < 0.01 * before, "{now} after {before} at {i}");
    }
    // Put nearer by a number, from where the pointer then leads it.
    harness.state_mut().editor.edit_tool(ToolEdit::Place(Vec3::new(20.0, 30.0, 50.0)));
    let tool = &harness.state().editor.tool;
    assert_eq!((tool.centre_vx, tool.follow), (Vec3::new(20.0, 30.0, 50.0), false));
    let before = depth(&harness);
    harness.state_mut().editor.tool.edit(ToolEdit::Follow(true));
    for i in -2..=2 {
        send(&mut harness, Event::PointerMoved(centre + vec2(i as f32 * 14.0, 3.0)));
        let now = depth(&harness);
        assert!((now - before).abs() < 0.01 * before, "{now} after {before} at {i}");
    }
    assert!(harness.get_all_by_role(egui::accesskit::Role::SpinButton).count() >= 9);
}
