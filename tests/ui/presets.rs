//! The presets answer what those who know other programs press first: the tables of docs/controls.md.

use std::fs;
use std::path::Path;

use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::input::{Action, Bindings, Trigger};
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::keys::{RADIUS, STRENGTH};

use super::bench::{Bench, bench, key, middle, send, undo_count};

#[test]
fn the_first_keys_do_what_the_tables_say() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/controls.md");
    let text = fs::read_to_string(path).unwrap();
    let presets = Bindings::presets().unwrap();
    let mut tables = 0;
    for table in text.split("### Preset `").skip(1) {
        let (name, rest) = table.split_once('`').unwrap();
        let bindings = presets.iter().find(|preset| preset.name == name).unwrap();
        let rest = rest.split("\n\n").nth(1).unwrap();
        let rows: Vec<Vec<&str>> = rest
            .lines()
            .filter(|line| line.contains('`'))
            .map(|line| line.split('`').skip(1).step_by(2).collect())
            .collect();
        assert!(rows.len() >= 20, "{name}: {} acts", rows.len());
        for row in rows {
            let [pressed, wanted] = row[..] else { panic!("{name}: {row:?}") };
            let trigger: Trigger = pressed.parse().unwrap();
            let action = Action::named(wanted).unwrap();
            assert_eq!(bindings.action(trigger), Some(action), "{name}: {pressed}");
        }
        tables += 1;
    }
    assert_eq!(tables, presets.len());
}

#[test]
fn no_preset_leaves_an_action_of_the_others_without_a_key() {
    let presets = Bindings::presets().unwrap();
    let has = |preset: &Bindings, action| preset.triggers(action).next().is_some();
    for preset in presets.iter().filter(|preset| preset.name != "thesis") {
        let lost: Vec<_> = Action::ALL
            .iter()
            .filter(|action| has(&presets[0], **action) && !has(preset, **action))
            .collect();
        assert!(lost.is_empty(), "{}: {lost:?}", preset.name);
    }
}

fn blender() -> Bench {
    let mut harness = bench();
    let presets = harness.state().controls.presets();
    let index = presets.iter().position(|preset| preset.name == "blender").unwrap();
    harness.state_mut().controls.preset = index;
    harness
}

fn point(harness: &mut Bench, at: Pos2) {
    send(harness, Event::PointerMoved(at));
}

fn click(harness: &mut Bench, button: PointerButton, pos: Pos2) {
    for pressed in [true, false] {
        send(harness, Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
    }
}

#[test]
fn in_blenders_preset_f_leads_the_radius_and_shift_f_the_strength() {
    let mut harness = blender();
    key(&mut harness, Modifiers::NONE, Key::B);
    assert_eq!(harness.state().editor.tool.kind, ToolKind::Brush(BrushId::Paint));
    let options = |harness: &Bench| *harness.state().editor.tool.brushes.of(BrushId::Paint);
    let follow = harness.state().editor.tool.follow;
    let at = middle(&harness);
    point(&mut harness, at);
    let before = options(&harness);
    key(&mut harness, Modifiers::NONE, Key::F);
    assert_eq!(harness.state().editor.tool.follow, follow, "it does not toggle the pointer");
    point(&mut harness, at + vec2(50.0, 10.0));
    point(&mut harness, at + vec2(100.0, 20.0));
    let led = options(&harness).get(RADIUS);
    assert!((led - before.get(RADIUS) * 2.0).abs() < 1e-3, "{led}");
    // A click keeps it and paints nothing.
    click(&mut harness, PointerButton::Primary, at + vec2(100.0, 20.0));
    assert!(!harness.state().editor.is_leading());
    assert_eq!((options(&harness).get(RADIUS), undo_count(&harness)), (led, 0));
    point(&mut harness, at);
    assert_eq!(options(&harness).get(RADIUS), led);
    click(&mut harness, PointerButton::Primary, at);
    assert_eq!(undo_count(&harness), 1, "the next click paints");
    // Escape, and another button, give back what was.
    for give_up in [None, Some(PointerButton::Middle)] {
        key(&mut harness, Modifiers::SHIFT, Key::F);
        point(&mut harness, at - vec2(100.0, 0.0));
        let cover = options(&harness).get(STRENGTH);
        assert!((cover - 0.6).abs() < 1e-3, "{cover}");
        match give_up {
            None => key(&mut harness, Modifiers::NONE, Key::Escape),
            Some(button) => click(&mut harness, button, at - vec2(100.0, 0.0)),
        }
        assert_eq!(options(&harness).get(STRENGTH), before.get(STRENGTH));
        point(&mut harness, at);
    }
}
