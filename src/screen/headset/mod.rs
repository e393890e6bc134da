//! Headsets through OpenXR: the installed runtime ([`probe`]), a session from connecting to closing ([`XrSession`]),
//! the thread that makes all calls to the runtime ([`session_thread`]), the session states ([`lifecycle`]), swapchains
//! and controllers. Also head poses for the off-axis view through a screen: of a headset that is only tracked
//! ([`HeadsetTracker`]), or of the headset in use ([`SessionHead`]).
//!
//! The loader is a system library that is loaded when first needed, so that the program runs without it. Takes finished
//! pictures; returns views and controller states as values. Knows no sculpture.

mod actions;
pub mod error;
mod head_locator;
mod headless_tracker;
mod lifecycle;
pub mod options;
mod probe;
mod room_space;
mod runtime;
mod runtime_thread;
mod session;
mod session_head;
mod session_thread;
mod swapchain;
mod vulkan_host;

pub use error::HeadsetError;
pub use headless_tracker::HeadsetTracker;
pub use options::HeadsetOptions;
pub use probe::probe;
pub use room_space::RoomOrigin;
pub use runtime::{BlendMode, Connector};
pub(crate) use runtime_thread::RuntimeThread;
pub use session::{XrSession, XrSessionOptions};
pub use session_head::SessionHead;
pub use session_thread::{FrameLayers, FrameTargets, XrEvent, XrFrame};
