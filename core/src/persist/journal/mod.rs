//! The journal of a session: a file that is always far enough ahead that a crash, a signal or an empty battery
//! costs at most the stroke in hand and what ended just before it.
//!
//! A journal begins with a **checkpoint**: all that the session began with, by content. It is followed by
//! **entries**: the commands that were executed, and the files that they read. `entry` and `checkpoint` define the
//! meaning of records, `writer` is the thread that writes, `growing` is its file, `live` knows all journals of this
//! process, `dir` is the folder in which journals lie, and `reader` reads one. Knows documents, but no session: the
//! session replays journals.

mod checkpoint;
mod dir;
mod entry;
mod growing;
mod live;
mod reader;
mod writer;

pub use checkpoint::Checkpoint;
pub use dir::{AbandonedJournal, JournalDir};
pub use entry::{Entry, Mark};
pub use live::sync_all;
pub use reader::{JournalError, JournalReader};
pub use writer::{JournalOptions, JournalWriter, STATES};
