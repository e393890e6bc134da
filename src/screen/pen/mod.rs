//! Pens of graphics tablets, from the window system of the windows: Wayland's tablet protocol, or the devices of
//! XInput2. Without either, or without a tablet, a pen acts as the mouse that the system makes of it.
//!
//! Turns the display and the windows of winit into [`PenReport`]s about pens over windows. A thread listens; nothing
//! here waits for it, and every failure is just a line in the log. On Windows, winit itself reports the pressure of
//! pens as that of a touch.

#[cfg(target_os = "linux")]
mod inbox;
#[cfg(test)]
#[cfg(target_os = "linux")]
mod test_compositor;
#[cfg(target_os = "linux")]
mod wayland;
#[cfg(target_os = "linux")]
pub mod wayland_tools;
#[cfg(target_os = "linux")]
mod x11;
#[cfg(target_os = "linux")]
pub mod xi2;

use winit::event_loop::OwnedDisplayHandle;
use winit::raw_window_handle::{HasWindowHandle, RawWindowHandle};

use crate::input::pen::PenSample;

/// Names a window as its window system does.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct WindowKey(u64);

impl WindowKey {
    /// Returns the key of a window; `None` on systems without a back end.
    pub fn of(window: &impl HasWindowHandle) -> Option<WindowKey> {
        match window.window_handle().ok()?.as_raw() {
            RawWindowHandle::Wayland(handle) => {
                Some(WindowKey(handle.surface.as_ptr() as usize as u64))
            }
            RawWindowHandle::Xlib(handle) => Some(WindowKey(u64::from(handle.window as u32))),
            RawWindowHandle::Xcb(handle) => Some(WindowKey(u64::from(handle.window.get()))),
            _ => None,
        }
    }

    /// Creates a key from the window system's number of a window.
    pub fn numbered(number: u64) -> WindowKey {
        WindowKey(number)
    }

    /// Returns the number of an X11 window.
    #[cfg(target_os = "linux")]
    fn xid(self) -> Option<u32> {
        u32::try_from(self.0).ok()
    }
}

/// A pen event over a window.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PenReport {
    pub window: WindowKey,
    /// Its position is in points of the display on Wayland, and in pixels on X11 ([`Pens::are_in_points`]).
    pub sample: PenSample,
}

/// The pens of all windows.
pub struct Pens {
    #[cfg(target_os = "linux")]
    backend: Option<Backend>,
    #[cfg(target_os = "linux")]
    watched: std::collections::BTreeSet<WindowKey>,
    /// Keeps the back end's connection alive; dropped after it.
    _display: OwnedDisplayHandle,
}

#[cfg(target_os = "linux")]
enum Backend {
    Wayland(wayland::WaylandPens),
    X11(x11::X11Pens),
}

#[cfg(target_os = "linux")]
impl Pens {
    /// Listens for pens on a display. `wake` is called on another thread when there are reports.
    pub fn new(display: OwnedDisplayHandle, wake: impl Fn() + Send + 'static) -> Pens {
        use winit::raw_window_handle::{HasDisplayHandle, RawDisplayHandle};
        let raw = display.display_handle().map(|handle| handle.as_raw());
        let backend = match raw {
            Ok(RawDisplayHandle::Wayland(handle)) => {
                // SAFETY: the pointer is winit's display, which lives as long as `display`, and that is dropped after
                // the back end.
                let pens = unsafe { wayland::WaylandPens::on(handle.display, wake) };
                pens.map(Backend::Wayland).map_err(|error| error.to_string())
            }
            Ok(RawDisplayHandle::Xlib(_) | RawDisplayHandle::Xcb(_)) => {
                x11::X11Pens::connect(wake).map(Backend::X11).map_err(|error| error.to_string())
            }
            _ => Err("pens are not supported on this window system".to_string()),
        };
        let backend =
            backend.inspect_err(|error| tracing::debug!("pens act as mice: {error}")).ok();
        Pens { backend, watched: Default::default(), _display: display }
    }

    /// Also listens to the pens over a window.
    pub fn watch(&mut self, window: WindowKey) {
        if !self.watched.insert(window) {
            return;
        }
        if let Some(Backend::X11(pens)) = &mut self.backend {
            pens.watch(window);
        }
    }

    /// Returns all reports since the last call, in order.
    pub fn take(&mut self) -> Vec<PenReport> {
        match &mut self.backend {
            Some(Backend::Wayland(pens)) => pens.take(),
            Some(Backend::X11(pens)) => pens.take(),
            None => Vec::new(),
        }
    }

    /// Returns the names of the tablets and pens, if they have changed since the last call.
    pub fn take_names(&mut self) -> Option<Vec<String>> {
        match &mut self.backend {
            Some(Backend::Wayland(pens)) => pens.take_names(),
            Some(Backend::X11(pens)) => pens.take_names(),
            None => None,
        }
    }

    /// Returns whether positions are in points, and a pen causes no other pointer events.
    pub fn are_in_points(&self) -> bool {
        matches!(self.backend, Some(Backend::Wayland(_)))
    }

    /// Shows a cursor at the pens, if the window system leaves that to the program.
    pub fn show_cursor(&mut self, icon: egui::CursorIcon) {
        if let Some(Backend::Wayland(pens)) = &mut self.backend {
            pens.show_cursor(icon);
        }
    }
}

#[cfg(not(target_os = "linux"))]
impl Pens {
    /// Here winit reports pens, as touches with a force.
    pub fn new(display: OwnedDisplayHandle, _wake: impl Fn() + Send + 'static) -> Pens {
        Pens { _display: display }
    }

    pub fn watch(&mut self, _window: WindowKey) {}

    pub fn take(&mut self) -> Vec<PenReport> {
        Vec::new()
    }

    pub fn take_names(&mut self) -> Option<Vec<String>> {
        None
    }

    pub fn are_in_points(&self) -> bool {
        false
    }

    pub fn show_cursor(&mut self, _icon: egui::CursorIcon) {}
}

/// Describes the session's support of pens in a line.
#[cfg(target_os = "linux")]
pub fn survey() -> String {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let on_wayland = match set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET") {
        true => Some(wayland::survey()),
        false => None,
    };
    match on_wayland {
        Some(Ok(text)) => text,
        Some(Err(error)) if !set("DISPLAY") => format!("Wayland: {error}"),
        _ if set("DISPLAY") => x11::survey().unwrap_or_else(|error| format!("X11: {error}")),
        _ => "no display to ask".to_string(),
    }
}

/// Describes the session's support of pens in a line.
#[cfg(not(target_os = "linux"))]
pub fn survey() -> String {
    "pressure, where the system reports pens as touches".to_string()
}
