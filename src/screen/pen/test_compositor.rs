//! A small Wayland server for tests: it shows nothing, and has a seat with a tablet whose pen follows the test.

use std::io::{PipeWriter, Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use wayland_protocols::wp::cursor_shape::v1::server::{
    wp_cursor_shape_device_v1::{self, WpCursorShapeDeviceV1},
    wp_cursor_shape_manager_v1::{self, WpCursorShapeManagerV1},
};
use wayland_protocols::wp::tablet::zv2::server::{
    zwp_tablet_manager_v2::{self, ZwpTabletManagerV2},
    zwp_tablet_pad_v2::ZwpTabletPadV2,
    zwp_tablet_seat_v2::{self, ZwpTabletSeatV2},
    zwp_tablet_tool_v2::{self, ZwpTabletToolV2},
    zwp_tablet_v2::{self, ZwpTabletV2},
};
use wayland_server::backend::ClientData;
use wayland_server::protocol::{wl_compositor, wl_region, wl_seat, wl_surface};
use wayland_server::{
    Client, DataInit, Dispatch, Display, DisplayHandle, GlobalDispatch, New, Resource, WEnum,
};

use crate::screen::pen::inbox::{Waited, wait};

/// A request of a test to the server, on its thread.
type Act = Box<dyn FnOnce(&mut CompositorState, &DisplayHandle) + Send>;

/// The server with one client.
pub struct Compositor {
    acts: Sender<Act>,
    bell: Option<PipeWriter>,
    thread: Option<JoinHandle<()>>,
    pub seen: Arc<Mutex<ClientRequests>>,
}

/// The client's requests.
#[derive(Default)]
pub struct ClientRequests {
    /// Shapes of the pen's cursor, with their serials.
    pub shapes: Vec<(u32, u32)>,
    /// The pads whose buttons it has declined.
    pub destroyed: usize,
}

/// The client's objects, and its requests.
#[derive(Default)]
pub struct CompositorState {
    pub surfaces: Vec<wl_surface::WlSurface>,
    pub seats: Vec<ZwpTabletSeatV2>,
    pub tablets: Vec<ZwpTabletV2>,
    pub tools: Vec<ZwpTabletToolV2>,
    seen: Arc<Mutex<ClientRequests>>,
}

impl Compositor {
    /// Returns a server, with or without tablets, and the socket of its client.
    pub fn start(has_tablets: bool) -> (Compositor, UnixStream) {
        let (own, clients) = UnixStream::pair().unwrap();
        let (acts, todo) = channel::<Act>();
        let (mut heard, bell) = std::io::pipe().unwrap();
        let seen = Arc::new(Mutex::new(ClientRequests::default()));
        let mut state = CompositorState { seen: seen.clone(), ..CompositorState::default() };
        let thread = std::thread::spawn(move || {
            let mut display = Display::<CompositorState>::new().unwrap();
            let mut handle = display.handle();
            handle.create_global::<CompositorState, wl_compositor::WlCompositor, ()>(4, ());
            handle.create_global::<CompositorState, wl_seat::WlSeat, ()>(1, ());
            if has_tablets {
                handle.create_global::<CompositorState, ZwpTabletManagerV2, ()>(1, ());
                handle.create_global::<CompositorState, WpCursorShapeManagerV1, ()>(1, ());
            }
            handle.insert_client(own, Arc::new(Nothing)).unwrap();
            loop {
                display.dispatch_clients(&mut state).unwrap();
                display.flush_clients().unwrap();
                match wait(display.backend().poll_fd(), &heard) {
                    Ok(Waited::Readable) => {}
                    Ok(Waited::Stopped) => {
                        let mut ring = [0];
                        if heard.read(&mut ring).unwrap() == 0 {
                            return;
                        }
                        display.dispatch_clients(&mut state).unwrap();
                        todo.recv().unwrap()(&mut state, &handle);
                    }
                    Err(error) => panic!("{error}"),
                }
            }
        });
        (Compositor { acts, bell: Some(bell), thread: Some(thread), seen }, clients)
    }

    /// Runs a function on the server's state, and waits for its result.
    pub fn act<T: Send + 'static>(
        &mut self,
        act: impl FnOnce(&mut CompositorState, &DisplayHandle) -> T + Send + 'static,
    ) -> T {
        let (done, result) = channel();
        let act: Act = Box::new(move |state, handle| done.send(act(state, handle)).unwrap());
        self.acts.send(act).unwrap();
        self.bell.as_mut().unwrap().write_all(&[1]).unwrap();
        result.recv().unwrap()
    }
}

impl Drop for Compositor {
    fn drop(&mut self) {
        self.bell = None;
        let ended = self.thread.take().map(JoinHandle::join);
        if !std::thread::panicking() {
            assert!(ended.is_some_and(|ended| ended.is_ok()), "the server has failed");
        }
    }
}

impl CompositorState {
    /// Adds a tablet.
    pub fn add_tablet(&mut self, handle: &DisplayHandle, name: &str) {
        let seat = &self.seats[0];
        let client = seat.client().unwrap();
        let tablet =
            client.create_resource::<ZwpTabletV2, (), CompositorState>(handle, 1, ()).unwrap();
        seat.tablet_added(&tablet);
        tablet.name(name.to_string());
        tablet.done();
        let pad =
            client.create_resource::<ZwpTabletPadV2, (), CompositorState>(handle, 1, ()).unwrap();
        seat.pad_added(&pad);
        pad.buttons(4);
        pad.done();
        self.tablets.push(tablet);
    }

    /// Adds one end of a pen to the seat.
    pub fn add_tool(&mut self, handle: &DisplayHandle, kind: zwp_tablet_tool_v2::Type) {
        use zwp_tablet_tool_v2::Capability;
        let seat = &self.seats[0];
        let client = seat.client().unwrap();
        let tool =
            client.create_resource::<ZwpTabletToolV2, (), CompositorState>(handle, 1, ()).unwrap();
        seat.tool_added(&tool);
        tool._type(kind);
        tool.capability(Capability::Pressure);
        tool.capability(Capability::Tilt);
        tool.done();
        self.tools.push(tool);
    }
}

struct Nothing;

impl ClientData for Nothing {}

/// Globals that do nothing when they are bound.
macro_rules! globals {
    ($($interface:ty),*) => {$(
        impl GlobalDispatch<$interface, ()> for CompositorState {
            fn bind(
                _: &mut CompositorState,
                _: &DisplayHandle,
                _: &Client,
                resource: New<$interface>,
                (): &(),
                init: &mut DataInit<'_, CompositorState>,
            ) {
                init.init(resource, ());
            }
        }
    )*};
}

globals!(wl_compositor::WlCompositor, wl_seat::WlSeat, ZwpTabletManagerV2, WpCursorShapeManagerV1);

/// Handles the requests of an interface.
macro_rules! requests {
    ($interface:ty, $request:ty, |$state:ident, $asked:ident, $init:ident| $body:expr) => {
        impl Dispatch<$interface, ()> for CompositorState {
            fn request(
                $state: &mut CompositorState,
                _: &Client,
                _: &$interface,
                $asked: $request,
                (): &(),
                _: &DisplayHandle,
                $init: &mut DataInit<'_, CompositorState>,
            ) {
                $body
            }
        }
    };
}

requests!(wl_compositor::WlCompositor, wl_compositor::Request, |state, asked, init| match asked {
    wl_compositor::Request::CreateSurface { id } => state.surfaces.push(init.init(id, ())),
    wl_compositor::Request::CreateRegion { id } => {
        init.init(id, ());
    }
    _ => {}
});
requests!(ZwpTabletManagerV2, zwp_tablet_manager_v2::Request, |state, asked, init| {
    if let zwp_tablet_manager_v2::Request::GetTabletSeat { tablet_seat, .. } = asked {
        state.seats.push(init.init(tablet_seat, ()));
    }
});
requests!(WpCursorShapeManagerV1, wp_cursor_shape_manager_v1::Request, |_state, asked, init| {
    if let wp_cursor_shape_manager_v1::Request::GetTabletToolV2 { cursor_shape_device, .. } = asked
    {
        init.init(cursor_shape_device, ());
    }
});
requests!(WpCursorShapeDeviceV1, wp_cursor_shape_device_v1::Request, |state, asked, _init| {
    if let wp_cursor_shape_device_v1::Request::SetShape { serial, shape: WEnum::Value(shape) } =
        asked
    {
        state.seen.lock().unwrap().shapes.push((serial, shape.into()));
    }
});
requests!(
    ZwpTabletPadV2,
    wayland_protocols::wp::tablet::zv2::server::zwp_tablet_pad_v2::Request,
    |state, _asked, _init| state.seen.lock().unwrap().destroyed += 1
);
requests!(ZwpTabletSeatV2, zwp_tablet_seat_v2::Request, |_state, _asked, _init| ());
requests!(ZwpTabletV2, zwp_tablet_v2::Request, |_state, _asked, _init| ());
requests!(ZwpTabletToolV2, zwp_tablet_tool_v2::Request, |_state, _asked, _init| ());
requests!(wl_seat::WlSeat, wl_seat::Request, |_state, _asked, _init| ());
requests!(wl_surface::WlSurface, wl_surface::Request, |_state, _asked, _init| ());
requests!(wl_region::WlRegion, wl_region::Request, |_state, _asked, _init| ());
