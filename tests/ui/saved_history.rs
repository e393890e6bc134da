//! A file that is opened again has its undo and redo, in the panel and on the keys; a damaged history is told.

use std::path::Path;

use egui::{Key, Modifiers, vec2};
use virtual_sculpture::app::Workspace;
use virtual_sculpture::input::Bindings;
use virtual_sculpture::persist::saved_history::SavedHistoryOptions;
use virtual_sculpture::session::Session;

use super::bench::{
    Bench, bench_around, config, has, key, look, rest, run_by_palette, undo_count, voxels,
};

/// The window at its start, with a new sculpture.
fn start(folder: &Path) -> Bench {
    let config = config(32);
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let options = SavedHistoryOptions::new(&folder.join("histories"), 1 << 20);
    session.keep_saved_histories(options);
    let workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
    bench_around(workspace, vec2(1280.0, 800.0))
}

fn ask_for(harness: &mut Bench, line: &str) {
    run_by_palette(harness, line);
    for _ in 0..3 {
        harness.run_steps(2);
        harness.state_mut().finish_job();
    }
    rest(harness);
}

#[test]
fn a_file_that_is_opened_again_has_its_undo() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    let mut harness = start(folder.path());
    let whole = voxels(&harness);
    ask_for(&mut harness, "subtract cuboid at=16,16,16 half=6");
    let first = voxels(&harness);
    ask_for(&mut harness, "subtract cuboid at=4,4,4 half=4");
    let second = voxels(&harness);
    ask_for(&mut harness, &format!("save {path:?}"));
    drop(harness);

    let mut harness = start(folder.path());
    ask_for(&mut harness, &format!("open {path:?}"));
    assert_eq!((voxels(&harness), undo_count(&harness)), (second, 3));
    assert!(!harness.state().session().modified());
    for expected in [first, whole] {
        key(&mut harness, Modifiers::COMMAND, Key::Z);
        harness.run_steps(2);
        assert_eq!(voxels(&harness), expected);
    }
    key(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    harness.run_steps(2);
    assert_eq!((voxels(&harness), undo_count(&harness)), (first, 2));
    look(&mut harness);
    drop(harness);

    for history in std::fs::read_dir(folder.path().join("histories")).unwrap() {
        let history = history.unwrap().path();
        let bytes = std::fs::read(&history).unwrap();
        std::fs::write(&history, &bytes[..bytes.len() / 2]).unwrap();
    }
    let mut harness = start(folder.path());
    ask_for(&mut harness, &format!("open {path:?}"));
    assert_eq!((voxels(&harness), undo_count(&harness)), (second, 1), "the `open` alone");
    let said = format!(
        "the undo history of {} is left out: it is cut off or damaged; the sculpture itself is whole",
        path.display()
    );
    assert!(has(&harness, &said), "{said}");
}
