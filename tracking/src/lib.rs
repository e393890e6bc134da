//! Head tracking: poses from trackers, for a picture that follows the eye.
//!
//! Sources ([`vrpn::Client`], [`opentrack::Opentrack`], [`scripted::Scripted`], or any other
//! [`Source`]) report poses and controls. A [`Tracker`] owns them; it transforms each report from the
//! tracker's axes to the screen's ([`calibration`]), smooths it ([`filter`]), predicts where the
//! head will be when the frame is seen ([`predict`]), and fades at loss and recovery ([`fade`]).
//! [`vrpn::server`] serves poses to others.
//!
//! Knows no Vulkan and no window. Only the threads of the sources read a clock: elsewhere time is a value,
//! seconds on the host's monotonic clock ([`HostClock`]).

#![cfg_attr(not(test), warn(clippy::too_many_lines))]

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
