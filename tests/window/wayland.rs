//! The program in a Wayland compositor without a screen: Weston, whose kiosk shell shows no window
//! while there is no seat, and whose desktop shell shows all of them.
//!
//! Needs `weston` (Debian, Ubuntu: weston). Without it the tests are skipped, or fail
//! with `VS_REQUIRE_WAYLAND=1`.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use crate::gpu::fixture::need_device;

use super::process::{LOOK, PATIENCE, Process};
use crate::faults::Faults;

const SOCKET: &str = "virtual-sculpture-test";

/// A running compositor; killed on drop.
struct Weston {
    server: Child,
    folder: tempfile::TempDir,
}

impl Weston {
    /// Starts one with a shell. Skips the test where it is not installed.
    fn start(shell: &str) -> Weston {
        need_device();
        let folder = tempfile::tempdir().unwrap();
        let settings = folder.path().join("weston.ini");
        std::fs::write(&settings, "[core]\nidle-time=0\n[shell]\npanel-position=none\n").unwrap();
        let server = Command::new("weston")
            .args(["--backend=headless-backend.so", "--use-pixman", "--width=1280", "--height=800"])
            .args([&format!("--shell={shell}"), &format!("--socket={SOCKET}")])
            .arg(format!("--config={}", settings.display()))
            .env("XDG_RUNTIME_DIR", folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| {
                let lack = format!("Weston cannot be started ({error}); install weston");
                trials::lacks("VS_REQUIRE_WAYLAND", &lack)
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
            std::thread::sleep(LOOK);
        }
    }

    /// The program in it, with a film that asks for a new picture all the time.
    fn program(&self) -> Process {
        self.program_with(|_| {})
    }

    /// The same with more to be set.
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
fn a_window_that_is_never_shown_does_not_stop_the_program() {
    let weston = Weston::start("kiosk-shell.so");
    let program = weston.program();
    // Presenting by turns would wait for ever with the first or second picture.
    let left_out = || program.count("a picture is left out");
    program.until("the program goes on", || left_out() >= 5);
    let pictures = program.pictures();
    program.until("the program goes on", || left_out() >= 10);
    assert!(program.pictures() <= pictures + 1, "nobody sees them");
    program.expect_no_complaint();
}

/// Where surfaces have no mailbox, presenting waits for the picture before to be seen, which none is.
#[test]
fn a_window_that_is_never_shown_does_not_stop_presenting_by_turns() {
    let weston = Weston::start("kiosk-shell.so");
    let program = weston.program_with(|command| {
        Faults::new(weston.folder.path(), command).set("fifo 0");
    });
    program.until("the program goes on", || program.count("a picture is left out") >= 10);
    assert!(program.count("pixels, FIFO") > 0, "{}", program.said());
    program.expect_no_complaint();
}

#[test]
fn a_window_that_is_shown_is_drawn_as_often_as_the_screen_shows_it_and_not_more() {
    let weston = Weston::start("desktop-shell.so");
    let program = weston.program();
    program.until("pictures come", || program.pictures() >= 20);
    let (pictures, start) = (program.pictures(), Instant::now());
    program.until("pictures go on", || program.pictures() >= pictures + 60);
    // Weston's screen without a screen shows 60 a second.
    let rate = (program.pictures() - pictures) as f32 / start.elapsed().as_secs_f32();
    assert!(rate < 75.0, "{rate} pictures a second");
    program.expect_no_complaint();
}
