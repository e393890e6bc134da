//! Head tracking in front of a screen: the options, and the sources of poses behind an address.
//!
//! The trackers, filters and protocols themselves are in the crate `tracking`. Must not know windows
//! or sculptures.

pub mod options;
pub mod source;

pub use options::{ScreenOptions, SourceAddress, TrackingOptions};
pub use source::SourceError;
