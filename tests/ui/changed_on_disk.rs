//! A file that another program has changed is overwritten, kept, or opened again, as the answer to the question says.

use std::path::Path;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use virtual_sculpture::session::Session;

use super::bench::{Bench, bench, click_once, config, has, key, run, undo_count, voxels};
use super::board::board;

const HEADING: &str = "The file has changed on disk";

/// Lets work on a thread end, and the window show what came of it.
fn settle(harness: &mut Bench) {
    for _ in 0..3 {
        harness.run_steps(3);
        harness.state_mut().finish_job();
    }
    harness.run_steps(3);
}

/// The window with carved work in the file at `path`, which another session has written since.
fn changed_meanwhile(path: &Path) -> Bench {
    changed_meanwhile_in(bench(), path)
}

fn changed_meanwhile_in(mut harness: Bench, path: &Path) -> Bench {
    run(&mut harness, "subtract cuboid at=16,16,16 half=6");
    run(&mut harness, &format!("save {path:?}"));
    run(&mut harness, "subtract cuboid at=40,40,40 half=4");
    let config = config(8);
    let mut other = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    other.execute(&format!("save {path:?}").parse().unwrap(), &()).unwrap();
    harness
}

/// How many voxels the file at `path` holds.
fn voxels_in(path: &Path) -> u64 {
    let config = config(8);
    let mut reader = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    reader.execute(&format!("open {path:?}").parse().unwrap(), &()).unwrap();
    reader.document().grid().opaque_count()
}

fn save(harness: &mut Bench) {
    key(harness, Modifiers::COMMAND, Key::S);
    settle(harness);
}

#[test]
fn a_file_that_has_changed_is_overwritten_when_the_person_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let mut harness = changed_meanwhile(&path);
    save(&mut harness);
    assert!(has(&harness, HEADING) && harness.state().session().modified());
    assert_eq!(voxels_in(&path), 512);
    click_once(&mut harness, "Overwrite");
    settle(&mut harness);
    assert!(!has(&harness, HEADING) && !harness.state().session().modified());
    assert_eq!(voxels_in(&path), voxels(&harness));
    // From now on it is known again.
    run(&mut harness, "subtract cuboid at=40,10,40 half=4");
    save(&mut harness);
    assert!(!has(&harness, HEADING) && !harness.state().session().modified());
}

#[test]
fn leaving_with_save_asks_before_a_changed_file_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let mut harness = changed_meanwhile(&path);
    harness.state_mut().ask_to_leave();
    settle(&mut harness);
    // The question lies over the bar, which has a button of that name, too.
    harness.get_all_by_label("Save").last().unwrap().click();
    settle(&mut harness);
    assert!(has(&harness, HEADING) && !harness.state().is_leaving());
    assert_eq!(voxels_in(&path), 512);
    click_once(&mut harness, "Overwrite");
    settle(&mut harness);
    assert!(harness.state().is_leaving());
    assert_eq!(voxels_in(&path), voxels(&harness));
}

#[test]
fn on_the_board_of_a_headset_a_file_that_has_changed_is_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let mut harness = changed_meanwhile_in(board(), &path);
    for (answer, is_mine) in [("Cancel", false), ("Overwrite", true)] {
        settle(&mut harness);
        click_once(&mut harness, "Save");
        settle(&mut harness);
        assert!(has(&harness, HEADING), "{answer}");
        click_once(&mut harness, answer);
        settle(&mut harness);
        assert_eq!(voxels_in(&path) == voxels(&harness), is_mine, "{answer}");
    }
}

#[test]
fn a_file_that_has_changed_is_opened_again_and_undo_leads_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let mut harness = changed_meanwhile(&path);
    let (mine, steps) = (voxels(&harness), undo_count(&harness));
    save(&mut harness);
    click_once(&mut harness, "Reload");
    settle(&mut harness);
    assert!(!has(&harness, HEADING) && !harness.state().session().modified());
    assert_eq!((voxels(&harness), undo_count(&harness)), (512, steps + 1));
    run(&mut harness, "undo 1");
    assert_eq!(voxels(&harness), mine);
}

#[test]
fn a_file_that_has_changed_stays_where_the_answer_is_no() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("owl.vsc");
    let mut harness = changed_meanwhile(&path);
    let mine = voxels(&harness);
    for answer in ["Cancel", "Escape", "Save as …"] {
        save(&mut harness);
        assert!(has(&harness, HEADING), "{answer}");
        match answer {
            "Escape" => key(&mut harness, Modifiers::NONE, Key::Escape),
            label => harness.get_by_label(label).click(),
        }
        settle(&mut harness);
        assert!(!has(&harness, HEADING), "{answer}");
        assert_eq!((voxels_in(&path), voxels(&harness)), (512, mine), "{answer}");
        assert!(harness.state().session().modified(), "{answer}");
    }
    assert!(harness.state().ui.dialogs.files.is_open(), "a name is asked for");
}
