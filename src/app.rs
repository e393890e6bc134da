//! The program in its windows: receives winit's events and draws the windows.
//!
//! [`App::frame`] is one iteration: input, interface, sculpture, presentation. Everything that needs no
//! window is in [`Workspace`].

mod detached;
mod dispatch;
mod error;
mod film;
mod final_picture;
mod first_run;
mod floor;
mod glyphs;
pub mod headset;
mod left;
mod long_work;
mod main_window;
mod memory;
mod overlay;
mod painter;
mod pane;
mod paste;
mod pens;
mod print_check;
mod references;
mod screenshot;
mod stereo_screen;
mod study;
mod symmetry_lines;
mod system_window;
mod tool_outline;
mod view_source;
pub mod workspace;

#[cfg(test)]
mod ar_tests;
#[cfg(test)]
mod camera_tests;
#[cfg(test)]
mod head_tests;
#[cfg(test)]
mod job_tests;
#[cfg(test)]
mod pad_tests;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::WindowId;

use crate::config::Config;
use crate::editor::recovery::{self, SecuredPlace};
use crate::folders;
use crate::gpu::{DeviceOptions, GpuError};
use crate::input::Bindings;
use crate::input::pad::device as pad_device;
use crate::input::pad::device::PadNews;
use crate::persist::journal::JournalOptions;
use crate::screen::headset::XrEvent;
use crate::session::Session;

use detached::DetachedPanels;
pub use error::AppError;
use headset::{Connection, Headset};
use main_window::MainWindow;
pub use memory::remembered_up;
use pane::RecordedFrame;
use pens::WindowPens;
pub use workspace::Workspace;

/// Smallest window in points for which the panels are laid out.
const SMALLEST: LogicalSize<u32> = LogicalSize::new(640, 480);
/// A device lost again within this time is an error.
const RESTART_INTERVAL: Duration = Duration::from_secs(20);
/// Longest wait for a swapchain image; a compositor may not give one to a hidden window.
const PATIENCE: Duration = Duration::from_millis(200);
/// The same wait while a headset shows pictures, which have priority.
const BRIEFLY: Duration = Duration::from_millis(2);
/// Time until a window without a free image tries again.
const ASK_AGAIN: Duration = Duration::from_millis(250);
/// Interval of redraws of the window while a headset is used.
const MIRROR_EVERY: Duration = Duration::from_millis(100);

/// Opens the window, on a device made with `device`, and works on `session` until the user leaves. `eye_screenshots`: a
/// folder for pictures of what the eyes in a headset see. `journals`: the place of the journals of earlier sessions.
pub fn run(
    session: Session,
    config: Config,
    device: DeviceOptions,
    eye_screenshots: Option<PathBuf>,
    journals: JournalOptions,
) -> Result<(), AppError> {
    let event_loop = system_window::event_loop()?;
    let proxy = event_loop.create_proxy();
    pad_device::listen(move |news| proxy.send_event(Wake::Pad(news)).is_ok());
    let mut workspace = Workspace::new(session, &config, Bindings::presets()?);
    workspace.render_device = device.clone();
    workspace.ui.dialogs.guide.open = config.window.guide && first_run::is_first_run();
    if let Some(folder) = folders::personal_folder() {
        workspace.keep_keys_in(folder.join("bindings.toml"));
        workspace.keep_calibration_in(folder.join("calibration.toml"));
    }
    workspace.remember_in(folders::state_folder().join("state.toml"), &config.window);
    workspace.look_for_left(journals);
    let proxy = event_loop.create_proxy();
    let headset = config.headset.enabled.then(|| {
        Headset::new(&config.headset, device.clone(), eye_screenshots, move |connection, event| {
            proxy.send_event(Wake::Headset(connection, event)).is_ok()
        })
    });
    let mut app = App {
        workspace,
        headset,
        pens: WindowPens::new(event_loop.create_proxy()),
        mirrored: None,
        config,
        device,
        started: Instant::now(),
        focused: None,
        view: None,
        detached: DetachedPanels::default(),
        restarted: None,
        resting: false,
        failed: None,
    };
    event_loop.run_app(&mut app)?;
    app.finish()
}

/// Events from other threads.
#[derive(Debug)]
enum Wake {
    Pad(PadNews),
    Headset(Connection, XrEvent),
    Pen,
}

/// The program in a window.
struct App {
    workspace: Workspace,
    headset: Option<Headset>,
    /// Dropped before the windows.
    pens: WindowPens,
    /// Time of the last redraw of the window for the headset.
    mirrored: Option<Instant>,
    config: Config,
    device: DeviceOptions,
    /// Windows of panels, on the device of the main one.
    detached: DetachedPanels,
    started: Instant,
    /// The window with the keyboard focus.
    focused: Option<WindowId>,
    /// Window and device; `None` before the event loop runs.
    view: Option<MainWindow>,
    /// Time of the last recreation of the device.
    restarted: Option<Instant>,
    /// The program is idle, and has logged it.
    resting: bool,
    failed: Option<AppError>,
}

impl App {
    /// Draws the window: acquires an image, handles input, updates the picture of the sculpture,
    /// composites the interface over it, and presents.
    fn frame(&mut self) -> Result<(), GpuError> {
        let Some(view) = &mut self.view else { return Ok(()) };
        if let Some(due) = view.pane.is_early(Instant::now()) {
            view.pane.wake_at(Some(due));
            return Ok(());
        }
        let showing = self.headset.as_ref().is_some_and(Headset::is_showing);
        let patience = if showing { BRIEFLY } else { PATIENCE };
        let frame = view.begin(&mut self.workspace, patience)?;
        self.update(frame)
    }

    /// Does the same for a window that is not visible (`frame` is `None`), without drawing. Requests from another
    /// window, a headset or a closing window are still processed.
    fn update(&mut self, frame: Option<RecordedFrame>) -> Result<(), GpuError> {
        let Some(view) = &mut self.view else { return Ok(()) };
        let started = Instant::now();
        view.pane.begin_redraw();
        view.play_pad(&mut self.workspace, (started - self.started).as_secs_f64());
        self.workspace.on_screen(view.pane.monitor());
        self.workspace.track();
        self.pens.play(Some(view), &mut self.detached, &mut self.workspace);
        let interface = view.interface(&mut self.workspace);
        self.pens.show_cursor(interface.cursor);
        self.workspace.shake_pad(self.started.elapsed().as_secs_f64());
        let pad_needs = self.workspace.controls.pads.is_active().then_some(Duration::ZERO);
        let mut again = pad_needs.unwrap_or(interface.repaint_after);
        if frame.is_none() {
            tracing::debug!("a picture is left out");
            // A hidden window tries again at intervals.
            let soon = if view.pane.is_minimised() { Duration::MAX } else { ASK_AGAIN };
            again = again.max(ASK_AGAIN).min(soon);
        }
        view.pane.wake_at(started.checked_add(again));
        if let Some(mut frame) = frame {
            view.draw_sculpture(&mut frame, &mut self.workspace)?;
            view.draw_interface(&mut frame, &interface)?;
            if let Some(lack) = view.pane.take_lack() {
                self.workspace.ui.toasts.error(lack.to_string());
            }
            view.end(frame)?;
            view.take_screenshot(&mut self.workspace)?;
            self.workspace.display.times.total_ms = started.elapsed().as_secs_f32() * 1e3;
        }
        view.switch_fullscreen(&mut self.workspace);
        view.paste_picture(&mut self.workspace);
        view.set_title(&self.workspace);
        // The panels may have to show the changes.
        self.detached.touch();
        Ok(())
    }

    /// Draws the window when due, or updates without drawing if the window system does not ask for a redraw.
    fn poll_window(&mut self) -> Result<(), GpuError> {
        let now = Instant::now();
        let Some(view) = &mut self.view else { return Ok(()) };
        if view.pane.has_missed() {
            return self.frame();
        }
        if view.pane.is_unseen(now) {
            return self.update(None);
        }
        if view.pane.wake().is_some_and(|wake| wake <= now) {
            view.pane.wake_at(None);
            view.pane.redraw();
        }
        Ok(())
    }

    /// Opens and closes the windows of detached panels, and updates them.
    fn panels(&mut self, event_loop: &ActiveEventLoop) -> Result<(), GpuError> {
        let Some(view) = &mut self.view else { return Ok(()) };
        let device = view.device().clone();
        self.detached.sync(event_loop, view.pane.window(), &device, &mut self.workspace);
        let modal = self.workspace.ui.dialogs.is_modal();
        if self.detached.refresh(&mut self.workspace)? {
            view.pane.redraw();
            if self.workspace.ui.dialogs.is_modal() && !modal {
                // A dialog opened from a panel is shown in the main window.
                view.pane.window().focus_window();
            }
        }
        Ok(())
    }

    fn open_window(&mut self, event_loop: &ActiveEventLoop) -> Result<(), AppError> {
        let windows = &self.workspace.ui.layout.windows;
        let wanted = windows.main.unwrap_or(self.config.window.size);
        let screens = event_loop.available_monitors();
        let screens = screens.map(|screen| screen.size().to_logical::<u32>(screen.scale_factor()));
        let largest = screens.max_by_key(|size| u64::from(size.width) * u64::from(size.height));
        let (size, is_tight) = system_window::fitting(wanted, largest);
        let attributes = system_window::attributes()
            .with_title("Virtual Sculpture")
            .with_inner_size(LogicalSize::new(size[0], size[1]))
            .with_maximized(windows.maximised || is_tight)
            .with_min_inner_size(SMALLEST);
        let window = Arc::new(event_loop.create_window(attributes)?);
        let view = MainWindow::new(window, &self.device)?;
        self.workspace.ui.view.suit_device(view.device().is_software());
        self.view = Some(view);
        self.pens.listen(event_loop.owned_display_handle());
        Ok(())
    }

    /// Recreates a lost device or surface, once. Other failures end the program after the sculpture was saved.
    fn recover(&mut self, error: GpuError) -> Result<(), AppError> {
        let lost = matches!(
            error,
            GpuError::DeviceLost(_)
                | GpuError::Vulkan { result: ash::vk::Result::ERROR_SURFACE_LOST_KHR, .. }
        );
        let again = self.restarted.is_some_and(|at| at.elapsed() < RESTART_INTERVAL);
        if let (true, false, Some(view)) = (lost, again, self.view.take()) {
            tracing::warn!("{error}; recreating the device");
            self.restarted = Some(Instant::now());
            self.detached.note_places(&mut self.workspace.ui.layout.windows.panels);
            self.detached.close();
            let window = view.into_window();
            match MainWindow::new(window, &self.device) {
                Ok(mut view) => {
                    view.pane.redraw();
                    self.view = Some(view);
                    return Ok(());
                }
                Err(second) => tracing::error!("{second}"),
            }
        }
        if !self.workspace.session().modified() {
            return Err(error.into());
        }
        match recovery::secure(self.workspace.session_mut(), &folders::state_folder()) {
            Ok(SecuredPlace::Journal(path)) => Err(AppError::Kept { error, path }),
            Ok(SecuredPlace::File(path)) => Err(AppError::Recovered { error, path }),
            Err(second) => {
                tracing::error!("the sculpture could not be saved: {second}");
                Err(error.into())
            }
        }
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, error: AppError) {
        self.failed.get_or_insert(error);
        event_loop.exit();
    }

    fn redraw(&mut self) {
        if let Some(view) = &mut self.view {
            view.pane.redraw();
        }
    }

    /// Returns when the next window must be redrawn.
    fn wake(&self) -> Option<Instant> {
        let main = self.view.as_ref().and_then(|view| view.pane.wake());
        main.into_iter().chain(self.detached.wake()).min()
    }

    /// Recovers from a failure to draw, or ends the program.
    fn survive(&mut self, event_loop: &ActiveEventLoop, result: Result<(), GpuError>) {
        if let Err(error) = result
            && let Err(error) = self.recover(error)
        {
            self.fail(event_loop, error);
        }
    }

    /// Handles an event of the headset, including frames. At intervals the window mirrors the headset.
    fn handle_headset(&mut self, connection: Connection, event: XrEvent) {
        let Some(headset) = &mut self.headset else { return };
        headset.handle(&mut self.workspace, connection, event);
        if self.mirrored.is_none_or(|at| at.elapsed() >= MIRROR_EVERY) {
            self.mirrored = Some(Instant::now());
            self.redraw();
        }
    }

    /// Records sizes and positions of the windows.
    fn note_windows(&mut self) {
        self.detached.note_places(&mut self.workspace.ui.layout.windows.panels);
        let Some(view) = &self.view else { return };
        let (window, windows) = (view.pane.window(), &mut self.workspace.ui.layout.windows);
        windows.maximised = window.is_maximized();
        let size = window.inner_size().to_logical::<u32>(window.scale_factor());
        let usable = size.width >= SMALLEST.width && size.height >= SMALLEST.height;
        if usable && !windows.maximised && window.fullscreen().is_none() {
            windows.main = Some([size.width, size.height]);
        }
    }

    /// Logs when the program becomes idle or busy, for tests that wait for it.
    fn note_rest(&mut self) {
        let soon = Instant::now() + Duration::from_secs(1);
        let pending = self.view.as_ref().is_some_and(|view| view.pane.is_pending());
        let resting =
            !pending && !self.detached.is_pending() && self.wake().is_none_or(|wake| wake > soon);
        match (self.resting, resting) {
            (false, true) => {
                tracing::debug!("at rest");
                self.note_windows();
                self.workspace.remember_at_rest();
            }
            (true, false) => tracing::debug!("at work"),
            _ => {}
        }
        self.resting = resting;
    }

    /// After the event loop: finishes jobs, drops the devices, and reports errors.
    fn finish(mut self) -> Result<(), AppError> {
        // A save in progress is completed.
        self.workspace.finish_job();
        if self.failed.is_none() && self.workspace.is_leaving() {
            // Everything is saved, or the person has said that it need not be.
            self.workspace.session_mut().discard_journal();
        }
        self.note_windows();
        self.workspace.remember();
        let log = self.view.as_ref().map(MainWindow::validation_log);
        let mut messages = self.headset.as_ref().map_or(0, Headset::validation_messages);
        self.headset = None;
        self.detached.close();
        self.view = None;
        if let Some(error) = self.failed {
            return Err(error);
        }
        messages += log.map_or(0, |log| log.messages().len());
        match messages {
            0 => Ok(()),
            count => Err(AppError::Validation(count)),
        }
    }
}

impl ApplicationHandler<Wake> for App {
    fn user_event(&mut self, _: &ActiveEventLoop, wake: Wake) {
        match wake {
            Wake::Pad(news) => {
                let now = news.at.saturating_duration_since(self.started);
                self.workspace.handle_pad(news, now.as_secs_f64());
                self.redraw();
            }
            Wake::Headset(connection, event) => self.handle_headset(connection, event),
            Wake::Pen => {
                self.pens.play(self.view.as_mut(), &mut self.detached, &mut self.workspace);
            }
        }
    }

    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.view.is_none()
            && let Err(error) = self.open_window(event_loop)
        {
            self.fail(event_loop, error);
        }
        self.redraw();
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, id: WindowId, event: WindowEvent) {
        if let WindowEvent::Focused(focused) = event
            // When the focus moves between windows of the program, either event may come first. Without a window
            // manager several windows may have the focus.
            && (focused || self.focused == Some(id))
        {
            self.focused = focused.then_some(id);
            self.workspace.controls.pads.set_listening(focused);
        }
        if let Some(window) = self.detached.get_mut(id) {
            self.resting = false;
            if window.pane.handle_event(&event) {
                window.touch();
            }
            match event {
                WindowEvent::RedrawRequested => {
                    let result = window.draw();
                    self.survive(event_loop, result);
                }
                WindowEvent::CloseRequested => {
                    let panel = window.panel();
                    self.workspace.put_back(panel);
                    self.redraw();
                }
                _ => {}
            }
            return;
        }
        let Some(view) = self.view.as_mut().filter(|view| view.pane.id() == id) else { return };
        let repaint = view.pane.handle_event(&event);
        match event {
            WindowEvent::RedrawRequested => {
                self.resting = false;
                let result = self.frame();
                self.survive(event_loop, result);
            }
            WindowEvent::CloseRequested => {
                self.workspace.ask_to_leave();
                self.redraw();
            }
            WindowEvent::Focused(_) => self.redraw(),
            _ if repaint => self.redraw(),
            _ => {}
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let result = self.panels(event_loop).and_then(|()| self.poll_window());
        self.survive(event_loop, result);
        if self.workspace.is_leaving() {
            event_loop.exit();
        }
        let headset = self.headset.as_mut().and_then(|headset| headset.poll(&mut self.workspace));
        event_loop.set_control_flow(match self.wake().into_iter().chain(headset).min() {
            Some(wake) => ControlFlow::WaitUntil(wake),
            None => ControlFlow::Wait,
        });
        self.note_rest();
    }
}
