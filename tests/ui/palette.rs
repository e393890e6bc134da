//! The palette leads to options of panels, in the window without a system.

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::ui::widgets::toasts::Tone;

use super::bench::{Bench, bench, has, key, rest, send};

fn search(harness: &mut Bench, words: &str) {
    key(harness, Modifiers::COMMAND, Key::P);
    rest(harness);
    send(harness, Event::Text(words.to_string()));
    key(harness, Modifiers::NONE, Key::Enter);
    rest(harness);
    assert!(!harness.state().ui.dialogs.palette.open, "{words}");
}

#[test]
fn an_option_is_shown_in_its_panel() {
    let mut harness = bench();
    // The section is closed at first, and panels may be hidden.
    assert!(!has(&harness, "Repeat"));
    key(&mut harness, Modifiers::NONE, Key::F10);
    search(&mut harness, "array");
    let repeat = harness.get_by_label("Repeat").rect();
    assert!(harness.state().picture().right() < repeat.left(), "beside the picture: {repeat}");
    search(&mut harness, "ambient occlusion");
    assert!(has(&harness, "Ambient occlusion"));
    // A tool that has the option is selected.
    search(&mut harness, "lazy mouse");
    let tool = &harness.state().editor.tool;
    assert_eq!(tool.kind, ToolKind::Brush(BrushId::Draw));
    assert!(has(&harness, "Steady"));
}

#[test]
fn a_missing_feature_is_reported_with_the_nearest_one() {
    let mut harness = bench();
    key(&mut harness, Modifiers::COMMAND, Key::P);
    rest(&mut harness);
    send(&mut harness, Event::Text("layers".to_string()));
    rest(&mut harness);
    harness.get_by_label_contains("No layers: masks and selected boxes").rect();
    key(&mut harness, Modifiers::NONE, Key::Enter);
    rest(&mut harness);
    assert!(harness.state().ui.dialogs.masks.open);
}

#[test]
fn words_that_are_commands_too_end_in_no_error() {
    for words in ["symmetry", "mask", "noise", "array", "stencil", "gradient"] {
        let mut harness = bench();
        search(&mut harness, words);
        let texts: Vec<_> = harness.state().ui.toasts.texts().collect();
        assert!(!texts.iter().any(|(tone, _)| *tone == Tone::Error), "{words}: {texts:?}");
    }
}
