//! The way to a headset through OpenXR: what the machine offers ([`probe`]), a session from
//! connecting to parting ([`link`]), the states that it goes through ([`lifecycle`]), images,
//! hands, and the wait for the next frame. And where the head is, for the view through a screen:
//! asked of a headset that shows nothing ([`HeadsetTracker`]) or of the one that is worn
//! ([`WornHead`]).
//!
//! The loader is a library of the system, loaded when it is first asked for, so that the program
//! runs where there is none. Takes finished pictures; gives views and hands as values. Knows no
//! sculpture.

mod actions;
mod chain;
pub mod error;
mod host;
mod lifecycle;
pub mod link;
mod locator;
mod parting;
mod probe;
mod runtime;
mod tracker;
mod waiter;
mod worn;

pub use error::HeadsetError;
pub use link::{Layers, Link, LinkOptions, RoomOrigin, Standing};
pub use probe::probe;
pub use runtime::Blend;
pub use tracker::HeadsetTracker;
pub use waiter::{FrameNews, FrameTime};
pub use worn::WornHead;
