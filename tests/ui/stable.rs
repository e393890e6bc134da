//! Widgets stay where they are while they are used, and help covers nothing that it speaks of.

use egui::{Rect, Vec2, vec2};
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use virtual_sculpture::input::Action;
use virtual_sculpture::sculpture::Rgb;

use super::bench::{Bench, bench_of, config, has, look, rest, run, screen};

fn places(harness: &Bench, labels: &[&str]) -> Vec<Rect> {
    labels.iter().map(|label| harness.get_all_by_label(label).last().unwrap().rect()).collect()
}

fn act(harness: &mut Bench, action: Action) {
    harness.state_mut().act(action);
    rest(harness);
}

#[test]
fn nothing_moves_as_colours_are_used() {
    let mut harness = bench_of(&config(32), vec2(1280.0, 1000.0));
    rest(&mut harness);
    let labels = ["Follow the pointer", "Snap to voxels", "Symmetry and array"];
    let before = places(&harness, &labels);
    for i in 0..20_u8 {
        let tool = &mut harness.state_mut().editor.tool;
        tool.colour = Rgb([i, 200, 9]);
        tool.used_colour();
        rest(&mut harness);
        assert_eq!(places(&harness, &labels), before, "after {} colours", i + 1);
    }
    // All of them are there.
    for colour in harness.state().editor.tool.recent() {
        harness.get_all_by_label(&colour.to_string()).next().unwrap();
    }
}

#[test]
fn nothing_moves_as_boxes_are_selected_and_copied() {
    let mut harness = bench_of(&config(32), vec2(1280.0, 1000.0));
    act(&mut harness, Action::Marker);
    let labels = [
        "Add",
        "Subtract",
        "Deselect all",
        "Limit tools to selection",
        "Copy",
        "Paste",
        "Symmetry and array",
    ];
    let before = places(&harness, &labels);
    for i in 0..9 {
        run(&mut harness, &format!("mark at={i},{i},{i} size=4,4,4"));
        run(&mut harness, "select add");
        if i == 4 {
            run(&mut harness, "copy");
        }
        rest(&mut harness);
        assert_eq!(places(&harness, &labels), before, "with {} boxes", i + 1);
    }
    assert!(has(&harness, "Remove"), "the last one is seen");
    run(&mut harness, "select clear");
    rest(&mut harness);
    assert_eq!(places(&harness, &labels), before);
}

#[test]
fn first_steps_cover_no_corner_of_the_block_and_leave_the_picture_as_large() {
    for size in [vec2(1280.0, 800.0), vec2(1024.0, 600.0), vec2(1920.0, 1080.0)] {
        block_is_seen(size);
    }
}

fn block_is_seen(size: Vec2) {
    let mut harness = bench_of(&config(64), size);
    harness.state_mut().ui.dialogs.guide.open = true;
    rest(&mut harness);
    act(&mut harness, Action::ResetView);
    look(&mut harness);
    let skip = harness.get_by_label("Skip").rect();
    let picture = harness.state().picture();
    assert!(!picture.intersects(skip), "{size}: {skip:?} in {picture:?}");
    for corner in 0..8 {
        let at = Vec3::new((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32);
        let at = screen(&harness, at * 64.0);
        assert!(picture.contains(at), "{size}: {at:?} outside {picture:?}");
    }
    let windows = harness.ctx.memory(|memory| {
        let layers = memory.areas().visible_layer_ids().into_iter();
        layers.filter(|layer| layer.order == egui::Order::Middle).count()
    });
    assert_eq!(windows, 0, "no window lies over it");
    for step in 2..=7 {
        harness.get_by_label("Skip").click();
        rest(&mut harness);
        harness.get_by_label_contains(&format!("{step}. ")).rect();
        assert_eq!(harness.state().picture(), picture, "{size}, step {step}");
    }
}
