//! Files.

pub mod dds;
mod error;
pub mod pvm;
pub mod volume;

pub use error::FormatError;
pub use volume::{Samples, Texts, Volume};
