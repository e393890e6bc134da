//! Sculptures of abandoned sessions are listed at the start, and are restored or discarded.

use std::path::Path;

use egui::vec2;
use egui_kittest::kittest::Queryable;
use virtual_sculpture::app::Workspace;
use virtual_sculpture::config::Config;
use virtual_sculpture::input::Bindings;
use virtual_sculpture::persist::journal::{JournalDir, JournalOptions};
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::session::Session;

use super::bench::{Bench, bench_around, click, click_once, config, has, rest, undo_count};
use super::board::board_around;

fn journals(folder: &Path) -> JournalOptions {
    JournalOptions::new(JournalDir::new(&folder.join("journals")))
}

/// A session that ends without being asked to, after these commands; what it had.
fn leave(folder: &Path, config: &Config, lines: &[&str]) -> Contents {
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    session.keep_journal(journals(folder)).unwrap();
    for line in lines {
        session.execute(&line.parse().unwrap(), &()).unwrap();
    }
    session.sync_journal();
    session.document().contents().clone()
}

/// The same for a session that is killed, so that it cannot even remove the journal that nobody needs.
fn kill(folder: &Path, config: &Config, lines: &[&str]) {
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    session.keep_journal(journals(folder)).unwrap();
    for line in lines {
        session.execute(&line.parse().unwrap(), &()).unwrap();
    }
    session.sync_journal();
    let journal = session.journal_path().unwrap();
    let bytes = std::fs::read(&journal).unwrap();
    drop(session);
    std::fs::write(journal, bytes).unwrap();
}

/// The window at its next start, in which all that was left has been found.
fn start(folder: &Path, config: &Config, size: egui::Vec2) -> Bench {
    let mut harness = bench_around(workspace(folder, config), size);
    harness.run_steps(4);
    harness
}

/// A workspace that has found all that was left.
fn workspace(folder: &Path, config: &Config) -> Workspace {
    let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let mut workspace = Workspace::new(session, config, Bindings::presets().unwrap());
    workspace.session_mut().keep_journal(journals(folder)).unwrap();
    workspace.session().sync_journal();
    workspace.look_for_left(journals(folder));
    workspace.finish_job();
    workspace
}

fn numbers(folder: &Path) -> Vec<u64> {
    journals(folder).journal_dir.numbers().unwrap()
}

const CARVED: [&str; 3] = [
    "subtract cuboid at=16,16,16 half=6",
    "recolour cuboid at=4,4,4 half=4 colour=#2040ff",
    "undo 1",
];

#[test]
fn an_abandoned_session_comes_back_with_undo_and_redo() {
    let folder = tempfile::tempdir().unwrap();
    let config = config(32);
    let made = leave(folder.path(), &config, &CARVED);
    let mut harness = start(folder.path(), &config, vec2(1280.0, 800.0));
    assert!(has(&harness, "Unsaved work was found") && has(&harness, "A new sculpture"));
    assert!(has(&harness, "1 step, 32 × 32 × 32 voxels"));
    assert!(harness.state().ui.dialogs.is_modal(), "keys are for the dialog");
    assert_eq!(numbers(folder.path()), [1, 2]);

    click_once(&mut harness, "Recover");
    harness.run_steps(2);
    harness.state_mut().finish_job();
    harness.run_steps(4);
    assert!(!has(&harness, "Unsaved work was found"));
    let session = harness.state().session();
    assert_eq!(session.document().contents(), &made);
    assert_eq!(undo_count(&harness), 1);
    assert_eq!(session.document().history().redo_count(), 1);
    assert!(session.modified());
    // It has a journal of its own, and nothing else is left.
    assert_eq!(numbers(folder.path()), [session.journal_number().unwrap()]);
    harness.state_mut().session_mut().execute(&"redo 1".parse().unwrap(), &()).unwrap();
    drop(harness);
    let harness = start(folder.path(), &config, vec2(1280.0, 800.0));
    assert!(has(&harness, "2 steps, 32 × 32 × 32 voxels"), "killed again");
}

#[test]
fn an_abandoned_session_is_recovered_on_the_board_of_a_headset() {
    let folder = tempfile::tempdir().unwrap();
    let config = config(32);
    let made = leave(folder.path(), &config, &CARVED);
    let mut harness = board_around(workspace(folder.path(), &config));
    harness.run_steps(4);
    assert!(has(&harness, "Unsaved work was found"));
    click_once(&mut harness, "Later");
    assert!(!has(&harness, "Unsaved work was found"));
    click(&mut harness, "Menu");
    click(&mut harness, "Unsaved work …");
    click_once(&mut harness, "Recover");
    rest(&mut harness);
    assert_eq!(harness.state().session().document().contents(), &made);
}

#[test]
fn unwanted_sessions_are_removed_after_a_question_and_the_others_are_offered_again() {
    let folder = tempfile::tempdir().unwrap();
    let config = config(16);
    leave(folder.path(), &config, &["subtract cuboid at=4,4,4 half=2"]);
    leave(folder.path(), &config, &["clear", "add cuboid at=8,8,8 half=3"]);
    // Nothing was done in this one.
    leave(folder.path(), &config, &[]);
    std::fs::write(folder.path().join("journals/9.journal"), "no journal").unwrap();
    let mut harness = start(folder.path(), &config, vec2(800.0, 600.0));
    let recover = harness.query_all_by_label("Recover").count();
    assert_eq!(recover, 2);
    harness.get_by_label("Cannot be recovered").rect();
    let later = harness.get_by_label("Later").rect();
    assert!(later.max.y < 600.0, "{later:?}");

    let last = harness.get_all_by_label("Discard …").last().unwrap();
    last.click();
    harness.run_steps(3);
    click(&mut harness, "Keep it");
    assert_eq!(harness.query_all_by_label("Discard …").count(), 3);
    harness.get_all_by_label("Discard …").last().unwrap().click();
    harness.run_steps(3);
    click(&mut harness, "Discard it");
    assert_eq!(harness.query_all_by_label("Discard …").count(), 2);
    let left = numbers(folder.path());
    click(&mut harness, "Later");
    assert!(!harness.state().ui.dialogs.is_modal());
    assert_eq!(numbers(folder.path()), left);
    // They can be listed before the next start.
    click(&mut harness, "Menu");
    click(&mut harness, "Unsaved work …");
    harness.state_mut().finish_job();
    harness.run_steps(4);
    assert_eq!(harness.query_all_by_label("Discard …").count(), 2);
    assert!(has(&harness, "Unsaved work was found"));
}

#[test]
fn unsaved_changes_are_asked_about_before_another_session_takes_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let config = config(16);
    let made = leave(folder.path(), &config, &["subtract cuboid at=4,4,4 half=2"]);
    let mut harness = start(folder.path(), &config, vec2(1280.0, 800.0));
    let command = "subtract cuboid at=12,12,12 half=1".parse().unwrap();
    harness.state_mut().session_mut().execute(&command, &()).unwrap();
    click_once(&mut harness, "Recover");
    harness.run_steps(3);
    assert!(has(&harness, "You have unsaved changes"));
    click_once(&mut harness, "Don't save");
    harness.run_steps(2);
    harness.state_mut().finish_job();
    harness.run_steps(4);
    assert_eq!(harness.state().session().document().contents(), &made);
}

#[test]
fn a_session_that_was_ended_from_outside_with_all_saved_has_left_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let config = config(16);
    let path = folder.path().join("owl.vsc");
    let save = format!("save {path:?}");
    let lines = ["subtract cuboid at=4,4,4 half=2", "clear", "undo 1", &save];
    kill(folder.path(), &config, &lines);
    let harness = start(folder.path(), &config, vec2(1280.0, 800.0));
    assert!(!has(&harness, "Unsaved work was found"));
    assert!(!harness.state().ui.dialogs.is_modal());
    let own = harness.state().session().journal_number().unwrap();
    assert_eq!(numbers(folder.path()), [own], "its journal is gone");
    drop(harness);

    // A change after that, a file that another program has changed, and one that is gone are listed.
    let after = ["subtract cuboid at=4,4,4 half=2", &save, "clear"];
    kill(folder.path(), &config, &after);
    let harness = start(folder.path(), &config, vec2(1280.0, 800.0));
    assert!(has(&harness, "Unsaved work was found"), "not saved");
    drop(harness);
    for number in numbers(folder.path()) {
        journals(folder.path()).journal_dir.remove(number).unwrap();
    }
    kill(folder.path(), &config, &lines);
    let mut other = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    other.execute(&save.parse().unwrap(), &()).unwrap();
    let harness = start(folder.path(), &config, vec2(1280.0, 800.0));
    assert!(has(&harness, "Unsaved work was found"), "another sculpture is there");
    drop(harness);
    std::fs::remove_file(&path).unwrap();
    let harness = start(folder.path(), &config, vec2(1280.0, 800.0));
    assert!(has(&harness, "Unsaved work was found"), "the file is gone");
}

#[test]
fn a_journal_that_cannot_be_written_is_marked_as_long_as_that_lasts() {
    const MARK: &str = "⚠ Not kept in the journal";
    let folder = tempfile::tempdir().unwrap();
    let config = config(16);
    let options =
        JournalOptions { retry: std::time::Duration::from_millis(1), ..journals(folder.path()) };
    // No folder can be where a file is.
    let in_the_way = folder.path().join("journals");
    std::fs::write(&in_the_way, "a file").unwrap();
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    session.keep_journal(options).unwrap();
    session.sync_journal();
    let workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
    let mut harness = bench_around(workspace, vec2(1280.0, 800.0));
    // Longer than any message stays.
    for _ in 0..100 {
        harness.step();
    }
    assert!(has(&harness, MARK));
    std::fs::remove_file(&in_the_way).unwrap();
    let began = std::time::Instant::now();
    while has(&harness, MARK) {
        assert!(began.elapsed() < std::time::Duration::from_secs(60), "it stays marked");
        harness.step();
    }
    harness.state().session().sync_journal();
    assert!(harness.state().session().journal_path().is_some_and(|path| path.exists()));
}

#[test]
fn the_menu_says_that_no_session_was_abandoned() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = start(folder.path(), &config(16), vec2(1280.0, 800.0));
    assert!(!harness.state().ui.dialogs.is_modal());
    click(&mut harness, "Menu");
    click(&mut harness, "Unsaved work …");
    harness.state_mut().finish_job();
    harness.run_steps(4);
    assert!(has(&harness, "There is no unsaved work of earlier sessions"));
    assert!(!harness.state().ui.dialogs.is_modal());
}
