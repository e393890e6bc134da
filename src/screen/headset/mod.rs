//! Headsets through OpenXR: the runtime of this machine ([`probe`]), a session from connecting to
//! closing ([`link`]), its thread, which makes all calls to the runtime ([`session`]), its states
//! ([`lifecycle`]), images and hands. Also head poses for the view through a screen: of a headset
//! that shows nothing ([`HeadsetTracker`]), or of the one in use ([`WornHead`]).
//!
//! The loader is a system library that is loaded when first needed, so that the program runs
//! without it. Takes finished pictures; returns views and hands as values. Knows no sculpture.

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
