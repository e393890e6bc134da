//! Tests pens on X11 with Xvfb. Its test pointer acts as a pen, since no pen can be created there.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use x11rb::protocol::xproto::{BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT};
use x11rb::protocol::xproto::{CreateWindowAux, MOTION_NOTIFY_EVENT, WindowClass};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_DEPTH_FROM_PARENT, COPY_FROM_PARENT};

use super::*;
use crate::input::Button;

/// Longest wait for an expected event.
const PATIENCE: Duration = Duration::from_secs(20);
/// The slave pointer of XTest.
const TEST_POINTER: u16 = 4;

struct Xvfb {
    server: Child,
    name: String,
}

impl Xvfb {
    /// Starts a server. Without Xvfb, prints a note and returns `None`, unless the tests require it.
    #[expect(clippy::print_stderr, reason = "a test says what it leaves out")]
    fn start() -> Option<Xvfb> {
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-screen", "0", "320x240x24", "-nolisten", "tcp"]);
        let server = command.arg("-noreset").stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut server = match server {
            Ok(server) => server,
            Err(error) => {
                assert!(std::env::var_os("VS_REQUIRE_WINDOW").is_none(), "no Xvfb: {error}");
                eprintln!("left out: Xvfb cannot be started ({error})");
                return None;
            }
        };
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Some(Xvfb { server, name: format!(":{}", number.trim()) })
    }
}

impl Drop for Xvfb {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Returns a client with a window that listens to the pointer like winit.
fn window(name: &str) -> (RustConnection, Window, Window) {
    let (x, screen) = x11rb::connect(Some(name)).unwrap();
    let root = x.setup().roots[screen].root;
    let window = x.generate_id().unwrap();
    let (depth, class) = (COPY_DEPTH_FROM_PARENT, WindowClass::INPUT_OUTPUT);
    let aux = CreateWindowAux::new();
    x.create_window(depth, window, root, 10, 20, 200, 150, 0, class, COPY_FROM_PARENT, &aux)
        .unwrap();
    x.xinput_xi_query_version(2, 2).unwrap().reply().unwrap();
    let events = XIEventMask::MOTION | XIEventMask::BUTTON_PRESS | XIEventMask::BUTTON_RELEASE;
    let masks = [EventMask { deviceid: Device::ALL_MASTER.into(), mask: vec![events] }];
    x.xinput_xi_select_events(window, &masks).unwrap().check().unwrap();
    x.map_window(window).unwrap();
    x.sync().unwrap();
    (x, window, root)
}

#[test]
fn pens_are_heard_beside_the_pointer_of_the_window_which_loses_nothing() {
    let Some(server) = Xvfb::start() else { return };
    let (x, window, root) = window(&server.name);
    let (woken, wakes) = channel();
    let mut pens =
        X11Pens::connect_to(Some(&server.name), move || woken.send(()).unwrap_or(())).unwrap();
    assert!(pens.take().is_empty() && pens.take_names().is_none(), "Xvfb has no pen");
    pens.watch(WindowKey::numbered(window.into()));
    // The pointer gets another device with its first event, and the thread looks for pens again.
    x.xtest_fake_input(MOTION_NOTIFY_EVENT, 0, 0, root, 20, 30, 0).unwrap();
    x.sync().unwrap();
    while x.poll_for_event().unwrap().is_some() {}
    {
        let mut reader = lock(&pens.reader);
        reader.catch_up().unwrap();
        reader.devices = PenDevices::pretended(TEST_POINTER);
        let windows = reader.windows.clone();
        reader.select(&windows).unwrap();
        reader.catch_up().unwrap();
    }
    for (kind, detail, [x_px, y_px]) in [
        (MOTION_NOTIFY_EVENT, 0, [40, 60]),
        (BUTTON_PRESS_EVENT, 1, [0, 0]),
        (MOTION_NOTIFY_EVENT, 0, [55, 61]),
        (BUTTON_PRESS_EVENT, 3, [0, 0]),
        (BUTTON_RELEASE_EVENT, 3, [0, 0]),
        (BUTTON_RELEASE_EVENT, 1, [0, 0]),
    ] {
        x.xtest_fake_input(kind, detail, 0, root, x_px, y_px, 0).unwrap();
    }
    x.sync().unwrap();
    // Everything sent by the server is there at once, however much the thread has read.
    let heard = pens.take();
    wakes.try_iter().for_each(drop);
    assert_eq!(heard.len(), 6, "{heard:?}");
    assert!(heard.iter().all(|report| report.window == WindowKey::numbered(window.into())));
    let sample = |i: usize| heard[i].sample;
    assert_eq!(sample(0).position_px.to_array(), [30.0, 40.0]);
    assert_eq!(sample(2).position_px.to_array(), [45.0, 41.0]);
    let down: Vec<bool> = (0..6).map(|i| sample(i).is_down()).collect();
    assert_eq!(down, [false, true, true, true, true, false]);
    assert!(sample(3).buttons.has(Button::PenUpper) && !sample(4).buttons.has(Button::PenUpper));

    // The window has received its pointer events throughout.
    let mut own = Vec::new();
    while let Some(event) = x.poll_for_event().unwrap() {
        own.push(match event {
            Event::XinputMotion(_) => "motion",
            Event::XinputButtonPress(_) => "press",
            Event::XinputButtonRelease(_) => "release",
            other => panic!("{other:?}"),
        });
    }
    assert_eq!(own, ["motion", "press", "motion", "press", "release", "release"]);
}

#[test]
fn the_thread_ends_with_the_pens_and_with_the_server() {
    let Some(server) = Xvfb::start() else { return };
    for _ in 0..3 {
        drop(X11Pens::connect_to(Some(&server.name), || ()).unwrap());
    }
    let mut pens = X11Pens::connect_to(Some(&server.name), || ()).unwrap();
    // A window that does not exist, or no longer.
    pens.watch(WindowKey::numbered(0x7777));
    assert!(pens.take().is_empty());
    let name = server.name.clone();
    drop(server);
    let until = Instant::now() + PATIENCE;
    while !pens.thread.as_ref().is_some_and(JoinHandle::is_finished) {
        assert!(Instant::now() < until, "the thread goes on");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(pens.take().is_empty());
    assert!(X11Pens::connect_to(Some(&name), || ()).is_err(), "nothing is there");
}
