//! The scripted source: plays poses and buttons from a text, for tests, demonstrations and machines without a
//! tracker. Takes text and the time as a value, gives events. Has no thread.
//!
//! One entry per line, times in seconds from the start, in ascending order; `#` begins a comment:
//! ```text
//! rate 60                      # optional: interpolate and report at this rate, Hz; else as written
//! loop                         # optional: restart at the last entry (first and last coincide)
//! sensor 0                     # optional: of the poses that follow
//! 0.0  0 0 0.6  0 0 0 1        # time, position in metres, quaternion x y z w
//! 2.0  0.2 0 0.6  0 0 0 1  0.5 # with a confidence from 0 to 1
//! 3.0  button 0 down           # or up
//! 4.0  lost                    # no reports (nor interpolation) until the next pose
//! ```

use std::sync::Arc;

use glam::{DQuat, DVec3};
use thiserror::Error;

use crate::event::Event;
use crate::pose::{HeadPose, Placement};
use crate::source::{Counters, Source, SourceState};
use crate::vrpn::messages::{MAX_BUTTONS, MAX_SENSORS};

/// Most entries of a script.
pub const MAX_ENTRIES: usize = 1_000_000;
/// Most poses of one poll: after a pause the older ones are skipped.
const MAX_AT_ONCE: usize = 1024;

/// The error in a script, and its line (counted from 1).
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("line {line}: {what}")]
pub struct ScriptError {
    pub line: usize,
    pub what: &'static str,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum ScriptEntry {
    Pose { sensor: u32, placement: Placement, confidence: f64 },
    Button { button: u32, pressed: bool },
    Lost,
}

/// A parsed and checked script.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Script {
    entries: Vec<(f64, ScriptEntry)>,
    rate_hz: Option<f64>,
    pub looped: bool,
}

impl Script {
    pub fn parse(text: &str) -> Result<Self, ScriptError> {
        let mut script = Self::default();
        let mut sensor = 0;
        for (index, line) in text.lines().enumerate() {
            let error = |what| ScriptError { line: index + 1, what };
            let words: Vec<&str> =
                line.split('#').next().unwrap_or_default().split_whitespace().take(16).collect();
            match words[..] {
                [] => {}
                ["loop"] => script.looped = true,
                ["rate", rate] => {
                    let rate_hz = number(rate).filter(|rate| (0.1..=10_000.0).contains(rate));
                    script.rate_hz = Some(rate_hz.ok_or(error("a rate is 0.1 to 10000 Hz"))?);
                }
                ["sensor", id] => {
                    let id = id.parse().ok().filter(|id| *id < MAX_SENSORS);
                    sensor = id.ok_or(error("a sensor is a number from 0 to 65535"))?;
                }
                [time, ref rest @ ..] => {
                    let time_s = number(time)
                        .filter(|time| (0.0..=1.0e6).contains(time))
                        .ok_or(error("a time is a number from 0 to 1000000"))?;
                    if script.entries.last().is_some_and(|(last_s, _)| time_s < *last_s) {
                        return Err(error("times must not decrease"));
                    }
                    if script.entries.len() >= MAX_ENTRIES {
                        return Err(error("the script is too long"));
                    }
                    script.entries.push((time_s, entry(rest, sensor).map_err(error)?));
                }
            }
        }
        if script.entries.is_empty() {
            return Err(ScriptError { line: 1, what: "the script has no pose, button or loss" });
        }
        if script.looped && script.length_s() <= 0.0 {
            return Err(ScriptError { line: 1, what: "a loop needs two different times" });
        }
        Ok(script)
    }

    /// Returns the time from the start to the last entry, in seconds.
    pub fn length_s(&self) -> f64 {
        self.entries.last().map_or(0.0, |(time_s, _)| *time_s)
    }

    /// Returns the placement of a sensor at a time from the start, interpolated; `None` before its first pose and while
    /// it is lost. After the last pose it stays.
    pub fn at(&self, sensor: u32, time_s: f64) -> Option<(Placement, f64)> {
        let next = self.entries.partition_point(|(entry_s, _)| *entry_s <= time_s);
        let mine = |(entry_s, entry): &(f64, ScriptEntry)| match *entry {
            ScriptEntry::Pose { sensor: s, placement, confidence } if s == sensor => {
                Some(Some((*entry_s, placement, confidence)))
            }
            ScriptEntry::Lost => Some(None),
            _ => None,
        };
        let (from_s, from, confidence) = self.entries[..next].iter().rev().find_map(mine)??;
        match self.entries[next..].iter().find_map(mine).flatten() {
            Some((to_s, to, to_confidence)) if to_s > from_s => {
                let share = (time_s - from_s) / (to_s - from_s);
                Some((from.blend(to, share), confidence + (to_confidence - confidence) * share))
            }
            _ => Some((from, confidence)),
        }
    }
}

fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

fn entry(words: &[&str], sensor: u32) -> Result<ScriptEntry, &'static str> {
    match *words {
        ["lost"] => Ok(ScriptEntry::Lost),
        ["button", button, state] => {
            let button = button.parse().ok().filter(|button| *button < MAX_BUTTONS as u32);
            let pressed = match state {
                "down" => true,
                "up" => false,
                _ => return Err("a button goes \"down\" or \"up\""),
            };
            Ok(ScriptEntry::Button {
                button: button.ok_or("a button is a number from 0 to 255")?,
                pressed,
            })
        }
        _ if words.len() == 7 || words.len() == 8 => {
            let mut n = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
            for (place, word) in n.iter_mut().zip(words) {
                *place = number(word).ok_or("a pose is numbers")?;
            }
            let placement = Placement::checked(
                DVec3::new(n[0], n[1], n[2]),
                DQuat::from_xyzw(n[3], n[4], n[5], n[6]),
            );
            let placement = placement.ok_or("a position or quaternion that is not valid")?;
            if !(0.0..=1.0).contains(&n[7]) {
                return Err("a confidence is 0 to 1");
            }
            Ok(ScriptEntry::Pose { sensor, placement, confidence: n[7] })
        }
        _ => Err("expected a pose of 7 or 8 numbers, \"button\" or \"lost\""),
    }
}

/// Plays a script; it starts at the first poll.
pub struct Scripted {
    label: Arc<str>,
    script: Script,
    sensors: Vec<u32>,
    start_s: Option<f64>,
    /// Played up to this time, from the start of the script's first round.
    played_s: f64,
    held: [bool; MAX_BUTTONS],
    accepted: u64,
    unread: u64,
}

impl Scripted {
    /// Creates it. `label` becomes [`HeadPose::source`] of the poses.
    pub fn new(label: &str, script: Script) -> Self {
        let mut sensors: Vec<u32> = script
            .entries
            .iter()
            .filter_map(|(_, entry)| match entry {
                ScriptEntry::Pose { sensor, .. } => Some(*sensor),
                _ => None,
            })
            .collect();
        sensors.sort_unstable();
        sensors.dedup();
        Self {
            label: label.into(),
            script,
            sensors,
            start_s: None,
            played_s: f64::NEG_INFINITY,
            held: [false; MAX_BUTTONS],
            accepted: 0,
            unread: 0,
        }
    }

    /// Plays one round of the script, after `from_s` up to `to_s`, both in script time; `zero_s` is its start on
    /// the host's clock.
    fn play(&mut self, zero_s: f64, from_s: f64, to_s: f64, events: &mut Vec<Event>) {
        let first = self.script.entries.partition_point(|(time_s, _)| *time_s <= from_s);
        let last = self.script.entries.partition_point(|(time_s, _)| *time_s <= to_s);
        for index in first..last {
            let (time_s, entry) = self.script.entries[index];
            let (source, host_s) = (self.label.clone(), zero_s + time_s);
            match entry {
                ScriptEntry::Pose { sensor, placement, confidence }
                    if self.script.rate_hz.is_none() =>
                {
                    events.push(self.pose(host_s, sensor, placement, confidence));
                }
                ScriptEntry::Button { button, pressed }
                    if self.held[button as usize] != pressed =>
                {
                    self.held[button as usize] = pressed;
                    events.push(Event::Button { source, button, pressed, time_s: host_s });
                }
                ScriptEntry::Lost => events.push(Event::Lost { source, time_s: host_s }),
                ScriptEntry::Pose { .. } | ScriptEntry::Button { .. } => {}
            }
        }
        let Some(rate_hz) = self.script.rate_hz else { return };
        // Ticks in (from, to]; the first one of a round is at its start.
        let end_s = to_s.min(self.script.length_s());
        let mut tick = (from_s.max(0.0) * rate_hz).floor();
        tick = tick.max((end_s * rate_hz).floor() - MAX_AT_ONCE as f64);
        while tick / rate_hz <= from_s {
            tick += 1.0;
        }
        while tick / rate_hz <= end_s {
            for index in 0..self.sensors.len() {
                let sensor = self.sensors[index];
                if let Some((placement, confidence)) = self.script.at(sensor, tick / rate_hz) {
                    let host_s = zero_s + tick / rate_hz;
                    events.push(self.pose(host_s, sensor, placement, confidence));
                }
            }
            tick += 1.0;
        }
    }

    fn pose(&self, time_s: f64, sensor: u32, placement: Placement, confidence: f64) -> Event {
        Event::Pose(HeadPose {
            placement,
            time_s,
            sender_time: None,
            source: self.label.clone(),
            sensor,
            confidence,
            velocity: None,
        })
    }
}

impl Source for Scripted {
    fn name(&self) -> &str {
        &self.label
    }

    fn poll(&mut self, now_s: f64, events: &mut Vec<Event>) {
        let start_s = *self.start_s.get_or_insert(now_s);
        let (from_s, to_s) = (self.played_s, now_s - start_s);
        if to_s <= from_s {
            return;
        }
        self.played_s = to_s;
        let mut played = Vec::new();
        let length_s = self.script.length_s();
        if self.script.looped {
            let round = (to_s / length_s).floor();
            let zero_s = round * length_s;
            // After a long pause only the round before the current one is completed.
            if from_s < zero_s {
                let from_s = (from_s - (zero_s - length_s)).max(-1.0);
                if round > 0.0 {
                    self.play(start_s + zero_s - length_s, from_s, length_s, &mut played);
                }
                self.play(start_s + zero_s, -1.0, to_s - zero_s, &mut played);
            } else {
                self.play(start_s + zero_s, from_s - zero_s, to_s - zero_s, &mut played);
            }
        } else {
            self.play(start_s, from_s.max(-1.0), to_s, &mut played);
        }
        played.sort_by(|a, b| time_of(a).total_cmp(&time_of(b)));
        let is_pose = |event: &Event| matches!(event, Event::Pose(_));
        let mut surplus =
            played.iter().filter(|event| is_pose(event)).count().saturating_sub(MAX_AT_ONCE);
        self.unread += surplus as u64;
        for event in played {
            if surplus > 0 && is_pose(&event) {
                surplus -= 1;
            } else {
                self.accepted += 1;
                events.push(event);
            }
        }
    }

    fn state(&self) -> SourceState {
        let is_over = !self.script.looped && self.played_s >= self.script.length_s();
        if is_over {
            SourceState::Ended("the script is over".to_owned())
        } else {
            SourceState::Running
        }
    }

    fn counters(&self) -> Counters {
        Counters { accepted: self.accepted, unread: self.unread, ..Default::default() }
    }
}

/// Returns the time of an event of a script.
fn time_of(event: &Event) -> f64 {
    match event {
        Event::Pose(pose) => pose.time_s,
        Event::Button { time_s, .. } | Event::Lost { time_s, .. } => *time_s,
        _ => 0.0,
    }
}

#[cfg(test)]
#[path = "scripted_tests.rs"]
mod tests;
