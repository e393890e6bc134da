//! Every operation on files fails once, in every way, and after power cuts: either all or nothing is restored, and a
//! save never fails because of it.

use sculpture_core::persist::saved_history::SavedHistoryOptions;

use super::{begin, counts, execute, hash, in_memory, reopen};
use crate::journal::memory::{Fault, Memory};

const NEW: &str = "new dims=24,20,12 colour=24";

#[test]
fn with_any_operation_failing_all_comes_back_or_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    for fault in [Fault::Refused, Fault::Short, Fault::DoneAndRefused] {
        let mut calls = 0;
        loop {
            let _ = std::fs::remove_file(&path);
            let memory = Memory::default();
            memory.fail_after(calls, fault);
            let mut session = begin(NEW, in_memory(&memory));
            let mut hashes = vec![];
            for (x, saves) in [(4, true), (9, false), (14, true)] {
                hashes.push(hash(&session));
                execute(&mut session, &format!("subtract ellipsoid at={x},9,6 half=4"));
                if saves {
                    execute(&mut session, &format!("save {path:?}"));
                    session.wait_for_saved_history();
                }
            }
            let has_failed = session.take_history_message().is_some();
            for power_cut in [false, true] {
                let mut again = reopen(&path, in_memory(&memory.left(power_cut)));
                let [undo, redo] = counts(&again);
                assert!([0, 3].contains(&undo) && redo == 0, "{fault:?} {calls}: {undo} {redo}");
                assert!(undo == 3 || has_failed || memory.calls() >= calls, "{fault:?} {calls}");
                for expected in hashes.iter().rev().take(undo) {
                    execute(&mut again, "undo 1");
                    assert_eq!(hash(&again), *expected, "{fault:?} {calls}");
                }
            }
            // Unfinished files are removed with the next one that is written.
            execute(&mut session, "undo 1");
            execute(&mut session, &format!("save {path:?}"));
            session.wait_for_saved_history();
            if memory.calls() < calls {
                assert!(!has_failed);
                break;
            }
            calls += 1;
        }
        assert!(calls > 12, "{calls}");
    }
}

#[test]
fn a_full_disk_is_told_and_the_save_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    let memory = Memory::default();
    memory.set_room(Some(200));
    let mut session = begin(NEW, in_memory(&memory));
    execute(&mut session, "subtract ellipsoid at=9,9,6 half=4");
    execute(&mut session, &format!("save {path:?}"));
    session.wait_for_saved_history();
    let message = session.take_history_message().unwrap();
    assert!(message.contains("a.vsc") && message.contains("is not kept"), "{message}");
    assert!(!session.modified());
    assert_eq!(memory.count(), 0, "nothing unfinished stays");
    let again = reopen(&path, in_memory(&memory));
    assert_eq!((counts(&again), again.take_history_message()), ([0, 0], None));
}

#[test]
fn a_folder_that_cannot_be_made_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let [path, blocked] = ["a.vsc", "file"].map(|name| folder.path().join(name));
    std::fs::write(&blocked, "in the way").unwrap();
    let mut session = begin(NEW, SavedHistoryOptions::new(&blocked.join("histories"), 1 << 20));
    execute(&mut session, "subtract ellipsoid at=9,9,6 half=4");
    execute(&mut session, &format!("save {path:?}"));
    session.wait_for_saved_history();
    assert!(session.take_history_message().unwrap().contains("is not kept"));
}
