//! The source of films and final pictures of the view: the sculpture and the view as it is at the start.

use crate::gpu::DeviceOptions;
use crate::session::Session;
use crate::ui::ViewState;
use crate::view::Eye;

/// The sculpture in the view of the window.
pub(super) struct ViewSource<'a> {
    pub session: &'a Session,
    pub view: &'a ViewState,
    /// The eye that sees it.
    pub eye: Eye,
    /// The device for drawing without a window.
    pub device: &'a DeviceOptions,
}
