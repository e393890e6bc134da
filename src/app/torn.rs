//! Owns the windows of panels that are torn off: one for each in the workbench's list, with the
//! place where it was last.
//!
//! A panel's pass is run whenever something happened in any window, for it costs little; a
//! picture of it is made only if the pass gives another one than the last, or if the window
//! system has lost it. It never waits for its window, so that it does not hold up the main one.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::TexturesDelta;
use egui::epaint::ClippedShape;
use winit::dpi::{LogicalSize, PhysicalPosition, PhysicalSize, Size};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Window, WindowId};

use super::AppError;
use super::pane::{Interface, Pane};
use super::workbench::Workbench;
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
pub struct Torn {
    windows: Vec<PanelWindow>,
}

/// A panel in a window of its own.
pub struct PanelWindow {
    panel: Panel,
    pub pane: Pane,
    /// Something happened that it may show.
    stale: bool,
    /// What the window shows.
    drawn: Option<Drawn>,
    /// Textures not yet brought over or freed.
    textures: TexturesDelta,
    retry: Duration,
}

#[derive(PartialEq)]
struct Drawn {
    shapes: Vec<ClippedShape>,
    pixels_per_point: f32,
    size: PhysicalSize<u32>,
}

impl Torn {
    /// Opens and closes windows as the workbench wants them. Without a window a panel goes back
    /// to its place.
    pub fn follow(
        &mut self,
        event_loop: &ActiveEventLoop,
        main: &Window,
        device: &Arc<Device>,
        bench: &mut Workbench,
    ) {
        let (kept, gone) = std::mem::take(&mut self.windows)
            .into_iter()
            .partition(|window| bench.ui.torn.contains(&window.panel));
        self.windows = kept;
        for window in gone {
            bench.ui.windows.panels.insert(window.panel, place_of(window.pane.window()));
            bench.put_back(window.panel);
        }
        for panel in bench.ui.torn.clone() {
            if self.windows.iter().any(|window| window.panel == panel) {
                continue;
            }
            let place = bench.ui.windows.panels.get(&panel).copied();
            let scale = bench.ui.scale.factor();
            match PanelWindow::open(event_loop, main, device, panel, place, scale) {
                Ok(window) => self.windows.push(window),
                Err(error) => {
                    bench.put_back(panel);
                    bench.ui.toasts.error(error.to_string());
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
    pub fn refresh(&mut self, bench: &mut Workbench) -> Result<bool, GpuError> {
        let now = Instant::now();
        let mut touched = false;
        for window in &mut self.windows {
            if window.stale || window.pane.wake().is_some_and(|wake| wake <= now) {
                touched |= window.frame(bench)?;
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

    /// Closes all windows; [`Torn::follow`] opens them again, with another device if need be,
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
        let textures = TexturesDelta::default();
        Ok(PanelWindow { panel, pane, stale: true, drawn: None, textures, retry: RETRY })
    }

    pub fn panel(&self) -> Panel {
        self.panel
    }

    /// Something happened that the panel may show.
    pub fn touch(&mut self) {
        self.stale = true;
    }

    /// The window system has lost the window's picture.
    pub fn lose_picture(&mut self) {
        self.drawn = None;
        self.stale = true;
    }

    /// Runs the panel's pass and draws it if it looks other than before. True if something was
    /// done in it that other windows may show.
    fn frame(&mut self, bench: &mut Workbench) -> Result<bool, GpuError> {
        let started = Instant::now();
        self.stale = false;
        let panel = self.panel;
        let mut touched = false;
        let mut interface = self.pane.interface(|root| touched |= bench.show_panel(panel, root));
        self.pane.wake_at(started.checked_add(interface.repaint_after));
        self.textures.append(std::mem::take(&mut interface.textures));
        self.show(interface)?;
        if let Some(lack) = self.pane.take_lack() {
            bench.ui.toasts.error(lack.to_string());
        }
        Ok(touched)
    }

    fn show(&mut self, interface: Interface) -> Result<(), GpuError> {
        let size = self.pane.window().inner_size();
        let Interface { shapes, pixels_per_point, .. } = &interface;
        let same = self.drawn.as_ref().is_some_and(|drawn| {
            (drawn.size, drawn.pixels_per_point) == (size, *pixels_per_point)
                && drawn.shapes == *shapes
        });
        // A window without a size is shown again once it has one.
        if (same && self.textures.is_empty()) || size.width == 0 || size.height == 0 {
            return Ok(());
        }
        let Some(mut frame) = self.pane.begin(Duration::ZERO)? else {
            let again = Instant::now() + self.retry;
            self.pane.wake_at(Some(self.pane.wake().map_or(again, |wake| wake.min(again))));
            self.retry = (2 * self.retry).min(RETRY_AT_LAST);
            return Ok(());
        };
        self.retry = RETRY;
        self.pane.upload(&mut self.textures)?;
        self.pane.draw(&mut frame, &interface)?;
        self.pane.end(frame, &mut self.textures)?;
        let Interface { shapes, pixels_per_point, .. } = interface;
        self.drawn = Some(Drawn { shapes, pixels_per_point, size });
        tracing::debug!("{} shown", self.panel.title());
        Ok(())
    }
}
