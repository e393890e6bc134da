//! Head poses for the off-axis view through a screen: from a headset that is only tracked, and from the one that
//! shows the program.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use glam::{Quat, Vec3};
use tracking::{Event, HeadPose, HostClock, Source, SourceState};
use virtual_sculpture::app::Workspace;
use virtual_sculpture::screen::headset::{HeadsetTracker, RoomOrigin};

use super::main_loop::MainLoop;
use super::program::PATIENCE;
use super::remote::{HEAD, Remote};
use super::runtime::{Runtime, alone_in_network, is_client};

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
        let (send, lines) = channel();
        std::thread::spawn(move || {
            for line in BufReader::new(stdout).lines().map_while(Result::ok) {
                let _ = send.send(line);
            }
        });
        Track { child, lines }
    }

    /// Waits for a line that contains this.
    fn wait_for_line(&self, what: &str) -> String {
        let (start, mut lines) = (Instant::now(), Vec::new());
        while start.elapsed() < PATIENCE {
            let Ok(line) = self.lines.recv_timeout(PATIENCE) else { break };
            if line.contains(what) {
                return line;
            }
            lines.push(line);
        }
        panic!("no line contains {what:?}: {lines:#?}");
    }
}

impl Drop for Track {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_tracked_headset_may_connect_late_and_disconnect() {
    if !alone_in_network() {
        return;
    }
    let mut runtime = Runtime::not_started();
    let track = Track::start(runtime.command(Path::new(env!("CARGO_BIN_EXE_virtual-sculpture"))));
    track.wait_for_line("start SteamVR, Monado");
    runtime.restart();
    let mut remote = Remote::connect();
    for (position, rotation, expected) in [
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
        let line = track.wait_for_line(expected);
        assert!(line.contains("confidence 1.00"), "{line}");
    }
    runtime.kill();
    let line = track.wait_for_line("lost 1");
    track.wait_for_line("start SteamVR, Monado");
    assert!(!line.contains("dropped 1"), "{line}");
    runtime.restart();
    let mut remote = Remote::connect();
    remote.send();
    track.wait_for_line("x +0.000 y +1.600 z +0.000 m");
}

#[test]
fn a_runtime_predicts_the_head_pose() {
    if is_client() {
        return predict();
    }
    if alone_in_network() {
        Runtime::simulated().run_client();
    }
}

/// The predicted pose of a head on a curved path equals the pose located once the time has come.
fn predict() {
    const AHEAD_S: f64 = 0.08;
    let clock = HostClock::starting_now();
    let mut tracker = HeadsetTracker::start("openxr", RoomOrigin::Local, clock).unwrap();
    assert!(tracker.located(0, 0.0).is_none(), "there is no session yet");
    let mut events = Vec::new();
    let start = Instant::now();
    while tracker.state() != SourceState::Running {
        assert!(start.elapsed() < PATIENCE, "{:?}", tracker.state());
        std::thread::sleep(Duration::from_millis(20));
    }
    let far = |a: &HeadPose, b: &HeadPose| {
        a.placement.position_m.distance(b.placement.position_m) + a.placement.angle_to(b.placement)
    };
    let mut moved = 0.0_f64;
    let mut queries = 0;
    // At the turning points of its path the head hardly moves.
    while queries < 10 || moved <= 0.01 {
        queries += 1;
        assert!(start.elapsed() < PATIENCE, "the head moves: {moved}");
        let then = clock.now_s() + AHEAD_S;
        let predicted = tracker.located(0, then).unwrap();
        assert_eq!(predicted.time_s, then);
        moved = moved.max(far(&predicted, &tracker.located(0, clock.now_s()).unwrap()));
        // Queried again when the time has just passed.
        while clock.now_s() < then {
            std::thread::sleep(Duration::from_millis(1));
        }
        let found = tracker.located(0, then).unwrap();
        assert!(far(&predicted, &found) < 1e-3, "{predicted:?} {found:?}");
        tracker.poll(clock.now_s(), &mut events);
    }
    assert!(events.iter().any(|event| matches!(event, Event::Pose(_))));
}

#[test]
fn the_view_of_the_window_follows_the_head_in_the_headset_in_use() {
    if is_client() {
        return follow_session();
    }
    if alone_in_network() {
        Runtime::start().run_client();
    }
}

/// The headset that shows the program is also its tracker.
fn follow_session() {
    let mut main = MainLoop::new(32);
    let follow = |main: &mut MainLoop| {
        // The room's origin is the centre of the screen.
        for head in [Vec3::new(0.1, 0.2, 0.7), Vec3::new(-0.3, 0.0, 0.5)] {
            main.remote.head = (head, Quat::IDENTITY);
            main.remote.send();
            main.until("the view of the head", |main, _| {
                sees_from(&main.workspace, head) && main.headset.is_showing()
            });
        }
        assert_eq!(main.headset.validation_messages(), 0);
    };
    follow(&mut main);
    // Without the headset the head moves to its rest position.
    let rest = Vec3::from(main.config.screen.rest_m.map(|x| x as f32));
    main.reconnect();
    let start = Instant::now();
    while !sees_from(&main.workspace, rest) {
        assert!(start.elapsed() < PATIENCE, "{:?}", main.workspace.viewpoint.tracked_eyes(0.0));
        main.workspace.track();
        std::thread::sleep(Duration::from_millis(10));
    }
    // The session is back.
    follow(&mut main);
}

/// Whether the window's eye is where `head` is before the screen.
fn sees_from(workspace: &Workspace, head: Vec3) -> bool {
    let Some([eye, _]) = workspace.viewpoint.tracked_eyes(0.0) else { return false };
    eye.position().normalize().abs_diff_eq(head.normalize(), 1e-3)
}
