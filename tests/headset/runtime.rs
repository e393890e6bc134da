//! The runtime: unpacked once into the target folder, started and killed in a network namespace of its own.

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::faults::Faults;
use trials::shared_file;

use crate::gpu::fixture::need_device;

use super::program::PATIENCE;

const INSIDE: &str = "VS_HEADSET_TEST_NETWORK";
const LAYER: &str = "XR_APILAYER_TEST_blend";
/// Unpacks the runtime.
const SCRIPT: &str = "openxr/monado-prefix.sh";
const CLIENT: &str = "VS_HEADSET_TEST_CLIENT";
/// The process id of the runtime, for clients.
const SERVICE: &str = "VS_HEADSET_TEST_SERVICE";

/// Whether this process runs with the runtime's libraries and may use it itself
/// ([`Runtime::run_client`]).
pub fn is_client() -> bool {
    std::env::var_os(CLIENT).is_some()
}

/// Suspends the runtime that a client uses, or resumes it.
pub fn stop_service(stopped: bool) {
    set_stopped(&std::env::var(SERVICE).unwrap(), stopped);
}

fn set_stopped(process: &str, stopped: bool) {
    let signal = if stopped { "-STOP" } else { "-CONT" };
    let done = Command::new("kill").args([signal, process]).status().unwrap();
    assert!(done.success(), "kill {signal} {process}: {done}");
}

/// Runs the calling test in a process and a network namespace of its own; true in there, where the test
/// continues. False outside, when it has finished.
pub fn alone_in_network() -> bool {
    if std::env::var_os(INSIDE).is_some() {
        return true;
    }
    // Unpacked before the network is gone.
    prefix();
    need_device();
    let mut command = Command::new("unshare");
    command
        .args(["-rn", "sh", "-c", "ip link set lo up && exec \"$0\" \"$@\""])
        .arg(trials::executable())
        .args(trials::arguments())
        .env(INSIDE, "1");
    trials::conclude(&mut command);
    false
}

fn target() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).parent().unwrap().to_path_buf()
}

/// Where the runtime is unpacked. Skips the test where there is no script that does it.
fn prefix() -> PathBuf {
    let script = shared_file(SCRIPT);
    let prefix = target().join("openxr-runtime");
    // Tests run in parallel: one unpacks, the others wait.
    let lock = std::fs::File::create(target().join("openxr-runtime.lock")).unwrap();
    lock.lock().unwrap();
    let ready = prefix.join("ready");
    if !ready.exists() {
        // Packages are downloaded, which may fail now and then.
        let unpack = || Command::new("bash").arg(&script).arg(&prefix).output().unwrap();
        let mut out = unpack();
        for pause_s in [5, 30] {
            if !out.status.success() {
                std::thread::sleep(Duration::from_secs(pause_s));
                out = unpack();
            }
        }
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "the runtime cannot be unpacked: {stderr}");
        // A second wrapper with the validation layers of this machine, if it has any.
        let plain = std::fs::read_to_string(prefix.join("xr")).unwrap();
        let layers = "VK_LAYER_PATH=/usr/share/vulkan/explicit_layer.d";
        let validated = plain.replace("VK_LAYER_PATH=/nonexistent", layers);
        assert_ne!(plain, validated, "{plain}");
        let path = prefix.join("xr-validated");
        std::fs::write(&path, validated).unwrap();
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).unwrap();
        std::fs::write(ready, "").unwrap();
    }
    prefix
}

/// A runtime with a scripted headset.
pub struct Runtime {
    service: Option<Child>,
    prefix: PathBuf,
    /// Holds its socket.
    folder: tempfile::TempDir,
    driver: Driver,
    /// The blend modes that the layer between programs and runtime reports.
    layered: Option<String>,
    /// How long that layer delays each call of connecting.
    pub slow: Option<Duration>,
    /// Faults of Vulkan in programs ([`Faults::set`]).
    pub faults: Option<String>,
}

/// The driver of the runtime's headset.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Driver {
    /// The test sets the poses.
    Remote,
    /// Moves on a path of its own, which the runtime can predict.
    Simulated,
}

impl Runtime {
    pub fn start() -> Runtime {
        let mut runtime = Runtime::not_started();
        runtime.restart();
        runtime
    }

    pub fn simulated() -> Runtime {
        let mut runtime = Runtime::not_started();
        runtime.driver = Driver::Simulated;
        runtime.restart();
        runtime
    }

    pub fn not_started() -> Runtime {
        let prefix = prefix();
        let folder = tempfile::tempdir().unwrap();
        let private = std::fs::Permissions::from_mode(0o700);
        std::fs::set_permissions(folder.path(), private).unwrap();
        Runtime {
            service: None,
            prefix,
            folder,
            driver: Driver::Remote,
            layered: None,
            slow: None,
            faults: None,
        }
    }

    /// A command that runs with the runtime's libraries and the validation layers.
    pub fn command(&self, program: &Path) -> Command {
        let mut command = self.run_by("xr-validated", program);
        if let Some(modes) = &self.layered {
            command
                .env("XR_API_LAYER_PATH", self.folder.path())
                .env("XR_ENABLE_API_LAYERS", LAYER)
                .env("VS_LAYER_BLEND", modes)
                .env("VS_LAYER_LOG", self.layer_log())
                .env("VS_LAYER_OFF", self.off());
        }
        if let Some(slow) = self.slow {
            command.env("VS_LAYER_SLOW_MS", slow.as_millis().to_string());
        }
        if let Some(faults) = &self.faults {
            Faults::new(self.folder.path(), &mut command).set(faults);
        }
        command
    }

    /// Puts the layer `tests/headset/layer` between the runtime and programs that start from now on.
    /// It reports these blend modes, which the runtime does not have.
    pub fn report_blend_modes(&mut self, modes: &str) {
        let tests = trials::executable();
        let library = tests.with_file_name("libopenxr_blend_layer.so");
        assert!(library.exists(), "{}", library.display());
        let manifest = serde_json::json!({
            "file_format_version": "1.0.0",
            "api_layer": {
                "name": LAYER,
                "library_path": library,
                "api_version": "1.0",
                "implementation_version": "1",
                "description": "Blend modes",
            },
        });
        std::fs::write(self.folder.path().join("layer.json"), manifest.to_string()).unwrap();
        let _ = std::fs::remove_file(self.layer_log());
        self.layered = Some(modes.to_owned());
    }

    fn layer_log(&self) -> PathBuf {
        self.folder.path().join("layer.log")
    }

    fn off(&self) -> PathBuf {
        self.folder.path().join("off")
    }

    /// Takes the headset off or puts it on; needs the layer ([`Runtime::report_blend_modes`]).
    pub fn take_off(&self, off: bool) {
        match off {
            true => std::fs::write(self.off(), "").unwrap(),
            false => std::fs::remove_file(self.off()).unwrap(),
        }
    }

    /// Blend mode and layers of the last frame, as written by the layer.
    pub fn last_frame(&self) -> Option<String> {
        let log = std::fs::read_to_string(self.layer_log()).ok()?;
        log.lines().last().map(str::to_owned)
    }

    fn run_by(&self, wrapper: &str, program: &Path) -> Command {
        let mut command = Command::new(self.prefix.join(wrapper));
        command.arg(program).env("XDG_RUNTIME_DIR_XR", self.folder.path());
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command
    }

    /// Runs the calling test once more with the runtime's libraries, so that it can use the runtime
    /// itself.
    pub fn run_client(&self) {
        let mut command = self.command(&trials::executable());
        command
            .args(trials::arguments())
            .env(CLIENT, "1")
            .env(SERVICE, self.service.as_ref().map_or(String::new(), |s| s.id().to_string()));
        trials::conclude(&mut command);
    }

    pub fn restart(&mut self) {
        let socket = self.folder.path().join("monado_comp_ipc");
        let _ = std::fs::remove_file(&socket);
        let _ = std::fs::remove_file(self.folder.path().join("monado.pid"));
        let mut command = self.run_by("xr", &self.prefix.join("usr/bin/monado-service"));
        match self.driver {
            Driver::Remote => command.env("P_OVERRIDE_ACTIVE_CONFIG", "remote"),
            Driver::Simulated => command.env("SIMULATED_ENABLE", "1"),
        };
        let service = command
            .env("XRT_COMPOSITOR_NULL", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        self.service = Some(service);
        let start = Instant::now();
        while !socket.exists() {
            assert!(start.elapsed() < PATIENCE, "the runtime does not start");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Suspends the process or resumes it: while suspended it exists, but does not answer.
    pub fn set_stopped(&self, stopped: bool) {
        let service = self.service.as_ref().unwrap();
        set_stopped(&service.id().to_string(), stopped);
    }

    /// Kills the process, like a crash.
    pub fn kill(&mut self) {
        if let Some(mut service) = self.service.take() {
            let _ = service.kill();
            let _ = service.wait();
        }
    }
}

impl Drop for Runtime {
    fn drop(&mut self) {
        self.kill();
    }
}
