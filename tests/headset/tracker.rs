//! Head poses for the view through a screen: from a headset that is used only as a tracker, and from one that is worn at
//! the same time.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use glam::{Quat, Vec3};
use tracking::{Event, HeadPose, HostClock, Source, SourceState};
use virtual_sculpture::app::Workspace;
use virtual_sculpture::screen::headset::{HeadsetTracker, RoomOrigin};

use super::program::PATIENCE;
use super::remote::{HEAD, Remote};
use super::runtime::{Runtime, alone_in_network, is_client};
use super::wearer::Wearer;

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
    if !alone_in_network() {
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

#[test]
fn a_runtime_foresees_where_the_head_will_be() {
    if is_client() {
        return look_ahead();
    }
    if alone_in_network() {
        Runtime::simulated().run_client();
    }
}

/// What is foreseen of a head on a curved way is what is found when the time has come.
fn look_ahead() {
    const AHEAD_S: f64 = 0.08;
    let clock = HostClock::starting_now();
    let mut tracker = HeadsetTracker::start("openxr", RoomOrigin::Local, clock).unwrap();
    assert!(tracker.located(0, 0.0).is_none(), "nobody is there yet");
    let mut events = Vec::new();
    let start = Instant::now();
    while tracker.state() != SourceState::Running {
        assert!(start.elapsed() < PATIENCE, "{:?}", tracker.state());
        std::thread::sleep(Duration::from_millis(20));
    }
    let far = |a: &HeadPose, b: &HeadPose| {
        a.placement.position_m.distance(b.placement.position_m) + a.placement.angle_to(b.placement)
    };
    let mut way = 0.0_f64;
    for _ in 0..10 {
        let then = clock.now_s() + AHEAD_S;
        let foreseen = tracker.located(0, then).unwrap();
        assert_eq!(foreseen.time_s, then);
        way = way.max(far(&foreseen, &tracker.located(0, clock.now_s()).unwrap()));
        // It is asked for again when it has just become the past.
        while clock.now_s() < then {
            std::thread::sleep(Duration::from_millis(1));
        }
        let found = tracker.located(0, then).unwrap();
        assert!(far(&foreseen, &found) < 1e-3, "{foreseen:?} {found:?}");
        tracker.poll(clock.now_s(), &mut events);
    }
    assert!(way > 0.01, "the head moves: {way}");
    assert!(events.iter().any(|event| matches!(event, Event::Pose(_))));
}

#[test]
fn the_view_of_the_window_follows_the_head_in_the_headset_that_is_worn() {
    if is_client() {
        return wear();
    }
    if alone_in_network() {
        Runtime::start().run_client();
    }
}

/// The headset in which the program is shown is its tracker, too.
fn wear() {
    let mut wearer = Wearer::new(32);
    let follow = |wearer: &mut Wearer| {
        // The room's origin is the middle of the screen.
        for head in [Vec3::new(0.1, 0.2, 0.7), Vec3::new(-0.3, 0.0, 0.5)] {
            wearer.remote.head = (head, Quat::IDENTITY);
            wearer.remote.send();
            wearer.until("the view of the head", |wearer, _| {
                sees_from(&wearer.workspace, head) && wearer.headset.is_showing()
            });
        }
        assert_eq!(wearer.headset.validation_messages(), 0);
    };
    follow(&mut wearer);
    // Without the headset the head goes to its place of rest.
    let rest = Vec3::from(wearer.config.screen.rest_m.map(|x| x as f32));
    wearer.reconnect();
    let start = Instant::now();
    while !sees_from(&wearer.workspace, rest) {
        assert!(start.elapsed() < PATIENCE, "{:?}", wearer.workspace.viewpoint.tracked_eyes(0.0));
        wearer.workspace.track();
        std::thread::sleep(Duration::from_millis(10));
    }
    // It comes back.
    follow(&mut wearer);
}

/// Whether the window's eye is where `head` is before the screen.
fn sees_from(workspace: &Workspace, head: Vec3) -> bool {
    let Some([eye, _]) = workspace.viewpoint.tracked_eyes(0.0) else { return false };
    eye.position().normalize().abs_diff_eq(head.normalize(), 1e-3)
}
