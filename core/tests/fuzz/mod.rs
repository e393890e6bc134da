//! Damaged bytes for every reader: files that the program writes itself and small ones of other programs, mutated in
//! thousands of ways, the same in every run. No reader may panic, and memory stays bounded.
//!
//! Each target has a number of runs for each of its seeds; `VS_FUZZ_RUNS=N` makes it N, for long manual runs. Inputs
//! that make a reader panic, or run for longer than a minute, are stored in target/test-output/fuzz.

mod formats;
mod journal;
mod saved_history;
mod script;
mod watchdog;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use sculpture_core::sculpture::Limits;

use self::watchdog::Watchdog;

/// The most memory that the process may take while a target is tested, in MiB.
const MOST_MIB: u64 = 300;

/// Returns limits that refuse large claims rather than try them.
pub fn small() -> Limits {
    Limits { grid_bytes: 1 << 20, colour_bytes: 8 << 20, ..Limits::default() }
}

/// A small seeded random generator, so that failures are reproducible.
pub struct Dice(u64);

impl Dice {
    fn of(target: &str, seed: usize, run: u64) -> Dice {
        let name = target.bytes().fold(seed as u64, |sum, b| sum.wrapping_mul(31) + u64::from(b));
        let mut dice = Dice(name.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ run);
        dice.below(2);
        dice
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) % end.max(1) as u64) as usize
    }
}

/// Numbers that readers often mishandle.
const EXTREMES: [u64; 14] = [
    0,
    1,
    2,
    0x7f,
    0xff,
    0x7fff,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7ff8_0000_0000_0000,
    0x7fff_ffff_ffff_ffff,
    u64::MAX,
];

/// Words that are inserted into texts.
const WORDS: [&str; 16] = [
    "0",
    "-1",
    "1e40",
    "-1e-40",
    "nan",
    "inf",
    "4294967295",
    "9223372036854775808",
    "99999999999999999999",
    "\n",
    " ",
    "\"",
    "=",
    ",",
    "\0",
    "é",
];

/// Damages `bytes` in one to five ways; `other`: a source of chunks.
pub fn mutate(bytes: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    for _ in 0..1 + dice.below(5) {
        // Headers are short, and the most sensitive part.
        let reach = if dice.below(2) == 0 { bytes.len().min(96) } else { bytes.len() };
        let at = dice.below(reach);
        let rest = bytes.len() - at;
        match dice.below(11) {
            0 if rest > 0 => bytes[at] ^= 1 << dice.below(8),
            1 if rest > 0 => bytes[at] = dice.below(256) as u8,
            2 => bytes.truncate(at),
            // An integer or a float of any size, in either byte order.
            3..=5 => {
                let width = [1, 2, 4, 8][dice.below(4)];
                let at = if dice.below(4) == 0 { at } else { at & !(width - 1) };
                let value = match dice.below(4) {
                    0 => (bytes.len() as u64).wrapping_add(dice.below(5) as u64).wrapping_sub(2),
                    _ => EXTREMES[dice.below(EXTREMES.len())],
                };
                let (little, big) = (value.to_le_bytes(), value.to_be_bytes());
                let new = if dice.below(3) > 0 { &little[..width] } else { &big[8 - width..] };
                let end = bytes.len().min(at + width);
                bytes[at..end].copy_from_slice(&new[..end - at]);
            }
            // A number in a text.
            6 | 7 => {
                let is_digit = |b: &u8| b.is_ascii_digit();
                let Some(start) = bytes[at..].iter().position(is_digit).map(|i| at + i) else {
                    continue;
                };
                let end = start + bytes[start..].iter().take_while(|b| is_digit(b)).count();
                bytes.splice(start..end, WORDS[dice.below(WORDS.len())].bytes());
            }
            8 => {
                bytes.splice(at..at, WORDS[dice.below(WORDS.len())].bytes());
            }
            9 if rest > 0 => {
                bytes.drain(at..at + 1 + dice.below(rest.min(64)));
            }
            // A chunk of another file, or of this one, inserted or replacing existing bytes.
            _ if !other.is_empty() => {
                let from = dice.below(other.len());
                let chunk = &other[from..from + 1 + dice.below((other.len() - from).min(96))];
                let gone = if dice.below(2) == 0 { 0 } else { chunk.len().min(rest) };
                bytes.splice(at..at + gone, chunk.iter().copied());
            }
            _ => {}
        }
    }
}

/// Tries `read` with damaged forms of all seeds; `read` returns whether they were accepted. `seal` corrects checksums,
/// if there are any: half of the time, so that the code behind them is reached.
pub fn fuzz(
    target: &str,
    runs: u64,
    seeds: &[Vec<u8>],
    seal: impl Fn(&mut Vec<u8>),
    mut read: impl FnMut(usize, &[u8]) -> bool,
) {
    // The memory of the whole process is measured.
    let runs = std::env::var("VS_FUZZ_RUNS").map_or(runs, |runs| runs.parse().unwrap());
    let (mut accepted, mut refused) = (0, 0);
    let watchdog = Watchdog::new(keep);
    for (i, seed) in seeds.iter().enumerate() {
        watchdog.begin(format!("{target}-{i}"), seed);
        assert!(read(i, seed), "{target}: seed {i} is refused as it is");
        for run in 0..runs {
            let mut dice = Dice::of(target, i, run);
            let mut bytes = seed.clone();
            let other = &seeds[dice.below(seeds.len())];
            mutate(&mut bytes, other, &mut dice);
            if dice.below(2) == 0 {
                seal(&mut bytes);
            }
            let name = format!("{target}-{i}-{run}");
            watchdog.begin(name.clone(), &bytes);
            match catch_unwind(AssertUnwindSafe(|| read(i, &bytes))) {
                Ok(true) => accepted += 1,
                Ok(false) => refused += 1,
                Err(_) => {
                    panic!("{target}: run {run} of seed {i}: {}", keep(&name, &bytes))
                }
            }
            if run % 64 == 0
                && let Some(peak) = trials::peak_mib()
            {
                let place = format!("{target}: run {run} of seed {i}");
                assert!(peak < MOST_MIB, "{place}: {peak} MiB: {}", keep(&name, &bytes));
            }
        }
    }
    trials::note!("{target}: {} seeds, {accepted} accepted, {refused} refused", seeds.len());
    // Otherwise the damage is too small to test anything.
    assert!(refused > 0, "{target}: {accepted} accepted, {refused} refused");
}

/// Writes a harmful input to a file of this name, and returns its path.
fn keep(name: &str, bytes: &[u8]) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).with_file_name("test-output/fuzz");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path.display().to_string()
}
