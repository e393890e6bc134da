//! Symmetry in the interface: a mirror plane and an axis of rotation, placed by key, by a press and by numbers.

use egui::{Event, Key, Modifiers};
use glam::{IVec3, Vec3};
use virtual_sculpture::editor::symmetry::SymmetryPart;
use virtual_sculpture::editor::tool::NextPress;
use virtual_sculpture::tools::symmetry::Symmetry;

use super::bench::{
    Bench, bench_of, click, config, corner, has, key, middle, press, rest, run, screen, send,
    voxels,
};

const FULL: u64 = 64 * 64 * 64;

/// A workspace with a solid block of 64^3 voxels, seen from the front, with the options of symmetry open.
fn front() -> Bench {
    let mut harness = bench_of(&config(64), egui::vec2(1280.0, 1200.0));
    rest(&mut harness);
    run(&mut harness, "place");
    click(&mut harness, "Symmetry and array");
    harness
}

fn symmetry(harness: &Bench) -> Symmetry {
    harness.state().session().document().symmetry()
}

fn press_at(harness: &mut Bench, at: Vec3) {
    let pos = screen(harness, at);
    press(harness, pos);
}

fn is_cut(harness: &Bench, v: [i32; 3]) -> bool {
    !harness.state().session().document().grid().get(IVec3::from(v))
}

#[test]
fn a_plane_is_toggled_and_placed_along_the_line_of_sight() {
    let mut harness = front();
    key(&mut harness, Modifiers::NONE, Key::Num4);
    assert_eq!(symmetry(&harness).plane.unwrap().normal, Vec3::X);
    press_at(&mut harness, Vec3::new(20.0, 32.0, 64.0));
    assert!(is_cut(&harness, [20, 32, 63]) && is_cut(&harness, [43, 32, 63]));
    assert!(!is_cut(&harness, [32, 32, 63]));
    run(&mut harness, "undo");
    key(&mut harness, Modifiers::NONE, Key::Num4);
    assert!(symmetry(&harness).plane.is_none());
    // Seen from the front, a plane through a press lies across x; the press uses no tool.
    click(&mut harness, "Place plane");
    assert_eq!(
        harness.state().editor.tool.next_press,
        Some(NextPress::Symmetry(SymmetryPart::Plane))
    );
    press_at(&mut harness, Vec3::new(32.0, 20.0, 64.0));
    let plane = symmetry(&harness).plane.unwrap();
    assert_eq!((plane.normal, plane.at_vx.x), (Vec3::X, 32.0));
    assert_eq!(voxels(&harness), FULL);
    // Turned about the vertical by 45 degrees, it is the diagonal one.
    run(&mut harness, "place turn=0,45,0");
    click(&mut harness, "Place plane");
    press_at(&mut harness, Vec3::new(0.0, 32.0, 64.0));
    let normal = symmetry(&harness).plane.unwrap().normal;
    assert!(normal.y.abs() < 0.05 && (normal.x.abs() - normal.z.abs()).abs() < 0.1, "{normal}");
    // Its numbers are shown.
    assert!(has(&harness, "Normal") && has(&harness, "At"));
    click(&mut harness, "Along y");
    assert_eq!(symmetry(&harness).plane.unwrap().normal, Vec3::Y);
    // Beside the sculpture nothing is placed, and that is said.
    click(&mut harness, "Place plane");
    let before = symmetry(&harness);
    let pos = corner(&harness);
    press(&mut harness, pos);
    assert_eq!(symmetry(&harness), before);
    assert!(harness.state().ui.toasts.texts().any(|(_, text)| text.contains("on the surface")));
}

#[test]
fn tools_are_repeated_around_an_axis_that_is_placed() {
    let mut harness = front();
    key(&mut harness, Modifiers::ALT, Key::Num4);
    let radial = symmetry(&harness).radial.unwrap();
    assert_eq!((radial.axis, radial.count, radial.at_vx), (Vec3::Y, 6, Vec3::splat(32.0)));
    click(&mut harness, "Place axis");
    press_at(&mut harness, Vec3::new(32.2, 31.9, 64.0));
    let radial = symmetry(&harness).radial.unwrap();
    assert_eq!((radial.axis, radial.at_vx.x, radial.at_vx.y), (Vec3::Z, 32.0, 32.0));
    press_at(&mut harness, Vec3::new(52.0, 32.0, 64.0));
    assert_eq!(harness.state().session().document().history().undo_count(), 1, "one step");
    for k in 0..6 {
        let (sin, cos) = (k as f32 * std::f32::consts::TAU / 6.0).sin_cos();
        let v = [(32.0 + 20.0 * cos) as i32, (32.0 + 20.0 * sin) as i32, 63];
        assert!(is_cut(&harness, v), "{v:?}");
    }
    assert!(!is_cut(&harness, [32, 32, 63]));
    let at = middle(&harness);
    send(&mut harness, Event::PointerMoved(at));
    key(&mut harness, Modifiers::ALT, Key::Num4);
    assert!(symmetry(&harness).radial.is_none());
}
