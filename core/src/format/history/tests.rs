use std::sync::Arc;

use glam::{UVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::command::{Command, NewSculpture};
use crate::document::Document;
use crate::sculpture::Rgb;
use crate::sculpture::brick_set::BrickSet;
use crate::sculpture::history::History;

fn document(dims: UVec3, depth: ColourDepth) -> Document {
    let new = NewSculpture {
        dims,
        voxel_size: Vec3::ONE,
        colour_depth: depth,
        base: Rgb::STONE,
        solid: true,
        room_vx: 0,
        grows: false,
    };
    Document::new(&new, Limits::default()).unwrap()
}

/// Returns a line for each kind of step, at a position.
fn line(kind: u8, at: [i32; 3]) -> String {
    let [x, y, z] = at;
    match kind {
        0 | 1 => format!("subtract ellipsoid at={x},{y},{z} half=4"),
        2 => format!("recolour cuboid at={x},{y},{z} half=3 colour=#{:02x}4080", x * 5),
        3 => format!("add cuboid at={x},{y},{z} half=2"),
        4 => "clear".to_string(),
        5 => "fill".to_string(),
        6 => "orient axes=y,-x,z".to_string(),
        7 => format!("new dims={},9,17 colour=16", 1 + x),
        8 => "undo".to_string(),
        10 => format!("canvas grow by={} sides=-x,y,-z", 1 + x),
        11 => format!("canvas size dims={},20,30", 1 + x),
        12 => "canvas crop".to_string(),
        13 => "canvas auto on".to_string(),
        14 => format!("add cuboid at={},{y},{} half=2", x - 30, z + 20),
        _ => "redo".to_string(),
    }
}

fn packed(steps: &[Arc<Step>]) -> Vec<Vec<u8>> {
    steps.iter().rev().map(|step| write_step(step).unwrap()).collect()
}

/// Executes the lines, packs the steps and reads them back.
fn read_back_exactly(lines: &[(u8, [i32; 3])], depth: ColourDepth) {
    let mut document = document(UVec3::new(21, 24, 11), depth);
    for (kind, at) in lines {
        // Painting fails without colours.
        let _ = document.apply(&line(*kind, *at).parse().unwrap());
    }
    let before = document.history().snapshot();
    let (undo, redo) = (packed(&before.undo), packed(&before.redo));
    let shape = ContentsShape::of(document.contents());
    let after = read_steps([&undo, &redo], shape, &Limits::default()).unwrap();
    assert_eq!(&before, &after);
    let restored = History::restored(after, document.history().budget_bytes(), None);
    assert_eq!(restored.bytes(), document.history().bytes());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    /// The steps are read back equal, in place, with the same memory size, whatever was done.
    #[test]
    fn a_history_is_read_back_exactly(
        lines in prop::collection::vec((0u8..15, [0i32..24, 0..24, 0..24]), 1..24),
        depth in prop::sample::select(&ColourDepth::ALL[..]),
    ) {
        read_back_exactly(&lines, depth);
    }

    /// No damage yields a step that breaks a sculpture.
    #[test]
    fn damaged_steps_are_refused_or_fit(
        kind in prop_oneof![0u8..8, 10u8..15], at in [0i32..20, 0..20, 0..20],
        place in any::<prop::sample::Index>(), value in any::<u8>(), cut in any::<bool>(),
    ) {
        let mut document = document(UVec3::new(21, 24, 11), ColourDepth::Bits24);
        if kind == 14 {
            document.apply(&"canvas auto on".parse().unwrap()).unwrap();
        }
        document.apply(&line(kind, at).parse().unwrap()).unwrap();
        let Some(step) = document.history().undo_steps().next() else { return Ok(()) };
        let mut bytes = write_step(step).unwrap();
        let place = place.index(bytes.len());
        if cut { bytes.truncate(place) } else { bytes[place] = value }
        let shape = ContentsShape::of(document.contents());
        if let Ok(step) = read_step(&bytes, shape, &Limits::default()) {
            let mut contents = document.contents().clone();
            if let StepChange::Bricks(record) = step.change {
                let bricks = contents.grid.brick_count();
                record.swap(&mut contents, &mut BrickSet::default());
                let counts = (0..bricks).map(|i| u64::from(contents.grid.brick_at(i).count()));
                prop_assert_eq!(counts.sum::<u64>(), contents.grid.opaque_count());
            }
        }
    }
}

#[test]
fn long_records_pass_through_many_blocks() {
    let mut document = document(UVec3::new(200, 160, 120), ColourDepth::Bits24);
    let texture: Vec<Rgb> = (0..64 * 64).map(|i| Rgb([i as u8, (i >> 4) as u8, 7])).collect();
    let picture = crate::tools::texture::Texture::new(64, texture).unwrap();
    document.learn_picture("noise".as_ref(), picture);
    let line = "texture \"noise\" ellipsoid at=100,80,60 half=90,70,55";
    document.apply(&line.parse::<Command>().unwrap()).unwrap();
    document.apply(&Command::Undo { steps: None }).unwrap();
    document.apply(&"clear".parse().unwrap()).unwrap();
    document.apply(&Command::Undo { steps: None }).unwrap();
    document.apply(&"subtract ellipsoid at=99,80,60 half=35,30,25".parse().unwrap()).unwrap();
    document.apply(&line.parse::<Command>().unwrap()).unwrap();
    document.apply(&Command::Undo { steps: None }).unwrap();
    let before = document.history().snapshot();
    let (undo, redo) = (packed(&before.undo), packed(&before.redo));
    assert!(redo.iter().any(|step| step.len() > 1 << 20), "several blocks");
    let shape = ContentsShape::of(document.contents());
    let after = read_steps([&undo, &redo], shape, &Limits::default()).unwrap();
    assert_eq!(before, after);
}

/// Whole cubes of one colour, of many, and of none.
#[test]
fn colours_of_whole_cubes_are_read_back() {
    let mut document = document(UVec3::new(136, 128, 72), ColourDepth::Bits16);
    for line in [
        "recolour cuboid at=64,64,0 half=64,64,64 colour=#204080",
        "undo",
        "redo",
        "dye colour=#ff8000",
        "noise colour=#204060 size=8 amount=1",
        "recolour ellipsoid at=30,40,30 half=20 colour=#102030",
        "recolour cuboid at=64,64,0 half=64,64,64 colour=#ff00ff",
        "clear",
        "add cuboid at=64,64,0 half=64,64,64 colour=#00ff00",
        "undo 4",
    ] {
        document.apply(&line.parse::<Command>().unwrap()).unwrap();
    }
    let before = document.history().snapshot();
    let (undo, redo) = (packed(&before.undo), packed(&before.redo));
    let shape = ContentsShape::of(document.contents());
    let after = read_steps([&undo, &redo], shape, &Limits::default()).unwrap();
    assert_eq!(before, after);
}

#[test]
fn the_steps_furthest_away_are_dropped_first() {
    let mut document = document(UVec3::splat(16), ColourDepth::None);
    for x in [2, 4, 6, 8] {
        document.apply(&line(0, [x, 4, 4]).parse().unwrap()).unwrap();
    }
    document.apply(&Command::Undo { steps: Some(1) }).unwrap();
    let all = document.history().snapshot();
    let bytes: Vec<usize> = all.undo.iter().rev().map(|step| step.heap_bytes()).collect();
    let mut short = all.clone();
    assert_eq!(short.shorten(bytes[0] + bytes[1]), [1, 1]);
    assert_eq!(short.undo, all.undo[1..]);
    let mut whole = all.clone();
    assert_eq!((whole.shorten(usize::MAX), whole), ([0, 0], all));
}

#[test]
fn an_edit_with_its_growth_is_read_back() {
    let lines =
        [(13, [0; 3]), (14, [3, 4, 5]), (12, [0; 3]), (11, [9, 0, 0]), (8, [0; 3]), (8, [0; 3])];
    read_back_exactly(&lines, ColourDepth::Bits8);
    read_back_exactly(&lines[..3], ColourDepth::None);
}

#[test]
fn a_sculpture_without_colours_that_was_cleared_is_read_back() {
    read_back_exactly(&[(4, [0; 3])], ColourDepth::None);
}
