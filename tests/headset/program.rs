//! The program as a process in a headset, without a window.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use glam::{Quat, Vec2, Vec3};
use image::RgbaImage;
use virtual_sculpture::input::hands::Board;
use virtual_sculpture::screen::headset::HeadsetOptions;
use virtual_sculpture::view::RoomPose;

use super::remote::EYES;
use super::runtime::Runtime;
use super::screenshot::Screenshot;

/// Longest wait for anything, even on a slow machine.
pub const PATIENCE: Duration = Duration::from_secs(120);
const PROGRAM: &str = env!("CARGO_BIN_EXE_virtual-sculpture");
/// Light in which stone has the colours that screenshots are searched for.
const LIGHT: &str =
    "[light]\nambient = 0.25\nsky = '#ffffff'\nground = '#ffffff'\nexposure = 0.0\ntone = 'off'\n";

pub struct Program {
    child: Child,
    log: Arc<Mutex<String>>,
    /// Number of frames according to the log.
    shown: Arc<AtomicUsize>,
    folder: tempfile::TempDir,
}

impl Program {
    /// Starts with a solid cube of `dims` voxels. `settings`: further tables of the settings.
    pub fn start(runtime: &Runtime, dims: u32, settings: &str) -> Program {
        let folder = tempfile::tempdir().unwrap();
        let config = folder.path().join("config.toml");
        let text = format!("[new]\ndims = [{dims}, {dims}, {dims}]\n{LIGHT}{settings}");
        std::fs::write(&config, text).unwrap();
        let mut child = runtime
            .command(Path::new(PROGRAM))
            .args(["--headset", "--headset-shots", "shots", "--record", "journal.sculpt"])
            .arg("--config")
            .arg(&config)
            .env("VS_VALIDATION", "if-available")
            .env("RUST_LOG", "virtual_sculpture=trace")
            .env("NO_COLOR", "1")
            .env("HOME", folder.path())
            .env_remove("XDG_CONFIG_HOME")
            .env_remove("XDG_STATE_HOME")
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let log = Arc::new(Mutex::new(String::new()));
        let shown = Arc::new(AtomicUsize::new(0));
        let (stderr, lines, count) = (child.stderr.take().unwrap(), log.clone(), shown.clone());
        std::thread::spawn(move || {
            for line in BufReader::new(stderr).lines().map_while(Result::ok) {
                let mut log = lines.lock().unwrap();
                log.push_str(&line);
                log.push('\n');
                if line.contains("frame shown") {
                    count.fetch_add(1, Ordering::Relaxed);
                }
            }
        });
        Program { child, log, shown, folder }
    }

    pub fn log(&self) -> String {
        self.log.lock().unwrap().clone()
    }

    /// Waits until `find` returns something.
    pub fn wait<T>(&self, what: &str, mut find: impl FnMut() -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            if let Some(found) = find() {
                return found;
            }
            let alive = Path::new(&format!("/proc/{}/exe", self.child.id())).exists();
            let late = start.elapsed() > PATIENCE;
            if late || !alive {
                let log = self.log();
                let tail: Vec<&str> = log.lines().rev().take(40).collect();
                let journal = self.journal();
                panic!("waited in vain for {what} (alive: {alive}): {tail:#?}\n{journal}");
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits until the log contains `what` at least so many times.
    pub fn wait_for_log(&self, what: &str, times: usize) {
        self.wait(what, || (self.log().matches(what).count() >= times).then_some(()));
    }

    /// Waits for so many further frames.
    pub fn frames(&self, count: usize) {
        let shown = || self.shown.load(Ordering::Relaxed);
        let until = shown() + count;
        self.wait("a frame", || (shown() >= until).then_some(()));
    }

    pub fn journal(&self) -> String {
        std::fs::read_to_string(self.folder.path().join("journal.sculpt")).unwrap_or_default()
    }

    /// Waits until so many commands that begin with `text` have been executed.
    pub fn wait_for_command(&self, text: &str, times: usize) {
        let count = || self.journal().lines().filter(|line| line.starts_with(text)).count();
        self.wait(text, || (count() >= times).then_some(()));
    }

    /// The positions of the executed commands that begin with `text`.
    pub fn places_of(&self, text: &str) -> Vec<Vec3> {
        let at = |line: &str| {
            let at = line.split_whitespace().find_map(|word| word.strip_prefix("at="))?;
            let parts: Vec<f32> = at.split(',').filter_map(|part| part.parse().ok()).collect();
            <[f32; 3]>::try_from(parts).ok().map(Vec3::from)
        };
        self.journal().lines().filter(|line| line.starts_with(text)).filter_map(at).collect()
    }

    /// The number of voxels that the journal removes when it is replayed without a headset.
    pub fn removed_voxels(&self) -> u64 {
        let folder = self.folder.path();
        let journal = self.journal();
        let dims = "new dims=64,64,64";
        std::fs::write(folder.join("again.sculpt"), format!("{dims}\n{journal}")).unwrap();
        let run = Command::new(PROGRAM)
            .args(["run", "again.sculpt", "--out", "again.pvm"])
            .current_dir(folder)
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let import = virtual_sculpture::format::options::ImportOptions::default();
        let limits = virtual_sculpture::document::Limits::default();
        let path = folder.join("again.pvm");
        let session =
            virtual_sculpture::session::Session::open(&path, &import, limits, &()).unwrap();
        64 * 64 * 64 - session.document().grid().opaque_count()
    }

    /// A screenshot taken from now on.
    pub fn new_screenshot(&self) -> Screenshot {
        self.wait_for_views();
        self.wait_for_views();
        self.screenshot((super::remote::HEAD, Quat::IDENTITY))
    }

    /// A screenshot with this head pose.
    pub fn screenshot_of_head(&self, position: Vec3, rotation: Quat) -> Screenshot {
        self.wait("a screenshot with the head pose", || {
            let views = self.views()?;
            let eye = views.get("eye")?.as_array()?.first()?.get("position")?.as_array()?;
            let eye: Vec<f32> = eye.iter().filter_map(|x| x.as_float()).map(|x| x as f32).collect();
            let expected = position + rotation * EYES[0];
            Vec3::from_slice(&eye).abs_diff_eq(expected, 1e-3).then_some(())
        });
        // The pictures belong to these views, or to later ones.
        self.wait_for_views();
        self.screenshot((position, rotation))
    }

    fn screenshot(&self, head: (Vec3, Quat)) -> Screenshot {
        let folder = self.folder.path().join("shots");
        self.wait("a screenshot", || Screenshot::read(&folder, head))
    }

    fn views(&self) -> Option<toml::Table> {
        let path = self.folder.path().join("shots").join("views.toml");
        std::fs::read_to_string(path).ok()?.parse().ok()
    }

    /// Waits for the next screenshot.
    fn wait_for_views(&self) {
        let number = || self.views()?.get("number")?.as_integer();
        let before = number();
        self.wait("another screenshot", || number().filter(|now| Some(*now) != before));
    }

    /// The picture of the board, once it exists.
    pub fn board(&self) -> RgbaImage {
        let path: PathBuf = self.folder.path().join("shots").join("board.png");
        self.wait("the board", || Some(image::open(&path).ok()?.into_rgba8()))
    }

    /// The point of the room at a point of the board, in fractions from its upper left corner, with
    /// the board on an upright hand.
    pub fn board_point(&self, share: [f32; 2], hand: Vec3) -> Vec3 {
        let grip = RoomPose { position: hand, rotation: Quat::IDENTITY };
        let board = Board::on_hand(&grip, HeadsetOptions::default().board_size_m());
        let from_middle = Vec2::new(share[0] - 0.5, 0.5 - share[1]) * board.size_m;
        board.pose.at(from_middle.extend(0.0))
    }

    /// Waits for a file in the folder in which the program was started.
    pub fn wait_for_file(&self, name: &str) {
        let path = self.folder.path().join(name);
        self.wait(name, || path.exists().then_some(()));
    }

    /// Memory in use.
    pub fn memory_kib(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse().unwrap()
    }

    /// Open descriptors.
    pub fn descriptors(&self) -> usize {
        std::fs::read_dir(format!("/proc/{}/fd", self.child.id())).unwrap().count()
    }

    /// Ends it and asserts that it logged no panic and no error.
    pub fn stop(mut self) {
        assert!(self.child.try_wait().unwrap().is_none(), "{}", self.log());
        let log = self.log();
        assert!(!log.contains("panicked"), "{log}");
        assert!(!log.contains("ERROR virtual_sculpture"), "{log}");
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
