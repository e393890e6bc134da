//! The program is killed in its window at random moments, while a person works: what had come into the journal by then
//! comes back, and what comes back is a state that the sculpture had.

use std::collections::HashMap;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::Value;
use virtual_sculpture::document::Limits;
use virtual_sculpture::sculpture::Digest;
use virtual_sculpture::session::Session;

use super::display::Display;
use super::process::STATES;
use super::program::{BUTTON, KEY, MOTION, Program, symbol};
use super::{LEFT, display, ready};

/// Returns the states that a program has logged.
pub struct States {
    /// The hash of the sculpture after each entry of the journal, and whether a stroke was open then.
    pub done: Vec<(String, bool)>,
    /// How many of them were in the journal's file.
    pub written: usize,
}

/// Reads them from the output.
pub fn states_of(output: &str) -> States {
    let mut states = States { done: Vec::new(), written: 0 };
    for line in output.lines() {
        let Some((_, text)) = line.split_once(&format!("{STATES}: ")) else { continue };
        match *text.split(' ').collect::<Vec<_>>() {
            ["written", number] => states.written = number.parse().unwrap(),
            ["done", number, digest, ref stroke @ ..] => {
                let place: (usize, String) = (number.parse().unwrap(), digest.to_string());
                assert_eq!(place.0, states.done.len() + 1, "{line}");
                states.done.push((place.1, !stroke.is_empty()));
            }
            _ => panic!("{line}"),
        }
    }
    states
}

fn recover(home: &Path, arguments: &[&str]) -> Vec<u8> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"));
    command.arg("recover").args(arguments).env("HOME", home).current_dir(home);
    command.env_remove("XDG_STATE_HOME").env_remove("XDG_CONFIG_HOME");
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// The hash of what the only journal gives back; none if there is no journal.
pub fn recovered(home: &Path) -> Option<String> {
    let listed = recover(home, &["--json"]);
    let Value::Array(listed) = serde_json::from_slice(&listed).unwrap() else { panic!() };
    let [left] = &listed[..] else {
        assert!(listed.is_empty(), "{listed:?}");
        return None;
    };
    assert_eq!(left["error"], Value::Null);
    recover(home, &[&left["number"].to_string(), "--out", "back.vsc"]);
    let back = Session::open(&home.join("back.vsc"), &Default::default(), Limits::default(), &());
    Some(Digest::of(back.unwrap().document().contents()).to_string())
}

/// Compares what comes back with what the program had logged. Returns how many strokes that had ended are lost, which
/// the kill found on the way to the file.
pub fn expect_back(home: &Path, output: &str) -> usize {
    let states = states_of(output);
    let Some(back) = recovered(home) else {
        assert_eq!(states.written, 0, "there is no journal:\n{output}");
        return 0;
    };
    // Counted from the last that is in the journal for certain; before the first entry it is the beginning.
    let from = states.written.max(1) - 1;
    let at = states.done[from.min(states.done.len())..].iter().position(|(d, _)| *d == back);
    assert!(at.is_some() || states.written == 0, "not a state since the last written:\n{output}");
    let after = states.done.iter().skip(from + at.unwrap_or(0) + 1);
    after.filter(|(_, in_stroke)| !in_stroke).count()
}

/// Numbers from a seed, as xorshift64 makes them.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end
    }

    fn point(&mut self) -> [i16; 2] {
        [350 + self.below(400) as i16, 250 + self.below(250) as i16]
    }
}

/// Works until `end` as fast as a hasty person: strokes, undo, redo, other brushes, never waiting for the program.
fn work(display: &Display, random: &mut Random, end: Instant) {
    let pause = |random: &mut Random| {
        let pause = Duration::from_millis(random.below(25));
        std::thread::sleep(pause.min(end.saturating_duration_since(Instant::now())));
    };
    let key = |name: &str, kind: u8| display.device(kind, display.keycode(symbol(name)), [0, 0]);
    let keys: HashMap<u64, &[&str]> = HashMap::from([
        (0, &["Control_L", "z"][..]),
        (1, &["Control_L", "y"]),
        (2, &["g"]),
        (3, &["Control_L", "z"]),
    ]);
    while Instant::now() < end {
        match keys.get(&random.below(10)) {
            Some(names) => {
                names.iter().for_each(|name| key(name, KEY));
                pause(random);
                names.iter().rev().for_each(|name| key(name, KEY + 1));
            }
            None => {
                display.device(MOTION, 0, random.point());
                pause(random);
                display.device(BUTTON, LEFT, [0, 0]);
                for _ in 0..1 + random.below(6) {
                    display.device(MOTION, 0, random.point());
                    pause(random);
                }
                display.device(BUTTON + 1, LEFT, [0, 0]);
            }
        }
        pause(random);
    }
    // The next program finds nothing pressed.
    ["Control_L", "z", "y", "g"].iter().for_each(|name| key(name, KEY + 1));
    display.device(BUTTON + 1, LEFT, [0, 0]);
}

/// Kills `VS_KILLS` sessions, or a few, each with a window of its own on one display.
#[test]
fn after_a_kill_in_the_window_at_any_moment_all_that_was_written_is_there() {
    let kills: u64 = std::env::var("VS_KILLS").map_or(2, |kills| kills.parse().unwrap());
    let display = display();
    let seed = std::process::id() as u64;
    let (mut with_work, mut in_stroke, mut lost) = (0, 0, 0);
    for kill in 0..kills {
        let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ (seed << 20) ^ (kill + 1));
        let folder = tempfile::tempdir().unwrap();
        let program = Program::start_with_states(&display, folder.path().to_path_buf(), |_| {});
        let program = ready(program);
        // The keyboard is the window's.
        program.key(&["Shift_L"]);
        let end = Instant::now() + Duration::from_millis(random.below(2500));
        work(&display, &mut random, end);
        program.signal("-KILL");
        let (_, output) = program.wait();
        let states = states_of(&output);
        with_work += usize::from(states.written > 0);
        in_stroke += usize::from(states.done.last().is_some_and(|(_, in_stroke)| *in_stroke));
        lost += usize::from(expect_back(folder.path(), &output) > 0);
    }
    println!(
        "{kills} kills: {with_work} had work in the journal, {in_stroke} were in a stroke, {lost} found a stroke that \
         had ended on its way to the file"
    );
}
