//! Limits of the length of headers and texts of volumes, for the readers and for the errors that name the limits.
//!
//! Numbers alone; knows no file and no error.

/// Greatest length of a header, comments included.
pub const HEADER_LIMIT: usize = 64 << 10;
/// Greatest number of bytes of texts that are read. The format itself sets no limit.
pub const TEXTS_LIMIT: u64 = 16 << 20;
