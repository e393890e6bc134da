use std::io::{Error, ErrorKind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use glam::{UVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::command::{Command, NewSculpture};
use crate::document::{CommandError, Document};
use crate::format::history::write_step;
use crate::sculpture::history::{HistorySnapshot, StepChange};
use crate::sculpture::{ColourDepth, Limits, Rgb};

/// A file in memory whose n-th operation can fail, and which can damage written data.
#[derive(Clone, Debug, Default)]
struct Faulty {
    /// Number of the first operation that fails; 0 for none.
    first: u32,
    /// Number of operations that fail from then on.
    count: u32,
    /// Whether a failing write writes half.
    half: bool,
    /// Position of the byte that is changed when it is written; all ones for none.
    damaged: u64,
    done: Arc<AtomicU32>,
    longest: Arc<AtomicU64>,
}

#[derive(Debug)]
struct FaultyFile {
    faults: Faulty,
    bytes: Vec<u8>,
}

impl Faulty {
    fn none() -> Faulty {
        Faulty { damaged: u64::MAX, ..Faulty::default() }
    }

    fn step(&self) -> Result<()> {
        let number = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        match self.first > 0 && (self.first..self.first + self.count).contains(&number) {
            true => Err(Error::from(ErrorKind::StorageFull)),
            false => Ok(()),
        }
    }
}

impl SpillPlace for Faulty {
    fn create(&self) -> Result<Box<dyn SpillFile>> {
        self.step()?;
        Ok(Box::new(FaultyFile { faults: self.clone(), bytes: Vec::new() }))
    }
}

impl SpillFile for FaultyFile {
    fn write_at(&mut self, at: u64, bytes: &[u8]) -> Result<()> {
        let fault = self.faults.step();
        let count = match (&fault, self.faults.half) {
            (Err(_), true) => bytes.len() / 2,
            (Err(_), false) => 0,
            (Ok(()), _) => bytes.len(),
        };
        let end = at as usize + count;
        self.bytes.resize(self.bytes.len().max(end), 0);
        self.bytes[at as usize..end].copy_from_slice(&bytes[..count]);
        if let Some(damaged) = self.bytes.get_mut(self.faults.damaged as usize) {
            *damaged ^= 0x10;
        }
        self.faults.longest.fetch_max(self.bytes.len() as u64, Ordering::Relaxed);
        fault
    }

    fn read_at(&mut self, at: u64, bytes: &mut [u8]) -> Result<()> {
        self.faults.step()?;
        bytes.copy_from_slice(&self.bytes[at as usize..at as usize + bytes.len()]);
        Ok(())
    }

    fn cut(&mut self, bytes: u64) -> Result<()> {
        self.faults.step()?;
        self.bytes.truncate(bytes as usize);
        Ok(())
    }
}

fn document(history_bytes: usize) -> Document {
    let new = NewSculpture {
        dims: UVec3::new(37, 24, 26),
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb::STONE,
        solid: true,
        room_vx: 0,
        grows: false,
    };
    Document::new(&new, Limits { history_bytes, ..Limits::default() }).unwrap()
}

fn spilled(history_bytes: usize, disk_bytes: u64, faults: &Faulty) -> (Document, Arc<Spill>) {
    let mut document = document(history_bytes);
    let place = Box::new(faults.clone());
    let spill = Arc::new(Spill::with_place(place, disk_bytes, history_bytes / 4, 700).unwrap());
    document.use_step_store(spill.clone());
    (document, spill)
}

/// Returns a command of a script, at a position.
fn command(kind: u8, at: [i32; 3]) -> Command {
    let [x, y, z] = at;
    let line = match kind {
        0..=2 => format!("subtract ellipsoid at={x},{y},{z} half=9"),
        3..=5 => format!("recolour cuboid at={x},{y},{z} half=8 colour=#{:02x}4080", x * 5),
        6 => format!("add cuboid at={x},{y},{z} half=7"),
        7 => "orient axes=y,-x,z".to_string(),
        8 => format!("new dims={},19,17 colour=16", 9 + x),
        9..=12 => format!("undo {}", 1 + x % 5),
        _ => format!("redo {}", 1 + y % 7),
    };
    line.parse().unwrap()
}

fn script(length: usize) -> impl Strategy<Value = Vec<(u8, [i32; 3])>> {
    prop::collection::vec((0u8..15, [0i32..37, 0..24, 0..26]), 1..length)
}

/// Returns all steps with their values in memory.
fn whole(document: &Document) -> HistorySnapshot {
    let mut walk = document.history().snapshot();
    let shape = crate::format::history::ContentsShape::of(document.contents());
    for steps in [&mut walk.undo, &mut walk.redo] {
        let packed: Vec<Vec<u8>> =
            steps.iter().rev().map(|step| write_step(step).unwrap()).collect();
        let none: &[Vec<u8>] = &[];
        let limits = Limits::default();
        let read = crate::format::history::read_steps([&packed, none], shape, &limits);
        *steps = read.unwrap().undo;
    }
    walk
}

fn stored(document: &Document) -> usize {
    let is_stored = |step: &&Step| matches!(step.change, StepChange::Stored(_));
    let history = document.history();
    history.undo_steps().chain(history.redo_steps()).filter(is_stored).count()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// With hardly any memory and a disk, a document equals one with everything in memory, to the byte, whether or not
    /// the disk is faster than the commands.
    #[test]
    fn history_on_disk_equals_one_in_memory(
        lines in script(40),
        history_bytes in 16_000usize..60_000,
        waits in any::<bool>(),
    ) {
        let mut plain = document(1 << 30);
        let (mut spilled, spill) = spilled(history_bytes, 1 << 30, &Faulty::none());
        for (kind, at) in lines {
            let command = command(kind, at);
            let (one, other) = (plain.apply(&command), spilled.apply(&command));
            prop_assert_eq!(format!("{one:?}"), format!("{other:?}"));
            prop_assert_eq!(plain.contents(), spilled.contents());
            prop_assert!(spilled.history().bytes() <= history_bytes);
            if waits { spill.wait() }
        }
        prop_assert_eq!(whole(&plain), whole(&spilled));
        for line in ["undo", "redo", "undo"] {
            plain.apply(&line.parse().unwrap()).unwrap();
            spilled.apply(&line.parse().unwrap()).unwrap();
            prop_assert_eq!(plain.contents(), spilled.contents());
            prop_assert_eq!(plain.state(), spilled.state());
        }
        prop_assert_eq!(spilled.history().dropped(), 0);
        prop_assert_eq!(spill.take_message(), None);
    }

    /// Each state that is reached is a previous one, and no loss goes unreported, whatever file operations fail: one,
    /// or all from then on.
    #[test]
    fn faults_never_lead_to_wrong_bytes(
        lines in script(30),
        first in 1u32..40,
        count in prop_oneof![Just(1u32), Just(3), Just(u32::MAX / 2)],
        half in any::<bool>(),
        damaged in prop_oneof![Just(u64::MAX), 0u64..20_000],
        disk_bytes in prop_oneof![Just(1u64 << 30), 0u64..12_000],
    ) {
        let faults = Faulty { first, count, half, damaged, ..Faulty::none() };
        let (mut document, spill) = spilled(16_000, disk_bytes, &faults);
        let mut known = std::collections::HashMap::from([(document.state(), document.contents().clone())]);
        let (mut unread, mut refused) = (false, false);
        for (kind, at) in lines {
            let before = (document.state(), document.contents().clone());
            match document.apply(&command(kind, at)) {
                Ok(_) => {
                    let now = known.entry(document.state()).or_insert_with(|| document.contents().clone());
                    prop_assert_eq!(&*now, document.contents());
                }
                Err(error) => {
                    unread |= matches!(error, CommandError::NotReadBack { .. });
                    refused |= matches!(error, CommandError::Irreversible { .. });
                    prop_assert_eq!(before, (document.state(), document.contents().clone()));
                }
            }
            spill.wait();
            prop_assert!(faults.longest.load(Ordering::Relaxed) <= disk_bytes);
        }
        // All remaining steps lead to previous states.
        while document.apply(&"undo 1".parse().unwrap()).is_ok_and(|applied| applied.steps == 1) {
            prop_assert_eq!(&known[&document.state()], document.contents());
        }
        if disk_bytes == 1 << 30 && faults.done.load(Ordering::Relaxed) < first && damaged == u64::MAX {
            prop_assert!(!unread && !refused && document.history().dropped() == 0);
        }
    }
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("vs-spill-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn the_file_is_its_owners_alone_and_goes_with_the_session() {
    let folder = folder("owner");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("1.history"), "what a killed session left").unwrap();
    std::fs::write(folder.join("1.journal"), "not ours").unwrap();
    let make = || Arc::new(Spill::new(&folder, 1 << 30, 1 << 10).unwrap());
    let mut documents = [document(20_000), document(20_000)];
    let spills = [make(), make()];
    for (document, spill) in documents.iter_mut().zip(&spills) {
        document.use_step_store(spill.clone());
        for seed in 1..5 {
            let line = format!("noise colour=#ff0000 size=3 amount=1 seed={seed}");
            document.apply(&line.parse().unwrap()).unwrap();
        }
        spill.wait();
        assert!(stored(document) > 0);
    }
    let third = make();
    let found = files(&folder);
    assert_eq!(
        found.len(),
        3,
        "one for each session with steps on disk, and the journal: {found:?}"
    );
    #[cfg(unix)]
    for path in found.iter().filter(|path| path.extension().unwrap() == "history") {
        let mode = std::os::unix::fs::PermissionsExt::mode(&path.metadata().unwrap().permissions());
        assert_eq!(mode & 0o777, 0o600);
    }
    drop((documents, spills, third));
    assert_eq!(files(&folder), [folder.join("1.journal")]);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_whole_sculpture_painted_twelve_times_comes_back_with_little_memory() {
    let folder = folder("twelve");
    let mut document = document(1 << 20);
    let new = "new dims=96,96,96 colour=24 fill=solid".parse().unwrap();
    document.apply(&new).unwrap();
    let spill = Arc::new(Spill::new(&folder, 1 << 30, 1 << 18).unwrap());
    document.use_step_store(spill.clone());
    let first = document.contents().clone();
    let mut painted = Vec::new();
    for pass in 0..12 {
        // Many colours a brick: a step of 2.7 MiB, more than the whole memory for the history.
        let line = format!("noise colour=#{:02x}8040 size=3 amount=1 seed={pass}", pass * 17);
        document.apply(&line.parse().unwrap()).unwrap();
        assert!(document.history().bytes() <= 1 << 20);
        painted.push(crate::sculpture::Digest::of(document.contents()));
    }
    for expected in painted.iter().rev() {
        assert_eq!(crate::sculpture::Digest::of(document.contents()), *expected);
        document.apply(&"undo 1".parse().unwrap()).unwrap();
    }
    assert_eq!(*document.contents(), first);
    document.apply(&"redo 12".parse().unwrap()).unwrap();
    assert_eq!(crate::sculpture::Digest::of(document.contents()), painted[11]);
    assert_eq!((document.history().dropped(), spill.take_message()), (0, None));
    drop((document, spill));
    assert_eq!(files(&folder), Vec::<PathBuf>::new());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_disk_that_fails_is_told_and_used_again_later() {
    let faults = Faulty { first: 3, count: 4, ..Faulty::none() };
    let (mut document, spill) = spilled(16_000, 1 << 30, &faults);
    let mut messages = Vec::new();
    for x in 0..30 {
        let line = format!("recolour cuboid at={x},9,9 half=9 colour=#ff{x:02}00");
        let _ = document.apply(&line.parse().unwrap());
        spill.wait();
        messages.extend(spill.take_message());
    }
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(messages[0].contains("cannot be written"), "{messages:?}");
    assert!(messages[1].contains("to the disk again"), "{messages:?}");
    assert!(stored(&document) > 0);
}
