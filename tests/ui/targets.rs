//! The size of what is clicked, the words on it, and how long a click may take.

use egui::accesskit::Role;
use egui::{Event, Modifiers, PointerButton, Rect, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use virtual_sculpture::input::{Action, DrawKind};
use virtual_sculpture::tools::brush::BrushId;

use super::bench::{Bench, bench, bench_of, click, config, rest, run, send};

/// The least side of what is clicked, in points.
const LEAST: f32 = 23.9;

/// All that can be pressed, with its name.
fn pressable(harness: &Bench) -> Vec<(String, Rect)> {
    let roles = [Role::Button, Role::CheckBox, Role::RadioButton, Role::ComboBox, Role::ColorWell];
    let mut found = Vec::new();
    for role in roles {
        for node in harness.query_all_by_role(role) {
            let name = node.accesskit_node().label().unwrap_or_default();
            found.push((name, node.rect()));
        }
    }
    found
}

#[test]
fn everything_that_is_clicked_has_at_least_24_points_a_side() {
    let mut harness = bench_of(&config(64), vec2(1280.0, 1600.0));
    rest(&mut harness);
    for title in ["Symmetry and array", "View", "Head tracking and AR", "Light"] {
        click(&mut harness, title);
    }
    run(&mut harness, "select add");
    run(&mut harness, "copy");
    let tools = [
        Action::Solid(virtual_sculpture::tools::solid::Solid::Cuboid),
        Action::Mode(virtual_sculpture::input::ToolMode::Recolour),
        Action::Marker,
        Action::Brush(BrushId::Paint),
        Action::Brush(BrushId::Smooth),
        Action::Draw(DrawKind::Text),
        Action::Brush(BrushId::Draw),
    ];
    for tool in tools {
        harness.state_mut().act(tool);
        rest(&mut harness);
        let pressable = pressable(&harness);
        assert!(pressable.len() > 60, "{} found", pressable.len());
        for (name, rect) in pressable {
            assert!(rect.width() >= LEAST && rect.height() >= LEAST, "{tool:?}, {name}: {rect:?}");
        }
    }
}

/// All texts that were drawn, with where they are.
fn texts(harness: &Bench) -> Vec<(String, Rect)> {
    let shapes = harness.output().shapes.iter();
    shapes
        .filter_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) => {
                let rect = text.galley.rect.translate(text.pos.to_vec2());
                Some((text.galley.text().to_string(), rect.intersect(clipped.clip_rect)))
            }
            _ => None,
        })
        .collect()
}

#[test]
fn the_menu_shows_the_keys_of_its_actions() {
    let mut harness = bench();
    rest(&mut harness);
    let shown = |harness: &Bench, text: &str| texts(harness).iter().any(|(own, _)| own == text);
    assert!(!shown(&harness, "Ctrl+Q"));
    click(&mut harness, "Menu");
    for keys in ["Ctrl+Q", "Ctrl+P", "F12", "Shift+F12", "F11"] {
        assert!(shown(&harness, keys), "{keys}: {:?}", texts(&harness));
    }
    // They are beside the name, not a part of it.
    harness.get_by_label("Quit").hover();
    click(&mut harness, "View ⏵");
    harness.get_by_label("Orthographic").rect();
    assert!(shown(&harness, "Home"), "{:?}", texts(&harness));
}

#[test]
fn names_are_written_as_their_owners_write_them_and_whole() {
    let mut harness = bench();
    rest(&mut harness);
    click(&mut harness, "Menu");
    click(&mut harness, "Controls ⏵");
    harness.get_by_label("MagicaVoxel").rect();
    let mut harness = bench_of(&config(32), vec2(1280.0, 1600.0));
    rest(&mut harness);
    click(&mut harness, "View");
    let panel = harness.state().picture().right();
    for label in ["Grid outline", "Floor grid", "Ground", "Show mask", "Axis gizmo"] {
        let drawn = texts(&harness);
        let (_, rect) = drawn.iter().find(|(text, _)| text == label).expect(label);
        let whole = harness.get_by_label(label).rect();
        assert!(rect.right() <= 1276.0 && rect.left() > panel, "{label}: {rect:?}");
        assert!(whole.right() <= 1276.0, "{label}: {whole:?}");
    }
}

/// Seconds go by where the machine is busy, and the press is heard long before the release.
#[test]
fn a_click_counts_however_long_it_takes() {
    let mut harness = bench();
    rest(&mut harness);
    let pos = harness.get_by_label("New").rect().center();
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    send(&mut harness, Event::PointerMoved(pos));
    send(&mut harness, Event::PointerButton { pos, button, pressed: true, modifiers });
    let now_s = harness.ctx.input(|input| input.time);
    harness.input_mut().time = Some(now_s + 5.0);
    send(&mut harness, Event::PointerButton { pos, button, pressed: false, modifiers });
    // From here on time passes by steps again.
    harness.input_mut().time = None;
    rest(&mut harness);
    assert!(harness.state().ui.dialogs.new.open);
}
