//! Tests which histories are refused, how they are bounded, and which are removed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use sculpture_core::document::Limits;
use sculpture_core::persist::saved_history::{FoundHistory, SavedHistories, SavedHistoryOptions};
use sculpture_core::sculpture::Digest;
use sculpture_core::session::Session;

use super::{begin, counts, execute, in_memory, on_disk, reopen};
use crate::journal::memory::Memory;

const NEW: &str = "new dims=24,20,12 colour=24";

/// Saves a file with a history of three steps, one of them undone. Returns the session.
fn saved(path: &Path, options: SavedHistoryOptions) -> Session {
    let mut session = begin(NEW, options);
    for x in [4, 9, 14] {
        execute(&mut session, &format!("subtract ellipsoid at={x},9,6 half=2"));
    }
    execute(&mut session, "undo 1");
    execute(&mut session, &format!("save {path:?}"));
    session.wait_for_saved_history();
    session
}

fn histories(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder.join("histories")).unwrap();
    entries.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn a_history_that_is_cut_or_damaged_gives_no_step() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    let memory = Memory::default();
    let session = saved(&path, in_memory(&memory));
    let (name, bytes) = memory.only_file();
    let file_hash = Digest::of_bytes(&fs::read(&path).unwrap());
    assert_eq!(name, PathBuf::from(format!("/h/{file_hash}.undo")));
    let (contents, limits) = (session.document().contents(), Limits::default());
    let find = |bytes: &[u8]| {
        let memory = Memory::with_file(&name, bytes);
        SavedHistories::new(in_memory(&memory)).find(file_hash, contents, &limits)
    };
    let FoundHistory::History(whole) = find(&bytes) else { panic!("it is whole") };
    assert_eq!((whole.history.undo.len(), whole.history.redo.len()), (2, 1));
    for at in 0..bytes.len() {
        assert!(matches!(find(&bytes[..at]), FoundHistory::Unusable(_)), "cut after {at} bytes");
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(matches!(find(&damaged), FoundHistory::Unusable(_)), "byte {at} is damaged");
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(matches!(find(&longer), FoundHistory::Unusable(_)), "something follows its end");
    assert!(matches!(find(&[]), FoundHistory::Unusable(_)));
}

#[test]
fn a_foreign_or_damaged_history_is_left_out_with_a_notice() {
    let folder = tempfile::tempdir().unwrap();
    let [path, other] = ["a.vsc", "b.vsc"].map(|name| folder.path().join(name));
    drop(saved(&path, on_disk(folder.path())));
    let kept = histories(folder.path()).pop().unwrap();
    // The history of one file under the name of another.
    let mut session = begin(NEW, on_disk(folder.path()));
    execute(&mut session, &format!("save {other:?}"));
    drop(session);
    let hash = Digest::of_bytes(&fs::read(&other).unwrap());
    let foreign = kept.with_file_name(format!("{hash}.undo"));
    fs::copy(&kept, &foreign).unwrap();
    let session = reopen(&other, on_disk(folder.path()));
    assert_eq!(counts(&session), [0, 0]);
    let message = session.take_history_message().unwrap();
    assert!(message.contains("b.vsc") && message.contains("another file"), "{message}");
    assert_eq!(session.take_history_message(), None, "it is said once");

    let bytes = fs::read(&kept).unwrap();
    fs::write(&kept, &bytes[..bytes.len() - 3]).unwrap();
    let mut session = begin(NEW, on_disk(folder.path()));
    execute(&mut session, &format!("open {path:?}"));
    assert_eq!(counts(&session), [1, 0], "the `open` alone");
    let message = session.take_history_message().unwrap();
    assert!(message.contains("a.vsc") && message.contains("left out"), "{message}");
}

#[test]
fn a_file_that_another_program_changed_has_no_history() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    drop(saved(&path, on_disk(folder.path())));
    let mut session = Session::open(&path, &Default::default(), Limits::default(), &()).unwrap();
    execute(&mut session, "fill");
    execute(&mut session, &format!("save {path:?}"));
    let session = reopen(&path, on_disk(folder.path()));
    assert_eq!((counts(&session), session.take_history_message()), ([0, 0], None));
}

#[test]
fn the_steps_nearest_to_the_present_are_kept_within_the_bound() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    let options = SavedHistoryOptions { max_bytes: 600_000, ..on_disk(folder.path()) };
    let mut session = begin("new dims=64,64,64 colour=24", options.clone());
    for seed in 1..25 {
        execute(&mut session, &format!("noise colour=#{seed:02}8020 size=3 amount=1 seed={seed}"));
    }
    execute(&mut session, "undo 8");
    execute(&mut session, &format!("save {path:?}"));
    session.wait_for_saved_history();
    let file = histories(folder.path()).pop().unwrap();
    let bytes = file.metadata().unwrap().len();
    assert!(bytes < 302_000, "{bytes}");
    let mut again = reopen(&path, options);
    let [undo, redo] = counts(&again);
    assert!((1..16).contains(&undo) && (1..8).contains(&redo), "{undo} {redo}");
    execute(&mut session, &format!("undo {undo}"));
    execute(&mut again, "undo all");
    assert!(session.document().contents() == again.document().contents());
}

#[test]
fn those_written_longest_ago_go_first() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = 0;
    for (age, name) in [(30, "a.vsc"), (10, "b.vsc"), (20, "c.vsc")] {
        let mut session = begin(NEW, on_disk(folder.path()));
        execute(&mut session, &format!("subtract ellipsoid at={age},9,6 half=9"));
        execute(&mut session, &format!("save {:?}", folder.path().join(name)));
        drop(session);
        for path in histories(folder.path()) {
            let file = fs::File::options().append(true).open(path).unwrap();
            let found = file.metadata().unwrap();
            if found.modified().unwrap().elapsed().unwrap_or_default() < Duration::from_secs(300) {
                file.set_modified(SystemTime::now() - Duration::from_secs(1000 * age)).unwrap();
                bytes = bytes.max(found.len());
            }
        }
    }
    let options = SavedHistoryOptions { max_bytes: 3 * bytes, ..on_disk(folder.path()) };
    let path = folder.path().join("d.vsc");
    let mut session = begin(NEW, options.clone());
    execute(&mut session, "subtract ellipsoid at=12,9,6 half=2");
    execute(&mut session, &format!("save {path:?}"));
    drop(session);
    let kept = ["a.vsc", "b.vsc", "c.vsc", "d.vsc"]
        .map(|name| counts(&reopen(&folder.path().join(name), options.clone()))[0]);
    assert_eq!(kept, [0, 1, 1, 1]);
}

#[cfg(unix)]
#[test]
fn only_its_owner_can_read_it() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    drop(saved(&folder.path().join("a.vsc"), on_disk(folder.path())));
    let file = histories(folder.path()).pop().unwrap();
    let mode = |path: &Path| path.metadata().unwrap().permissions().mode() & 0o777;
    assert_eq!((mode(&file), mode(file.parent().unwrap())), (0o600, 0o700));
}
