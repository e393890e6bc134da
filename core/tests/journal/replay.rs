//! A replay restores the session: at the end, at every prefix, with every byte damaged.

use std::time::Duration;

use glam::UVec3;
use proptest::prelude::*;
use sculpture_core::command::Command;
use sculpture_core::document::Limits;
use sculpture_core::persist::frame::Ending;
use sculpture_core::persist::journal::{AbandonedJournal, JournalOptions};
use sculpture_core::sculpture::Digest;
use sculpture_core::session::{Session, recover, summary};

use super::memory::Memory;
use super::{all_of, assert_same, options, recovered, session};
use crate::commands::strategies::{new_sculpture, work};

fn execute(session: &mut Session, line: &str) {
    session.execute(&line.parse().unwrap(), &()).unwrap_or_else(|error| panic!("{line}: {error}"));
}

/// Returns the journal once everything so far is written.
fn written(session: &Session, memory: &Memory) -> Vec<u8> {
    session.wait_for_journal();
    memory.bytes("1.journal").unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// With any commands executed or refused, a small history, and checkpoints in between or not.
    #[test]
    fn a_replay_is_the_session(
        new in new_sculpture(20),
        commands in prop::collection::vec(work(), 1..30),
        history_bytes in prop_oneof![Just(1usize << 30), 0usize..60_000],
        always_anew in any::<bool>(),
    ) {
        let memory = Memory::default();
        let limits = Limits { history_bytes, ..Limits::default() };
        let mut session = Session::new(&new, limits).unwrap();
        let replay = if always_anew { Duration::ZERO } else { Duration::from_secs(1000) };
        session.keep_journal(JournalOptions { replay, ..options(&memory) }).unwrap();
        for command in &commands {
            let _ = session.execute(command, &());
            session.wait_for_journal();
            let again = recovered(&memory.left(false)).unwrap();
            prop_assert_eq!(&again.report.difference, &None);
            prop_assert_eq!(again.report.ending, Ending::Whole);
            prop_assert_eq!(again.report.in_stroke, session.document().stroke_open());
            prop_assert!(again.session.document().contents() == session.document().contents());
            if !session.document().stroke_open() {
                assert_same(&all_of(&again.session), &all_of(&session));
                prop_assert_eq!(again.session.modified(), session.modified());
            }
        }
    }
}

#[test]
fn a_replay_drops_the_steps_that_the_session_dropped() {
    // Many colours a brick.
    const RED: &str = "noise colour=#a02010 size=3 amount=1 seed=1";
    const GREEN: &str = "noise colour=#20a010 size=3 amount=1 seed=2";
    let memory = Memory::default();
    let mut session = session(Limits { history_bytes: 45_000, ..Limits::default() });
    session.keep_journal(options(&memory)).unwrap();
    for line in [RED, GREEN, "clear", "undo 3", "redo 1"] {
        execute(&mut session, line);
        session.wait_for_journal();
        let again = recovered(&memory.left(false)).unwrap();
        assert_same(&all_of(&again.session), &all_of(&session));
        let limits = again.session.document().limits();
        assert_eq!(
            limits.history_bytes,
            Limits::default().history_bytes,
            "it may keep more from now on"
        );
        assert_eq!(again.session.document().history().budget_bytes(), limits.history_bytes);
    }
    assert!(session.document().history().dropped() > 0, "the history was too small for all");
}

#[test]
fn steps_on_disk_are_in_the_journal() {
    let folder = tempfile::tempdir().unwrap();
    let memory = Memory::default();
    let limits = Limits { history_bytes: 20_000, history_disk_bytes: 1 << 30, ..Limits::default() };
    let mut session = session(limits);
    session.keep_history_in(folder.path()).unwrap();
    let replay = Duration::ZERO;
    session.keep_journal(JournalOptions { replay, ..options(&memory) }).unwrap();
    let hash = |session: &Session| Digest::of(session.document().contents());
    let mut hashes = vec![hash(&session)];
    for shade in 1..9 {
        // Steps larger than the memory for all, each after a checkpoint of the previous ones.
        let line = format!("recolour cuboid at=12,10,6 half=20 colour=#{shade}02010");
        execute(&mut session, &line);
        session.sync_journal();
        hashes.push(hash(&session));
    }
    execute(&mut session, "undo 3");
    session.sync_journal();
    let left = memory.left(false);
    let journal_dir = options(&left).journal_dir;
    let AbandonedJournal::Journal(source) = journal_dir.open(journal_dir.numbers().unwrap()[0])
    else {
        panic!("in use")
    };
    let again = recover(source, &limits, Some(folder.path()), &()).unwrap();
    assert_eq!(again.report.difference, None);
    for session in [&mut session, &mut { again.session }] {
        assert_eq!(hash(session), hashes[5]);
        execute(session, "redo all");
        for expected in hashes.iter().rev() {
            assert_eq!(hash(session), *expected);
            execute(session, "undo 1");
        }
        assert_eq!(session.document().history().dropped(), 0);
        assert_eq!((session.take_history_message(), session.take_journal_message()), (None, None));
    }
}

#[test]
fn files_and_pictures_are_kept_by_content() {
    let folder = tempfile::tempdir().unwrap();
    let [other, picture, saved] =
        ["other.vsc", "picture.png", "saved.vsc"].map(|name| folder.path().join(name));
    let paint = |rgb: [u8; 3]| {
        image::RgbImage::from_pixel(2, 2, image::Rgb(rgb)).save(&picture).unwrap();
    };
    paint([200, 10, 20]);
    let mut made = session(Limits::default());
    execute(&mut made, "subtract ellipsoid at=9,9,9 half=8");
    execute(&mut made, &format!("save {other:?}"));

    let memory = Memory::default();
    let mut session = session(Limits::default());
    session.keep_journal(options(&memory)).unwrap();
    let texture = format!("texture {picture:?} cuboid at=8,8,8 half=4");
    for line in ["begin", &texture, "end", "begin", &texture, "end", "array count=1 step=4,0,0"] {
        execute(&mut session, line);
    }
    paint([20, 210, 30]);
    for line in ["begin", &texture, "end"] {
        execute(&mut session, line);
    }
    execute(&mut session, &format!("open {other:?}"));
    execute(&mut session, "copy");
    execute(&mut session, "clear marker");
    execute(&mut session, &format!("save {saved:?}"));
    execute(&mut session, "undo 2");
    execute(&mut session, "redo 2");
    assert!(!session.modified());
    execute(&mut session, "paste at=1,1,1");
    session.wait_for_journal();
    // None of the files exists any more.
    drop(folder);
    let source = |memory: &Memory| match options(memory).journal_dir.open(1) {
        AbandonedJournal::Journal(source) => source,
        _ => panic!("it cannot be opened"),
    };
    let left = memory.left(false);
    let again = recover(source(&left), &Limits::default(), None, &()).unwrap();
    assert_eq!(again.report.difference, None);
    assert_same(&all_of(&again.session), &all_of(&session));
    assert_eq!(again.session.path(), Some(&*saved));
    assert!(again.session.modified());
    let known = summary(source(&left), &Limits::default()).unwrap();
    assert_eq!((known.path.as_deref(), known.modified), (Some(&*saved), true));
    assert_eq!(known.steps, session.document().history().undo_count() as u64);
    assert_eq!(known.voxels, session.document().grid().opaque_count());

    // The recovered session continues like the other, and its journal begins with its whole state.
    let mut again = again.session;
    let second = Memory::default();
    again.keep_journal(options(&second)).unwrap();
    for line in ["undo", "undo", "clear", "undo all", "redo 3"] {
        execute(&mut session, line);
        execute(&mut again, line);
        assert_same(&all_of(&again), &all_of(&session));
    }
    again.wait_for_journal();
    let third = recovered(&second.left(false)).unwrap();
    assert_same(&all_of(&third.session), &all_of(&session));
}

#[test]
fn cut_or_damaged_anywhere_it_gives_back_a_state_that_was() {
    let memory = Memory::default();
    let mut session = session(Limits::default());
    session.keep_journal(options(&memory)).unwrap();
    let mut states = vec![Digest::of(session.document().contents())];
    let mut ends = vec![written(&session, &memory).len()];
    for line in [
        "subtract cuboid at=4,4,4 half=2",
        "begin \"a stroke\"",
        "recolour cuboid at=8,8,8 half=3 colour=#204060",
        "add ellipsoid at=3,3,3 half=2",
        "end",
        "undo",
    ] {
        execute(&mut session, line);
        states.push(Digest::of(session.document().contents()));
        ends.push(written(&session, &memory).len());
    }
    let whole = written(&session, &memory);
    let digest_of = |bytes: &[u8]| {
        let left = Memory::with_journal(bytes);
        let AbandonedJournal::Journal(source) = options(&left).journal_dir.open(1) else {
            panic!()
        };
        recover(source, &Limits::default(), None, &()).ok().map(|again| {
            assert_eq!(again.report.difference, None);
            Digest::of(again.session.document().contents())
        })
    };
    for cut in 0..=whole.len() {
        let complete = ends.iter().filter(|end| **end <= cut).count();
        let expected = complete.checked_sub(1).map(|last| states[last]);
        assert_eq!(digest_of(&whole[..cut]), expected, "cut at {cut}");
    }
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x55;
        let complete = ends.iter().filter(|end| **end <= at).count();
        let expected = complete.checked_sub(1).map(|last| states[last]);
        assert_eq!(digest_of(&damaged), expected, "damaged at {at}");
    }
}

#[test]
fn a_replay_that_goes_another_way_is_reported() {
    let memory = Memory::default();
    let mut session = session(Limits::default());
    session.keep_journal(options(&memory)).unwrap();
    execute(&mut session, "subtract cuboid at=4,4,4 half=2");
    let bytes = written(&session, &memory);
    // The same command with another size, and a matching checksum.
    let at = bytes.windows(6).rposition(|window| window == b"half=2").unwrap();
    let frame = bytes.windows(8).rposition(|window| window == b"subtract").unwrap() - 44 - 21;
    let mut other = bytes.clone();
    other[at + 5] = b'3';
    let mut crc = crc32fast::Hasher::new();
    crc.update(&other[frame..frame + 17]);
    crc.update(&other[frame + 21..]);
    other[frame + 17..frame + 21].copy_from_slice(&crc.finalize().to_le_bytes());
    let again = recovered(&Memory::with_journal(&other)).unwrap();
    let difference = again.report.difference.unwrap();
    assert!(
        difference.contains("entry 1") && difference.contains("the session had"),
        "{difference}"
    );
    assert_eq!(again.report.entries, 1, "what it led to is given back all the same");
}

#[test]
fn a_checkpoint_with_a_part_of_the_history_still_replays_undo_of_all_of_it() {
    let memory = Memory::default();
    let mut session = session(Limits::default());
    let replay = Duration::ZERO;
    session.keep_journal(JournalOptions { replay, max_bytes: 3000, ..options(&memory) }).unwrap();
    for i in 0..24 {
        execute(&mut session, &format!("subtract cuboid at={i},4,4 half=1"));
        session.wait_for_journal();
    }
    execute(&mut session, "clear");
    session.wait_for_journal();
    let kept = recovered(&memory.left(false)).unwrap();
    let kept = kept.session.document().history().undo_count();
    assert!(kept < 25, "{kept}");
    for line in ["undo 3", "redo 1", "undo all", "redo 20", "clear", "undo 9"] {
        execute(&mut session, line);
        session.wait_for_journal();
        let again = recovered(&memory.left(false)).unwrap();
        assert_eq!(again.report.difference, None, "{line}");
        assert!(again.session.document().contents() == session.document().contents(), "{line}");
    }
}

#[test]
fn it_is_removed_where_nothing_is_lost_and_stays_where_something_is() {
    let memory = Memory::default();
    let mut unchanged = session(Limits::default());
    unchanged.keep_journal(options(&memory)).unwrap();
    unchanged.wait_for_journal();
    assert_eq!((unchanged.journal_number(), memory.count()), (Some(1), 1));
    let mut changed = session(Limits::default());
    changed.keep_journal(options(&memory)).unwrap();
    execute(&mut changed, "clear");
    changed.wait_for_journal();
    assert_eq!(changed.journal_number(), Some(2), "no two share a number");
    assert!(matches!(options(&memory).journal_dir.open(2), AbandonedJournal::InUse));
    drop(unchanged);
    assert_eq!(memory.count(), 1);
    drop(changed);
    assert!(matches!(options(&memory).journal_dir.open(2), AbandonedJournal::Journal(_)));
    let mut discarded = session(Limits::default());
    discarded.keep_journal(options(&memory)).unwrap();
    execute(&mut discarded, "clear");
    discarded.discard_journal();
    assert_eq!(memory.count(), 1);
    assert_eq!(UVec3::from_array(summary_dims(&memory)), UVec3::new(24, 20, 12));
}

fn summary_dims(memory: &Memory) -> [u32; 3] {
    let AbandonedJournal::Journal(source) = options(memory).journal_dir.open(2) else { panic!() };
    summary(source, &Limits::default()).unwrap().dims
}

#[test]
fn a_session_within_a_stroke_begins_no_journal() {
    let mut session = session(Limits::default());
    session.execute(&Command::Begin { label: String::new() }, &()).unwrap();
    assert!(session.keep_journal(options(&Memory::default())).is_err());
}
