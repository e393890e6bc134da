//! The main window: its device, and the picture of the sculpture below its interface.
//!
//! The workspace decides about the contents.

use std::sync::Arc;
use std::time::Duration;

use glam::UVec2;
use winit::window::{Fullscreen, Window};

use super::painter::{REFINED_SAMPLES, WindowPainter};
use super::pane::{Interface, Pane, RecordedFrame};
use super::screenshot;
use super::workspace::Workspace;
use crate::gpu::{Device, DeviceOptions, GpuError, ValidationLog, WindowHost};
use crate::ui::ScreenshotTo;
use crate::view::StereoLayout;

/// Most frames to wait for a complete picture to save or copy: a moving view never completes one.
const MOST_FRAMES: u32 = 2 * REFINED_SAMPLES;

/// The main window and its renderers. Fields are dropped in this order.
pub struct MainWindow {
    painter: WindowPainter,
    pub pane: Pane,
    /// The picture's rectangle in the window, in pixels.
    corner: UVec2,
    /// Number of pictures shown.
    shown: u64,
    /// The picture is complete: the next one of the same scene would not be better.
    complete: bool,
    /// Frames since a picture was requested to be saved or copied.
    waited: u32,
    /// The system's clipboard, once it was used. On some systems the copied contents last only as long as this.
    clipboard: Option<arboard::Clipboard>,
}

impl MainWindow {
    pub fn new(window: Arc<Window>, options: &DeviceOptions) -> Result<MainWindow, GpuError> {
        let mut host = WindowHost::new(window.clone());
        let device = Device::new(&mut host, options)?;
        let pane = Pane::new(window, host.into_surface()?, &device)?;
        let painter = WindowPainter::new(&device, pane.screen().format())?;
        Ok(MainWindow {
            painter,
            pane,
            corner: UVec2::ZERO,
            shown: 0,
            complete: true,
            waited: 0,
            clipboard: None,
        })
    }

    /// Drops everything except the window.
    pub fn into_window(self) -> Arc<Window> {
        self.pane.into_window()
    }

    pub fn device(&self) -> &Arc<Device> {
        self.pane.device()
    }

    pub fn validation_log(&self) -> Arc<ValidationLog> {
        self.device().validation_log().clone()
    }

    pub fn set_title(&self, workspace: &Workspace) {
        let session = workspace.session();
        let name = session.path().and_then(|p| p.file_name()).map(|n| n.to_string_lossy());
        let star = if session.modified() { "*" } else { "" };
        let access = if session.is_read_only() { " (read-only)" } else { "" };
        let name = name.as_deref().unwrap_or("untitled");
        self.pane.window().set_title(&format!("{name}{star}{access} – Virtual Sculpture"));
    }

    /// Waits up to `patience` for a free image of the window. Returns `None` while there is nothing to draw to.
    pub fn begin(
        &mut self,
        workspace: &mut Workspace,
        patience: Duration,
    ) -> Result<Option<RecordedFrame>, GpuError> {
        workspace.display.quad_buffered = self.pane.screen().can_layer();
        let layout = &mut workspace.ui.view.stereo.layout;
        if *layout == StereoLayout::Layers && !workspace.display.quad_buffered {
            *layout = StereoLayout::SideBySide;
            let text = "this display does not support quad-buffered stereo";
            workspace.ui.toasts.error(format!("{text}; showing the eyes side by side"));
        }
        self.pane.arrange(workspace.ui.view.stereo.layout);
        self.pane.begin(patience)
    }

    /// Applies the gamepad. Its pointer movements reach the next pass of the interface like those of a mouse.
    pub fn play_pad(&mut self, workspace: &mut Workspace, now_s: f64) {
        let events = workspace.play_pad(now_s, self.pane.context());
        let moved = events.iter().rev().find_map(|event| match event {
            egui::Event::PointerMoved(at) => Some(*at),
            _ => None,
        });
        if let Some(at) = moved {
            workspace.controls.pads.pointer_follows(self.pane.move_pointer(at));
        }
        self.pane.inject(events);
    }

    /// Runs a pass of the interface, in which the workspace handles input.
    pub fn interface(&mut self, workspace: &mut Workspace) -> Interface {
        if workspace.display.device.is_empty() {
            workspace.display.device = self.device().device_name();
        }
        workspace.viewpoint.pointing_eye = self.pane.pointing_eye();
        self.pane.interface(|root| workspace.show(root))
    }

    /// Draws the picture of the sculpture into its rectangle of the window.
    pub fn draw_sculpture(
        &mut self,
        frame: &mut RecordedFrame,
        workspace: &mut Workspace,
    ) -> Result<(), GpuError> {
        let slot = self.pane.slot();
        self.complete = self.painter.paint(&mut frame.recorder, slot, workspace)?;
        if !self.complete {
            self.pane.redraw();
        }
        let corner = (workspace.picture().min.to_vec2() * self.pane.pixels_per_point()).round();
        self.corner = UVec2::new(corner.x.max(0.0) as u32, corner.y.max(0.0) as u32);
        if let Some(pictures) = self.painter.pictures()
            // Stereo pictures are composited together with the interface.
            && pictures.colour.eyes() == 1
        {
            let picture = &pictures.colour;
            let size = picture.size().to_array();
            frame.paste(picture.image().layer(0), size, self.corner.to_array());
        }
        Ok(())
    }

    /// Draws panels and windows over the picture.
    pub fn draw_interface(
        &mut self,
        frame: &mut RecordedFrame,
        interface: &Interface,
    ) -> Result<(), GpuError> {
        match self.painter.pictures() {
            Some(pictures) if pictures.colour.eyes() > 1 => {
                let corner = self.corner.as_ivec2();
                self.pane.draw_stereo(frame, interface, &mut pictures.colour, corner)
            }
            _ => self.pane.draw(frame, interface),
        }
    }

    /// Saves or copies the picture just shown, if requested and if it is complete.
    pub fn take_screenshot(&mut self, workspace: &mut Workspace) -> Result<(), GpuError> {
        let Some(to) = workspace.ui.window_tasks.screenshot else { return Ok(()) };
        self.waited += 1;
        if !self.complete && self.waited < MOST_FRAMES {
            return Ok(());
        }
        (self.waited, workspace.ui.window_tasks.screenshot) = (0, None);
        if let Some((format, eyes)) = self.painter.read_back()? {
            let taken = match to {
                ScreenshotTo::File => screenshot::save(workspace.session().path(), format, &eyes)
                    .map_err(|error| error.to_string()),
                ScreenshotTo::Clipboard => screenshot::copy(&mut self.clipboard, format, &eyes)
                    .map_err(|error| format!("The picture cannot be copied: {error}")),
            };
            match taken {
                Ok(text) => workspace.ui.toasts.note(text),
                Err(text) => {
                    tracing::warn!("{text}");
                    workspace.ui.toasts.error(text);
                }
            }
        }
        // The next picture has the tool and the lines again.
        self.pane.redraw();
        Ok(())
    }

    /// Toggles fullscreen, if requested. Asks the window for its present state, since the system may have changed it.
    pub fn switch_fullscreen(&self, workspace: &mut Workspace) {
        if std::mem::take(&mut workspace.ui.window_tasks.switch_fullscreen) {
            let window = self.pane.window();
            let whole = window.fullscreen().is_none().then_some(Fullscreen::Borderless(None));
            window.set_fullscreen(whole);
        }
    }

    /// Pastes the picture on the system's clipboard, if requested.
    pub fn paste_picture(&mut self, workspace: &mut Workspace) {
        if workspace.ui.window_tasks.paste.is_some() {
            workspace.paste_picture(&mut self.clipboard);
            self.pane.redraw();
        }
    }

    /// Presents the picture.
    pub fn end(&mut self, frame: RecordedFrame) -> Result<(), GpuError> {
        if self.pane.end(frame)? {
            self.shown += 1;
            tracing::debug!(number = self.shown, "picture shown");
        }
        Ok(())
    }
}
