//! The tasks that only the owner of the windows can do: fill the screen, take a picture of the view, read the clipboard.
//!
//! Panels set them, and the window takes them. Knows neither.

/// The tasks that the main window is still to do.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct WindowTasks {
    /// The window is to fill its screen, or no longer.
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

/// Where a picture of the view goes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ScreenshotTo {
    /// A file with a name of its own.
    File,
    /// The clipboard of the system.
    Clipboard,
}
