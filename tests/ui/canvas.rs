//! A box that grows in the view: strokes go on where they were, the camera stays, and the window of the canvas does what
//! its buttons say.

use egui::{Event, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use glam::{IVec3, Quat, UVec3, Vec3};
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::input::{Action, DrawKind, ToolMode};
use virtual_sculpture::tools::brush::BrushId;

use super::bench::{
    Bench, bench_of, click, config, has, key, look, rest, run, screen, send, undo_count,
};

const EDGE: u32 = 32;
/// The room of a box that need not grow.
const ROOM: u32 = 64;

/// A stone in a box that grows, and the same stone in one with room, seen alike: towards the low sides of all axes.
fn growing_and_roomy() -> [Bench; 2] {
    let [mut growing, mut roomy] = [config(EDGE), config(EDGE)];
    (growing.new.grow, roomy.new.room) = (true, ROOM);
    let [mut growing, mut roomy] =
        [growing, roomy].map(|config| bench_of(&config, vec2(1280.0, 800.0)));
    let q = Quat::from_euler(glam::EulerRot::YXZ, 2.6, -0.5, 0.2);
    for harness in [&mut growing, &mut roomy] {
        rest(harness);
        run(harness, &format!("place turn={},{},{},{}", q.x, q.y, q.z, q.w));
    }
    let camera = growing.state().viewpoint.turntable;
    roomy.state_mut().viewpoint.turntable = camera;
    let mut both = [growing, roomy];
    both.iter_mut().for_each(look);
    both
}

fn exists(harness: &Bench, v: IVec3) -> bool {
    let document = harness.state().session().document();
    document.grid().get(v - document.origin())
}

/// The voxels within the room that only one of two sculptures has, and those that either has outside of the stone.
fn difference(a: &Bench, b: &Bench) -> [usize; 2] {
    let (low, high) = (-(ROOM as i32), (EDGE + ROOM) as i32);
    let mut counts = [0; 2];
    for z in low..high {
        for y in low..high {
            for x in low..high {
                let v = IVec3::new(x, y, z);
                let (one, other) = (exists(a, v), exists(b, v));
                let is_outside = v.min_element() < 0 || v.max_element() >= EDGE as i32;
                counts[0] += usize::from(one != other);
                counts[1] += usize::from(is_outside && (one || other));
            }
        }
    }
    counts
}

/// Drags over the picture. `looks`: a picture is shown after each movement, or only when the hand rests.
fn drag(harness: &mut Bench, path: &[Pos2], looks: bool) {
    let press = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    send(harness, Event::PointerMoved(path[0]));
    look(harness);
    send(harness, press(path[0], true));
    for (at, &pos) in path.iter().enumerate() {
        if looks || at % 4 == 3 {
            look(harness);
        }
        send(harness, Event::PointerMoved(pos));
    }
    send(harness, press(path[path.len() - 1], false));
    look(harness);
}

#[test]
fn a_stroke_goes_on_where_it_was_while_the_box_grows_under_it() {
    let tools: [(ToolKind, ToolMode); 6] = [
        (ToolKind::Solid, ToolMode::Add),
        (ToolKind::Brush(BrushId::Clay), ToolMode::Add),
        (ToolKind::Brush(BrushId::Draw), ToolMode::Add),
        (ToolKind::Brush(BrushId::Inflate), ToolMode::Add),
        (ToolKind::Brush(BrushId::Grab), ToolMode::Add),
        (ToolKind::Draw(DrawKind::Line), ToolMode::Add),
    ];
    for (kind, mode) in tools {
        for looks in [true, false] {
            let [mut growing, mut roomy] = growing_and_roomy();
            for harness in [&mut growing, &mut roomy] {
                harness.state_mut().act(Action::Mode(mode));
                harness.state_mut().editor.tool.kind = kind;
                rest(harness);
                // Across an edge, so that more than one side moves, and out over the silhouette.
                let corner = |v: [f32; 3]| Vec3::from(v) * EDGE as f32;
                let from = screen_of(harness, corner([0.0, 0.3, 0.4]));
                let to = match kind {
                    // It pulls the clay out.
                    ToolKind::Brush(BrushId::Grab) => {
                        from.lerp(screen_of(harness, corner([0.5; 3])), -2.0)
                    }
                    _ => screen_of(harness, corner([0.6, 0.4, 0.0])),
                };
                let path: Vec<Pos2> = (0..=24).map(|i| from.lerp(to, i as f32 / 24.0)).collect();
                drag(harness, &path, looks);
            }
            let document = growing.state().session().document();
            let has_grown = document.origin() != IVec3::ZERO;
            let [differing, outside] = difference(&growing, &roomy);
            let name = format!("{kind:?}, {looks}: {differing} of {outside} differ");
            assert!(has_grown && outside > 20, "{name}");
            // Coordinates with another origin are rounded elsewhere, and a brush that works in the picture waits for one
            // of the larger box.
            let most = if looks { outside / 50 } else { outside / 10 };
            assert!(differing <= most, "{name}");
            assert_eq!(undo_count(&growing), 1, "{name}");
            assert_eq!(growing.state().viewpoint.turntable, roomy.state().viewpoint.turntable);
            growing.state_mut().act(Action::Undo);
            rest(&mut growing);
            let document = growing.state().session().document();
            assert_eq!(document.grid().dims(), UVec3::splat(EDGE), "{name}");
            assert_eq!(document.grid().opaque_count(), u64::from(EDGE).pow(3), "{name}");
        }
    }
}

/// The position on screen of a point in signed coordinates.
fn screen_of(harness: &Bench, point: Vec3) -> Pos2 {
    let origin = harness.state().session().document().origin();
    screen(harness, point - origin.as_vec3())
}

#[test]
fn a_stroke_that_is_cancelled_leaves_the_former_box_and_the_tool_on_it() {
    let [mut growing, _] = growing_and_roomy();
    growing.state_mut().act(Action::Mode(ToolMode::Add));
    rest(&mut growing);
    let at = screen_of(&growing, Vec3::new(0.0, 10.0, 10.0));
    send(&mut growing, Event::PointerMoved(at));
    let before = growing.state().editor.tool.centre_vx;
    let (pos, button, modifiers) = (at, PointerButton::Primary, Modifiers::NONE);
    send(&mut growing, Event::PointerButton { pos, button, pressed: true, modifiers });
    assert_ne!(growing.state().session().document().origin(), IVec3::ZERO);
    key(&mut growing, Modifiers::NONE, egui::Key::Escape);
    let document = growing.state().session().document();
    assert_eq!((document.origin(), document.grid().dims()), (IVec3::ZERO, UVec3::splat(EDGE)));
    let after = growing.state().editor.tool.centre_vx;
    assert!(after.abs_diff_eq(before, 1e-3), "{before} {after}");
}

#[test]
fn the_window_of_the_canvas_grows_crops_and_resamples() {
    let [mut harness, _] = growing_and_roomy();
    let camera = harness.state().viewpoint.turntable;
    harness.state_mut().act(Action::Canvas);
    rest(&mut harness);
    assert!(has(&harness, "32 × 32 × 32 voxels, from 0, 0, 0"));
    assert!(has(&harness, "Tool 16 16 16"));
    click(&mut harness, "Grow");
    assert!(has(&harness, "160 × 160 × 160 voxels, from -64, -64, -64"));
    assert_eq!(harness.state().editor.tool.centre_vx, Vec3::splat(80.0));
    assert!(has(&harness, "Tool 16 16 16"), "coordinates stay what they are");
    assert_eq!(harness.state().viewpoint.turntable, camera, "the view stays");
    click(&mut harness, "Crop to content");
    assert!(has(&harness, "32 × 32 × 32 voxels, from 0, 0, 0"));
    click(&mut harness, "Grow as needed");
    let grows = |harness: &Bench| harness.state().session().document().contents().frame.grows;
    assert!(!grows(&harness));
    click(&mut harness, "Half");
    let document = harness.state().session().document();
    assert_eq!(document.grid().dims(), UVec3::splat(16));
    assert_eq!(document.grid().voxel_size(), Vec3::splat(2.0));
    for _ in 0..4 {
        harness.state_mut().act(Action::Undo);
        rest(&mut harness);
    }
    assert!(grows(&harness));
    assert!(harness.query_by_label("32 × 32 × 32 voxels, from 0, 0, 0").is_some());
}
