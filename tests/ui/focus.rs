//! Tests which part hears keys: the sculpture, or a button, a slider, a list, a field and a dialog that have the focus.

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::tools::brush::BrushId;

use super::bench::{Bench, bench, click, drag, has, key, middle, rest, send, undo_count, voxels};

fn focus(harness: &mut Bench, label: &str) {
    harness.get_by_label(label).focus();
    rest(harness);
    assert!(harness.ctx.memory(|memory| memory.focused()).is_some(), "{label}");
}

fn point_at_sculpture(harness: &mut Bench) {
    let at = middle(harness);
    send(harness, egui::Event::PointerMoved(at + vec2(3.0, 0.0)));
    send(harness, egui::Event::PointerMoved(at));
}

#[test]
fn a_button_with_the_focus_takes_enter_and_space_alone() {
    let mut harness = bench();
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    assert_eq!(undo_count(&harness), 1);
    for pressed in 1..6 {
        key(&mut harness, Modifiers::NONE, Key::Tab);
        assert!(harness.ctx.memory(|memory| memory.focused()).is_some(), "{pressed} times Tab");
    }
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(undo_count(&harness), 0, "undone with a button in focus");
    key(&mut harness, Modifiers::NONE, Key::B);
    let is_paintbrush =
        |harness: &Bench| harness.state().editor.tool.kind == ToolKind::Brush(BrushId::Paint);
    assert!(is_paintbrush(&harness), "tools are chosen");
    focus(&mut harness, "New");
    let before = harness.ctx.memory(|memory| memory.focused());
    let centre = |harness: &Bench| harness.state().editor.tool.centre_vx;
    let place = centre(&harness);
    key(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    assert_ne!(centre(&harness), place, "arrows move the tool");
    assert_eq!(harness.ctx.memory(|memory| memory.focused()), before, "and not the focus");
    let count = voxels(&harness);
    key(&mut harness, Modifiers::NONE, Key::Enter);
    rest(&mut harness);
    assert!(harness.state().ui.dialogs.new.open, "Enter presses the button");
    assert_eq!(voxels(&harness), count, "and does not carve");
}

#[test]
fn enter_once_too_often_after_a_dialog_does_not_carve() {
    let mut harness = bench();
    point_at_sculpture(&mut harness);
    for close in [Key::Enter, Key::Escape] {
        key(&mut harness, Modifiers::COMMAND, Key::N);
        rest(&mut harness);
        assert!(harness.state().ui.dialogs.new.open);
        key(&mut harness, Modifiers::NONE, close);
        rest(&mut harness);
        assert!(!harness.state().ui.dialogs.new.open, "{close:?} closes the dialog");
        let (count, steps) = (voxels(&harness), undo_count(&harness));
        for again in [Key::Enter, Key::Space, Key::Enter] {
            key(&mut harness, Modifiers::NONE, again);
            assert_eq!((voxels(&harness), undo_count(&harness)), (count, steps), "{again:?}");
        }
        // Other keys are heard.
        key(&mut harness, Modifiers::COMMAND, Key::Delete);
        assert_eq!(voxels(&harness), 0);
        key(&mut harness, Modifiers::COMMAND, Key::Z);
        // Once the pointer was over the view, they use the tool again.
        point_at_sculpture(&mut harness);
        key(&mut harness, Modifiers::NONE, Key::Enter);
        assert_eq!(undo_count(&harness), steps + 1);
    }
}

#[test]
fn enter_once_too_often_after_a_field_or_a_window_does_not_carve() {
    let mut harness = bench();
    point_at_sculpture(&mut harness);
    key(&mut harness, Modifiers::NONE, Key::F4);
    rest(&mut harness);
    focus(&mut harness, "Close window");
    let steps = undo_count(&harness);
    for _ in 0..3 {
        key(&mut harness, Modifiers::NONE, Key::Enter);
        rest(&mut harness);
    }
    assert!(!harness.state().ui.dialogs.light.open);
    assert_eq!(undo_count(&harness), steps);
}

#[test]
fn escape_in_a_list_closes_the_list_alone() {
    let mut harness = bench();
    key(&mut harness, Modifiers::NONE, Key::F1);
    rest(&mut harness);
    click(&mut harness, "Menu");
    assert!(has(&harness, "Search actions …"));
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!has(&harness, "Search actions …"));
    assert!(harness.state().ui.dialogs.keys.open, "the window stays");
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!harness.state().ui.dialogs.keys.open);
}

#[test]
fn a_decimal_comma_counts_like_a_point_in_fields_for_numbers_alone() {
    let mut harness = bench();
    // A number of the options, after those of the place: the longest side of the tool.
    let sizes: Vec<_> = harness.get_all_by_role(egui::accesskit::Role::SpinButton).collect();
    let at = sizes[3].rect().center();
    let before = harness.state().editor.tool.half();
    for pressed in [true, false] {
        send(&mut harness, egui::Event::PointerMoved(at));
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        send(&mut harness, egui::Event::PointerButton { pos: at, button, pressed, modifiers });
    }
    rest(&mut harness);
    key(&mut harness, Modifiers::COMMAND, Key::A);
    for typed in ["1", "2", ",", "5"] {
        send(&mut harness, egui::Event::Text(typed.to_string()));
    }
    key(&mut harness, Modifiers::NONE, Key::Enter);
    rest(&mut harness);
    let half = harness.state().editor.tool.half();
    assert_ne!(half, before);
    assert_eq!(half.max_element(), 6.25, "{half}");
    // Thousands are joined; what can be read in several ways is said, and nothing of it cut in silence. In the field of
    // a place, where thousands make sense.
    let at = harness.get_all_by_role(egui::accesskit::Role::SpinButton).next().unwrap();
    let at = at.rect().center();
    let mut write = |text: &str, last: Key| {
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            send(&mut harness, egui::Event::PointerMoved(at));
            send(&mut harness, egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        rest(&mut harness);
        key(&mut harness, Modifiers::COMMAND, Key::A);
        for typed in text.chars() {
            send(&mut harness, egui::Event::Text(typed.to_string()));
        }
        key(&mut harness, Modifiers::NONE, last);
        rest(&mut harness);
        let told = format!("\"{text}\" is not a number");
        let toasts = &harness.state().ui.toasts;
        let is_told = toasts.texts().any(|(_, toast)| toast.contains(&told));
        (harness.state().editor.tool.centre_vx.x, is_told)
    };
    for (text, place_vx) in [
        ("16.5", 16.5),
        ("1.024,5", 1024.5),
        ("-1,016.5", -1016.5),
        ("0.001.024,5", 1024.5),
        ("1,016", 1.016),
        ("2.024", 2.024),
        ("1 024,5", 1024.5),
    ] {
        assert_eq!(write(text, Key::Enter), (place_vx, false), "{text}");
    }
    for text in ["1.5,3", "1,2,3", "12,5 mm"] {
        assert!(write(text, Key::Enter).1, "{text}");
        assert_eq!(write("16.5", Key::Enter), (16.5, false), "{text}");
    }
    assert!(!write("1.5.3", Key::Escape).1, "it was given up");
    // In a field for words it stays: `8,8,8` is three numbers.
    super::bench::run_by_palette(&mut harness, "subtract cuboid at=8,8,8 half=2");
    assert_eq!(voxels(&harness), 64u64.pow(3) - 64);
}
