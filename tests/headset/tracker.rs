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
use virtual_sculpture::app::headset::Headset;
use virtual_sculpture::config::Config;
use virtual_sculpture::input::Bindings;
use virtual_sculpture::screen::headset::{HeadsetTracker, RoomOrigin};
use virtual_sculpture::session::Session;

use super::program::PATIENCE;
use super::remote::{HEAD, Remote};
use super::runtime::{Runtime, alone_in_network, is_client, stop_service};

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

/// The program without its window, in a headset which is its tracker, too.
fn wear() {
    let mut remote = Remote::connect();
    let mut config = Config::default();
    config.new.dims = [32; 3];
    config.headset.enabled = true;
    config.tracking.source = "openxr".parse().unwrap();
    let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let mut bench = Workspace::new(session, &config, Bindings::presets().unwrap());
    bench.start_head();
    let follow = |bench: &mut Workspace, remote: &mut Remote| {
        let (tell, heard) = channel();
        let tell = move |connection, news| tell.send((connection, news)).is_ok();
        let mut headset = Headset::new(&config.headset, config.device_options(None), None, tell);
        // The room's origin is the middle of the screen.
        for head in [Vec3::new(0.1, 0.2, 0.7), Vec3::new(-0.3, 0.0, 0.5)] {
            remote.head = (head, Quat::IDENTITY);
            remote.send();
            let start = Instant::now();
            while !sees_from(bench, head) || !headset.is_showing() {
                assert!(start.elapsed() < PATIENCE, "{:?}", bench.viewpoint.tracked_eyes(0.0));
                headset.poll(bench);
                if let Ok((connection, news)) = heard.recv_timeout(Duration::from_millis(20)) {
                    headset.hear(bench, connection, news);
                }
                bench.track();
            }
        }
        assert_eq!(headset.complaints(), 0);
    };
    follow(&mut bench, &mut remote);
    // Without the headset the head goes to its place of rest.
    let rest = Vec3::from(config.screen.rest_m.map(|x| x as f32));
    let start = Instant::now();
    while !sees_from(&bench, rest) {
        assert!(start.elapsed() < PATIENCE, "{:?}", bench.viewpoint.tracked_eyes(0.0));
        bench.track();
        std::thread::sleep(Duration::from_millis(10));
    }
    // It comes back.
    follow(&mut bench, &mut remote);
}

#[test]
fn a_runtime_that_stops_holds_up_no_window() {
    if is_client() {
        return go_on_without();
    }
    if alone_in_network() {
        Runtime::start().run_client();
    }
}

/// The program without its window: each turn of its loop is short, whenever the runtime stops.
fn go_on_without() {
    /// Longer than is waited for within a frame for pictures and for the tracker, and what a busy
    /// machine adds.
    const TURN: Duration = Duration::from_millis(700);
    let mut remote = Remote::connect();
    remote.send();
    let mut config = Config::default();
    config.new.dims = [32; 3];
    config.headset.enabled = true;
    config.tracking.source = "openxr".parse().unwrap();
    let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let mut bench = Workspace::new(session, &config, Bindings::presets().unwrap());
    bench.start_head();
    let (tell, heard) = channel();
    let tell = move |connection, news| tell.send((connection, news)).is_ok();
    let mut headset = Headset::new(&config.headset, config.device_options(None), None, tell);
    // Turns of the main loop until something is so; gives how long the longest took.
    let mut turns = |done: &dyn Fn(&Headset, Duration) -> bool| {
        let (start, mut longest) = (Instant::now(), Duration::ZERO);
        while !done(&headset, start.elapsed()) {
            assert!(start.elapsed() < PATIENCE);
            let news = heard.recv_timeout(Duration::from_millis(5));
            let turn = Instant::now();
            headset.poll(&mut bench);
            if let Ok((connection, news)) = news {
                headset.hear(&mut bench, connection, news);
            }
            bench.track();
            let _ = bench.viewpoint.tracked_eyes(0.0);
            longest = longest.max(turn.elapsed());
        }
        longest
    };
    turns(&|headset, _| headset.is_showing());
    for round in 0..4 {
        stop_service(true);
        let longest = [
            turns(&|headset, _| !headset.is_showing()),
            turns(&|_, after| after > Duration::from_millis(500)),
        ];
        stop_service(false);
        assert!(longest.iter().all(|turn| *turn < TURN), "{longest:?} in round {round}");
        turns(&|headset, _| headset.is_showing());
    }
    assert_eq!(headset.complaints(), 0);
}

/// Whether the window's eye is where `head` is before the screen.
fn sees_from(bench: &Workspace, head: Vec3) -> bool {
    let Some([eye, _]) = bench.viewpoint.tracked_eyes(0.0) else { return false };
    eye.position().normalize().abs_diff_eq(head.normalize(), 1e-3)
}
