//! The program as a process, with what it says in a file: so all that it has said by a moment can be
//! read at that moment.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Longer than anything takes, on a slow machine too.
pub const PATIENCE: Duration = Duration::from_secs(120);
/// Between two looks.
pub const LOOK: Duration = Duration::from_millis(5);

/// The running program; killed on drop.
pub struct Process {
    child: Mutex<Child>,
    folder: PathBuf,
}

impl Process {
    /// Starts the program with settings of its own, and the validation layers where they are
    /// installed. `set` says on which display.
    pub fn start(arguments: &[&str], settings: &str, set: impl FnOnce(&mut Command)) -> Process {
        Process::start_in(tempfile::tempdir().unwrap().keep(), arguments, settings, set)
    }

    /// The same at home in a folder, where it may have been started before.
    pub fn start_in(
        folder: PathBuf,
        arguments: &[&str],
        settings: &str,
        set: impl FnOnce(&mut Command),
    ) -> Process {
        let config = folder.join("config.toml");
        std::fs::write(&config, settings).unwrap();
        let said = std::fs::File::create(folder.join("said.txt")).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"));
        set(&mut command);
        let child = command
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
            .stderr(said)
            .spawn()
            .unwrap();
        Process { child: Mutex::new(child), folder }
    }

    pub fn is_running(&self) -> bool {
        self.child.lock().unwrap().try_wait().unwrap().is_none()
    }

    /// The folder that the program runs in.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// All that the program has said so far.
    pub fn said(&self) -> String {
        String::from_utf8_lossy(&std::fs::read(self.folder.join("said.txt")).unwrap()).into_owned()
    }

    /// How often it has said something.
    pub fn count(&self, what: &str) -> usize {
        self.said().lines().filter(|line| line.contains(what)).count()
    }

    /// Pictures that the window has shown so far.
    pub fn pictures(&self) -> usize {
        self.count("picture shown")
    }

    /// Whether the last that it has said is that it waits, with a picture in its window.
    pub fn rests(&self) -> bool {
        let said = self.said();
        said.ends_with("at rest\n") && said.contains("picture shown")
    }

    /// Waits until something is so.
    pub fn until(&self, what: &str, is_so: impl Fn() -> bool) {
        let start = Instant::now();
        loop {
            // Asked first: what is so because the program has ended counts.
            let runs = self.is_running();
            if is_so() {
                return;
            }
            assert!(runs, "{what}: the program has ended:\n{}", self.said());
            assert!(start.elapsed() < PATIENCE, "{what}: in vain:\n{}", self.said());
            std::thread::sleep(LOOK);
        }
    }

    /// Waits for the end; gives how it ended and all that was said.
    pub fn wait(&self) -> (ExitStatus, String) {
        let start = Instant::now();
        loop {
            let status = self.child.lock().unwrap().try_wait().unwrap();
            if let Some(status) = status {
                return (status, self.said());
            }
            assert!(start.elapsed() < PATIENCE, "no end:\n{}", self.said());
            std::thread::sleep(LOOK);
        }
    }

    /// Neither the program nor the validation layers have complained.
    pub fn expect_no_complaint(&self) {
        let said = self.said();
        let complaints: Vec<&str> = said
            .lines()
            .filter(|l| l.contains("virtual_sculpture"))
            .filter(|l| l.contains(" WARN ") || l.contains(" ERROR "))
            .collect();
        assert!(complaints.is_empty(), "{complaints:#?}");
    }

    /// Waits for the end, which must be without complaint, of the validation layers too.
    pub fn expect_clean_exit(&self) {
        let (status, said) = self.wait();
        assert!(status.success(), "{status}:\n{said}");
        self.expect_no_complaint();
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
