//! The tasks that only the owner of the windows can do: fill the screen, take a picture of the view, read the
//! clipboard.
//!
//! Panels set them, and the window takes them. Knows neither.

/// The pending tasks of the main window.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct WindowTasks {
    /// The window should enter or leave fullscreen.
    pub switch_fullscreen: bool,
    /// The use of a picture of the view.
    pub screenshot: Option<ScreenshotTo>,
    /// The use of the picture on the clipboard of the system.
    pub paste: Option<PasteAs>,
}

/// The use of a pasted picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PasteAs {
    /// A reference picture.
    Reference,
    /// The picture that solids paint with.
    ToolPicture,
}

/// The destination of a picture of the view.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ScreenshotTo {
    /// A file with a new name.
    File,
    /// The clipboard of the system.
    Clipboard,
}
