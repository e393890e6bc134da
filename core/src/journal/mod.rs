//! The journal of a session: a file that is always far enough ahead that a crash, a signal or an empty battery
//! costs at most the stroke in hand and what ended just before it.
//!
//! A journal begins with a **checkpoint**: all that the session began with, by content. What follows are
//! **entries**: the commands that were executed, and the files that they read. `files` is the file layer,
//! `frame` the framing of records, `entry` and `checkpoint` what they mean, `writer` the thread that writes, `growing` its file,
//! `live` knows all of this process,
//! `shelf` the folder in which journals lie, `reader` reads one. Knows documents, but no session: that
//! replays them.

mod checkpoint;
mod entry;
pub mod files;
pub mod frame;
mod growing;
mod live;
mod reader;
mod shelf;
mod writer;

pub use checkpoint::{Checkpoint, SculptureFile};
pub use entry::{Entry, Mark};
pub use live::sync_all;
pub use reader::{JournalError, JournalReader};
pub use shelf::{Left, Shelf};
pub use writer::{JournalOptions, JournalWriter, STATES};
