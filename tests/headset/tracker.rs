//! A headset that is used only as a tracker: `track --from openxr`.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use glam::{Quat, Vec3};

use crate::remote::{HEAD, Remote};
use crate::runtime::{Runtime, alone_in_network};

const PATIENCE: Duration = Duration::from_secs(60);

struct Track {
    child: Child,
    lines: Receiver<String>,
}

impl Track {
    fn start(mut command: Command) -> Track {
        let mut child = command
            .args(["track", "--from", "openxr"])
            .env("RUST_LOG", "warn")
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let stdout = child.stdout.take().unwrap();
        let (tell, lines) = channel();
        std::thread::spawn(move || {
            for line in BufReader::new(stdout).lines().map_while(Result::ok) {
                let _ = tell.send(line);
            }
        });
        Track { child, lines }
    }

    /// Waits for a line that says this.
    fn says(&self, what: &str) -> String {
        let (start, mut said) = (Instant::now(), Vec::new());
        while start.elapsed() < PATIENCE {
            let Ok(line) = self.lines.recv_timeout(PATIENCE) else { break };
            if line.contains(what) {
                return line;
            }
            said.push(line);
        }
        panic!("{what:?} is not said: {said:#?}");
    }
}

impl Drop for Track {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_headset_is_a_tracker_that_may_come_late_and_go() {
    if !alone_in_network("tracker::a_headset_is_a_tracker_that_may_come_late_and_go") {
        return;
    }
    let mut runtime = Runtime::not_started();
    let track = Track::start(runtime.command(Path::new(env!("CARGO_BIN_EXE_virtual-sculpture"))));
    track.says("start SteamVR, Monado");
    runtime.restart();
    let mut remote = Remote::connect();
    for (position, rotation, said) in [
        (HEAD, Quat::IDENTITY, "x +0.000 y +1.600 z +0.000 m  yaw +0.0 pitch"),
        (
            HEAD + Vec3::new(0.25, -0.125, 0.5),
            Quat::from_rotation_y(20f32.to_radians()),
            "x +0.250 y +1.475 z +0.500 m  yaw +20.0 pitch",
        ),
        (
            HEAD + Vec3::new(-0.5, 0.0, 0.125),
            Quat::from_rotation_x(-10f32.to_radians()),
            "x -0.500 y +1.600 z +0.125 m  yaw",
        ),
    ] {
        remote.head = (position, rotation);
        remote.send();
        let line = track.says(said);
        assert!(line.contains("confidence 1.00"), "{line}");
    }
    runtime.kill();
    let line = track.says("lost 1");
    track.says("start SteamVR, Monado");
    assert!(!line.contains("dropped 1"), "{line}");
    runtime.restart();
    let mut remote = Remote::connect();
    remote.send();
    track.says("x +0.000 y +1.600 z +0.000 m");
}
