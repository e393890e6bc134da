//! The windows of detached panels: one for each panel in the workspace's list, at its last position.
//!
//! A panel's pass runs whenever something happened in any window, since it costs little. If its output
//! has changed, a redraw is requested, and the window is drawn when the window system asks for it; for a
//! window that is not visible, never. Nothing here waits for a window, so the main one is not delayed.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::dpi::{LogicalSize, PhysicalPosition, PhysicalSize, Size};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Window, WindowId};

use super::AppError;
use super::pane::{Interface, Pane};
use super::system_window;
use super::workspace::Workspace;
use crate::gpu::{Device, GpuError};
use crate::input::Panel;
use crate::screen::pen::WindowKey;
use crate::ui::layout::PanelPlace;
use crate::ui::widgets::theme;

/// First delay of a window without a free image; doubled after each attempt.
const RETRY: Duration = Duration::from_millis(8);
/// The longest such delay, for a window that is not visible.
const RETRY_AT_LAST: Duration = Duration::from_millis(500);
/// Offset of a panel's first window from the main window's corner, in points.
const OFFSET: f64 = 48.0;
const SMALLEST: LogicalSize<f32> = LogicalSize::new(theme::TOOLBOX_WIDTH, 120.0);

/// The windows of panels.
#[derive(Default)]
pub struct DetachedPanels {
    windows: Vec<PanelWindow>,
}

/// A panel in a window of its own.
pub struct PanelWindow {
    panel: Panel,
    pub pane: Pane,
    /// Something has happened that it may have to show.
    stale: bool,
    /// The output of the last pass.
    latest: Option<Interface>,
    /// The size at which the window shows the latest output; `None` if it does not show it.
    drawn: Option<PhysicalSize<u32>>,
    retry: Duration,
}

impl DetachedPanels {
    /// Opens and closes windows according to the workspace's list. A panel whose window cannot be opened
    /// is docked.
    pub fn sync(
        &mut self,
        event_loop: &ActiveEventLoop,
        main: &Window,
        device: &Arc<Device>,
        workspace: &mut Workspace,
    ) {
        let (kept, gone) = std::mem::take(&mut self.windows)
            .into_iter()
            .partition(|window| workspace.ui.layout.detached.contains(&window.panel));
        self.windows = kept;
        for window in gone {
            workspace.ui.layout.windows.panels.insert(window.panel, place_of(window.pane.window()));
            workspace.put_back(window.panel);
        }
        for panel in workspace.ui.layout.detached.clone() {
            if self.windows.iter().any(|window| window.panel == panel) {
                continue;
            }
            let place = workspace.ui.layout.windows.panels.get(&panel).copied();
            let scale = workspace.ui.appearance.scale.factor();
            match PanelWindow::open(event_loop, main, device, panel, place, scale) {
                Ok(window) => self.windows.push(window),
                Err(error) => {
                    workspace.put_back(panel);
                    workspace.ui.toasts.error(error.to_string());
                }
            }
        }
    }

    pub fn get_mut(&mut self, id: WindowId) -> Option<&mut PanelWindow> {
        self.windows.iter_mut().find(|window| window.pane.id() == id)
    }

    /// Returns the names that the window system uses for the windows in pen events.
    pub fn pen_keys(&self) -> impl Iterator<Item = Option<WindowKey>> {
        self.windows.iter().map(|window| window.pane.pen_key())
    }

    /// Returns the window under a pen.
    pub fn with_pen(&mut self, key: WindowKey) -> Option<&mut PanelWindow> {
        self.windows.iter_mut().find(|window| window.pane.pen_key() == Some(key))
    }

    /// Marks the panels as possibly outdated.
    pub fn touch(&mut self) {
        self.windows.iter_mut().for_each(PanelWindow::touch);
    }

    /// Updates the windows that are due. Returns true if something was done in one that the main window may have to
    /// show.
    pub fn refresh(&mut self, workspace: &mut Workspace) -> Result<bool, GpuError> {
        let now = Instant::now();
        let mut touched = false;
        for window in &mut self.windows {
            if window.pane.is_unseen(now) {
                // The window system asks for a redraw once the window is visible.
                window.pane.cancel_redraw();
            }
            if window.stale || window.pane.wake().is_some_and(|wake| wake <= now) {
                touched |= window.frame(workspace);
            }
            // The window system waits for a picture that was not presented.
            if window.pane.has_missed() {
                window.draw()?;
            }
        }
        Ok(touched)
    }

    /// Returns when the next window must be updated without an event.
    pub fn wake(&self) -> Option<Instant> {
        self.windows.iter().filter_map(|window| window.pane.wake()).min()
    }

    /// Records the positions of the windows.
    pub fn note_places(&self, places: &mut BTreeMap<Panel, PanelPlace>) {
        let windows = self.windows.iter();
        places.extend(windows.map(|window| (window.panel, place_of(window.pane.window()))));
    }

    /// Returns whether a window is about to be drawn.
    pub fn is_pending(&self) -> bool {
        self.windows.iter().any(|window| window.pane.is_pending())
    }

    /// Closes all windows; [`DetachedPanels::sync`] opens them again at their recorded positions, possibly
    /// on another device.
    pub fn close(&mut self) {
        self.windows.clear();
    }
}

fn place_of(window: &Window) -> PanelPlace {
    let corner_px = window.outer_position().ok().map(|corner| [corner.x, corner.y]);
    PanelPlace { corner_px, size_px: window.inner_size().into() }
}

/// Returns the initial position of a panel's window: over the main one, where the panel was docked.
fn first_place(main: &Window, panel: Panel, scale: f32) -> PanelPlace {
    let (width, height) = match panel {
        Panel::Toolbox => (theme::TOOLBOX_WIDTH + 20.0, 620.0),
        Panel::Options => (theme::OPTIONS_WIDTH + 20.0, 560.0),
        Panel::History => (theme::OPTIONS_WIDTH, 280.0),
    };
    let pixels = main.scale_factor() * f64::from(scale);
    let size = LogicalSize::new(width, height).to_physical::<u32>(pixels);
    let corner = main.inner_position().ok().map(|corner| {
        let offset = (OFFSET * pixels) as i32;
        let room = main.inner_size();
        let x = match panel {
            Panel::Toolbox => offset,
            Panel::Options | Panel::History => {
                (room.width as i32 - size.width as i32 - offset).max(0)
            }
        };
        let y = match panel {
            Panel::Toolbox | Panel::Options => offset,
            Panel::History => (room.height as i32 - size.height as i32 - offset).max(0),
        };
        [corner.x + x, corner.y + y]
    });
    PanelPlace { corner_px: corner, size_px: size.into() }
}

/// Returns whether a corner is on a connected screen.
fn is_on_screen(event_loop: &ActiveEventLoop, corner: [i32; 2]) -> bool {
    event_loop.available_monitors().any(|screen| {
        let (at, size) = (screen.position(), screen.size());
        let within = |value: i32, from: i32, length: u32| {
            (i64::from(from)..i64::from(from) + i64::from(length)).contains(&i64::from(value))
        };
        within(corner[0], at.x, size.width) && within(corner[1], at.y, size.height)
    })
}

impl PanelWindow {
    fn open(
        event_loop: &ActiveEventLoop,
        main: &Window,
        device: &Arc<Device>,
        panel: Panel,
        place: Option<PanelPlace>,
        scale: f32,
    ) -> Result<PanelWindow, AppError> {
        // Its last screen may no longer be connected.
        let place = place
            .filter(|place| place.corner_px.is_none_or(|corner| is_on_screen(event_loop, corner)));
        let place = place.unwrap_or_else(|| first_place(main, panel, scale));
        let mut attributes = system_window::attributes()
            .with_title(panel.title())
            .with_inner_size(Size::Physical(place.size_px.into()))
            .with_min_inner_size(SMALLEST);
        if let Some(corner) = place.corner_px {
            attributes = attributes.with_position(PhysicalPosition::<i32>::from(corner));
        }
        let window = Arc::new(event_loop.create_window(attributes)?);
        let pane = Pane::new(window.clone(), device.surface(window)?, device)?;
        Ok(PanelWindow { panel, pane, stale: true, latest: None, drawn: None, retry: RETRY })
    }

    pub fn panel(&self) -> Panel {
        self.panel
    }

    /// Marks the panel as possibly outdated.
    pub fn touch(&mut self) {
        self.stale = true;
    }

    /// Runs the panel's pass, and requests a redraw if its output has changed. Returns true if something was done in it
    /// that other windows may have to show.
    fn frame(&mut self, workspace: &mut Workspace) -> bool {
        let started = Instant::now();
        self.stale = false;
        let panel = self.panel;
        let mut touched = false;
        let interface = self.pane.interface(|root| touched |= workspace.show_panel(panel, root));
        self.pane.wake_at(started.checked_add(interface.repaint_after));
        let same = self.latest.as_ref().is_some_and(|latest| {
            latest.pixels_per_point == interface.pixels_per_point
                && latest.shapes == interface.shapes
        });
        self.latest = Some(interface);
        let size = self.pane.window().inner_size();
        if !same || self.drawn != Some(size) || self.pane.has_textures() {
            self.drawn = None;
            self.pane.redraw();
        }
        if let Some(lack) = self.pane.take_lack() {
            workspace.ui.toasts.error(lack.to_string());
        }
        touched
    }

    /// Draws the window, as requested by the window system.
    pub fn draw(&mut self) -> Result<(), GpuError> {
        let now = Instant::now();
        self.pane.cancel_redraw();
        if let Some(due) = self.pane.is_early(now) {
            self.wake_by(due);
            return Ok(());
        }
        let size = self.pane.window().inner_size();
        // A window without a size is drawn once it has one.
        let Some(interface) = self.latest.take().filter(|_| size.width > 0 && size.height > 0)
        else {
            return Ok(());
        };
        let drawn = self.show(&interface);
        self.latest = Some(interface);
        if drawn? {
            self.retry = RETRY;
            self.drawn = Some(size);
            tracing::debug!("{} shown", self.panel.title());
        } else {
            self.drawn = None;
            self.wake_by(now + self.retry);
            self.retry = (2 * self.retry).min(RETRY_AT_LAST);
        }
        Ok(())
    }

    /// Shows the output. Returns false if the window cannot show it now.
    fn show(&mut self, interface: &Interface) -> Result<bool, GpuError> {
        let Some(mut frame) = self.pane.begin(Duration::ZERO)? else { return Ok(false) };
        self.pane.draw(&mut frame, interface)?;
        self.pane.end(frame)
    }

    fn wake_by(&mut self, at: Instant) {
        let wake = self.pane.wake().map_or(at, |wake| wake.min(at));
        self.pane.wake_at(Some(wake));
    }
}
