//! Pens on X11: a connection besides that of the windows, on which the pen devices are selected for each window
//! (XInput2), and a thread that reads it. The windows get the pointer of a pen as before.
//!
//! Gives reports in pixels, by the number of the window.

use std::io::PipeReader;
use std::os::fd::AsFd;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use glam::Vec2;
use thiserror::Error;
use x11rb::connection::{Connection, RequestConnection as _};
use x11rb::errors::{ConnectError, ConnectionError, ReplyError};
use x11rb::protocol::Event;
use x11rb::protocol::xinput::{ConnectionExt as _, Device, EventMask, XIEventMask};
use x11rb::protocol::xproto::{ConnectionExt as _, Window};
use x11rb::rust_connection::RustConnection;

use super::inbox::{Inbox, StopSignal, Waited, wait};
use super::xi2::{AxisAtoms, EventKind, PenDevices};
use super::{PenReport, WindowKey};

/// The version of XInput with these devices and axes.
const VERSION: (u16, u16) = (2, 2);

/// The reason why pens are not available.
#[derive(Debug, Error)]
pub enum X11PenError {
    #[error("the thread that listens to pens cannot be started: {0}")]
    Thread(#[from] std::io::Error),
    #[error("{0}")]
    Connect(#[from] ConnectError),
    #[error("{0}")]
    Connection(#[from] ConnectionError),
    #[error("{0}")]
    Reply(#[from] ReplyError),
    #[error("the server has no XInput 2")]
    NoXInput,
}

/// The pens of an X11 display.
pub struct X11Pens {
    reader: Arc<Mutex<XInputReader>>,
    inbox: Inbox,
    stop: Option<StopSignal>,
    thread: Option<JoinHandle<()>>,
}

impl X11Pens {
    /// Listens on the display of the session.
    pub fn connect(wake: impl Fn() + Send + 'static) -> Result<X11Pens, X11PenError> {
        X11Pens::connect_to(None, wake)
    }

    /// Listens on a display.
    pub fn connect_to(
        display: Option<&str>,
        wake: impl Fn() + Send + 'static,
    ) -> Result<X11Pens, X11PenError> {
        let inbox = Inbox::default();
        let reader = XInputReader::new(display, inbox.clone())?;
        let connection = reader.connection.clone();
        let reader = Arc::new(Mutex::new(reader));
        let (stop, stopped) = StopSignal::new()?;
        let own = reader.clone();
        let thread = std::thread::Builder::new()
            .name("pens".into())
            .spawn(move || run(&connection, &own, &stopped, wake))?;
        Ok(X11Pens { reader, inbox, stop: Some(stop), thread: Some(thread) })
    }

    /// Also listens to the pens over a window.
    pub fn watch(&mut self, window: WindowKey) {
        let Some(window) = window.xid() else { return };
        let mut reader = lock(&self.reader);
        reader.windows.push(window);
        if let Err(error) = reader.select(&[window]) {
            tracing::debug!("pens act as mice in this window: {error}");
        }
    }

    /// Returns all reports, including those of events that the server has sent until now, so that nothing known to the
    /// window is missing.
    pub fn take(&mut self) -> Vec<PenReport> {
        let mut reader = lock(&self.reader);
        if !reader.devices.is_empty()
            && let Err(error) = reader.catch_up()
        {
            tracing::debug!("pen input has ended: {error}");
        }
        self.inbox.take()
    }

    pub fn take_names(&mut self) -> Option<Vec<String>> {
        self.inbox.take_names()
    }
}

impl Drop for X11Pens {
    fn drop(&mut self) {
        self.stop = None;
        if self.thread.take().is_some_and(|thread| thread.join().is_err()) {
            tracing::warn!("the thread that listens to pens has failed");
        }
    }
}

fn lock(reader: &Mutex<XInputReader>) -> MutexGuard<'_, XInputReader> {
    reader.lock().unwrap_or_else(PoisonError::into_inner)
}

fn run(
    connection: &RustConnection,
    reader: &Mutex<XInputReader>,
    stopped: &PipeReader,
    wake: impl Fn(),
) {
    let error: X11PenError = loop {
        match lock(reader).drain() {
            Ok(true) => wake(),
            Ok(false) => {}
            Err(error) => break error,
        }
        match wait(connection.stream().as_fd(), stopped) {
            Ok(Waited::Readable) => {}
            Ok(Waited::Stopped) => return,
            Err(error) => break error.into(),
        }
    };
    tracing::debug!("pen input has ended: {error}");
}

/// Describes the support by the session's server in a line.
pub fn survey() -> Result<String, X11PenError> {
    let reader = XInputReader::new(None, Inbox::default())?;
    Ok(match reader.devices.is_empty() {
        true => "no tablet connected (X11, XInput 2)".to_string(),
        false => format!("{} (X11)", reader.devices.names().join(", ")),
    })
}

/// Reads the connection.
struct XInputReader {
    connection: Arc<RustConnection>,
    atoms: AxisAtoms,
    devices: PenDevices,
    windows: Vec<Window>,
    inbox: Inbox,
    /// An event to handle first.
    early: Option<Event>,
}

impl XInputReader {
    fn new(display: Option<&str>, inbox: Inbox) -> Result<XInputReader, X11PenError> {
        let (connection, screen) = x11rb::connect(display)?;
        let root = connection.setup().roots.get(screen).ok_or(X11PenError::NoXInput)?.root;
        let name = x11rb::protocol::xinput::X11_EXTENSION_NAME;
        if connection.extension_information(name)?.is_none() {
            return Err(X11PenError::NoXInput);
        }
        let version = connection.xinput_xi_query_version(VERSION.0, VERSION.1)?.reply()?;
        if (version.major_version, version.minor_version) < (2, 0) {
            return Err(X11PenError::NoXInput);
        }
        let mut atoms = [0; 4];
        for (atom, name) in atoms.iter_mut().zip(AxisAtoms::NAMES) {
            *atom = connection.intern_atom(false, name.as_bytes())?.reply()?.atom;
        }
        let [x, pressure, tilt_x, tilt_y] = atoms;
        let atoms = AxisAtoms { x, pressure, tilt_x, tilt_y };
        let connection = Arc::new(connection);
        let (devices, windows) = (PenDevices::default(), Vec::new());
        let mut reader = XInputReader { connection, atoms, devices, windows, inbox, early: None };
        // Pens come and go; those of some drivers appear at their first use.
        let changes = XIEventMask::HIERARCHY | XIEventMask::DEVICE_CHANGED;
        let masks = [EventMask { deviceid: Device::ALL.into(), mask: vec![changes] }];
        reader.connection.xinput_xi_select_events(root, &masks)?.check()?;
        reader.look()?;
        Ok(reader)
    }

    /// Finds the pen devices, and listens to them over all windows.
    fn look(&mut self) -> Result<(), X11PenError> {
        let infos = self.connection.xinput_xi_query_device(Device::ALL)?.reply()?.infos;
        let found = PenDevices::among(&infos, &self.atoms);
        if found.names() != self.devices.names() {
            tracing::debug!("pens: {:?}", found.names());
            self.inbox.name(found.names());
        }
        self.devices = found;
        self.select(&self.windows)
    }

    /// Selects the events of all pens for these windows. A window that is gone causes an error that is ignored.
    fn select(&self, windows: &[Window]) -> Result<(), X11PenError> {
        let events = XIEventMask::MOTION | XIEventMask::BUTTON_PRESS | XIEventMask::BUTTON_RELEASE;
        let mask = |id| EventMask { deviceid: id, mask: vec![events] };
        let masks: Vec<EventMask> = self.devices.iter().map(|pen| mask(pen.id)).collect();
        for window in windows.iter().filter(|_| !masks.is_empty()) {
            self.connection.xinput_xi_select_events(*window, &masks)?;
        }
        self.connection.flush()?;
        Ok(())
    }

    /// Waits until everything sent by the server so far has arrived, and handles it.
    fn catch_up(&mut self) -> Result<(), X11PenError> {
        self.connection.get_input_focus()?.reply()?;
        self.drain().map(drop)
    }

    /// Handles arrived events. Returns true if there are reports.
    fn drain(&mut self) -> Result<bool, X11PenError> {
        let mut changed = false;
        // A motion of a device has the pointer's position before it; the next event has the new one.
        let mut last: Option<PenReport> = None;
        loop {
            while let Some(event) = self.next_event()? {
                let (report, moves) = match &event {
                    Event::XinputMotion(e) => (self.devices.report(e, EventKind::Motion), true),
                    Event::XinputButtonPress(e) => {
                        (self.devices.report(e, EventKind::Press), false)
                    }
                    Event::XinputButtonRelease(e) => {
                        (self.devices.report(e, EventKind::Release), false)
                    }
                    Event::XinputHierarchy(_) | Event::XinputDeviceChanged(_) => {
                        changed = true;
                        (None, false)
                    }
                    _ => (None, false),
                };
                let Some(report) = report else { continue };
                if let Some(mut before) = last.take() {
                    if before.window == report.window {
                        before.sample.position_px = report.sample.position_px;
                    }
                    self.inbox.push(before);
                }
                match moves {
                    true => last = Some(report),
                    false => self.inbox.push(report),
                }
            }
            let Some(report) = &mut last else { break };
            // Events that the server has sent before the answer arrive with it, and are newer.
            let here = self.place_in(report.window)?;
            report.sample.position_px = here.unwrap_or(report.sample.position_px);
            self.early = self.connection.poll_for_event()?;
            if self.early.is_none() {
                last.into_iter().for_each(|report| self.inbox.push(report));
                break;
            }
        }
        if changed {
            self.look()?;
        }
        Ok(!self.inbox.is_empty())
    }

    fn next_event(&mut self) -> Result<Option<Event>, X11PenError> {
        match self.early.take() {
            Some(event) => Ok(Some(event)),
            None => Ok(self.connection.poll_for_event()?),
        }
    }

    /// Returns the present position of the pointer in a window; `None` if the window is gone.
    fn place_in(&self, window: WindowKey) -> Result<Option<Vec2>, X11PenError> {
        let Some(window) = window.xid() else { return Ok(None) };
        match self.connection.query_pointer(window)?.reply() {
            Ok(at) => Ok(at.same_screen.then(|| Vec2::new(at.win_x.into(), at.win_y.into()))),
            Err(ReplyError::X11Error(_)) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }
}

#[cfg(test)]
#[path = "x11_tests.rs"]
mod tests;
