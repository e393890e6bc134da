//! A file that another program has open is opened as a copy or read only, as the answer to the question says.

use std::path::Path;

use egui::{Key, Modifiers};
use virtual_sculpture::session::{FileAccess, Session};

use super::bench::{Bench, bench, click_once, config, has, key, run};
use super::board::board;

const HEADING: &str = "The file is open elsewhere";

/// Lets work on a thread end, and the window show what came of it.
fn settle(harness: &mut Bench) {
    for _ in 0..3 {
        harness.run_steps(3);
        harness.state_mut().finish_job();
    }
    harness.run_steps(3);
}

/// A session that has saved a sculpture to the file at `path`, and keeps it open.
fn holder(path: &Path) -> Session {
    let config = config(8);
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    session.set_file_access(FileAccess::Locked);
    session.execute(&format!("save {path:?}").parse().unwrap(), &()).unwrap();
    session
}

/// The window in which that file has just been opened.
fn opened(path: &Path) -> Bench {
    opened_in(bench(), path)
}

fn opened_in(mut harness: Bench, path: &Path) -> Bench {
    harness.state_mut().session_mut().set_file_access(FileAccess::Locked);
    run(&mut harness, &format!("open {path:?}"));
    settle(&mut harness);
    harness
}

#[test]
fn a_file_that_is_open_elsewhere_is_opened_as_a_copy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let _other = holder(&path);
    // On the board of a headset, too.
    for harness in [bench(), board()] {
        let mut harness = opened_in(harness, &path);
        assert!(has(&harness, HEADING) && harness.state().ui.dialogs.is_modal());
        click_once(&mut harness, "Open a copy");
        settle(&mut harness);
        assert!(!has(&harness, HEADING));
        let session = harness.state().session();
        assert!(session.path().is_none() && session.modified());
        click_once(&mut harness, "Save");
        settle(&mut harness);
        assert!(harness.state().ui.dialogs.files.is_open(), "a name is asked for");
    }
}

#[test]
fn the_key_saves_a_copy_under_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let _other = holder(&path);
    let mut harness = opened(&path);
    click_once(&mut harness, "Open a copy");
    settle(&mut harness);
    key(&mut harness, Modifiers::COMMAND, Key::S);
    settle(&mut harness);
    assert!(harness.state().ui.dialogs.files.is_open(), "a name is asked for");
}

#[test]
fn a_file_that_is_open_elsewhere_is_opened_read_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let _other = holder(&path);
    let bytes = std::fs::read(&path).unwrap();
    for (answer, is_read_only) in [("Read only", true), ("Escape", false)] {
        let mut harness = opened(&path);
        assert!(has(&harness, HEADING), "{answer}");
        match answer {
            "Escape" => key(&mut harness, Modifiers::NONE, Key::Escape),
            answer => click_once(&mut harness, answer),
        }
        settle(&mut harness);
        assert!(!has(&harness, HEADING), "{answer}");
        assert_eq!(harness.state().session().path(), Some(path.as_path()));
        assert_eq!(harness.state().session().is_read_only(), is_read_only);
        run(&mut harness, "subtract cuboid at=4,4,4 half=1");
        key(&mut harness, Modifiers::COMMAND, Key::S);
        settle(&mut harness);
        assert_eq!(harness.state().ui.dialogs.files.is_open(), is_read_only, "{answer}");
        assert!(harness.state().session().modified());
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
    }
}

#[test]
fn a_file_that_nobody_else_has_open_is_opened_without_a_question() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    drop(holder(&path));
    // The remains of a killed program.
    std::fs::write(folder.path().join(".owl.vsc.lock"), r#"{"process":1}"#).unwrap();
    let harness = opened(&path);
    assert!(!has(&harness, HEADING) && !harness.state().session().is_read_only());
}
