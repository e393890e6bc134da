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
type Act = Box<dyn FnOnce(&mut Desk, &DisplayHandle) + Send>;

/// The server with one client.
pub struct Compositor {
    acts: Sender<Act>,
    bell: Option<PipeWriter>,
    thread: Option<JoinHandle<()>>,
    pub seen: Arc<Mutex<Seen>>,
}

/// The client's requests.
#[derive(Default)]
pub struct Seen {
    /// Shapes of the pen's cursor, with their serials.
    pub shapes: Vec<(u32, u32)>,
    /// The pads whose buttons it has declined.
    pub destroyed: usize,
}

/// The things on the server's desk.
#[derive(Default)]
pub struct Desk {
    pub surfaces: Vec<wl_surface::WlSurface>,
    pub seats: Vec<ZwpTabletSeatV2>,
    pub tablets: Vec<ZwpTabletV2>,
    pub tools: Vec<ZwpTabletToolV2>,
    seen: Arc<Mutex<Seen>>,
}

impl Compositor {
    /// Returns a server, with or without tablets, and the socket of its client.
    pub fn start(has_tablets: bool) -> (Compositor, UnixStream) {
        let (own, clients) = UnixStream::pair().unwrap();
        let (acts, todo) = channel::<Act>();
        let (mut heard, bell) = std::io::pipe().unwrap();
        let seen = Arc::new(Mutex::new(Seen::default()));
        let mut desk = Desk { seen: seen.clone(), ..Desk::default() };
        let thread = std::thread::spawn(move || {
            let mut display = Display::<Desk>::new().unwrap();
            let mut handle = display.handle();
            handle.create_global::<Desk, wl_compositor::WlCompositor, ()>(4, ());
            handle.create_global::<Desk, wl_seat::WlSeat, ()>(1, ());
            if has_tablets {
                handle.create_global::<Desk, ZwpTabletManagerV2, ()>(1, ());
                handle.create_global::<Desk, WpCursorShapeManagerV1, ()>(1, ());
            }
            handle.insert_client(own, Arc::new(Nothing)).unwrap();
            loop {
                display.dispatch_clients(&mut desk).unwrap();
                display.flush_clients().unwrap();
                match wait(display.backend().poll_fd(), &heard) {
                    Ok(Waited::Readable) => {}
                    Ok(Waited::Stopped) => {
                        let mut ring = [0];
                        if heard.read(&mut ring).unwrap() == 0 {
                            return;
                        }
                        display.dispatch_clients(&mut desk).unwrap();
                        todo.recv().unwrap()(&mut desk, &handle);
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
        act: impl FnOnce(&mut Desk, &DisplayHandle) -> T + Send + 'static,
    ) -> T {
        let (done, result) = channel();
        let act: Act = Box::new(move |desk, handle| done.send(act(desk, handle)).unwrap());
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

impl Desk {
    /// Adds a tablet.
    pub fn add_tablet(&mut self, handle: &DisplayHandle, name: &str) {
        let seat = &self.seats[0];
        let client = seat.client().unwrap();
        let tablet = client.create_resource::<ZwpTabletV2, (), Desk>(handle, 1, ()).unwrap();
        seat.tablet_added(&tablet);
        tablet.name(name.to_string());
        tablet.done();
        let pad = client.create_resource::<ZwpTabletPadV2, (), Desk>(handle, 1, ()).unwrap();
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
        let tool = client.create_resource::<ZwpTabletToolV2, (), Desk>(handle, 1, ()).unwrap();
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
        impl GlobalDispatch<$interface, ()> for Desk {
            fn bind(
                _: &mut Desk,
                _: &DisplayHandle,
                _: &Client,
                resource: New<$interface>,
                (): &(),
                init: &mut DataInit<'_, Desk>,
            ) {
                init.init(resource, ());
            }
        }
    )*};
}

globals!(wl_compositor::WlCompositor, wl_seat::WlSeat, ZwpTabletManagerV2, WpCursorShapeManagerV1);

/// Handles the requests of an interface.
macro_rules! requests {
    ($interface:ty, $request:ty, |$desk:ident, $asked:ident, $init:ident| $body:expr) => {
        impl Dispatch<$interface, ()> for Desk {
            fn request(
                $desk: &mut Desk,
                _: &Client,
                _: &$interface,
                $asked: $request,
                (): &(),
                _: &DisplayHandle,
                $init: &mut DataInit<'_, Desk>,
            ) {
                $body
            }
        }
    };
}

requests!(wl_compositor::WlCompositor, wl_compositor::Request, |desk, asked, init| match asked {
    wl_compositor::Request::CreateSurface { id } => desk.surfaces.push(init.init(id, ())),
    wl_compositor::Request::CreateRegion { id } => {
        init.init(id, ());
    }
    _ => {}
});
requests!(ZwpTabletManagerV2, zwp_tablet_manager_v2::Request, |desk, asked, init| {
    if let zwp_tablet_manager_v2::Request::GetTabletSeat { tablet_seat, .. } = asked {
        desk.seats.push(init.init(tablet_seat, ()));
    }
});
requests!(WpCursorShapeManagerV1, wp_cursor_shape_manager_v1::Request, |_desk, asked, init| {
    if let wp_cursor_shape_manager_v1::Request::GetTabletToolV2 { cursor_shape_device, .. } = asked
    {
        init.init(cursor_shape_device, ());
    }
});
requests!(WpCursorShapeDeviceV1, wp_cursor_shape_device_v1::Request, |desk, asked, _init| {
    if let wp_cursor_shape_device_v1::Request::SetShape { serial, shape: WEnum::Value(shape) } =
        asked
    {
        desk.seen.lock().unwrap().shapes.push((serial, shape.into()));
    }
});
requests!(
    ZwpTabletPadV2,
    wayland_protocols::wp::tablet::zv2::server::zwp_tablet_pad_v2::Request,
    |desk, _asked, _init| desk.seen.lock().unwrap().destroyed += 1
);
requests!(ZwpTabletSeatV2, zwp_tablet_seat_v2::Request, |_desk, _asked, _init| ());
requests!(ZwpTabletV2, zwp_tablet_v2::Request, |_desk, _asked, _init| ());
requests!(ZwpTabletToolV2, zwp_tablet_tool_v2::Request, |_desk, _asked, _init| ());
requests!(wl_seat::WlSeat, wl_seat::Request, |_desk, _asked, _init| ());
requests!(wl_surface::WlSurface, wl_surface::Request, |_desk, _asked, _init| ());
requests!(wl_region::WlRegion, wl_region::Request, |_desk, _asked, _init| ());
