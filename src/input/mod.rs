//! From devices to actions: what a key, a drag or the wheel stands for is one table
//! ([`bindings`]), read from text, so that presets, gamepads and headsets are further tables.
//!
//! Knows no sculpture and no window: it takes device events as values and gives [`ActionEvent`]s.

pub mod action;
mod action_help;
pub mod bindings;
pub mod events;
pub mod group;
pub mod hands;
pub mod listener;
pub mod mapper;
pub(crate) mod pace;
pub mod pad;
pub mod panel;
pub mod personal;
pub mod remap;
mod synonyms;
pub mod trigger;

pub use action::{Action, Axis, Side, Step, ToolMode};
pub use bindings::Bindings;
pub use events::DeviceEvent;
pub use mapper::{ActionEvent, Mapper};
pub use panel::Panel;
pub use personal::Personal;
pub use trigger::Trigger;
