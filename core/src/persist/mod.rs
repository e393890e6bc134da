//! What a session leaves on the disk beside the sculptures that a person saves: its journal, the undo histories of
//! saved files, and the undo steps that memory has no room for.
//!
//! Journals and saved histories share their bytes on the disk: `frame` is the framing of records, `payload` the numbers
//! and texts in them, `sculpture_file` a record that both have. `files` is the file layer, `dir` a folder of such
//! files. `spill` shares names, locks and checksums alone: its file ends with the session, so that its bytes have no
//! frames. Knows documents, but no session.

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
