//! Owns the windows of panels that are detached off: one for each in the workspace's list, with the
//! place where it was last.
//!
//! A panel's pass is run whenever something happened in any window, for it costs little. If it gives
//! another picture than the last, the window system is told, and the picture is made when that asks
//! for it: for a window that cannot be seen, never. It never waits for its window, so that it does
//! not hold up the main one.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::dpi::{LogicalSize, PhysicalPosition, PhysicalSize, Size};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Window, WindowId};

use super::AppError;
use super::pane::{Interface, Pane};
use super::workspace::Workspace;
use crate::gpu::{Device, GpuError};
use crate::input::Panel;
use crate::ui::state::PanelPlace;
use crate::ui::theme;

/// When a window that has no free image is asked again, at first; twice as late each time after.
const RETRY: Duration = Duration::from_millis(8);
/// The same at last, for a window that cannot be seen.
const RETRY_AT_LAST: Duration = Duration::from_millis(500);
/// From the main window's corner to that of a panel's first window, in points.
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
    /// Something happened that it may show.
    stale: bool,
    /// What the last pass gave.
    latest: Option<Interface>,
    /// What the window shows is of this size; none if it does not show the latest.
    drawn: Option<PhysicalSize<u32>>,
    retry: Duration,
}

impl DetachedPanels {
    /// Opens and closes windows as the workspace wants them. Without a window a panel goes back
    /// to its place.
    pub fn follow(
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

    /// Something happened that panels may show.
    pub fn touch(&mut self) {
        self.windows.iter_mut().for_each(PanelWindow::touch);
    }

    /// Brings up to date the windows whose time has come. True if something was done in one that
    /// the main window may show.
    pub fn refresh(&mut self, workspace: &mut Workspace) -> Result<bool, GpuError> {
        let now = Instant::now();
        let mut touched = false;
        for window in &mut self.windows {
            if window.pane.is_unseen(now) {
                // The window system asks for the picture once somebody can see it.
                window.pane.await_none();
            }
            if window.stale || window.pane.wake().is_some_and(|wake| wake <= now) {
                touched |= window.frame(workspace);
            }
            // The window system waits for a picture that it did not get.
            if window.pane.has_missed() {
                window.draw()?;
            }
        }
        Ok(touched)
    }

    /// When the first window wants to be brought up to date by itself.
    pub fn wake(&self) -> Option<Instant> {
        self.windows.iter().filter_map(|window| window.pane.wake()).min()
    }

    /// Notes where the windows are.
    pub fn note_places(&self, places: &mut BTreeMap<Panel, PanelPlace>) {
        let windows = self.windows.iter();
        places.extend(windows.map(|window| (window.panel, place_of(window.pane.window()))));
    }

    /// Whether a window is about to be drawn.
    pub fn is_pending(&self) -> bool {
        self.windows.iter().any(|window| window.pane.is_pending())
    }

    /// Closes all windows; [`DetachedPanels::follow`] opens them again, with another device if need be,
    /// where they were noted to be.
    pub fn close(&mut self) {
        self.windows.clear();
    }
}

fn place_of(window: &Window) -> PanelPlace {
    let corner_px = window.outer_position().ok().map(|corner| [corner.x, corner.y]);
    PanelPlace { corner_px, size_px: window.inner_size().into() }
}

/// Where a panel's first window goes: over the main one, where the panel has been.
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

/// Whether a corner lies on a screen that is there.
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
        // The screen that it was on may be gone.
        let place = place
            .filter(|place| place.corner_px.is_none_or(|corner| is_on_screen(event_loop, corner)));
        let place = place.unwrap_or_else(|| first_place(main, panel, scale));
        let mut attributes = Window::default_attributes()
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

    /// Something happened that the panel may show.
    pub fn touch(&mut self) {
        self.stale = true;
    }

    /// Runs the panel's pass, and asks for a picture if it looks other than the last. True if
    /// something was done in it that other windows may show.
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

    /// Makes the picture that the window system asks for.
    pub fn draw(&mut self) -> Result<(), GpuError> {
        let now = Instant::now();
        self.pane.await_none();
        if let Some(due) = self.pane.is_early(now) {
            self.wake_by(due);
            return Ok(());
        }
        let size = self.pane.window().inner_size();
        // A window without a size is shown again once it has one.
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

    /// False if the window cannot show it now.
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
