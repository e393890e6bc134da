//! The program as a process, with its standard error in a file, so that all output up to a moment can be
//! read at that moment.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Longest wait for anything, even on a slow machine.
pub const PATIENCE: Duration = Duration::from_secs(120);
/// Interval between two checks of a condition.
pub const POLL_INTERVAL: Duration = Duration::from_millis(5);

/// Target of the log of what is in the journal.
pub const STATES: &str = "sculpture_core::states";

/// Lines that windows log while they work: pictures of the main one and of panels, and those that nobody sees.
const WORK: [&str; 3] = ["at work", " shown", "a picture is left out"];

/// The running program; killed on drop.
pub struct Process {
    child: Mutex<Child>,
    folder: PathBuf,
}

impl Process {
    /// Starts the program with these settings, and the validation layers where they are installed.
    /// `set` chooses the display.
    pub fn start(arguments: &[&str], settings: &str, set: impl FnOnce(&mut Command)) -> Process {
        Process::start_in(tempfile::tempdir().unwrap().keep(), arguments, settings, set)
    }

    /// The same with a given home folder, in which it may have been started before.
    pub fn start_in(
        folder: PathBuf,
        arguments: &[&str],
        settings: &str,
        set: impl FnOnce(&mut Command),
    ) -> Process {
        let config = folder.join("config.toml");
        std::fs::write(&config, settings).unwrap();
        let stderr = std::fs::File::create(folder.join("stderr.txt")).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"));
        command
            .arg("--config")
            .arg(&config)
            .args(arguments)
            .env("VS_VALIDATION", "if-available")
            .env("RUST_LOG", "virtual_sculpture=debug")
            .env("NO_COLOR", "1")
            .env("HOME", &folder)
            .env_remove("XDG_CONFIG_HOME")
            .env_remove("XDG_STATE_HOME")
            .env_remove("XDG_CACHE_HOME")
            .current_dir(&folder)
            .stdout(Stdio::null())
            .stderr(stderr);
        set(&mut command);
        let child = command.spawn().unwrap();
        Process { child: Mutex::new(child), folder }
    }

    pub fn is_running(&self) -> bool {
        self.child.lock().unwrap().try_wait().unwrap().is_none()
    }

    /// Ends it as `kill` with this signal does.
    pub fn signal(&self, signal: &str) {
        let id = self.child.lock().unwrap().id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
    }

    /// The folder that the program runs in.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The output of the program so far.
    pub fn output(&self) -> String {
        String::from_utf8_lossy(&std::fs::read(self.folder.join("stderr.txt")).unwrap())
            .into_owned()
    }

    /// The number of lines of the output that contain `what`.
    pub fn count(&self, what: &str) -> usize {
        self.output().lines().filter(|line| line.contains(what)).count()
    }

    /// The number of pictures shown so far, in all windows.
    pub fn pictures(&self) -> usize {
        self.count("picture shown")
    }

    /// Whether the program is idle: it has shown a picture, and its windows rest.
    pub fn is_idle(&self) -> bool {
        let output = self.output();
        rests(&output) && output.contains("picture shown")
    }

    /// Waits until `is_so` holds.
    pub fn until(&self, what: &str, is_so: impl Fn() -> bool) {
        let start = Instant::now();
        loop {
            // Checked first: a condition that holds because the program has ended counts.
            let runs = self.is_running();
            if is_so() {
                return;
            }
            assert!(runs, "{what}: the program has ended:\n{}", self.output());
            assert!(start.elapsed() < PATIENCE, "waited in vain for {what}:\n{}", self.output());
            std::thread::sleep(POLL_INTERVAL);
        }
    }

    /// Waits for the end; returns the exit status and all output.
    pub fn wait(&self) -> (ExitStatus, String) {
        let start = Instant::now();
        loop {
            let status = self.child.lock().unwrap().try_wait().unwrap();
            if let Some(status) = status {
                return (status, self.output());
            }
            assert!(start.elapsed() < PATIENCE, "the program does not end:\n{}", self.output());
            std::thread::sleep(POLL_INTERVAL);
        }
    }

    /// Asserts that neither the program nor the validation layers logged a warning or an error.
    pub fn expect_no_warnings(&self) {
        let output = self.output();
        let warnings: Vec<&str> = output
            .lines()
            .filter(|l| l.contains("virtual_sculpture"))
            .filter(|l| l.contains(" WARN ") || l.contains(" ERROR "))
            .collect();
        assert!(warnings.is_empty(), "{warnings:#?}");
    }

    /// Waits for the end, which must be successful and without warnings.
    pub fn expect_clean_exit(&self) {
        let (status, output) = self.wait();
        assert!(status.success(), "{status}:\n{output}");
        self.expect_no_warnings();
    }
}

/// Whether windows have logged last that they rest. Other threads log when it suits them, on a busy machine after that.
fn rests(output: &str) -> bool {
    let is_rest = |line: &str| line.ends_with("at rest");
    let is_work = |line: &str| WORK.iter().any(|work| line.contains(work));
    let last = output.lines().rev().find(|line| is_rest(line) || is_work(line));
    last.is_some_and(is_rest)
}

#[test]
fn the_log_of_other_threads_hides_no_rest() {
    let begun = "DEBUG a: picture shown number=1\nDEBUG app: at rest\n";
    let pads = "INFO pad: gamepads: none\n";
    for (then, is_so) in [
        ("", true),
        ("DEBUG app: at work\n", false),
        ("DEBUG app: picture shown number=2\n", false),
        ("DEBUG app: Options shown\n", false),
        ("DEBUG app: a picture is left out\n", false),
        ("DEBUG app: at work\nDEBUG app: at rest\n", true),
    ] {
        assert_eq!(rests(&format!("{begun}{then}")), is_so, "{then}");
        assert_eq!(rests(&format!("{begun}{then}{pads}")), is_so, "{then}");
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if let Ok(mut child) = self.child.lock() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}
