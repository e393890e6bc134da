//! The undo history of saved files: what is restored after closing and opening, what is refused, what is removed.

mod dir;
mod faults;

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::Limits;
use sculpture_core::persist::saved_history::SavedHistoryOptions;
use sculpture_core::sculpture::Digest;
use sculpture_core::session::Session;

use crate::commands::strategies::{new_sculpture, work};
use crate::journal::memory::Memory;

/// Returns options for histories on disk.
fn on_disk(folder: &Path) -> SavedHistoryOptions {
    SavedHistoryOptions::new(&folder.join("histories"), 64 << 20)
}

/// Returns options for histories in memory.
pub fn in_memory(memory: &Memory) -> SavedHistoryOptions {
    SavedHistoryOptions {
        files: memory.files(),
        ..SavedHistoryOptions::new("/h".as_ref(), 1 << 20)
    }
}

pub fn execute(session: &mut Session, line: &str) {
    session.execute(&line.parse().unwrap(), &()).unwrap_or_else(|error| panic!("{line}: {error}"));
}

/// Returns a session that keeps histories.
pub fn begin(new: &str, options: SavedHistoryOptions) -> Session {
    let Command::New(new) = new.parse().unwrap() else { panic!("{new}") };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    session.keep_saved_histories(options);
    session
}

/// Returns a new session that begins with a file.
pub fn reopen(path: &Path, options: SavedHistoryOptions) -> Session {
    let mut session = Session::open(path, &Default::default(), Limits::default(), &()).unwrap();
    session.keep_saved_histories(options);
    session
}

fn hash(session: &Session) -> Digest {
    Digest::of(session.document().contents())
}

fn counts(session: &Session) -> [usize; 2] {
    let history = session.document().history();
    [history.undo_count(), history.redo_count()]
}

fn labels(session: &Session) -> [Vec<String>; 2] {
    let history = session.document().history();
    let owned = |labels: &mut dyn Iterator<Item = &str>| labels.map(String::from).collect();
    [owned(&mut history.undo_labels()), owned(&mut history.redo_labels())]
}

/// Undoes all and redoes all, step by step, in two sessions that must be equal throughout; with `marks`, their saved
/// state must be equal, too.
fn assert_same_travel(a: &mut Session, b: &mut Session, marks: bool) {
    for line in ["undo 1", "redo 1"] {
        loop {
            assert!(a.document().contents() == b.document().contents(), "{line}");
            assert_eq!(labels(a), labels(b));
            assert!(!marks || a.modified() == b.modified());
            let [one, other] =
                [&mut *a, &mut *b].map(|s| s.execute(&line.parse().unwrap(), &()).unwrap().steps);
            assert_eq!(one, other, "{line}");
            if one == 0 {
                break;
            }
        }
    }
}

/// Saves, opens the file in a new session, and undoes and redoes everything.
fn assert_comes_back(session: &mut Session, path: &Path, options: SavedHistoryOptions) {
    execute(session, &format!("save {path:?}"));
    session.wait_for_saved_history();
    let mut again = reopen(path, options);
    assert_eq!((session.take_history_message(), again.take_history_message()), (None, None));
    assert!(!again.modified());
    // Storage locations of other sculptures are not restored, so that they count as changed there.
    let own = session.document().state().sculpture;
    let is_one = session.document().history().states().all(|state| state.sculpture == own);
    assert_same_travel(session, &mut again, is_one);
}

/// Returns a file of another sculpture and a volume, to be opened.
fn files(folder: &Path) -> [PathBuf; 2] {
    let [other, volume] = ["other.vsc", "volume.raw"].map(|name| folder.join(name));
    let new = "new dims=13,7,11 colour=8".parse().unwrap();
    let Command::New(new) = new else { panic!() };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    execute(&mut session, "subtract ellipsoid at=5,4,4 half=3");
    execute(&mut session, &format!("save {other:?}"));
    std::fs::write(&volume, (0..=255).chain(0..=255).collect::<Vec<u8>>()).unwrap();
    [other, volume]
}

/// Executes the commands, after some of which (0, 1) a file is opened, undoes some, saves, closes and opens.
fn goes_on_after_closing(new: &NewSculpture, commands: &[(Command, u8)], undone: u32) {
    let folder = tempfile::tempdir().unwrap();
    let [other, volume] = files(folder.path());
    let mut session = Session::new(new, Limits::default()).unwrap();
    session.keep_saved_histories(on_disk(folder.path()));
    for (command, opens) in commands {
        let _ = session.execute(command, &());
        let open = match opens {
            0 => format!("open {other:?}"),
            1 => format!("open {volume:?} raw=8x8x8:u8"),
            _ => continue,
        };
        let _ = session.execute(&open.parse().unwrap(), &());
    }
    let _ = session.execute(&Command::End, &());
    session.execute(&Command::Undo { steps: Some(undone) }, &()).unwrap();
    assert_comes_back(&mut session, &folder.path().join("a.vsc"), on_disk(folder.path()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// With any commands, a new sculpture, and other sculptures, volumes and orientations in between.
    #[test]
    fn undo_and_redo_go_on_after_closing_and_opening(
        new in new_sculpture(20),
        commands in prop::collection::vec((work(), 0u8..12), 1..24),
        undone in 0u32..6,
    ) {
        goes_on_after_closing(&new, &commands, undone);
    }
}

#[test]
fn a_use_that_changes_nothing_before_a_volume_is_opened_comes_back() {
    let Command::New(new) = "new dims=1,1,1".parse().unwrap() else { panic!() };
    let add = "add ellipsoid at=0,0,0 half=0.3 colour=#c8beaa".parse().unwrap();
    goes_on_after_closing(&new, &[(add, 1)], 0);
}

#[test]
fn a_script_that_saves_closes_and_opens_can_undo() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vsc");
    let mut session = begin("new dims=24,20,12 colour=24", on_disk(folder.path()));
    let first = hash(&session);
    execute(&mut session, "subtract ellipsoid at=9,9,9 half=6");
    let second = hash(&session);
    execute(&mut session, "recolour cuboid at=12,10,6 half=4 colour=#a02010");
    let third = hash(&session);
    execute(&mut session, "undo");
    execute(&mut session, &format!("save {path:?}"));
    execute(&mut session, "new dims=5,5,5 colour=8");
    let other = hash(&session);
    execute(&mut session, &format!("open {path:?}"));
    assert_eq!((hash(&session), counts(&session)), (second, [4, 1]));
    assert!(!session.modified() && session.path() == Some(path.as_path()));
    execute(&mut session, "redo");
    assert_eq!(hash(&session), third);
    execute(&mut session, "undo 2");
    assert!(session.modified());
    assert_eq!(hash(&session), first);
    // Below its steps are those of the session.
    execute(&mut session, "undo 1");
    assert_eq!((hash(&session), session.path()), (other, None));
    execute(&mut session, "redo all");
    assert_eq!((hash(&session), session.path()), (third, Some(path.as_path())));
    execute(&mut session, "undo 1");
    assert!(!session.modified(), "this is what the file holds");
}

/// However soon another file is saved, the first one's history is still written completely.
#[test]
fn files_saved_one_after_another_have_a_history_each() {
    const STEPS: usize = 300;
    let folder = tempfile::tempdir().unwrap();
    let mut session = begin("new dims=24,20,12 colour=24", on_disk(folder.path()));
    for i in 0..STEPS {
        execute(&mut session, &format!("dye colour=#{i:06x}"));
    }
    let paths: Vec<PathBuf> = (0..4).map(|i| folder.path().join(format!("{i}.vsc"))).collect();
    for (i, path) in paths.iter().enumerate() {
        execute(&mut session, &format!("subtract ellipsoid at=9,9,6 half={}", i + 2));
        execute(&mut session, &format!("save {path:?}"));
    }
    drop(session);
    for (i, path) in paths.iter().enumerate() {
        let session = reopen(path, on_disk(folder.path()));
        assert_eq!(counts(&session), [STEPS + i + 1, 0], "{}", path.display());
    }
}

#[test]
fn a_history_survives_many_generations_and_a_new_name() {
    let folder = tempfile::tempdir().unwrap();
    let [path, moved] = ["a.vsc", "b.vsc"].map(|name| folder.path().join(name));
    let mut hashes = vec![];
    let mut session = begin("new dims=24,20,12 colour=24", on_disk(folder.path()));
    for x in 2..8 {
        hashes.push(hash(&session));
        execute(&mut session, &format!("subtract ellipsoid at={x},9,6 half=4"));
        execute(&mut session, &format!("save {path:?}"));
        drop(session);
        session = reopen(&path, on_disk(folder.path()));
    }
    drop(session);
    let kept = std::fs::read_dir(folder.path().join("histories")).unwrap().count();
    assert_eq!(kept, 1, "that of what the file held before is gone");
    std::fs::rename(&path, &moved).unwrap();
    let mut session = reopen(&moved, on_disk(folder.path()));
    for expected in hashes.iter().rev() {
        execute(&mut session, "undo 1");
        assert_eq!(hash(&session), *expected);
    }
    assert_eq!(counts(&session), [0, 6]);
}

#[test]
fn undo_leads_to_no_file_of_an_earlier_session() {
    let folder = tempfile::tempdir().unwrap();
    let [path, other] = ["a.vsc", "other.vsc"].map(|name| folder.path().join(name));
    files(folder.path());
    let mut session = begin("new dims=24,20,12 colour=24", on_disk(folder.path()));
    execute(&mut session, &format!("open {other:?}"));
    execute(&mut session, "new dims=9,9,9 colour=8");
    execute(&mut session, &format!("save {path:?}"));
    drop(session);
    let mut session = reopen(&path, on_disk(folder.path()));
    assert_eq!(counts(&session), [2, 0]);
    execute(&mut session, "undo 1");
    assert_eq!(session.document().grid().dims().to_array(), [13, 7, 11]);
    assert_eq!(session.path(), None, "it would be overwritten unseen");
    assert!(session.modified());
    execute(&mut session, "redo 1");
    assert_eq!((session.path(), session.modified()), (Some(path.as_path()), false));
}

#[test]
fn a_journal_and_a_recording_go_on_from_it() {
    let folder = tempfile::tempdir().unwrap();
    let [path, record] = ["a.vsc", "a.sculpt"].map(|name| folder.path().join(name));
    let mut session = begin("new dims=24,20,12 colour=24", on_disk(folder.path()));
    for x in [4, 9, 14] {
        execute(&mut session, &format!("subtract ellipsoid at={x},9,6 half=4"));
    }
    execute(&mut session, &format!("save {path:?}"));
    drop(session);

    let memory = Memory::default();
    let mut session = begin("new dims=8,8,8 colour=8", on_disk(folder.path()));
    session.record_to(&record).unwrap();
    session.keep_journal(crate::journal::options(&memory)).unwrap();
    for line in [format!("open {path:?}").as_str(), "undo 2", "redo 1", "clear", "undo 3"] {
        execute(&mut session, line);
        session.sync_journal();
        let again = crate::journal::recovered(&memory.left(true)).unwrap();
        assert_eq!(again.report.difference, None, "{line}");
        crate::journal::assert_same(
            &crate::journal::all_of(&again.session),
            &crate::journal::all_of(&session),
        );
    }
    assert_eq!(session.take_journal_error().map(|error| error.to_string()), None);
    // Without the history, and without the file, the recording leads to the same sculpture.
    std::fs::remove_file(&path).unwrap();
    let new: NewSculpture = match "new dims=2,2,2 colour=8".parse().unwrap() {
        Command::New(new) => new,
        _ => panic!(),
    };
    let mut replay = Session::new(&new, Limits::default()).unwrap();
    let text = std::fs::read_to_string(&record).unwrap();
    for (_, command) in sculpture_core::command::text::parse_script(&text).unwrap() {
        replay.execute(&command, &()).unwrap();
    }
    assert_eq!(hash(&replay), hash(&session));
}
