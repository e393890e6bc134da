//! The program as a process with a window.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConfigureWindowAux, ConnectionExt as _, EventMask, InputFocus,
    Keysym, Window,
};

use super::display::Display;

/// In the title of the main window alone.
const MAIN: &str = "Virtual Sculpture";
const KEY: u8 = 2;
const BUTTON: u8 = 4;
const MOTION: u8 = 6;
/// So long at rest is at rest.
const REST: Duration = Duration::from_millis(80);
/// By then the program has heard what was done to its window.
const HEARING: Duration = Duration::from_millis(300);
/// Longer than anything takes, on a slow machine too.
const PATIENCE: Duration = Duration::from_secs(120);

/// What the program has said so far.
#[derive(Default)]
struct Log {
    text: String,
    pictures: usize,
    /// Since when the program has said that it waits.
    resting: Option<Instant>,
}

/// The running program.
pub struct Program<'a> {
    child: Mutex<Child>,
    log: Arc<Mutex<Log>>,
    reader: Option<std::thread::JoinHandle<()>>,
    display: &'a Display,
    folder: PathBuf,
}

impl<'a> Program<'a> {
    /// Starts the program on a display with settings of its own: a small sculpture, and the
    /// validation layers where they are installed.
    pub fn start(display: &'a Display, arguments: &[&str]) -> Program<'a> {
        Program::start_with(
            display,
            arguments,
            "[new]\ndims = [96, 96, 96]\n[window]\nguide = false\n",
        )
    }

    /// The same with other settings.
    pub fn start_with(display: &'a Display, arguments: &[&str], settings: &str) -> Program<'a> {
        Program::start_in(display, tempfile::tempdir().unwrap().keep(), arguments, settings)
    }

    /// The same at home in a folder, where it may have been started before.
    pub fn start_in(
        display: &'a Display,
        folder: PathBuf,
        arguments: &[&str],
        settings: &str,
    ) -> Program<'a> {
        let config = folder.join("config.toml");
        std::fs::write(&config, settings).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"))
            .arg("--config")
            .arg(&config)
            .args(arguments)
            .env("DISPLAY", display.name())
            .env_remove("WAYLAND_DISPLAY")
            .env("VS_VALIDATION", "if-available")
            .env("RUST_LOG", "virtual_sculpture=debug")
            .env("NO_COLOR", "1")
            .env("HOME", &folder)
            .env_remove("XDG_CONFIG_HOME")
            .env_remove("XDG_STATE_HOME")
            .current_dir(&folder)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let log = Arc::new(Mutex::new(Log::default()));
        let (stderr, heard) = (child.stderr.take().unwrap(), log.clone());
        let reader = std::thread::spawn(move || {
            for line in BufReader::new(stderr).lines().map_while(Result::ok) {
                let mut log = heard.lock().unwrap();
                log.pictures += usize::from(line.contains("picture shown"));
                let resting = line.ends_with("at rest");
                log.resting = resting.then(Instant::now);
                log.text.push_str(&line);
                log.text.push('\n');
            }
        });
        Program { child: Mutex::new(child), log, reader: Some(reader), display, folder }
    }

    pub fn display(&self) -> &Display {
        self.display
    }

    pub fn is_running(&self) -> bool {
        self.child.lock().unwrap().try_wait().unwrap().is_none()
    }

    /// Pictures that the window has shown so far.
    pub fn pictures(&self) -> usize {
        self.log.lock().unwrap().pictures
    }

    /// The folder that the program runs in.
    pub fn folder(&self) -> &std::path::Path {
        &self.folder
    }

    /// Waits until the program has shown a picture and rests.
    pub fn settle(&self) {
        self.display.sync();
        let start = Instant::now();
        loop {
            std::thread::sleep(Duration::from_millis(20));
            let log = self.log.lock().unwrap();
            if self.child.lock().unwrap().try_wait().unwrap().is_some() {
                panic!("the program has ended:\n{}", log.text);
            }
            let resting = log.resting.is_some_and(|since| since.elapsed() > REST);
            if log.pictures > 0 && resting && start.elapsed() > HEARING {
                return;
            }
            assert!(start.elapsed() < PATIENCE, "no rest:\n{}", log.text);
        }
    }

    /// The program's main window.
    fn window(&self) -> Window {
        self.named(MAIN).expect("the program has a window")
    }

    /// The window whose title contains `title`.
    fn named(&self, title: &str) -> Option<Window> {
        let x = &self.display.x;
        let children = x.query_tree(self.display.root).unwrap().reply().unwrap().children;
        let named = |window: &Window| {
            let kind = AtomEnum::WM_NAME;
            let name = x.get_property(false, *window, kind, AtomEnum::ANY, 0, 100).unwrap();
            name.reply().is_ok_and(|name| String::from_utf8_lossy(&name.value).contains(title))
        };
        children.into_iter().find(named)
    }

    pub fn has_window(&self, title: &str) -> bool {
        self.display.sync();
        self.named(title).is_some()
    }

    /// The window of a panel, which may be on its way.
    fn panel(&self, title: &str) -> Window {
        let asked = Instant::now();
        loop {
            match self.named(title) {
                Some(window) => return window,
                None if asked.elapsed() > Duration::from_secs(20) => {
                    panic!("there is no window {title}")
                }
                None => std::thread::sleep(Duration::from_millis(50)),
            }
        }
    }

    /// Puts the window of a panel at x, y with a width and height.
    pub fn place_panel(&self, title: &str, [x, y, width, height]: [u32; 4]) {
        let change = ConfigureWindowAux::new().x(x as i32).y(y as i32).width(width).height(height);
        self.display.x.configure_window(self.panel(title), &change).unwrap();
        self.display.sync();
    }

    /// Width and height of the main window.
    pub fn size(&self) -> [u32; 2] {
        let place = self.display.x.get_geometry(self.window()).unwrap().reply().unwrap();
        [place.width.into(), place.height.into()]
    }

    /// x, y, width and height of the window of a panel.
    pub fn panel_place(&self, title: &str) -> [u32; 4] {
        let place = self.display.x.get_geometry(self.panel(title)).unwrap().reply().unwrap();
        [place.x as u32, place.y as u32, place.width.into(), place.height.into()]
    }

    /// Asks the window of a panel to close.
    pub fn close_panel(&self, title: &str) {
        self.close_window(self.panel(title));
    }

    /// Presses keys with the window of a panel in focus.
    pub fn key_in_panel(&self, title: &str, names: &[&str]) {
        self.key_in(self.panel(title), names);
    }

    /// Clicks with the left button.
    pub fn click(&self, at: [i16; 2]) {
        self.display.device(MOTION, 0, at);
        self.settle();
        self.display.device(BUTTON, 1, at);
        std::thread::sleep(Duration::from_millis(60));
        self.display.device(BUTTON + 1, 1, at);
        self.settle();
    }

    /// Presses keys in order and releases them in reverse, with the window in focus (there is no
    /// window manager that would give it).
    pub fn key(&self, names: &[&str]) {
        self.key_in(self.window(), names);
    }

    fn key_in(&self, window: Window, names: &[&str]) {
        let x = &self.display.x;
        x.set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME).unwrap();
        self.display.sync();
        std::thread::sleep(Duration::from_millis(80));
        let codes: Vec<u8> = names.iter().map(|n| self.display.keycode(symbol(n))).collect();
        for &code in &codes {
            self.display.device(KEY, code, [0, 0]);
            std::thread::sleep(Duration::from_millis(20));
        }
        for &code in codes.iter().rev() {
            self.display.device(KEY + 1, code, [0, 0]);
        }
        std::thread::sleep(Duration::from_millis(80));
    }

    /// Presses a button at the first point, goes along the others, releases it at the last, and
    /// leaves the picture.
    pub fn drag(&self, button: u8, way: &[[i16; 2]]) {
        let pause = || std::thread::sleep(Duration::from_millis(60));
        self.display.device(MOTION, 0, way[0]);
        // The pointer is where it points at only once its picture is there.
        self.settle();
        self.display.device(BUTTON, button, way[0]);
        pause();
        for &at in &way[1..] {
            self.display.device(MOTION, 0, at);
            pause();
        }
        self.display.device(BUTTON + 1, button, way[way.len() - 1]);
        pause();
        self.leave_picture();
    }

    /// Puts the pointer beside the picture, where it moves nothing.
    pub fn leave_picture(&self) {
        self.display.device(MOTION, 0, [30, 700]);
    }

    /// Turns the wheel away from the hand.
    pub fn wheel(&self, at: [i16; 2], notches: usize) {
        self.display.device(MOTION, 0, at);
        self.settle();
        for _ in 0..notches {
            self.display.device(BUTTON, 4, at);
            self.display.device(BUTTON + 1, 4, at);
        }
        self.settle();
        self.leave_picture();
    }

    pub fn resize(&self, [width, height]: [u32; 2]) {
        let change = ConfigureWindowAux::new().x(0).y(0).width(width).height(height);
        self.display.x.configure_window(self.window(), &change).unwrap();
        self.display.sync();
    }

    /// Unmaps the window, as a window manager does to minimise it.
    pub fn hide(&self) {
        self.display.x.unmap_window(self.window()).unwrap();
        self.display.sync();
    }

    pub fn show(&self) {
        self.display.x.map_window(self.window()).unwrap();
        self.display.sync();
    }

    /// Asks the window to close, as a window manager does.
    pub fn close(&self) {
        self.close_window(self.window());
    }

    fn close_window(&self, window: Window) {
        let x = &self.display.x;
        let atom = |name: &[u8]| x.intern_atom(false, name).unwrap().reply().unwrap().atom;
        let data = [atom(b"WM_DELETE_WINDOW"), x11rb::CURRENT_TIME, 0, 0, 0];
        let message = ClientMessageEvent::new(32, window, atom(b"WM_PROTOCOLS"), data);
        x.send_event(false, window, EventMask::NO_EVENT, message).unwrap();
        x.flush().unwrap();
        std::thread::sleep(Duration::from_millis(200));
    }

    /// Waits for the end; gives how it ended and all that was said.
    pub fn wait(mut self) -> (ExitStatus, String) {
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.child.lock().unwrap().try_wait().unwrap() {
                break status;
            }
            assert!(start.elapsed() < PATIENCE, "no end:\n{}", self.log.lock().unwrap().text);
            std::thread::sleep(Duration::from_millis(50));
        };
        if let Some(reader) = self.reader.take() {
            reader.join().unwrap();
        }
        let text = self.log.lock().unwrap().text.clone();
        (status, text)
    }

    /// Answers the question that leaving asks, and waits for the end.
    pub fn leave_without_saving(self) {
        // Save, Don't save, Cancel: two steps of the keyboard lead to the second.
        self.key(&["Tab"]);
        self.key(&["Tab"]);
        self.key(&["space"]);
        self.expect_clean_exit();
    }

    /// Waits for the end, which must be without complaint, of the validation layers too.
    pub fn expect_clean_exit(self) {
        let (status, text) = self.wait();
        assert!(status.success(), "{status}:\n{text}");
        let complaints: Vec<&str> = text
            .lines()
            .filter(|l| l.contains("virtual_sculpture"))
            .filter(|l| l.contains(" WARN ") || l.contains("ERROR"))
            .collect();
        assert!(complaints.is_empty(), "{complaints:#?}");
    }
}

impl Drop for Program<'_> {
    fn drop(&mut self) {
        if let Ok(mut child) = self.child.lock() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// The X symbol of a key.
fn symbol(name: &str) -> Keysym {
    match name {
        "Control_L" => 0xffe3,
        "Shift_L" => 0xffe1,
        "Alt_L" => 0xffe9,
        "Home" => 0xff50,
        "Escape" => 0xff1b,
        "Tab" => 0xff09,
        "F1" => 0xffbe,
        "Delete" => 0xffff,
        "Up" => 0xff52,
        "Down" => 0xff54,
        "Next" => 0xff56,
        "bracketleft" => 0x5b,
        "bracketright" => 0x5d,
        "F3" => 0xffc0,
        "F8" => 0xffc5,
        "F12" => 0xffc9,
        "equal" => 0x3d,
        "comma" => 0x2c,
        "Return" => 0xff0d,
        "space" => 0x20,
        "minus" => 0x2d,
        letter if letter.len() == 1 => u32::from(letter.as_bytes()[0]),
        other => panic!("no symbol for {other}"),
    }
}
