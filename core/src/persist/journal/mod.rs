//! The journal of a session: a file kept so current that a crash, a signal or an empty battery costs at most the stroke
//! in progress and the strokes that ended just before it.
//!
//! A journal begins with a **checkpoint**: the complete initial state of the session, by content. It is followed by
//! **entries**: the executed commands, and the files that they read. `entry` and `checkpoint` define the meaning of
//! records, `writer` is the thread that writes, `growing` is its file, `live` knows all journals of this process, `dir`
//! is the folder of the journals, and `reader` reads one. Knows documents, but no session: the session replays
//! journals.

mod checkpoint;
mod dir;
mod entry;
mod growing;
mod live;
mod reader;
mod writer;

pub use checkpoint::Checkpoint;
pub use dir::{AbandonedJournal, JournalDir};
pub use entry::{JournalEntry, Mark};
pub use live::sync_all;
pub use reader::{JournalError, JournalReader};
pub use writer::{JournalOptions, JournalWriter, STATES};
