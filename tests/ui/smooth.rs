//! Smoothing in the view: by a strength, for as long as the button is held, on the scale of the brush; and the unit in which
//! the sizes of all brushes are given.

use egui::{Event, Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use glam::{IVec3, Vec3};
use virtual_sculpture::editor::sizes::SizeUnit;
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::input::Action;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::keys::{RADIUS, STRENGTH};

use super::bench::{
    Bench, bench_of, config, drag, key, look, rest, run, screen, send, undo_count, voxels, wheel,
};

const FLOOR: i32 = 40;

/// A floor with a post on it, 20 voxels wide and high, seen from the front; smooth in hand.
fn nub() -> Bench {
    let mut harness = bench_of(&config(96), vec2(1280.0, 800.0));
    rest(&mut harness);
    run(&mut harness, "place");
    run(&mut harness, "subtract cuboid at=48,48,68 half=48,48,28");
    run(&mut harness, "add cuboid at=48,48,50 half=10,10,10");
    harness.state_mut().editor.tool.kind = ToolKind::Brush(BrushId::Smooth);
    harness
}

/// Voxels above the floor.
fn left(harness: &Bench) -> usize {
    let grid = harness.state().session().document().grid();
    let all = (0..96 * 96 * 96).map(|i| grid.voxel_coords(i).as_ivec3());
    all.filter(|v: &IVec3| v.z >= FLOOR && grid.get(*v)).count()
}

/// How far the highest voxel is above the floor.
fn height(harness: &Bench) -> i32 {
    let grid = harness.state().session().document().grid();
    let layer = |z: i32| (0..96 * 96).map(move |i| IVec3::new(i % 96, i / 96, z));
    (FLOOR..96).rev().find(|z| layer(*z).any(|v| grid.get(v))).map_or(0, |z| z + 1 - FLOOR)
}

fn button(harness: &mut Bench, pos: egui::Pos2, pressed: bool) {
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    send(harness, Event::PointerButton { pos, button, pressed, modifiers });
    look(harness);
}

#[test]
fn a_nub_as_large_as_the_brush_is_levelled_by_eight_scrubs_and_the_floor_stays() {
    for unit in SizeUnit::ALL {
        let mut harness = nub();
        let middle = screen(&harness, Vec3::new(48.0, 48.0, 60.0));
        let rim = screen(&harness, Vec3::new(58.0, 48.0, 60.0));
        let tool = &mut harness.state_mut().editor.tool;
        tool.edit(virtual_sculpture::editor::tool::ToolEdit::SizeUnit(unit));
        let smooth = tool.brushes.of_mut(BrushId::Smooth);
        smooth.set(STRENGTH, 1.0);
        smooth.set(RADIUS, if unit == SizeUnit::Screen { rim.x - middle.x } else { 10.0 });
        let before = undo_count(&harness);
        let far = rim.x - middle.x;
        for aside in [0.35, -0.35, 0.9, -0.9] {
            for flip in [false, true] {
                let path = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|along| {
                    let offset = vec2(along, aside) * far;
                    middle + if flip { offset.yx() } else { offset }
                });
                drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &path);
            }
        }
        assert!(height(&harness) <= 4, "{unit:?}: {} of 20 voxels are left", height(&harness));
        // Beyond the brush the floor is as it was.
        let grid = harness.state().session().document().grid();
        let plane = (0..96 * 96).map(|i| IVec3::new(i % 96, i / 96, FLOOR - 1));
        let beside = plane.filter(|v| (v.x - 48).abs().max((v.y - 48).abs()) > 34);
        assert!(beside.into_iter().all(|v| grid.get(v)));
        assert_eq!(undo_count(&harness), before + 8);
    }
}

#[test]
fn it_goes_on_while_the_button_is_held_and_is_one_step() {
    let mut harness = nub();
    let at = screen(&harness, Vec3::new(48.0, 48.0, 60.0));
    harness.state_mut().editor.tool.brushes.of_mut(BrushId::Smooth).set(RADIUS, 60.0);
    let (before, steps) = (voxels(&harness), undo_count(&harness));
    send(&mut harness, Event::PointerMoved(at));
    button(&mut harness, at, true);
    let mut amounts = vec![voxels(&harness)];
    for _ in 0..6 {
        harness.run_steps(2);
        amounts.push(voxels(&harness));
    }
    assert!(amounts[0] < before && amounts.is_sorted_by(|a, b| a >= b), "{before} {amounts:?}");
    assert!(2 * (before - amounts[6]) > 3 * (before - amounts[0]), "{before} {amounts:?}");
    button(&mut harness, at, false);
    let after = voxels(&harness);
    harness.run_steps(4);
    assert_eq!((voxels(&harness), undo_count(&harness)), (after, steps + 1));
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!((voxels(&harness), left(&harness)), (before, 8000));
    // Other brushes do not.
    harness.state_mut().editor.tool.kind = ToolKind::Brush(BrushId::Erode);
    button(&mut harness, at, true);
    let once = voxels(&harness);
    harness.run_steps(4);
    assert_eq!(voxels(&harness), once);
    button(&mut harness, at, false);
}

#[test]
fn less_strength_takes_less() {
    let taken = |strength: f32| {
        let mut harness = nub();
        let at = screen(&harness, Vec3::new(48.0, 48.0, 60.0));
        let smooth = harness.state_mut().editor.tool.brushes.of_mut(BrushId::Smooth);
        *smooth = smooth.with(RADIUS, 60.0).with(STRENGTH, strength);
        send(&mut harness, Event::PointerMoved(at));
        button(&mut harness, at, true);
        button(&mut harness, at, false);
        8000 - left(&harness)
    };
    let [little, half, all] = [0.2, 0.5, 1.0].map(taken);
    assert!(0 < little && little < half && half < all, "{little} {half} {all}");
}

#[test]
fn all_brushes_have_their_sizes_in_one_unit_that_is_chosen_once() {
    let mut harness = nub();
    rest(&mut harness);
    let sizes = |harness: &Bench| {
        let tool = &harness.state().editor.tool;
        (tool.brushes.radius(BrushId::Clay), tool.brushes.ball_radius(BrushId::Draw))
    };
    let (clay, ball) = sizes(&harness);
    harness.get_by_label("Sculpture").click();
    harness.run_steps(3);
    assert_eq!(harness.state().editor.tool.brushes.unit, SizeUnit::Sculpture);
    let (clay_vx, ball_vx) = sizes(&harness);
    assert!(clay_vx < clay && (ball - ball_vx).abs() < 0.1, "they stay as large: {ball} {ball_vx}");
    // Nearer it is the same in the sculpture.
    let at = screen(&harness, Vec3::new(48.0, 48.0, 60.0));
    wheel(&mut harness, Modifiers::NONE, at, 4.0);
    harness.run_steps(2);
    assert_eq!(sizes(&harness), (clay_vx, ball_vx));
    // The same choice in the options of a brush that deforms.
    harness.state_mut().act(Action::Brush(BrushId::Draw));
    harness.run_steps(2);
    harness.get_by_label("Screen").click();
    harness.run_steps(3);
    let (clay_px, nearer) = sizes(&harness);
    assert!(clay_px > clay, "as large as in the picture now: {clay_px}");
    assert!((nearer - ball_vx).abs() < 0.5, "{nearer} {ball_vx}");
}
