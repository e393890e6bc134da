//! Changing controls in their dialog, and the palette, without a system window.

use std::path::{Path, PathBuf};

use egui::{Event, Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::ui::Theme;

use super::bench::{
    Bench, bench, bench_of, config, corner, drag, has, key, middle, rest, send, undo_count, voxels,
    wheel,
};

const UNDO: &str = "Undo the last step";
const FILL: &str = "Fill the whole grid";

fn help(harness: &mut Bench) {
    key(harness, Modifiers::NONE, Key::F1);
    rest(harness);
    assert!(harness.state().ui.dialogs.keys.open);
}

fn click(harness: &mut Bench, label: &str) {
    let node = harness.get_by_label(label);
    node.scroll_to_me();
    rest(harness);
    harness.get_by_label(label).click();
    rest(harness);
}

fn typed(harness: &mut Bench, text: &str) {
    send(harness, Event::Text(text.to_string()));
    rest(harness);
}

/// A bench that keeps its keys in a file.
fn keeping(path: &Path) -> Bench {
    let mut harness = bench();
    harness.state_mut().keep_keys_in(path.to_path_buf());
    rest(&mut harness);
    harness
}

fn file() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("not there yet").join("bindings.toml");
    (folder, path)
}

#[test]
fn the_window_lists_the_triggers_of_the_preset_in_use() {
    let mut harness = bench();
    help(&mut harness);
    assert!(has(&harness, &format!("Remove Ctrl+Z from: {UNDO}")));
    assert!(!has(&harness, "Remove Left + right buttons from: Use the tool where it is"));
    harness.state_mut().controls.preset = 1;
    rest(&mut harness);
    assert!(has(&harness, "Remove Left + right buttons from: Use the tool where it is"));
    harness.get_by_label("Filter").focus();
    rest(&mut harness);
    typed(&mut harness, "step last undo");
    assert!(has(&harness, &format!("Add to: {UNDO}")));
    assert!(!has(&harness, &format!("Add to: {FILL}")));
    // The first leaves the field, the second the window.
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!harness.state().ui.dialogs.keys.open);
}

#[test]
fn a_key_is_added_used_removed_and_reset() {
    let mut harness = bench();
    help(&mut harness);
    click(&mut harness, &format!("Add to: {UNDO}"));
    key(&mut harness, Modifiers::NONE, Key::Num6);
    rest(&mut harness);
    let chip = format!("Remove 6 from: {UNDO}");
    assert!(has(&harness, &chip));
    key(&mut harness, Modifiers::NONE, Key::F1);
    key(&mut harness, Modifiers::COMMAND, Key::Delete);
    assert_eq!(voxels(&harness), 0);
    key(&mut harness, Modifiers::NONE, Key::Num6);
    assert!(voxels(&harness) > 0, "the new key undoes");
    help(&mut harness);
    click(&mut harness, &format!("Remove Ctrl+Z from: {UNDO}"));
    key(&mut harness, Modifiers::NONE, Key::F1);
    key(&mut harness, Modifiers::COMMAND, Key::Y);
    assert_eq!(voxels(&harness), 0);
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(voxels(&harness), 0, "the old key does not");
    help(&mut harness);
    click(&mut harness, &format!("Reset: {UNDO}"));
    assert!(!has(&harness, &chip) && has(&harness, &format!("Remove Ctrl+Z from: {UNDO}")));
}

#[test]
fn while_a_trigger_is_awaited_nothing_else_reacts() {
    let mut harness = bench();
    help(&mut harness);
    click(&mut harness, &format!("Add to: {FILL}"));
    assert!(harness.state().ui.dialogs.keys.is_catching());
    // A wheel and a click are refused in words, and neither zooms, cuts nor clicks.
    let placement = *harness.state().session().document().placement();
    let at = corner(&harness);
    wheel(&mut harness, Modifiers::NONE, at, 1.0);
    rest(&mut harness);
    harness.get_by_label_contains("Wheel cannot trigger this action; it needs a key").rect();
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at, at + vec2(30.0, 0.0)]);
    rest(&mut harness);
    harness.get_by_label_contains("Left button cannot trigger this action").rect();
    let new = harness.get_by_label("New").rect().center();
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[new]);
    assert!(!harness.state().ui.dialogs.new.open);
    assert_eq!(*harness.state().session().document().placement(), placement);
    assert_eq!(undo_count(&harness), 0);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!harness.state().ui.dialogs.keys.is_catching() && harness.state().ui.dialogs.keys.open);
    // Two buttons together are heard as such, for what is held.
    click(&mut harness, "Add to: Use the tool where it is");
    let press = |button, pressed| Event::PointerButton {
        pos: at,
        button,
        pressed,
        modifiers: Modifiers::NONE,
    };
    for (button, pressed) in [
        (PointerButton::Primary, true),
        (PointerButton::Middle, true),
        (PointerButton::Middle, false),
        (PointerButton::Primary, false),
    ] {
        send(&mut harness, press(button, pressed));
    }
    rest(&mut harness);
    assert!(has(&harness, "Remove Left + middle buttons from: Use the tool where it is"));
    assert_eq!(undo_count(&harness), 0);
}

#[test]
fn a_trigger_of_another_action_is_asked_about() {
    let mut harness = bench();
    help(&mut harness);
    for (answer, owner) in [("Cancel", UNDO), ("Reassign", FILL)] {
        click(&mut harness, &format!("Add to: {FILL}"));
        key(&mut harness, Modifiers::COMMAND, Key::Z);
        rest(&mut harness);
        harness.get_by_label(&format!("Ctrl+Z is already assigned to: {UNDO}.")).rect();
        harness.get_by_label(answer).click();
        rest(&mut harness);
        assert!(has(&harness, &format!("Remove Ctrl+Z from: {owner}")), "{answer}");
    }
    assert!(!has(&harness, &format!("Remove Ctrl+Z from: {UNDO}")));
    harness.get_by_label("Reset all").click();
    rest(&mut harness);
    harness.get_by_label("Discard all changes to Direct").click();
    rest(&mut harness);
    assert!(has(&harness, &format!("Remove Ctrl+Z from: {UNDO}")));
}

#[test]
fn changes_and_the_choice_of_a_preset_are_kept() {
    let (_folder, path) = file();
    let mut harness = keeping(&path);
    assert!(!path.exists(), "nothing is written before something is changed");
    help(&mut harness);
    click(&mut harness, &format!("Add to: {UNDO}"));
    key(&mut harness, Modifiers::NONE, Key::Num6);
    rest(&mut harness);
    // Another preset keeps its own changes.
    harness.get_by_label("Menu").click();
    rest(&mut harness);
    harness.get_by_label("Controls ⏵").click();
    rest(&mut harness);
    harness.get_by_label("Thesis").click();
    rest(&mut harness);
    assert_eq!(harness.state().controls.preset, 1);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("extends = \"thesis\"") && text.contains("[kept.\"direct\"]"), "{text}");

    let mut again = keeping(&path);
    assert_eq!(again.state().controls.preset, 1);
    again.state_mut().controls.preset = 0;
    help(&mut again);
    assert!(has(&again, &format!("Remove 6 from: {UNDO}")));
}

#[test]
fn a_broken_table_is_said_to_be_so_and_is_not_lost() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bindings.toml");
    std::fs::write(&path, "extends = \"direct\"\n[bindings]\nfly = [\"a\"]\n").unwrap();
    let mut harness = keeping(&path);
    harness.get_by_label_contains("fly: there is no such action").rect();
    help(&mut harness);
    assert!(has(&harness, &format!("Remove Ctrl+Z from: {UNDO}")), "the preset is used");
    click(&mut harness, &format!("Remove Ctrl+Z from: {UNDO}"));
    let old = std::fs::read_to_string(folder.path().join("bindings.old.toml")).unwrap();
    assert!(old.contains("fly"));
    assert!(std::fs::read_to_string(&path).unwrap().contains("undo = ["));
}

#[test]
fn the_palette_finds_actions_by_words_and_runs_them() {
    let mut harness = bench();
    for open in [(Modifiers::COMMAND, Key::P), (Modifiers::NONE, Key::F3)] {
        key(&mut harness, open.0, open.1);
        rest(&mut harness);
        assert!(harness.state().ui.dialogs.palette.open);
        typed(&mut harness, "voxel delete every");
        key(&mut harness, Modifiers::NONE, Key::Enter);
        rest(&mut harness);
        assert!(!harness.state().ui.dialogs.palette.open);
        assert_eq!(voxels(&harness), 0);
        key(&mut harness, Modifiers::COMMAND, Key::Z);
        assert!(voxels(&harness) > 0);
    }
    // Arrows choose, Escape closes and does nothing.
    key(&mut harness, Modifiers::NONE, Key::F3);
    typed(&mut harness, "mirror symmetry in");
    key(&mut harness, Modifiers::NONE, Key::ArrowDown);
    key(&mut harness, Modifiers::NONE, Key::Enter);
    rest(&mut harness);
    let axes = harness.state().session().document().symmetry().axes;
    assert_eq!(axes.map(|axis| axis.is_some()), [false, true, false]);
    key(&mut harness, Modifiers::NONE, Key::F3);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    rest(&mut harness);
    assert!(!harness.state().ui.dialogs.palette.open);
    assert_eq!(undo_count(&harness), 0);
}

#[test]
fn the_palette_runs_typed_commands_and_says_what_is_wrong() {
    let mut harness = bench();
    key(&mut harness, Modifiers::COMMAND, Key::P);
    typed(&mut harness, "subtract sponge at=8,8,8");
    harness.get_by_label_contains("`sponge` is not a solid").rect();
    key(&mut harness, Modifiers::NONE, Key::Enter);
    rest(&mut harness);
    assert!(harness.state().ui.dialogs.palette.open && undo_count(&harness) == 0);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, Modifiers::COMMAND, Key::P);
    rest(&mut harness);
    // A command that is chosen from the list is begun in the field.
    typed(&mut harness, "inside solid remove");
    key(&mut harness, Modifiers::NONE, Key::Enter);
    rest(&mut harness);
    typed(&mut harness, "cuboid at=8,8,8 half=2");
    key(&mut harness, Modifiers::NONE, Key::Enter);
    rest(&mut harness);
    assert_eq!(voxels(&harness), 64u64.pow(3) - 64);
    assert_eq!(undo_count(&harness), 1);
    assert!(!harness.state().ui.dialogs.palette.open);
    let at = middle(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, &[at]);
    assert_eq!(undo_count(&harness), 2, "the sculpture listens again");
}

/// The windows fit at the smallest size and in both themes.
#[test]
fn the_windows_fit() {
    for theme in [Theme::Dark, Theme::Light] {
        for size in [vec2(1280.0, 800.0), vec2(640.0, 480.0)] {
            let mut config = config(16);
            config.window.theme = theme;
            let mut harness = bench_of(&config, size);
            for open in [Key::F1, Key::F3] {
                key(&mut harness, Modifiers::NONE, open);
                rest(&mut harness);
                let label = if open == Key::F1 { "Filter" } else { "Command" };
                let rect = harness.get_by_label(label).rect();
                let window = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
                assert!(window.contains_rect(rect), "{size} {rect}");
                key(&mut harness, Modifiers::NONE, Key::Escape);
                rest(&mut harness);
            }
        }
    }
}
