//! Journals through the public interface: replay of the whole, of every prefix, with every operation on files failing
//! once, and after power cuts.

mod faults;
pub mod memory;
mod recording;
mod replay;

use std::path::Path;
use std::time::Duration;

use sculpture_core::document::{DocumentSnapshot, Limits};
use sculpture_core::persist::journal::{AbandonedJournal, JournalDir, JournalOptions};
use sculpture_core::session::{Recovered, Session, recover};

use self::memory::Memory;

pub fn options(memory: &Memory) -> JournalOptions {
    let journal_dir = JournalDir::with_files(Path::new("/state/journals"), memory.files());
    JournalOptions { retry: Duration::from_millis(1), ..JournalOptions::new(journal_dir) }
}

/// Returns a session with a new sculpture of 24x20x12 voxels and 24 bits of colour.
pub fn session(limits: Limits) -> Session {
    let new = "new dims=24,20,12 colour=24".parse().unwrap();
    let sculpture_core::command::Command::New(new) = new else { panic!() };
    Session::new(&new, limits).unwrap()
}

/// Returns the session recovered from the only journal.
pub fn recovered(memory: &Memory) -> Option<Recovered> {
    let journal_dir = options(memory).journal_dir;
    let number = *journal_dir.numbers().unwrap().first()?;
    let AbandonedJournal::Journal(source) = journal_dir.open(number) else {
        panic!("it is in use")
    };
    Some(recover(source, &Limits::default(), None, &()).unwrap())
}

/// Returns everything that belongs to a session between two strokes.
pub fn all_of(session: &Session) -> DocumentSnapshot {
    session.document().snapshot().unwrap()
}

/// Asserts that two sessions are equal to the byte, in contents, history, clipboard, settings and identifiers.
pub fn assert_same(a: &DocumentSnapshot, b: &DocumentSnapshot) {
    assert!(a.contents == b.contents, "contents");
    assert_eq!(a.history, b.history);
    assert_eq!(a.clip, b.clip);
    assert_eq!((&a.settings, &a.last_uses), (&b.settings, &b.last_uses));
    assert_eq!((a.state, a.states), (b.state, b.states));
}
