//! Histories of saved files: bytes of the file, and payloads of records with correct checksums. Accepted histories are
//! undone and redone. Also packed steps alone, as stored on disk: accepted ones are swapped with a sculpture.

use std::path::PathBuf;

use sculpture_core::command::Command;
use sculpture_core::format::history::{ContentsShape, read_step, write_step};
use sculpture_core::persist::saved_history::SavedHistoryOptions;
use sculpture_core::sculpture::brick_set::BrickSet;
use sculpture_core::sculpture::history::StepChange;
use sculpture_core::session::Session;

use super::journal::seal;
use super::{fuzz, small};
use crate::journal::memory::Memory;
use crate::saved_history::{begin, execute, in_memory};

/// Returns a file with a history: its path, that of the history, and the bytes of the history.
fn seed(folder: &std::path::Path) -> (PathBuf, PathBuf, Vec<u8>) {
    let path = folder.join("a.vsc");
    let memory = Memory::default();
    let mut session = begin("new dims=11,9,10 colour=8", in_memory(&memory));
    for line in [
        "new dims=24,20,12 colour=24",
        "subtract cuboid at=4,4,4 half=2",
        "recolour ellipsoid at=12,10,6 half=7 colour=#204060",
        "orient axes=y,-x,z",
        "clear",
        "fill",
        "undo 2",
    ] {
        execute(&mut session, line);
    }
    execute(&mut session, &format!("save {path:?}"));
    session.wait_for_saved_history();
    let (name, bytes) = memory.only_file();
    (path, name, bytes)
}

#[test]
fn damaged_histories_do_no_harm() {
    if !trials::alone() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (path, name, bytes) = seed(folder.path());
    fuzz("saved history", 400, &[bytes], seal, |_, bytes| {
        let files = Memory::with_file(&name, bytes).files();
        let options = SavedHistoryOptions { files, ..in_memory(&Memory::default()) };
        let mut session = Session::open(&path, &Default::default(), small(), &()).unwrap();
        session.keep_saved_histories(options);
        let is_refused = session.take_history_message().is_some();
        let history = session.document().history();
        let steps = history.undo_count() + history.redo_count();
        assert_eq!(steps == 0, is_refused);
        for command in [Command::Undo { steps: None }, Command::Redo { steps: None }] {
            let _ = session.execute(&command, &());
        }
        !is_refused
    });
}

#[test]
fn damaged_steps_do_no_harm() {
    if !trials::alone() {
        return;
    }
    let mut session = begin("new dims=24,20,12 colour=24", in_memory(&Memory::default()));
    let (mut all, mut seeds) = (Vec::new(), Vec::new());
    for line in [
        "subtract ellipsoid at=4,4,4 half=3",
        "recolour ellipsoid at=12,10,6 half=7 colour=#204060",
        "orient axes=y,-x,z",
        "new dims=9,9,9 colour=8",
    ] {
        execute(&mut session, line);
        let step = session.document().history().undo_steps().next().unwrap();
        seeds.push(write_step(step).unwrap());
        // The step leads back from these.
        all.push(session.document().contents().clone());
    }
    fuzz(
        "undo step",
        400,
        &seeds,
        |_| {},
        |i, bytes| {
            let Ok(step) = read_step(bytes, ContentsShape::of(&all[i]), &small()) else {
                return false;
            };
            if let StepChange::Bricks(record) = step.change {
                let mut contents = all[i].clone();
                let bricks = contents.grid.brick_count();
                record.swap(&mut contents, &mut BrickSet::default());
                let counts = (0..bricks).map(|i| u64::from(contents.grid.brick_at(i).count()));
                assert_eq!(counts.sum::<u64>(), contents.grid.opaque_count());
            }
            true
        },
    );
}
