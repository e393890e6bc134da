//! Flood fills where one presses, and the window of colours: each is one command that undo takes back.

use egui::{Event, Key, Modifiers};
use virtual_sculpture::sculpture::Rgb;

use super::bench::{
    Bench, bench, click, click_once, has, key, look, middle, press, rest, run, send,
};

const RED: Rgb = Rgb::new(255, 0, 0);
const GREEN: Rgb = Rgb::new(0, 255, 0);

/// A workspace with a solid block of 64^3 voxels, seen from the front, with a red tool.
fn front() -> Bench {
    let mut harness = bench();
    rest(&mut harness);
    run(&mut harness, "place");
    harness.state_mut().editor.tool.colour = RED;
    harness
}

fn colour_at(harness: &Bench, v: [u32; 3]) -> Rgb {
    harness.state().session().document().contents().rgb(v.into())
}

fn last_step(harness: &Bench) -> String {
    let document = harness.state().session().document();
    document.history().undo_labels().last().unwrap_or_default().to_string()
}

#[test]
fn a_patch_is_flooded_by_key_and_by_the_next_press() {
    let mut harness = front();
    run(&mut harness, "recolour cuboid at=32,32,32 half=40,8,40 colour=#00ff00");
    let at = middle(&harness);
    send(&mut harness, Event::PointerMoved(at));
    look(&mut harness);
    key(&mut harness, Modifiers::ALT, Key::F);
    assert_eq!(last_step(&harness), "flood");
    assert_eq!(colour_at(&harness, [0, 32, 32]), RED, "around the belt");
    assert_eq!(colour_at(&harness, [32, 32, 32]), GREEN, "not inside");
    assert_eq!(colour_at(&harness, [32, 50, 63]), Rgb::STONE);
    assert_eq!(harness.state().editor.tool.recent()[0], RED);
    run(&mut harness, "undo");
    assert_eq!(colour_at(&harness, [0, 32, 32]), GREEN);
    // Chosen, the next press floods and uses no tool; the one after that uses the tool.
    harness.state_mut().editor.tool.flood_tolerance = 1.0;
    click(&mut harness, "💧 Flood");
    press(&mut harness, at);
    assert_eq!(last_step(&harness), "flood");
    assert_eq!(colour_at(&harness, [32, 50, 63]), RED, "all colours are alike enough");
    assert_eq!(harness.state().editor.tool.next_press, None);
    press(&mut harness, at);
    assert_ne!(last_step(&harness), "flood");
}

#[test]
fn the_window_of_colours_adjusts_blends_and_speckles() {
    let mut harness = front();
    key(&mut harness, Modifiers::ALT, Key::C);
    rest(&mut harness);
    click_once(&mut harness, "Apply");
    assert_eq!(last_step(&harness), "", "nothing is adjusted yet");
    click(&mut harness, "Gradient");
    click(&mut harness, "Swap");
    click_once(&mut harness, "Apply");
    assert_eq!(last_step(&harness), "gradient");
    let [bottom, top] = [[5, 0, 5], [5, 63, 5]].map(|v| colour_at(&harness, v));
    assert!(bottom.0[0] > 220 && top.0[0] < 70, "{bottom} {top}");
    assert_eq!(bottom, colour_at(&harness, [60, 0, 33]));
    // Of the marker alone, and by the menu.
    run(&mut harness, "mark at=0,0,0 size=8,8,8");
    click(&mut harness, "Noise");
    click(&mut harness, "Marker's box");
    let before = colour_at(&harness, [9, 9, 9]);
    run(&mut harness, "undo");
    click_once(&mut harness, "Apply");
    assert_eq!(last_step(&harness), "noise marker");
    assert!((0..8).any(|x| colour_at(&harness, [x, 3, 3]) != Rgb::STONE));
    assert_eq!(colour_at(&harness, [9, 9, 9]), Rgb::STONE);
    assert_ne!(before, Rgb::STONE);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!has(&harness, "Apply"));
    run(&mut harness, "new dims=16,16,16 colour=0");
    key(&mut harness, Modifiers::ALT, Key::C);
    rest(&mut harness);
    assert!(
        has(&harness, "This sculpture has only one colour; a new one can have more")
            && !has(&harness, "Apply")
    );
}
