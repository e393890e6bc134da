//! Every operation on files fails once, in every way; disks fill up, folders vanish, the power is cut. In each case
//! work continues, and the remaining files hold a state that the session had.

use std::time::Duration;

use sculpture_core::document::Limits;
use sculpture_core::persist::journal::JournalOptions;
use sculpture_core::sculpture::Digest;
use sculpture_core::session::Session;

use super::memory::{Fault, Memory};
use super::{options, recovered, session};

const SCRIPT: [&str; 9] = [
    "subtract cuboid at=4,4,4 half=2",
    "begin \"a stroke\"",
    "recolour cuboid at=8,8,8 half=3 colour=#204060",
    "add ellipsoid at=4,4,4 half=2",
    "end",
    "orient upright=z",
    "undo",
    "new dims=9,9,9 colour=8",
    "subtract ellipsoid at=4,4,4 half=3",
];

/// Executes the script, and returns a hash of each state that the session had.
fn run(session: &mut Session) -> Vec<Digest> {
    let mut states = vec![Digest::of(session.document().contents())];
    for line in SCRIPT {
        session.execute(&line.parse().unwrap(), &()).unwrap();
        states.push(Digest::of(session.document().contents()));
        session.sync_journal();
    }
    states
}

/// Lets the journal catch up, until a power cut would leave `state` or some time has passed.
fn attend(session: &mut Session, memory: &Memory, state: Digest) {
    for _ in 0..40 {
        session.attend_journal();
        session.sync_journal();
        let name = session.journal_number().map(|number| format!("{number}.journal"));
        let bytes = name.and_then(|name| memory.left(true).bytes(&name));
        if bytes.and_then(|bytes| left(&Memory::with_journal(&bytes))) == Some(state) {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Returns the state that a disk restores; `None` if there is no journal.
fn left(memory: &Memory) -> Option<Digest> {
    let again = recovered(memory)?;
    assert_eq!(again.report.difference, None);
    Some(Digest::of(again.session.document().contents()))
}

#[test]
fn with_any_operation_failing_what_is_left_is_a_state_that_was_and_soon_the_last() {
    for fault in [Fault::Refused, Fault::Short, Fault::DoneAndRefused] {
        for anew in [false, true] {
            let mut calls = 0;
            loop {
                let memory = Memory::default();
                memory.fail_after(calls, fault);
                let mut session = session(Limits::default());
                let replay = if anew { Duration::ZERO } else { Duration::from_secs(1000) };
                session.keep_journal(JournalOptions { replay, ..options(&memory) }).unwrap();
                let states = run(&mut session);
                for power_cut in [false, true] {
                    if let Some(state) = left(&memory.left(power_cut)) {
                        assert!(states.contains(&state), "{fault:?} {calls} {power_cut}");
                    }
                }
                attend(&mut session, &memory, states[states.len() - 1]);
                let number = session.journal_number().unwrap();
                let path = format!("{number}.journal");
                for power_cut in [false, true] {
                    let last =
                        memory.left(power_cut).bytes(&path).map(|b| Memory::with_journal(&b));
                    let state = last.and_then(|memory| left(&memory));
                    assert_eq!(state, states.last().copied(), "{fault:?} {calls} {power_cut}");
                }
                if memory.calls() < calls {
                    break;
                }
                calls += 1;
            }
            assert!(calls > 20, "{calls}");
        }
    }
}

#[test]
fn a_full_disk_is_told_once_and_caught_up_with() {
    let memory = Memory::default();
    let mut session = session(Limits::default());
    session.keep_journal(options(&memory)).unwrap();
    session.sync_journal();
    let used = memory.bytes("1.journal").unwrap().len();
    memory.set_room(Some(used + 100));
    let states = run(&mut session);
    attend(&mut session, &memory, states[states.len() - 1]);
    let message = session.take_journal_message().unwrap();
    assert!(message.contains("/state/journals") && message.contains("work goes on"), "{message}");
    assert_eq!(session.take_journal_message(), None, "it is said once");
    assert!(states.contains(&left(&memory.left(true)).unwrap()));
    memory.set_room(None);
    for _ in 0..50 {
        attend(&mut session, &memory, states[states.len() - 1]);
    }
    assert_eq!(left(&memory.left(true)), states.last().copied());
    let message = session.take_journal_message().unwrap();
    assert!(message.contains("complete again"), "{message}");
}

#[test]
fn a_folder_that_vanishes_is_made_again() {
    let memory = Memory::default();
    let mut session = session(Limits::default());
    session.keep_journal(options(&memory)).unwrap();
    session.sync_journal();
    memory.remove_folder();
    let states = run(&mut session);
    attend(&mut session, &memory, states[states.len() - 1]);
    assert!(session.take_journal_message().unwrap().contains("cannot be written"));
    assert_eq!(left(&memory.left(true)), states.last().copied());
    drop(session);
    assert!(memory.count() > 0, "what is not saved stays");
}
