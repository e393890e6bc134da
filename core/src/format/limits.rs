//! How long headers and texts of volumes may be, for the readers and for the errors that name the bounds.
//!
//! Numbers alone; knows no file and no error.

/// Longest header that is read, comments included.
pub const HEADER_LIMIT: usize = 64 << 10;
/// Most bytes of texts that are read. The format itself sets no limit.
pub const TEXTS_LIMIT: u64 = 16 << 20;
