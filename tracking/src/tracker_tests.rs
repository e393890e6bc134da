//! Properties of the tracker: predicted placements never jump, whatever the sources do.

use super::*;
use crate::pose::Velocity;
use crate::source::{Counters, SourceState};
use glam::{DQuat, DVec3};
use std::sync::{Arc, Mutex};

/// A source that passes on the test's events.
struct Fed {
    queue: Arc<Mutex<Vec<Event>>>,
    foreseen: Option<Placement>,
}

impl Source for Fed {
    fn name(&self) -> &str {
        "fed"
    }
    fn poll(&mut self, _now_s: f64, events: &mut Vec<Event>) {
        events.append(&mut self.queue.lock().unwrap());
    }
    fn state(&self) -> SourceState {
        SourceState::Running
    }
    fn counters(&self) -> Counters {
        Counters::default()
    }
    fn located(&mut self, sensor: u32, display_time_s: f64) -> Option<HeadPose> {
        let placement = self.foreseen?;
        Some(HeadPose { placement, ..pose("A", sensor, DVec3::ZERO, display_time_s) })
    }
}

fn pose(source: &str, sensor: u32, position_m: DVec3, time_s: f64) -> HeadPose {
    HeadPose {
        placement: Placement { position_m, orientation: DQuat::from_rotation_y(position_m.x) },
        time_s,
        sender_time: None,
        source: source.into(),
        sensor,
        confidence: 1.0,
        velocity: None,
    }
}

fn rest() -> Placement {
    Placement { position_m: DVec3::new(0.0, 0.0, 0.6), orientation: DQuat::IDENTITY }
}

type Queue = Arc<Mutex<Vec<Event>>>;

fn tracker(channels: &[&str]) -> (Tracker, Queue) {
    let queue: Queue = Arc::default();
    let mut tracker = Tracker::new(BodyOptions {
        rest: rest(),
        fade: FadeOptions::default(),
        channels: channels.iter().map(|name| ChannelOptions::new(name, 0)).collect(),
    });
    tracker.add_source(Box::new(Fed { queue: queue.clone(), foreseen: None }));
    (tracker, queue)
}

/// Runs frames at 90 Hz with a prediction of 20 ms; `feed` gives the poses for each time. Returns all placements
/// shown, after checking that no frame moves faster than `limit_m_s` and as many rad/s.
fn run(
    tracker: &mut Tracker,
    queue: &Queue,
    seconds: f64,
    limit_m_s: f64,
    feed: impl Fn(f64) -> Vec<Event>,
) -> Vec<(f64, Predicted)> {
    let dt = 1.0 / 90.0;
    let mut shown: Vec<(f64, Predicted)> = Vec::new();
    for i in 0..(seconds / dt) as u32 {
        let t = f64::from(i) * dt;
        queue.lock().unwrap().extend(feed(t));
        tracker.update(t, &mut Vec::new());
        let now = tracker.predicted(t + 0.02);
        assert_eq!(now, tracker.predicted(t + 0.02), "asking twice gives the same");
        if let Some((_, last)) = shown.last() {
            let step = last.placement.position_m.distance(now.placement.position_m);
            assert!(step <= limit_m_s * dt, "step of {step} m at {t} s");
            let turn = last.placement.angle_to(now.placement);
            assert!(turn <= limit_m_s * dt, "turn of {turn} rad at {t} s");
        }
        shown.push((t, now));
    }
    shown
}

fn swinging(t: f64) -> DVec3 {
    DVec3::new(0.3 * (2.0 * t).sin(), 0.1, 0.5)
}

#[test]
fn loss_and_recovery_fade() {
    let (mut tracker, queue) = tracker(&["A"]);
    // Live from 1 s to 3 s and from 3.9 s on: it is found again in the middle of the fade to rest.
    let live = |t: f64| (1.0..3.0).contains(&t) || t >= 3.9;
    // The fade to rest covers less than 0.4 m in 0.5 s at slope 1.5, and the swing itself reaches 0.6 m/s.
    let shown = run(&mut tracker, &queue, 8.0, 1.9, |t| {
        if live(t) { vec![Event::Pose(pose("A", 0, swinging(t), t))] } else { Vec::new() }
    });
    let at = |t: f64| shown.iter().find(|(time, _)| *time >= t).unwrap().1;
    assert_eq!(at(0.5).presence, Presence::Absent);
    assert_eq!(at(0.5).placement, rest());
    assert_eq!(at(1.1).presence, Presence::Returning);
    assert_eq!(at(2.5).presence, Presence::Tracked);
    assert!(at(2.5).placement.position_m.distance(swinging(2.52)) < 0.02);
    assert_eq!(at(3.5).presence, Presence::Leaving);
    assert!(at(3.5).placement.position_m.distance(rest().position_m) > 0.05, "held at first");
    assert_eq!(at(7.0).presence, Presence::Tracked);
    assert!((at(7.0).confidence - 1.0).abs() < 1e-9);
}

#[test]
fn goes_to_rest_when_lost_for_good() {
    let (mut tracker, queue) = tracker(&["A"]);
    let shown = run(&mut tracker, &queue, 5.0, 1.9, |t| {
        if t < 1.0 { vec![Event::Pose(pose("A", 0, swinging(t), t))] } else { Vec::new() }
    });
    let last = shown.last().unwrap().1;
    assert_eq!((last.presence, last.placement, last.confidence), (Presence::Absent, rest(), 0.0));
    assert!(tracker.latest().is_none());
}

#[test]
fn a_reported_loss_counts_at_once() {
    let (mut tracker, queue) = tracker(&["A"]);
    queue.lock().unwrap().push(Event::Pose(pose("A", 0, DVec3::X, 0.0)));
    let mut events = Vec::new();
    tracker.update(0.0, &mut events);
    assert!(tracker.latest().is_some() && events.is_empty());
    queue.lock().unwrap().push(Event::Lost { source: "A".into(), time_s: 0.01 });
    tracker.update(0.01, &mut events);
    assert!(tracker.latest().is_none());
    assert_eq!(events.len(), 1, "losses are told on");
}

#[test]
fn a_second_tracker_stands_in() {
    let (mut tracker, queue) = tracker(&["A", "B"]);
    let other = |t: f64| swinging(t) + DVec3::new(0.0, 0.2, 0.0);
    let shown = run(&mut tracker, &queue, 6.0, 1.9, |t| {
        let mut events = vec![Event::Pose(pose("B", 0, other(t), t))];
        if (1.5..3.0).contains(&t) {
            events.push(Event::Pose(pose("A", 0, swinging(t), t)));
        }
        events
    });
    let y = |t: f64| shown.iter().find(|(time, _)| *time >= t).unwrap().1.placement.position_m.y;
    assert!(
        (y(1.2) - 0.3).abs() < 0.01 && (y(2.8) - 0.1).abs() < 0.01 && (y(5.0) - 0.3).abs() < 0.01
    );
}

#[test]
fn wild_poses_of_other_sensors_and_low_confidence_are_left_alone() {
    let (mut tracker, queue) = tracker(&["A"]);
    let good = DVec3::new(0.1, 0.0, 0.5);
    for i in 0..100 {
        let t = f64::from(i) * 0.01;
        let mut bad = pose("A", 0, DVec3::splat(9.0), t);
        bad.confidence = 0.0;
        queue.lock().unwrap().extend([
            Event::Pose(pose("A", 0, good, t)),
            Event::Pose(bad),
            Event::Pose(pose("A", 1, DVec3::splat(5.0), t)),
            Event::Pose(pose("B", 0, DVec3::splat(5.0), t)),
            Event::Pose(pose("A", 0, DVec3::splat(7.0), t - 0.5)),
        ]);
        tracker.update(t, &mut Vec::new());
    }
    assert!(tracker.predicted(1.0).placement.position_m.distance(good) < 1e-9);
}

#[test]
fn a_reported_velocity_is_used_for_prediction() {
    let (mut tracker, queue) = tracker(&["A"]);
    for i in 0..100 {
        let t = f64::from(i) * 0.01;
        let velocity = Velocity { linear_m_s: DVec3::X, angular_rad_s: DVec3::ZERO };
        queue.lock().unwrap().extend([
            Event::Pose(pose("A", 0, DVec3::ZERO, t)),
            Event::Velocity { source: "A".into(), sensor: 0, velocity, time_s: t },
        ]);
        tracker.update(t, &mut Vec::new());
    }
    let x = tracker.predicted(0.99 + 0.05).placement.position_m.x;
    assert!((x - 0.05).abs() < 1e-9, "{x}");
}

#[test]
fn a_source_that_foresees_is_believed() {
    let foreseen = Placement { position_m: DVec3::Y, orientation: DQuat::from_rotation_x(0.5) };
    let queue: Queue = Arc::default();
    let mut tracker = Tracker::new(BodyOptions {
        rest: rest(),
        fade: FadeOptions { return_s: 0.0, ..Default::default() },
        channels: vec![ChannelOptions::new("A", 0)],
    });
    tracker.add_source(Box::new(Fed { queue: queue.clone(), foreseen: Some(foreseen) }));
    queue.lock().unwrap().push(Event::Pose(pose("A", 0, DVec3::X, 0.0)));
    tracker.update(0.0, &mut Vec::new());
    assert_eq!(tracker.predicted(0.02).placement, foreseen);
    assert_eq!(tracker.latest().unwrap().placement.position_m, DVec3::X);
}

#[test]
fn a_new_calibration_fades_in() {
    let (mut tracker, queue) = tracker(&["A"]);
    let there = DVec3::new(0.1, 0.0, 0.5);
    let mut last = None::<DVec3>;
    for i in 0..400 {
        let t = f64::from(i) * 0.01;
        queue.lock().unwrap().push(Event::Pose(pose("A", 0, there, t)));
        tracker.update(t, &mut Vec::new());
        if i == 200 {
            let moved = Calibration::from_values(DVec3::Y * 0.3, [0.0; 3], 1.0).unwrap();
            assert!(tracker.set_calibration(BodyId::HEAD, 0, moved, t));
            assert!(!tracker.set_calibration(BodyId::HEAD, 1, moved, t));
        }
        let now = tracker.predicted(t + 0.01).placement.position_m;
        if let Some(last) = last {
            assert!(last.distance(now) < 0.01 * 1.6 * 0.6);
        }
        last = Some(now);
    }
    assert!(last.unwrap().distance(there + DVec3::Y * 0.3) < 1e-6);
    assert_eq!(tracker.raw_of(BodyId::HEAD).flatten().count(), 1);
}
