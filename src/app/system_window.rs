//! Creates the event loop on a server that answers, and a main window that fits the screen. Takes environment and
//! sizes, returns winit's builders; knows nothing of what the windows show.

use winit::dpi::LogicalSize;
use winit::event_loop::EventLoop;
use winit::window::{Window, WindowAttributes};

/// The desktop finds the program's icon by this name: the app_id on Wayland, the class on X11.
#[cfg(target_os = "linux")]
const APPLICATION: &str = "virtual-sculpture";
/// Space that a title bar, the window's frame and the desktop's panel take of a screen, in points.
const AROUND_WINDOW: [u32; 2] = [16, 64];

/// Returns an event loop. On Linux, uses X11 if WAYLAND_DISPLAY names a missing server and DISPLAY is set.
pub fn event_loop<T: 'static>() -> Result<EventLoop<T>, winit::error::EventLoopError> {
    let mut builder = EventLoop::with_user_event();
    #[cfg(target_os = "linux")]
    if linux::is_wayland_dead() && std::env::var_os("DISPLAY").is_some_and(|name| !name.is_empty())
    {
        use winit::platform::x11::EventLoopBuilderExtX11;
        tracing::warn!("WAYLAND_DISPLAY names no running server; using DISPLAY instead");
        builder.with_x11();
    }
    builder.build()
}

/// Returns the attributes of a window, with the name by which the desktop knows this program.
pub fn attributes() -> WindowAttributes {
    let attributes = Window::default_attributes();
    #[cfg(target_os = "linux")]
    let attributes = {
        use winit::platform::wayland::WindowAttributesExtWayland;
        attributes.with_name(APPLICATION, APPLICATION)
    };
    attributes
}

/// Returns the size for a window that should have `wanted`, and whether to maximise it because its title bar or lower
/// edge might be off the screen. All in points.
pub fn fitting(wanted: [u32; 2], screen: Option<LogicalSize<u32>>) -> ([u32; 2], bool) {
    let Some(screen) = screen else { return (wanted, false) };
    let screen = [screen.width, screen.height];
    let is_tight = (0..2).any(|i| wanted[i].saturating_add(AROUND_WINDOW[i]) > screen[i]);
    ([wanted[0].min(screen[0]), wanted[1].min(screen[1])], is_tight)
}

/// Returns a message of the window system without the location in its library's source.
pub fn without_place(error: &dyn std::fmt::Display) -> String {
    let text = error.to_string();
    let Some(rest) = text.strip_prefix("os error at ") else { return text };
    let end = rest.find(".rs:").map(|at| at + ".rs:".len());
    let message = end.and_then(|at| rest[at..].split_once(": "));
    message.map_or_else(|| text.clone(), |(_line, message)| message.to_owned())
}

#[cfg(target_os = "linux")]
mod linux {
    use std::ffi::{OsStr, OsString};
    use std::os::unix::net::UnixStream;
    use std::path::{Path, PathBuf};

    /// Returns whether Wayland is requested by a socket's name, but no server answers there.
    pub fn is_wayland_dead() -> bool {
        let set = |name| std::env::var_os(name).filter(|value: &OsString| !value.is_empty());
        let (Some(display), None) = (set("WAYLAND_DISPLAY"), set("WAYLAND_SOCKET")) else {
            return false;
        };
        let folder = set("XDG_RUNTIME_DIR").map(PathBuf::from);
        !answers(&display, folder.as_deref())
    }

    pub fn answers(display: &OsStr, runtime_folder: Option<&Path>) -> bool {
        let path = match runtime_folder {
            Some(folder) => folder.join(display),
            None => PathBuf::from(display),
        };
        path.is_absolute() && UnixStream::connect(path).is_ok()
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn a_server_answers_until_it_has_gone() {
            let folder = tempfile::tempdir().unwrap();
            let name = OsStr::new("wayland-7");
            assert!(!answers(name, Some(folder.path())));
            let server = std::os::unix::net::UnixListener::bind(folder.path().join(name)).unwrap();
            assert!(answers(name, Some(folder.path())));
            assert!(answers(folder.path().join(name).as_os_str(), None));
            assert!(!answers(name, None), "no folder to look in");
            // The socket of a server that has crashed stays.
            drop(server);
            assert!(!answers(name, Some(folder.path())));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_that_would_not_fit_is_maximised() {
        let on = |wanted, width, height| fitting(wanted, Some(LogicalSize::new(width, height)));
        assert_eq!(on([1280, 800], 1920, 1080), ([1280, 800], false));
        assert_eq!(on([1280, 800], 1280, 800), ([1280, 800], true));
        assert_eq!(on([1280, 800], 1024, 600), ([1024, 600], true));
        assert_eq!(on([1280, 800], 1440, 850), ([1280, 800], true));
        assert_eq!(fitting([1280, 800], None), ([1280, 800], false));
    }

    #[test]
    fn messages_name_no_source_file() {
        let place =
            "os error at /home/x/.cargo/registry/winit-0.30.13/src/x11/mod.rs:764: no server: x";
        assert_eq!(without_place(&place), "no server: x");
        assert_eq!(without_place(&"Exit Failure: 3"), "Exit Failure: 3");
    }
}
