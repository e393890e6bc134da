//! The interface: panels, windows and messages over the sculpture, in egui.
//!
//! Reads the program through [`UiContext`], changes only its own choices in [`UiState`], and expresses everything else
//! as [`UiRequest`]s. It changes no sculpture and knows no Vulkan.

pub mod board;
mod context;
pub mod dialogs;
mod dropped;
pub mod gizmo;
pub mod history;
pub mod layout;
pub mod memory;
pub mod options;
mod panel_head;
pub mod panels;
pub mod pens;
pub mod pictures;
mod recent_menu;
pub mod references;
mod request;
pub mod state;
pub mod status;
pub mod switches;
pub mod tasks;
pub mod toolbox;
pub mod top_bar;
mod upright;
pub mod view_options;
pub mod view_state;
pub mod widgets;
mod window;
pub mod window_options;

pub use context::{FrameTimes, UiContext};
pub use request::UiRequest;
pub use state::{UiOptions, UiState};
pub use tasks::ScreenshotTo;
pub use view_options::ViewOptions;
pub use view_state::ViewState;
pub use window::show;
pub use window_options::{SCALE_RANGE, Theme, WindowOptions};
