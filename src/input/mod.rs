//! From devices to actions: one table ([`bindings`]), read from text, maps keys, drags and the
//! wheel to actions; presets are such tables. Gamepads and hands have mappers of their own.
//!
//! Knows no sculpture and no window: takes device events as values and returns [`ActionEvent`]s.

pub mod action;
pub mod bindings;
pub mod button;
pub mod draw_kind;
pub mod events;
pub mod group;
pub mod hands;
pub mod listener;
pub mod mapper;
pub(crate) mod pace;
pub mod pad;
pub mod panel;
pub mod pen;
pub mod personal;
pub mod remap;
pub mod tool_mode;
pub mod trigger;

pub use action::{Action, Axis, ScreenDirection, Side};
pub use bindings::Bindings;
pub use button::{Button, Buttons};
pub use draw_kind::DrawKind;
pub use events::DeviceEvent;
pub use mapper::{ActionEvent, Mapper};
pub use panel::Panel;
pub use personal::Personal;
pub use tool_mode::ToolMode;
pub use trigger::Trigger;
