//! The program in a window on an X server, driven by simulated mouse and keyboard events.
//!
//! Nothing here waits for a time: the program is asked whether it has handled all events
//! ([`Program::wait_until_handled`]), and logs when it is idle.

use std::ops::Deref;
use std::path::PathBuf;

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    AtomEnum, ChangeWindowAttributesAux, ClientMessageEvent, ConfigureWindowAux,
    ConnectionExt as _, CreateWindowAux, EventMask, InputFocus, Keysym, Window, WindowClass,
};

use super::display::Display;
use super::process::{Process, STATES};
use crate::faults::Faults;

/// A small sculpture, no introduction, and pictures that are complete with their first frame: refining them takes a
/// debug build seconds for each.
pub const SETTINGS: &str =
    "[new]\ndims = [96, 96, 96]\n[window]\nguide = false\n[render]\nrefine = false\n";
/// The same with refined pictures.
pub const REFINED: &str = "[new]\ndims = [96, 96, 96]\n[window]\nguide = false\n";
/// Part of the title of the main window only.
const MAIN: &str = "Virtual Sculpture";
pub const KEY: u8 = 2;
pub const BUTTON: u8 = 4;
pub const MOTION: u8 = 6;

/// The running program.
pub struct Program<'a> {
    process: Process,
    display: &'a Display,
}

impl Deref for Program<'_> {
    type Target = Process;

    fn deref(&self) -> &Process {
        &self.process
    }
}

impl<'a> Program<'a> {
    /// Starts the program on a display with a small sculpture.
    pub fn start(display: &'a Display, arguments: &[&str]) -> Program<'a> {
        Program::start_with(display, arguments, SETTINGS)
    }

    /// The same in a theme.
    pub fn start_themed(display: &'a Display, theme: &str) -> Program<'a> {
        let settings = SETTINGS.replace("[window]\n", &format!("[window]\ntheme = \"{theme}\"\n"));
        Program::start_with(display, &[], &settings)
    }

    /// The same with other settings.
    pub fn start_with(display: &'a Display, arguments: &[&str], settings: &str) -> Program<'a> {
        Program::start_in(display, tempfile::tempdir().unwrap().keep(), arguments, settings)
    }

    /// The same with a given home folder, in which it may have been started before.
    pub fn start_in(
        display: &'a Display,
        folder: PathBuf,
        arguments: &[&str],
        settings: &str,
    ) -> Program<'a> {
        let process = Process::start_in(folder, arguments, settings, |command| {
            command.env("DISPLAY", display.name()).env_remove("WAYLAND_DISPLAY");
        });
        Program { process, display }
    }

    /// The same, and it logs which states it had and which of them are in the journal.
    pub fn start_with_states(
        display: &'a Display,
        folder: PathBuf,
        set: impl FnOnce(&mut std::process::Command),
    ) -> Program<'a> {
        let process = Process::start_in(folder, &[], SETTINGS, |command| {
            command.env("DISPLAY", display.name()).env_remove("WAYLAND_DISPLAY");
            command.env("RUST_LOG", format!("virtual_sculpture=debug,{STATES}=trace"));
            set(command);
        });
        Program { process, display }
    }

    /// Starts it as [`Program::start`] does, with a driver that fails on demand.
    pub fn start_failing(display: &'a Display) -> (Program<'a>, Faults) {
        let folder = tempfile::tempdir().unwrap().keep();
        let mut faults = None;
        let process = Process::start_in(folder.clone(), &[], SETTINGS, |command| {
            command.env("DISPLAY", display.name()).env_remove("WAYLAND_DISPLAY");
            faults = Some(Faults::new(&folder, command));
        });
        (Program { process, display }, faults.unwrap())
    }

    pub fn display(&self) -> &Display {
        self.display
    }

    /// Waits until the program has handled all events so far, and their immediate effects. Events come
    /// in order; the second ping arrives in a later iteration of the program's loop than the first,
    /// and so after the effects of the first iteration.
    pub fn wait_until_handled(&self) {
        // There may be no window yet, or no longer.
        let has_begun = || self.named(MAIN).is_some() || self.pictures() > 0;
        self.until("there is a window", || has_begun() || !self.is_running());
        for _ in 0..2 {
            self.ping();
        }
    }

    /// Asks the window whether the program is alive, as window managers do, and waits for the answer.
    fn ping(&self) {
        let x = &self.display.x;
        let listen = ChangeWindowAttributesAux::new().event_mask(EventMask::SUBSTRUCTURE_NOTIFY);
        x.change_window_attributes(self.display.root, &listen).unwrap();
        let atom = |name: &[u8]| x.intern_atom(false, name).unwrap().reply().unwrap().atom;
        let (protocols, ping) = (atom(b"WM_PROTOCOLS"), atom(b"_NET_WM_PING"));
        while x.poll_for_event().unwrap().is_some() {}
        // A program that is exiting has no window any more.
        let Some(window) = self.named(MAIN) else { return };
        let data = [ping, x11rb::CURRENT_TIME, window, 0, 0];
        let message = ClientMessageEvent::new(32, window, protocols, data);
        x.send_event(false, window, EventMask::NO_EVENT, message).unwrap();
        self.display.sync();
        self.until("the window answers", || {
            while let Some(event) = x.poll_for_event().unwrap() {
                if let Event::ClientMessage(answer) = event
                    && answer.data.as_data32()[0] == ping
                {
                    return true;
                }
            }
            self.named(MAIN).is_none() || !self.is_running()
        });
    }

    /// Waits until the program has handled all events so far, has shown a picture, and is idle.
    pub fn settle(&self) {
        self.display.sync();
        self.until("there is a picture", || self.pictures() > 0);
        // Until the pings cause no output: an event of one window may lead to a redraw of another only
        // some iterations later.
        loop {
            let before = self.output().len();
            self.wait_until_handled();
            self.until("the program is idle", || self.is_idle());
            if self.output().len() == before {
                return;
            }
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

    /// The window of a panel, once it is open.
    fn panel(&self, title: &str) -> Window {
        self.until("there is the window of a panel", || self.named(title).is_some());
        self.named(title).expect("it was there")
    }

    /// Moves and resizes the window of a panel: x, y, width, height.
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

    /// The picture that was copied to the clipboard.
    pub fn copied_picture(&self) -> image::RgbImage {
        let x = &self.display.x;
        let atom = |name: &[u8]| x.intern_atom(false, name).unwrap().reply().unwrap().atom;
        let (clipboard, png) = (atom(b"CLIPBOARD"), atom(b"image/png"));
        let window = x.generate_id().unwrap();
        let (class, depth) = (WindowClass::INPUT_ONLY, x11rb::COPY_FROM_PARENT as u8);
        let aux = CreateWindowAux::new();
        x.create_window(depth, window, self.display.root, 0, 0, 1, 1, 0, class, 0, &aux).unwrap();
        x.convert_selection(window, clipboard, png, png, x11rb::CURRENT_TIME).unwrap();
        self.display.sync();
        let given = std::cell::Cell::new(None);
        self.until("the clipboard answers", || {
            while let Some(event) = x.poll_for_event().unwrap() {
                if let Event::SelectionNotify(answer) = event {
                    given.set(Some(answer.property));
                }
            }
            given.get().is_some()
        });
        assert_eq!(given.get(), Some(png), "there is a picture on the clipboard");
        let bytes = x.get_property(true, window, png, AtomEnum::ANY, 0, u32::MAX).unwrap();
        image::load_from_memory(&bytes.reply().unwrap().value).unwrap().to_rgb8()
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
        self.wait_until_handled();
        self.display.device(BUTTON + 1, 1, at);
        self.settle();
    }

    /// Presses keys in order and releases them in reverse, after setting the focus (there is no window
    /// manager that would).
    pub fn key(&self, names: &[&str]) {
        self.key_in(self.window(), names);
    }

    fn key_in(&self, window: Window, names: &[&str]) {
        let x = &self.display.x;
        x.set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME).unwrap();
        self.wait_until_handled();
        let codes: Vec<u8> = names.iter().map(|n| self.display.keycode(symbol(n))).collect();
        for &code in &codes {
            self.display.device(KEY, code, [0, 0]);
            self.wait_until_handled();
        }
        for &code in codes.iter().rev() {
            self.display.device(KEY + 1, code, [0, 0]);
        }
        self.wait_until_handled();
    }

    /// Presses a button at the first point, moves along the others, releases it at the last, and leaves
    /// the picture.
    pub fn drag(&self, button: u8, path: &[[i16; 2]]) {
        self.display.device(MOTION, 0, path[0]);
        // Picking needs the picture that belongs to the pointer's position.
        self.settle();
        self.display.device(BUTTON, button, path[0]);
        self.settle();
        for &at in &path[1..] {
            self.display.device(MOTION, 0, at);
            // Each point needs a picture of its own, or the stroke would skip it.
            self.settle();
        }
        self.display.device(BUTTON + 1, button, path[path.len() - 1]);
        self.settle();
        self.leave_picture();
    }

    /// Moves the pointer out of the picture, where it has no effect.
    pub fn leave_picture(&self) {
        self.display.device(MOTION, 0, [30, 745]);
    }

    /// Turns the wheel away from the user.
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
        self.display.sync();
        self.wait_until_handled();
    }

    /// Answers the question about unsaved changes, and waits for the end.
    pub fn leave_without_saving(self) {
        // Save, Don't save, Cancel: two Tabs lead to the second button.
        self.key(&["Tab"]);
        self.key(&["Tab"]);
        self.key(&["space"]);
        self.expect_clean_exit();
    }
}

/// The X keysym of a key.
pub fn symbol(name: &str) -> Keysym {
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
        "F10" => 0xffc7,
        "F12" => 0xffc9,
        "equal" => 0x3d,
        "comma" => 0x2c,
        "apostrophe" => 0x27,
        "Return" => 0xff0d,
        "space" => 0x20,
        "minus" => 0x2d,
        letter if letter.len() == 1 => u32::from(letter.as_bytes()[0]),
        other => panic!("no symbol for {other}"),
    }
}
