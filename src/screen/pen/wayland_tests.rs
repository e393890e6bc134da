//! Tests pens on Wayland with a test server that has a tablet.

use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use wayland_client::globals::{GlobalListContents, registry_queue_init};
use wayland_client::protocol::{wl_compositor, wl_registry, wl_surface};
use wayland_protocols::wp::tablet::zv2::server::zwp_tablet_tool_v2::{ButtonState, Type};

use super::*;
use crate::input::pen::PenEnd;
use crate::input::{Button, Buttons};
use crate::screen::pen::test_compositor::Compositor;

/// Longest wait for an expected event.
const PATIENCE: Duration = Duration::from_secs(20);

/// The other part of the program, which has a window on the display.
struct Other {
    connection: Connection,
    queue: EventQueue<Windows>,
    surfaces: Vec<wl_surface::WlSurface>,
}

struct Windows;

impl Dispatch<wl_registry::WlRegistry, GlobalListContents> for Windows {
    fn event(
        _: &mut Windows,
        _: &wl_registry::WlRegistry,
        _: wl_registry::Event,
        _: &GlobalListContents,
        _: &Connection,
        _: &QueueHandle<Windows>,
    ) {
    }
}

delegate_noop!(Windows: wl_compositor::WlCompositor);
delegate_noop!(Windows: ignore wl_surface::WlSurface);

impl Other {
    fn connect(socket: UnixStream, windows: usize) -> Other {
        let connection = Connection::from_socket(socket).unwrap();
        let (globals, queue) = registry_queue_init::<Windows>(&connection).unwrap();
        let handle = queue.handle();
        let compositor: wl_compositor::WlCompositor = globals.bind(&handle, 1..=4, ()).unwrap();
        let surfaces = (0..windows).map(|_| compositor.create_surface(&handle, ())).collect();
        let mut other = Other { connection, queue, surfaces };
        other.roundtrip();
        other
    }

    fn roundtrip(&mut self) {
        self.queue.roundtrip(&mut Windows).unwrap();
    }

    fn pens(&self) -> (WaylandPens, Receiver<()>) {
        let (woken, wakes) = channel();
        let display = NonNull::new(self.connection.backend().display_ptr()).unwrap();
        // SAFETY: each test drops the pens before the connection.
        let pens = unsafe { WaylandPens::on(display.cast(), move || woken.send(()).unwrap_or(())) };
        (pens.unwrap(), wakes)
    }
}

/// Polls until there is a result.
fn until<T>(what: &str, mut ask: impl FnMut() -> Option<T>) -> T {
    let until = Instant::now() + PATIENCE;
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(Instant::now() < until, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Returns the reports of so many frames.
fn reports(pens: &mut WaylandPens, wakes: &Receiver<()>, count: usize) -> Vec<PenReport> {
    let mut all = Vec::new();
    while all.len() < count {
        wakes.recv_timeout(PATIENCE).unwrap();
        all.extend(pens.take());
    }
    all
}

#[test]
fn a_stroke_of_a_tablet_is_heard_over_the_window_that_it_is_on() {
    let (mut server, socket) = Compositor::start(true);
    let mut other = Other::connect(socket, 2);
    let (mut pens, wakes) = other.pens();
    until("the seat", || server.act(|desk, _| (!desk.seats.is_empty()).then_some(())));
    server.act(|desk, handle| {
        desk.add_tablet(handle, "Wacom Intuos Pro M");
        desk.add_tool(handle, Type::Pen);
    });
    until("its name", || pens.take_names().filter(|names| names == &["Wacom Intuos Pro M"]));
    server.act(|desk, _| {
        let (tool, tablet, surface) = (&desk.tools[0], &desk.tablets[0], &desk.surfaces[1]);
        tool.proximity_in(17, tablet, surface);
        tool.motion(100.0, 50.0);
        tool.tilt(30.0, -15.5);
        tool.frame(1);
        for i in 0..4u32 {
            if i == 0 {
                tool.down(18);
            }
            tool.motion(100.0 + f64::from(i) * 2.5, 50.0);
            tool.pressure(i * 16_000);
            tool.frame(2 + i);
        }
        tool.button(19, 0x14b, ButtonState::Pressed);
        tool.frame(7);
        tool.up();
        tool.pressure(0);
        tool.button(20, 0x14b, ButtonState::Released);
        tool.frame(8);
        tool.proximity_out();
        tool.frame(9);
    });
    let heard = reports(&mut pens, &wakes, 8);
    assert_eq!(heard.len(), 8);
    let window = key_of(&other.surfaces[1]);
    assert!(heard.iter().all(|report| report.window == window));
    assert_ne!(window, key_of(&other.surfaces[0]));
    let samples: Vec<_> = heard.iter().map(|report| report.sample).collect();
    assert_eq!((samples[0].touch(), samples[0].tilt_deg), (None, Vec2::new(30.0, -15.5)));
    for (i, sample) in samples[1..5].iter().enumerate() {
        assert_eq!(sample.position_px, Vec2::new(100.0 + i as f32 * 2.5, 50.0));
        let pressure = i as f32 * 16_000.0 / 65_535.0;
        assert!((sample.touch().unwrap().pressure - pressure).abs() < 1e-6);
    }
    let tip = Buttons::NONE.with(Button::Left);
    assert_eq!(samples[5].buttons, tip.with(Button::PenLower));
    assert_eq!(samples[6].buttons, Buttons::NONE);
    assert!(!samples[7].is_near && samples[..7].iter().all(|sample| sample.is_near));
    // Meanwhile the other part has lost none of its events.
    other.roundtrip();
    assert_eq!(server.seen.lock().unwrap().destroyed, 1, "the pad is left to the desktop");
}

#[test]
fn the_eraser_is_another_tool_and_tools_and_tablets_may_go() {
    let (mut server, socket) = Compositor::start(true);
    let other = Other::connect(socket, 1);
    let (mut pens, wakes) = other.pens();
    until("the seat", || server.act(|desk, _| (!desk.seats.is_empty()).then_some(())));
    server.act(|desk, handle| {
        desk.add_tablet(handle, "Tablet");
        desk.add_tool(handle, Type::Pen);
        desk.add_tool(handle, Type::Eraser);
        let (tool, tablet, surface) = (&desk.tools[1], &desk.tablets[0], &desk.surfaces[0]);
        tool.proximity_in(1, tablet, surface);
        tool.motion(5.0, 6.0);
        tool.down(2);
        tool.pressure(65_535);
        tool.frame(1);
        // It is unplugged during a touch.
        tool.removed();
        tablet.removed();
    });
    let mut heard = Vec::new();
    until("two reports", || {
        heard.extend(pens.take());
        (heard.len() == 2).then_some(())
    });
    assert_eq!(heard[0].sample.end, PenEnd::Eraser);
    assert_eq!(heard[0].sample.buttons, Buttons::NONE.with(Button::Eraser));
    assert!(!heard[1].sample.is_near && heard[1].sample.buttons == Buttons::NONE);
    until("no names", || pens.take_names().filter(Vec::is_empty));
    drop(wakes);
}

#[test]
fn the_pen_has_the_cursor_of_the_window_under_it() {
    let (mut server, socket) = Compositor::start(true);
    let other = Other::connect(socket, 1);
    let (mut pens, wakes) = other.pens();
    pens.show_cursor(CursorIcon::Grab);
    until("the seat", || server.act(|desk, _| (!desk.seats.is_empty()).then_some(())));
    server.act(|desk, handle| {
        desk.add_tablet(handle, "Tablet");
        desk.add_tool(handle, Type::Pen);
        desk.tools[0].proximity_in(41, &desk.tablets[0], &desk.surfaces[0]);
        desk.tools[0].frame(1);
    });
    assert_eq!(reports(&mut pens, &wakes, 1).len(), 1);
    pens.show_cursor(CursorIcon::Crosshair);
    pens.show_cursor(CursorIcon::Crosshair);
    let (grab, crosshair) = (shape(CursorIcon::Grab) as u32, shape(CursorIcon::Crosshair) as u32);
    until("both shapes", || {
        server.act(|_, _| ());
        let shapes = server.seen.lock().unwrap().shapes.clone();
        (shapes == [(41, grab), (41, crosshair)]).then_some(())
    });
}

#[test]
fn without_a_tablet_manager_the_thread_ends_and_windows_go_on() {
    let (mut server, socket) = Compositor::start(false);
    let mut other = Other::connect(socket, 1);
    let (mut pens, _wakes) = other.pens();
    until("the end of the thread", || {
        pens.thread.as_ref().is_some_and(JoinHandle::is_finished).then_some(())
    });
    for _ in 0..3 {
        other.roundtrip();
    }
    assert!(pens.take().is_empty() && pens.take_names().is_none());
    pens.show_cursor(CursorIcon::Grab);
    drop(pens);
    other.roundtrip();
    server.act(|desk, _| assert!(desk.seats.is_empty()));
}

#[test]
fn pens_stop_while_nothing_happens_and_when_the_server_has_gone() {
    let (mut server, socket) = Compositor::start(true);
    let mut other = Other::connect(socket, 1);
    for _ in 0..3 {
        let (pens, _wakes) = other.pens();
        until("a seat", || server.act(|desk, _| desk.seats.pop()));
        drop(pens);
        other.roundtrip();
    }
    let (pens, _wakes) = other.pens();
    until("a seat", || server.act(|desk, _| desk.seats.pop()));
    drop(server);
    until("the end of the thread", || {
        pens.thread.as_ref().is_some_and(JoinHandle::is_finished).then_some(())
    });
}
