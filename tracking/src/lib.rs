//! Head poses from trackers, for a picture that follows the eye.
//!
//! Sources ([`vrpn::Client`], [`opentrack::Opentrack`], [`scripted::Scripted`], or any other
//! [`Source`]) report poses and controls; a [`Tracker`] owns them, brings each report from the
//! tracker's axes to the screen's ([`calibration`]), smooths it ([`filter`]), foresees where the
//! head will be when the picture is seen ([`predict`]), and fades loss and recovery ([`fade`]).
//! [`vrpn::server`] gives poses to others.
//!
//! Knows no Vulkan and no window. Everything but the threads of the sources is free of clocks:
//! time comes in as seconds on the host's monotonic clock ([`HostClock`]).

pub mod calibration;
mod channel;
pub mod controls;
mod eigen;
mod event;
pub mod fade;
pub mod filter;
pub mod opentrack;
pub mod pose;
pub mod predict;
pub mod scripted;
mod source;
mod tracker;
pub mod vrpn;

pub use channel::{ChannelOptions, Smoothing};
pub use event::{Event, INBOX_CAPACITY, Inbox, Severity};
pub use pose::{HeadPose, Placement, Velocity};
pub use source::{Counters, HostClock, Source, SourceState};
pub use tracker::{BodyId, BodyOptions, Predicted, Presence, Tracker};
