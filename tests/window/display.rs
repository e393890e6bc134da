//! A private X server without a monitor (Xvfb): simulated input devices and screenshots.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    AutoRepeatMode, ChangeKeyboardControlAux, ConnectionExt as _, ImageFormat, Keysym, Window,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

/// A running Xvfb; killed on drop.
pub struct Display {
    server: Child,
    name: String,
    pub x: RustConnection,
    pub root: Window,
    size: [u32; 2],
}

impl Display {
    /// Starts a server on a free display, or says why there is none.
    pub fn start(size: [u32; 2]) -> Result<Display, String> {
        let screen = format!("{}x{}x24", size[0], size[1]);
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &screen, "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("Xvfb cannot be started ({error}); install xvfb"))?;
        let mut number = String::new();
        let stdout = server.stdout.take().expect("piped");
        BufReader::new(stdout).read_line(&mut number).map_err(|e| e.to_string())?;
        if number.trim().is_empty() {
            let status = server.wait();
            return Err(format!("Xvfb names no display and ends with {status:?}"));
        }
        let name = format!(":{}", number.trim());
        let (x, _) = x11rb::connect(Some(&name)).map_err(|error| {
            let _ = server.kill();
            format!("no connection to Xvfb: {error}")
        })?;
        let root = x.setup().roots[0].root;
        let display = Display { server, name, x, root, size };
        // On a busy machine a key may be down for so long that it would be repeated.
        let no_repeat = ChangeKeyboardControlAux::new().auto_repeat_mode(AutoRepeatMode::OFF);
        let changed = display.x.change_keyboard_control(&no_repeat);
        let checked = changed.map_err(|error| error.to_string())?.check();
        checked.map_err(|error| format!("keys go on repeating themselves: {error}"))?;
        Ok(display)
    }

    /// The value for the environment variable DISPLAY.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Ends the server, as when a graphical session breaks down.
    pub fn kill(&self) {
        let id = self.server.id().to_string();
        assert!(Command::new("kill").args(["-KILL", &id]).status().unwrap().success());
    }

    /// Waits until the server has processed all requests.
    pub fn sync(&self) {
        self.x.sync().unwrap();
    }

    /// Simulates a device event; `kind` as in the X protocol (2 and 3 keys, 4 and 5 buttons, 6
    /// motion).
    pub fn device(&self, kind: u8, detail: u8, at: [i16; 2]) {
        self.x.xtest_fake_input(kind, detail, 0, self.root, at[0], at[1], 0).unwrap();
        self.sync();
    }

    /// The key that produces a symbol without modifiers.
    pub fn keycode(&self, symbol: Keysym) -> u8 {
        let setup = self.x.setup();
        let (first, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let map = self.x.get_keyboard_mapping(first, count).unwrap().reply().unwrap();
        let per_key = usize::from(map.keysyms_per_keycode);
        let found = map.keysyms.chunks(per_key).position(|symbols| symbols[0] == symbol);
        first + found.unwrap_or_else(|| panic!("no key gives {symbol:#x}")) as u8
    }

    /// Returns the contents of the screen.
    pub fn picture(&self) -> Picture {
        let [width, height] = self.size;
        let (format, all) = (ImageFormat::Z_PIXMAP, u32::MAX);
        let request =
            self.x.get_image(format, self.root, 0, 0, width as u16, height as u16, all).unwrap();
        let data = request.reply().unwrap().data;
        let rgb = data.chunks_exact(4).map(|p| [p[2], p[1], p[0]]).collect();
        Picture { size: self.size, rgb }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The folder target/test-output/window.
pub fn output_folder() -> PathBuf {
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let folder = target.parent().expect("in target").join("test-output").join("window");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A picture of the screen or a part of it.
#[derive(Clone)]
pub struct Picture {
    size: [u32; 2],
    rgb: Vec<[u8; 3]>,
}

impl Picture {
    /// The part at x, y of a width and height.
    pub fn part(&self, [x, y, width, height]: [u32; 4]) -> Picture {
        let row = |y: u32| {
            let start = (y * self.size[0] + x) as usize;
            &self.rgb[start..start + width as usize]
        };
        let rgb = (y..y + height).flat_map(row).copied().collect();
        Picture { size: [width, height], rgb }
    }

    /// `whole` with this part pasted at its original position.
    pub fn on(self, whole: &Picture, [x, y, width, height]: [u32; 4]) -> Picture {
        let mut out = whole.clone();
        for row in 0..height {
            let to = ((y + row) * whole.size[0] + x) as usize;
            let from = (row * width) as usize;
            let width = width as usize;
            out.rgb[to..to + width].copy_from_slice(&self.rgb[from..from + width]);
        }
        out
    }

    /// The number of pixels with another colour.
    pub fn differing(&self, other: &Picture) -> usize {
        assert_eq!(self.size, other.size);
        std::iter::zip(&self.rgb, &other.rgb).filter(|(a, b)| a != b).count()
    }

    /// All pixels, row by row.
    pub fn pixels(&self) -> Vec<[u8; 3]> {
        self.rgb.clone()
    }

    /// The number of different colours.
    pub fn colours(&self) -> usize {
        self.rgb.iter().collect::<std::collections::HashSet<_>>().len()
    }

    /// Saves it as target/test-output/window/NAME.png.
    pub fn save(&self, name: &str) {
        let folder = output_folder();
        let bytes = self.rgb.as_flattened().to_vec();
        let image = image::RgbImage::from_raw(self.size[0], self.size[1], bytes).unwrap();
        image.save(folder.join(format!("{name}.png"))).unwrap();
    }
}
