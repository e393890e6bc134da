//! Pens on Wayland: a separate event queue on the connection of the windows, read by a thread, that listens to the
//! tablets of all seats (`zwp_tablet_manager_v2`). A program that does so no longer gets a pointer for a pen.
//!
//! Gives reports in points of the display, by the surface of the window.

use std::collections::BTreeMap;
use std::ffi::c_void;
use std::io::PipeReader;
use std::ptr::NonNull;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use egui::CursorIcon;
use glam::Vec2;
use thiserror::Error;
use wayland_client::backend::{Backend, ObjectId, WaylandError};
use wayland_client::protocol::{wl_callback, wl_registry, wl_seat, wl_surface};
use wayland_client::{
    Connection, Dispatch, DispatchError, EventQueue, Proxy, QueueHandle, WEnum, delegate_noop,
    event_created_child,
};
use wayland_protocols::wp::cursor_shape::v1::client::{
    wp_cursor_shape_device_v1::{Shape, WpCursorShapeDeviceV1},
    wp_cursor_shape_manager_v1::WpCursorShapeManagerV1,
};
use wayland_protocols::wp::tablet::zv2::client::{
    zwp_tablet_manager_v2::ZwpTabletManagerV2,
    zwp_tablet_pad_group_v2::{self, ZwpTabletPadGroupV2},
    zwp_tablet_pad_ring_v2::ZwpTabletPadRingV2,
    zwp_tablet_pad_strip_v2::ZwpTabletPadStripV2,
    zwp_tablet_pad_v2::{self, ZwpTabletPadV2},
    zwp_tablet_seat_v2::{self, ZwpTabletSeatV2},
    zwp_tablet_tool_v2::{self, ZwpTabletToolV2},
    zwp_tablet_v2::{self, ZwpTabletV2},
};

use super::inbox::{Inbox, StopSignal, Waited, wait};
use super::wayland_tools::{Tool, ToolEvent};
use super::{PenReport, WindowKey};

/// The reason why pens are not available.
#[derive(Debug, Error)]
pub enum WaylandPenError {
    #[error("the thread that listens to pens cannot be started: {0}")]
    Thread(#[from] std::io::Error),
    #[error("{0}")]
    Connect(#[from] wayland_client::ConnectError),
    #[error("{0}")]
    Dispatch(#[from] DispatchError),
}

/// The pens of a Wayland display.
pub struct WaylandPens {
    inbox: Inbox,
    cursor: Arc<Mutex<Cursor>>,
    connection: Connection,
    stop: Option<StopSignal>,
    thread: Option<JoinHandle<()>>,
}

impl WaylandPens {
    /// Listens on a display of another part of the program.
    ///
    /// # Safety
    ///
    /// `display` is a `wl_display` that lives until the pens are dropped.
    pub unsafe fn on(
        display: NonNull<c_void>,
        wake: impl Fn() + Send + 'static,
    ) -> Result<WaylandPens, WaylandPenError> {
        // SAFETY: as the caller promises; the thread that uses it is joined when the pens are dropped.
        let backend = unsafe { Backend::from_foreign_display(display.as_ptr().cast()) };
        WaylandPens::listen(Connection::from_backend(backend), wake)
    }

    fn listen(
        connection: Connection,
        wake: impl Fn() + Send + 'static,
    ) -> Result<WaylandPens, WaylandPenError> {
        let (inbox, cursor) = (Inbox::default(), Arc::new(Mutex::new(Cursor::default())));
        let (queue, state) = begin(&connection, inbox.clone(), cursor.clone());
        let (stop, stopped) = StopSignal::new()?;
        let thread = std::thread::Builder::new()
            .name("pens".into())
            .spawn(move || run(queue, state, &stopped, wake))?;
        let (stop, thread) = (Some(stop), Some(thread));
        Ok(WaylandPens { inbox, cursor, connection, stop, thread })
    }

    pub fn take(&mut self) -> Vec<PenReport> {
        self.inbox.take()
    }

    pub fn take_names(&mut self) -> Option<Vec<String>> {
        self.inbox.take_names()
    }

    /// Shows a cursor at the pen over a window.
    pub fn show_cursor(&mut self, icon: CursorIcon) {
        let mut cursor = self.cursor.lock().unwrap_or_else(PoisonError::into_inner);
        if cursor.choose(icon)
            && let Err(error) = self.connection.flush()
        {
            tracing::debug!("the pen's cursor is not shown: {error}");
        }
    }
}

impl Drop for WaylandPens {
    fn drop(&mut self) {
        self.stop = None;
        if self.thread.take().is_some_and(|thread| thread.join().is_err()) {
            tracing::warn!("the thread that listens to pens has failed");
        }
    }
}

/// Asks for the compositor's globals.
fn begin(
    connection: &Connection,
    inbox: Inbox,
    cursor: Arc<Mutex<Cursor>>,
) -> (EventQueue<WaylandState>, WaylandState) {
    let queue = connection.new_event_queue();
    let handle = queue.handle();
    let display = connection.display();
    display.get_registry(&handle, ());
    // Answered after all initial globals.
    display.sync(&handle, ());
    (queue, WaylandState { inbox, cursor, ..WaylandState::default() })
}

/// Reads until it is told to stop, or there is nothing to listen to.
fn run(
    mut queue: EventQueue<WaylandState>,
    mut state: WaylandState,
    stopped: &PipeReader,
    wake: impl Fn(),
) {
    let error: DispatchError = loop {
        if let Err(error) = queue.dispatch_pending(&mut state) {
            break error;
        }
        if !state.inbox.is_empty() {
            wake();
        }
        if state.is_known && state.manager.is_none() {
            tracing::debug!("pens act as mice: the compositor has no zwp_tablet_manager_v2");
            return;
        }
        if let Err(error) = queue.flush()
            && !would_block(&error)
        {
            break error.into();
        }
        let Some(guard) = queue.prepare_read() else { continue };
        match wait(guard.connection_fd(), stopped) {
            Ok(Waited::Stopped) => return,
            Ok(Waited::Readable) => match guard.read() {
                Err(error) if !would_block(&error) => break error.into(),
                _ => {}
            },
            Err(error) => break DispatchError::Backend(error.into()),
        }
    };
    tracing::debug!("pen input has ended: {error}");
}

fn would_block(error: &WaylandError) -> bool {
    matches!(error, WaylandError::Io(error) if error.kind() == std::io::ErrorKind::WouldBlock)
}

/// Describes the support by the session's compositor in a line.
pub fn survey() -> Result<String, WaylandPenError> {
    let connection = Connection::connect_to_env()?;
    let inbox = Inbox::default();
    let (mut queue, mut state) = begin(&connection, inbox.clone(), Arc::default());
    // First the globals, then the tablets, then their names.
    for _ in 0..3 {
        queue.roundtrip(&mut state)?;
    }
    let names = inbox.take_names().unwrap_or_default();
    Ok(match (&state.manager, names.is_empty()) {
        (None, _) => {
            "the compositor has no zwp_tablet_manager_v2: pens act as mice, if at all".to_string()
        }
        (Some(_), true) => "no tablet connected (Wayland, zwp_tablet_manager_v2)".to_string(),
        (Some(_), false) => format!("{} (Wayland)", names.join(", ")),
    })
}

/// The cursor of the pen over a window.
#[derive(Default)]
struct Cursor {
    device: Option<(WpCursorShapeDeviceV1, u32)>,
    icon: CursorIcon,
}

impl Cursor {
    /// Chooses a cursor. Returns true if it must be sent.
    fn choose(&mut self, icon: CursorIcon) -> bool {
        std::mem::replace(&mut self.icon, icon) != icon && self.send()
    }

    fn send(&self) -> bool {
        if let Some((device, serial)) = &self.device {
            device.set_shape(*serial, shape(self.icon));
        }
        self.device.is_some()
    }
}

fn shape(icon: CursorIcon) -> Shape {
    match icon {
        CursorIcon::Crosshair => Shape::Crosshair,
        CursorIcon::Grab => Shape::Grab,
        CursorIcon::Grabbing => Shape::Grabbing,
        CursorIcon::PointingHand => Shape::Pointer,
        CursorIcon::Text => Shape::Text,
        CursorIcon::ResizeHorizontal | CursorIcon::ResizeColumn => Shape::EwResize,
        CursorIcon::ResizeVertical | CursorIcon::ResizeRow => Shape::NsResize,
        CursorIcon::NotAllowed => Shape::NotAllowed,
        CursorIcon::Wait => Shape::Wait,
        _ => Shape::Default,
    }
}

/// The state of the queue.
#[derive(Default)]
struct WaylandState {
    inbox: Inbox,
    cursor: Arc<Mutex<Cursor>>,
    manager: Option<ZwpTabletManagerV2>,
    shapes: Option<WpCursorShapeManagerV1>,
    /// Seats by their names in the registry, with the tablets of each once they are requested.
    seats: BTreeMap<u32, (wl_seat::WlSeat, Option<ZwpTabletSeatV2>)>,
    tablets: Vec<(ObjectId, String)>,
    tools: Vec<(ObjectId, Tool, Option<WpCursorShapeDeviceV1>)>,
    /// The initial globals are known.
    is_known: bool,
}

impl WaylandState {
    /// Asks each seat for its tablets.
    fn ask_seats(&mut self, handle: &QueueHandle<WaylandState>) {
        let Some(manager) = &self.manager else { return };
        for (seat, tablets) in self.seats.values_mut() {
            tablets.get_or_insert_with(|| manager.get_tablet_seat(seat, handle, ()));
        }
    }

    fn tell_names(&self) {
        self.inbox.name(self.tablets.iter().map(|(_, name)| name.clone()).collect());
    }

    fn take(&mut self, tool: &ZwpTabletToolV2, event: ToolEvent) {
        let found = self.tools.iter_mut().find(|(id, ..)| *id == tool.id());
        if let Some(report) = found.and_then(|(_, tool, _)| tool.take(event)) {
            self.inbox.push(report);
        }
    }

    /// Handles a pen that comes over a window, where it has a cursor of its own.
    fn enter(&mut self, tool: &ZwpTabletToolV2, serial: u32, handle: &QueueHandle<WaylandState>) {
        let Some(shapes) = &self.shapes else { return };
        let Some((_, _, device)) = self.tools.iter_mut().find(|(id, ..)| *id == tool.id()) else {
            return;
        };
        let device = device.get_or_insert_with(|| shapes.get_tablet_tool_v2(tool, handle, ()));
        let mut cursor = self.cursor.lock().unwrap_or_else(PoisonError::into_inner);
        cursor.device = Some((device.clone(), serial));
        cursor.send();
    }

    fn forget(&mut self, tool: &ZwpTabletToolV2) {
        let mut cursor = self.cursor.lock().unwrap_or_else(PoisonError::into_inner);
        for (_, _, device) in self.tools.extract_if(.., |(id, ..)| *id == tool.id()) {
            let Some(device) = device else { continue };
            cursor.device.take_if(|(used, _)| *used == device);
            device.destroy();
        }
    }
}

impl Dispatch<wl_registry::WlRegistry, ()> for WaylandState {
    fn event(
        state: &mut WaylandState,
        registry: &wl_registry::WlRegistry,
        event: wl_registry::Event,
        (): &(),
        _: &Connection,
        handle: &QueueHandle<WaylandState>,
    ) {
        match event {
            wl_registry::Event::Global { name, interface, .. } => match interface.as_str() {
                "zwp_tablet_manager_v2" => {
                    state.manager.get_or_insert_with(|| registry.bind(name, 1, handle, ()));
                    state.ask_seats(handle);
                }
                "wp_cursor_shape_manager_v1" => {
                    state.shapes.get_or_insert_with(|| registry.bind(name, 1, handle, ()));
                }
                "wl_seat" => {
                    state.seats.insert(name, (registry.bind(name, 1, handle, ()), None));
                    state.ask_seats(handle);
                }
                _ => {}
            },
            wl_registry::Event::GlobalRemove { name } => {
                if let Some((_, Some(tablets))) = state.seats.remove(&name) {
                    tablets.destroy();
                }
            }
            _ => {}
        }
    }
}

impl Dispatch<wl_callback::WlCallback, ()> for WaylandState {
    fn event(
        state: &mut WaylandState,
        _: &wl_callback::WlCallback,
        _: wl_callback::Event,
        (): &(),
        _: &Connection,
        _: &QueueHandle<WaylandState>,
    ) {
        state.is_known = true;
    }
}

impl Dispatch<ZwpTabletSeatV2, ()> for WaylandState {
    fn event(
        state: &mut WaylandState,
        _: &ZwpTabletSeatV2,
        event: zwp_tablet_seat_v2::Event,
        (): &(),
        _: &Connection,
        _: &QueueHandle<WaylandState>,
    ) {
        match event {
            zwp_tablet_seat_v2::Event::TabletAdded { id } => {
                state.tablets.push((id.id(), "tablet".to_string()));
                state.tell_names();
            }
            zwp_tablet_seat_v2::Event::ToolAdded { id } => {
                state.tools.push((id.id(), Tool::default(), None));
            }
            // The desktop handles the buttons of the tablet itself.
            zwp_tablet_seat_v2::Event::PadAdded { id } => id.destroy(),
            _ => {}
        }
    }

    event_created_child!(WaylandState, ZwpTabletSeatV2, [
        zwp_tablet_seat_v2::EVT_TABLET_ADDED_OPCODE => (ZwpTabletV2, ()),
        zwp_tablet_seat_v2::EVT_TOOL_ADDED_OPCODE => (ZwpTabletToolV2, ()),
        zwp_tablet_seat_v2::EVT_PAD_ADDED_OPCODE => (ZwpTabletPadV2, ()),
    ]);
}

impl Dispatch<ZwpTabletV2, ()> for WaylandState {
    fn event(
        state: &mut WaylandState,
        tablet: &ZwpTabletV2,
        event: zwp_tablet_v2::Event,
        (): &(),
        _: &Connection,
        _: &QueueHandle<WaylandState>,
    ) {
        match event {
            zwp_tablet_v2::Event::Name { name } => {
                if let Some(known) = state.tablets.iter_mut().find(|(id, _)| *id == tablet.id()) {
                    known.1 = name;
                }
            }
            zwp_tablet_v2::Event::Removed => {
                state.tablets.retain(|(id, _)| *id != tablet.id());
                tablet.destroy();
            }
            _ => return,
        }
        state.tell_names();
    }
}

impl Dispatch<ZwpTabletToolV2, ()> for WaylandState {
    fn event(
        state: &mut WaylandState,
        tool: &ZwpTabletToolV2,
        event: zwp_tablet_tool_v2::Event,
        (): &(),
        _: &Connection,
        handle: &QueueHandle<WaylandState>,
    ) {
        use zwp_tablet_tool_v2::{ButtonState, Capability, Event};
        let event = match event {
            Event::Type { tool_type } => ToolEvent::Kind(tool_type.into()),
            Event::Capability { capability: WEnum::Value(Capability::Pressure) } => {
                ToolEvent::CanPress
            }
            Event::ProximityIn { serial, surface, .. } => {
                state.enter(tool, serial, handle);
                ToolEvent::Near(key_of(&surface))
            }
            Event::ProximityOut => ToolEvent::Away,
            Event::Down { .. } => ToolEvent::Down,
            Event::Up => ToolEvent::Up,
            Event::Motion { x, y } => ToolEvent::Moved(Vec2::new(x as f32, y as f32)),
            Event::Pressure { pressure } => ToolEvent::Pressed(pressure),
            Event::Tilt { tilt_x, tilt_y } => {
                ToolEvent::Tilted(Vec2::new(tilt_x as f32, tilt_y as f32))
            }
            Event::Button { button, state, .. } => {
                let is_down = state == WEnum::Value(ButtonState::Pressed);
                ToolEvent::Button { code: button, is_down }
            }
            Event::Frame { .. } => ToolEvent::Frame,
            Event::Removed => {
                // Releases its buttons.
                state.take(tool, ToolEvent::Away);
                state.take(tool, ToolEvent::Frame);
                state.forget(tool);
                return tool.destroy();
            }
            _ => return,
        };
        state.take(tool, event);
    }
}

/// Returns the key of the window of a surface.
fn key_of(surface: &wl_surface::WlSurface) -> WindowKey {
    WindowKey::numbered(surface.id().as_ptr() as usize as u64)
}

impl Dispatch<ZwpTabletPadV2, ()> for WaylandState {
    fn event(
        _: &mut WaylandState,
        _: &ZwpTabletPadV2,
        _: zwp_tablet_pad_v2::Event,
        (): &(),
        _: &Connection,
        _: &QueueHandle<WaylandState>,
    ) {
    }

    event_created_child!(WaylandState, ZwpTabletPadV2, [
        zwp_tablet_pad_v2::EVT_GROUP_OPCODE => (ZwpTabletPadGroupV2, ()),
    ]);
}

impl Dispatch<ZwpTabletPadGroupV2, ()> for WaylandState {
    fn event(
        _: &mut WaylandState,
        _: &ZwpTabletPadGroupV2,
        _: zwp_tablet_pad_group_v2::Event,
        (): &(),
        _: &Connection,
        _: &QueueHandle<WaylandState>,
    ) {
    }

    event_created_child!(WaylandState, ZwpTabletPadGroupV2, [
        zwp_tablet_pad_group_v2::EVT_RING_OPCODE => (ZwpTabletPadRingV2, ()),
        zwp_tablet_pad_group_v2::EVT_STRIP_OPCODE => (ZwpTabletPadStripV2, ()),
    ]);
}

delegate_noop!(WaylandState: ignore wl_seat::WlSeat);
delegate_noop!(WaylandState: ignore ZwpTabletPadRingV2);
delegate_noop!(WaylandState: ignore ZwpTabletPadStripV2);
delegate_noop!(WaylandState: ZwpTabletManagerV2);
delegate_noop!(WaylandState: WpCursorShapeManagerV1);
delegate_noop!(WaylandState: WpCursorShapeDeviceV1);

#[cfg(test)]
#[path = "wayland_tests.rs"]
mod tests;
