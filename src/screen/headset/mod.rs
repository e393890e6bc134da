//! The way to a headset through OpenXR: what the machine offers ([`probe`]), a session from
//! connecting to parting ([`link`]), all that calls the runtime within it on a thread of its own
//! ([`session`]), the states that it goes through ([`lifecycle`]), images, hands. And where the head is, for the view through a screen:
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
pub mod options;
mod parting;
mod probe;
mod runtime;
mod session;
mod tracker;
mod worn;

pub use error::HeadsetError;
pub use link::{Link, LinkOptions, RoomOrigin};
pub use options::HeadsetOptions;
pub(crate) use parting::Helper;
pub use probe::probe;
pub use runtime::{Blend, Connector};
pub use session::{Aimed, Frame, Layers, LinkNews};
pub use tracker::HeadsetTracker;
pub use worn::WornHead;
