//! Volumes that do not say which way is up, without a window: the bar after opening one, what one
//! click does, undo, and what is remembered at the next file and the next start.

use std::path::{Path, PathBuf};

use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;
use glam::UVec3;
use virtual_sculpture::app::Workspace;
use virtual_sculpture::command::Command;
use virtual_sculpture::document::Limits;
use virtual_sculpture::format::options::ImportOptions;
use virtual_sculpture::input::Bindings;
use virtual_sculpture::sculpture::orientation::Up;
use virtual_sculpture::session::Session;

use super::bench::{Bench, bench, bench_around, config, key, rest, run_by_palette, undo_count};

const QUESTION: &str = "Which axis points up?";

/// A volume of another program: a slab at the lower end of z.
fn lying(folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    let mut bytes = b"PVM\n24 16 8\n1\n".to_vec();
    bytes.extend((0..24 * 16 * 8).map(|i| if i < 24 * 16 * 2 { 200u8 } else { 0 }));
    std::fs::write(&path, bytes).unwrap();
    path
}

fn settle(harness: &mut Bench) {
    for _ in 0..3 {
        harness.run_steps(3);
        harness.state_mut().finish_job();
    }
    harness.run_steps(3);
}

/// Types a command into the palette.
fn ask_for(harness: &mut Bench, line: &str) {
    run_by_palette(harness, line);
    settle(harness);
}

fn click(harness: &mut Bench, label: &str) {
    harness.get_by_label(label).click();
    settle(harness);
}

fn dims(harness: &Bench) -> UVec3 {
    harness.state().session().document().grid().dims()
}

fn bounds(harness: &Bench) -> (UVec3, UVec3) {
    harness.state().session().document().grid().opaque_bounds().unwrap()
}

fn is_asked(harness: &Bench) -> bool {
    harness.query_by_label(QUESTION).is_some()
}

#[test]
fn one_click_turns_a_volume_upright_and_undo_asks_again() {
    let folder = tempfile::tempdir().unwrap();
    let scan = lying(folder.path(), "scan.pvm");
    let mut harness = bench();
    assert!(!is_asked(&harness));
    ask_for(&mut harness, &format!("open {scan:?} threshold=100"));
    assert!(is_asked(&harness));
    let steps = undo_count(&harness);
    harness.state_mut().ui.view.up = glam::Vec3::Z;

    click(&mut harness, "−Z up");
    assert_eq!(dims(&harness), UVec3::new(24, 8, 16));
    assert_eq!(bounds(&harness), (UVec3::new(0, 6, 0), UVec3::new(24, 8, 16)));
    assert_eq!(undo_count(&harness), steps + 1);
    assert_eq!(harness.state().ui.view.up, glam::Vec3::Y);
    assert!(!is_asked(&harness));
    assert_eq!(harness.state().session().path(), Some(scan.as_path()), "the file is the same");
    let said: Vec<_> = harness.state().ui.toasts.texts().map(|(_, text)| text).collect();
    assert!(said.contains(&".pvm files open with −Z up from now on"), "{said:?}");

    key(&mut harness, Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert_eq!(dims(&harness), UVec3::new(24, 16, 8));
    assert!(is_asked(&harness), "another answer may be given");
    click(&mut harness, "Z up");
    assert_eq!(bounds(&harness), (UVec3::ZERO, UVec3::new(24, 2, 16)));
    assert_eq!(harness.state().ui.known_files.upright.of(&scan), Some(Up::Z));

    // Without an answer it is as it is, and a change of the sculpture ends the question.
    key(&mut harness, Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    click(&mut harness, "Y up");
    assert!(!is_asked(&harness));
    assert_eq!(dims(&harness), UVec3::new(24, 16, 8));
    assert_eq!(harness.state().ui.known_files.upright.of(&scan), Some(Up::Y));
}

#[test]
fn the_answer_is_kept_for_the_format_and_the_next_start() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("state.toml");
    let [scan, other] = ["scan.pvm", "other.PVM"].map(|name| lying(folder.path(), name));
    let window = &config(16).window;
    let mut harness = bench();
    harness.state_mut().remember_in(file.clone(), window);
    ask_for(&mut harness, &format!("open {scan:?} threshold=100"));
    click(&mut harness, "Z up");
    harness.state_mut().remember();
    drop(harness);

    let mut harness = bench();
    harness.state_mut().remember_in(file.clone(), window);
    rest(&mut harness);
    assert_eq!(harness.state().ui.known_files.upright.of(&other), Some(Up::Z));
    // As it was opened last.
    let line = harness.state().ui.known_files.recent.lines().next().unwrap();
    assert!(line.ends_with(" threshold=100 upright=z"), "{line}");
    ask_for(&mut harness, &line);
    assert_eq!(bounds(&harness), (UVec3::ZERO, UVec3::new(24, 2, 16)));
    // It stands as it was remembered; the question shows so, and another answer turns it from there.
    assert!(is_asked(&harness));
    click(&mut harness, "−Z up");
    assert_eq!(bounds(&harness), (UVec3::new(0, 6, 0), UVec3::new(24, 8, 16)));
    drop(harness);

    // A file named at the start is read by the caller, who says how.
    let import = ImportOptions { upright: Some(Up::Z), ..ImportOptions::default() };
    let session = Session::open(&scan, &import, Limits::default(), &()).unwrap();
    let workspace = Workspace::new(session, &config(16), Bindings::presets().unwrap());
    let mut harness = bench_around(workspace, vec2(1280.0, 800.0));
    rest(&mut harness);
    assert!(is_asked(&harness));
    click(&mut harness, "✖");
    assert!(!is_asked(&harness));
    assert_eq!(undo_count(&harness), 0);
}

#[test]
fn only_volumes_that_do_not_say_it_are_asked_about_and_only_as_they_were_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = bench();
    let session = harness.state_mut().session_mut();
    for name in ["own.vsc", "own.pvm"] {
        let save = Command::Save { path: folder.path().join(name), export: Default::default() };
        session.execute(&save, &()).unwrap();
    }
    for name in ["own.vsc", "own.pvm"] {
        ask_for(&mut harness, &format!("open {:?}", folder.path().join(name)));
        assert!(!is_asked(&harness), "{name}");
    }
    let scan = lying(folder.path(), "scan.pvm");
    ask_for(&mut harness, &format!("open {scan:?} threshold=100"));
    assert!(is_asked(&harness));
    ask_for(&mut harness, "subtract cuboid at=2,2,2 half=2");
    assert!(!is_asked(&harness));
}

#[test]
fn the_menu_lays_any_sculpture_another_way() {
    let mut harness = bench();
    ask_for(&mut harness, "new dims=24,16,8 colour=24");
    ask_for(&mut harness, "recolour cuboid at=4,4,4 half=4 colour=#ff0000");
    for (label, expected) in [("−X up", [16, 24, 8]), ("Rotate 90° about Z", [24, 16, 8])] {
        click(&mut harness, "Menu");
        click(&mut harness, "Turn upright ⏵");
        click(&mut harness, label);
        assert_eq!(dims(&harness), UVec3::from(expected), "{label}");
    }
    // By other words in the palette.
    ask_for(&mut harness, "stand scan z axis");
    assert_eq!(dims(&harness), UVec3::new(24, 8, 16));
    ask_for(&mut harness, "undo 3");
    assert_eq!(dims(&harness), UVec3::new(24, 16, 8));
    let red = harness.state().session().document().contents().rgb(UVec3::splat(1));
    assert_eq!(red.0, [255, 0, 0]);
}
