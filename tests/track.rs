//! `track` from outside: the program serves poses, and this project's client reads them in both modes; the program shows
//! the poses that it receives.

use std::io::{BufRead, BufReader};
use std::net::UdpSocket;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::DVec3;
use tracking::vrpn::{Client, ClientTiming, DeviceAddress};
use tracking::{Event, HostClock, Source};

const PATIENCE: Duration = Duration::from_secs(60);

/// The program while it runs; it ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn track(folder: &std::path::Path, arguments: &[&str]) -> (Running, BufReader<ChildStdout>) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"))
        .arg("track")
        .args(arguments)
        .env("XDG_CONFIG_HOME", folder)
        .env("RUST_LOG", "warn")
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap());
    (Running(child), lines)
}

fn line(lines: &mut impl BufRead) -> String {
    let mut line = String::new();
    lines.read_line(&mut line).unwrap();
    line.trim_end().to_owned()
}

/// A head that moves to the right by 0.1 m/s, and a held button.
fn script(folder: &std::path::Path) -> String {
    let path = folder.join("head.txt");
    let text = "rate 60\nloop\n0 0 0 0.6 0 0 0 1\n0.1 button 3 down\n\
                4 0.4 0 0.6 0 0 0 1\n8 0 0 0.6 0 0 0 1\n";
    std::fs::write(&path, text).unwrap();
    format!("script:{}", path.display())
}

#[test]
fn the_program_serves_and_clients_of_both_modes_hear_it() {
    let folder = tempfile::tempdir().unwrap();
    let script = script(folder.path());
    let (_running, mut lines) =
        track(folder.path(), &["--serve", "--port", "0", "--source", &script]);
    let first = line(&mut lines);
    let address = first.rsplit(' ').next().unwrap();
    assert!(address.starts_with("127.0.0.1:"), "loopback unless told otherwise: {first}");
    for address in [format!("Tracker0@tcp://{address}"), format!("Tracker0@{address}")] {
        let device: DeviceAddress = address.parse().unwrap();
        let clock = HostClock::starting_now();
        let mut clients = Client::start_all(&[device], ClientTiming::default(), clock).unwrap();
        let (mut poses, mut held, mut events) = (Vec::new(), false, Vec::new());
        let started = Instant::now();
        while poses.len() < 30 || !held {
            assert!(started.elapsed() < PATIENCE, "{address}: {} poses, {held}", poses.len());
            clients[0].poll(clock.now_s(), &mut events);
            for event in events.drain(..) {
                match event {
                    Event::Pose(pose) => poses.push(pose.placement.position_m),
                    Event::Button { button: 3, pressed, .. } => held = pressed,
                    _ => {}
                }
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        for pose in &poses {
            // On the line of the script, but for what its interpolation rounds.
            let off_m = pose.distance(DVec3::new(pose.x, 0.0, 0.6));
            assert!((0.0..=0.4).contains(&pose.x) && off_m < 1e-12, "{pose}");
        }
        assert!(poses.windows(2).any(|pair| pair[0] != pair[1]), "it moves");
    }
}

#[test]
fn the_monitor_tells_poses_rate_and_what_is_dropped() {
    let folder = tempfile::tempdir().unwrap();
    // A port that was free a moment ago.
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let source = format!("opentrack:{port}");
    let (_running, mut lines) = track(folder.path(), &["--from", &source, "--seconds", "60"]);
    assert!(line(&mut lines).starts_with("source "));
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    // Sends until the monitor has been heard, however long that takes.
    let done = Arc::new(AtomicBool::new(false));
    let heard = done.clone();
    let sender = std::thread::spawn(move || {
        let at = DVec3::new(10.0, -5.0, 60.0);
        let pose: Vec<u8> =
            [at.x, at.y, at.z, 20.0, 0.0, 0.0].into_iter().flat_map(f64::to_le_bytes).collect();
        while !heard.load(Ordering::Relaxed) {
            let _ = socket.send_to(&pose, ("127.0.0.1", port));
            let _ = socket.send_to(b"nonsense", ("127.0.0.1", port));
            std::thread::sleep(Duration::from_millis(10));
        }
    });
    let started = Instant::now();
    loop {
        assert!(started.elapsed() < PATIENCE);
        let line = line(&mut lines);
        let told = line.contains("x +0.100 y -0.050 z +0.600 m  yaw +20.0");
        if told && line.contains(" Hz") && !line.contains("dropped 0") {
            break;
        }
    }
    done.store(true, Ordering::Relaxed);
    sender.join().unwrap();
}

#[test]
fn a_script_is_shown_to_its_end_and_faults_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("short.txt");
    std::fs::write(&path, "0 0 0 0.6 0 0 0 1\n0.2 button 1 down\n0.3 lost\n").unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"));
        command.arg("track").args(arguments).env("XDG_CONFIG_HOME", folder.path());
        command.output().unwrap()
    };
    let shown = run(&["--from", &format!("script:{}", path.display())]);
    let text = String::from_utf8(shown.stdout).unwrap();
    assert!(shown.status.success() && text.contains("button 1 down"), "{text}");
    assert!(text.contains("lost 1"), "{text}");
    for (arguments, code, needle) in [
        (&[][..], 2, "--from"),
        (&["--from", "script:/nonexistent/x"], 3, "/nonexistent/x"),
        (&["--from", "Head0"], 2, "Head0"),
    ] {
        let failed = run(arguments);
        let text = String::from_utf8_lossy(&failed.stderr).into_owned();
        assert_eq!(failed.status.code(), Some(code), "{arguments:?}: {text}");
        assert!(text.contains(needle), "{text}");
    }
}
