//! The program in a headless Wayland compositor: Weston, whose kiosk shell shows no window without a
//! seat, and whose desktop shell shows all of them.
//!
//! Needs `weston` (Debian, Ubuntu: weston). Without it the tests are skipped, or fail
//! with `VS_REQUIRE_WINDOW=1`.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use crate::gpu::fixture::need_device;

use super::display::output_folder;
use super::process::{PATIENCE, POLL_INTERVAL, Process};
use crate::faults::Faults;

const SOCKET: &str = "virtual-sculpture-test";
const LOG: &str = "weston.log";

/// A running compositor; killed on drop. Its log is left in target/test-output/window if a test fails.
struct Weston {
    server: Child,
    folder: tempfile::TempDir,
}

impl Weston {
    /// Starts Weston with a shell. Skips the test where it is not installed.
    fn start(shell: &str) -> Weston {
        need_device();
        let folder = tempfile::tempdir().unwrap();
        let settings = folder.path().join("weston.ini");
        std::fs::write(&settings, "[core]\nidle-time=0\n[shell]\npanel-position=none\n").unwrap();
        let server = Command::new("weston")
            // Without a renderer: that of Pixman in Weston 10 draws from memory that has moved, once a window's frame has grown
            // the pool that it is drawn in, and the compositor crashes.
            .args(["--backend=headless-backend.so", "--width=1280", "--height=800"])
            .args([&format!("--shell={shell}"), &format!("--socket={SOCKET}")])
            .arg(format!("--config={}", settings.display()))
            .arg(format!("--log={}", folder.path().join(LOG).display()))
            .env("XDG_RUNTIME_DIR", folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| {
                let lack = format!("Weston cannot be started ({error}); install weston");
                trials::lacks("VS_REQUIRE_WINDOW", &lack)
            });
        let mut weston = Weston { server, folder };
        weston.listen();
        weston
    }

    /// Waits until programs can connect.
    fn listen(&mut self) {
        let start = Instant::now();
        while !self.folder.path().join(SOCKET).exists() {
            if let Some(status) = self.server.try_wait().unwrap() {
                panic!("Weston ends with {status}");
            }
            assert!(start.elapsed() < PATIENCE, "Weston does not listen");
            std::thread::sleep(POLL_INTERVAL);
        }
    }

    /// The program in it, with a video that needs new pictures all the time.
    fn program(&self) -> Process {
        self.program_with(|_| {})
    }

    /// The same with changes to the command.
    fn program_with(&self, set: impl FnOnce(&mut Command)) -> Process {
        let film = self.folder.path().join("film");
        std::fs::create_dir_all(&film).unwrap();
        film_of_greys(&film);
        let settings = format!(
            "[new]\ndims = [64, 64, 64]\n[window]\nguide = false\n[video]\non = true\n\
             source = \"{}?fps=25\"\n",
            film.display()
        );
        Process::start(&[], &settings, |command| {
            command
                .env_remove("DISPLAY")
                .env("WAYLAND_DISPLAY", SOCKET)
                .env("XDG_RUNTIME_DIR", self.folder.path());
            set(command);
        })
    }
}

impl Drop for Weston {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let log = std::fs::read_to_string(self.folder.path().join(LOG)).unwrap_or_default();
            let end = format!("{log}\nended before the test: {:?}\n", self.server.try_wait());
            let _ = std::fs::write(output_folder().join(LOG), end);
        }
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn film_of_greys(folder: &Path) {
    for i in 0..8_u8 {
        let picture = image::RgbImage::from_pixel(64, 48, image::Rgb([30 * i; 3]));
        picture.save(folder.join(format!("{i}.png"))).unwrap();
    }
}

#[test]
fn a_window_that_is_never_shown_does_not_block_the_program() {
    let weston = Weston::start("kiosk-shell.so");
    let program = weston.program();
    // FIFO would wait forever with the first or second picture.
    let skipped = || program.count("a picture is left out");
    program.until("the program goes on", || skipped() >= 5);
    let pictures = program.pictures();
    program.until("the program goes on", || skipped() >= 10);
    assert!(program.pictures() <= pictures + 1, "the window is not visible");
    program.expect_no_warnings();
}

/// Without the mailbox mode, presenting waits until the previous picture was visible, which none is.
#[test]
fn a_window_that_is_never_shown_does_not_block_fifo() {
    let weston = Weston::start("kiosk-shell.so");
    let program = weston.program_with(|command| {
        Faults::new(weston.folder.path(), command).set("fifo 0");
    });
    program.until("the program goes on", || program.count("a picture is left out") >= 10);
    assert!(program.count("pixels, FIFO") > 0, "{}", program.output());
    program.expect_no_warnings();
}

#[test]
fn a_visible_window_is_drawn_at_the_refresh_rate_and_no_faster() {
    let weston = Weston::start("desktop-shell.so");
    let program = weston.program();
    program.until("pictures are shown", || program.pictures() >= 20);
    let (pictures, start) = (program.pictures(), Instant::now());
    program.until("more pictures are shown", || program.pictures() >= pictures + 60);
    // Weston's headless output runs at 60 Hz.
    let rate = (program.pictures() - pictures) as f32 / start.elapsed().as_secs_f32();
    assert!(rate < 75.0, "{rate} pictures a second");
    program.expect_no_warnings();
}
