//! The files that a session leaves on disk besides saved sculptures: its journal, the undo histories of saved files,
//! and the undo steps that do not fit into memory.
//!
//! Journals and saved histories share their encoding: `frame` is the framing of records, `payload` the numbers and
//! texts in them, `sculpture_file` a record that both use. `files` is the file layer, `dir` a folder of such files.
//! `spill` shares only names, locks and checksums: its file ends with the session, so that its bytes need no frames.
//! Knows documents, but no session.

mod dir;
pub mod files;
pub mod frame;
pub mod journal;
mod payload;
#[doc(hidden)]
pub mod saved_history;
mod sculpture_file;
#[doc(hidden)]
pub mod spill;

pub use sculpture_file::SculptureFile;
