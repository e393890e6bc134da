//! A long session on a large sculpture: random strokes with every tool, taken back and made again now and then. Memory
//! stays what the sculpture and its history take, and undo and redo restore each state exactly.
//!
//! `VS_SOAK_STROKES=N` makes N strokes, for long manual runs.

use glam::{UVec3, Vec3};
use sculpture_core::command::Command;
use sculpture_core::document::{Document, Limits};
use sculpture_core::scenes::Random;

use super::uses::{self, Place};

const EDGE: u32 = 4096;
const STROKES: usize = 20_000;
/// Strokes that are taken back and made again together.
const BATCH: usize = 50;

/// The memory that the process takes without a sculpture, in MiB: code, threads, and room for the work.
const IDLE_MIB: u64 = 80;

fn random_point(random: &mut Random) -> Vec3 {
    Vec3::new(random.unit(), random.unit(), random.unit())
}

/// Returns a place on the surface of a ball.
fn place_on(centre: Vec3, radius: f32, random: &mut Random) -> Place {
    let outwards = (random_point(random) - 0.5).normalize_or(Vec3::Y);
    let at_vx = centre + radius * outwards;
    // From within the hollow.
    let eye_vx = centre + 0.25 * radius * outwards;
    let further_vx = at_vx + 20.0 * (random_point(random) - 0.5);
    Place { at_vx, ball_vx: at_vx, further_vx, eye_vx, aim: outwards }
}

/// Returns the next stroke: a new hollow, or any tool at the surface of one made before.
fn stroke(hollows: &mut Vec<(Vec3, f32)>, random: &mut Random) -> Command {
    let pick = |random: &mut Random, count: usize| random.next_u64() as usize % count;
    if hollows.is_empty() || pick(random, 4) == 0 {
        let centre = random_point(random) * EDGE as f32;
        let radius = 8.0 + 56.0 * random.unit();
        hollows.push((centre, radius));
        let Vec3 { x, y, z } = centre;
        return format!("subtract ellipsoid at={x},{y},{z} half={radius}").parse().unwrap();
    }
    let (centre, radius) = hollows[pick(random, hollows.len())];
    let mut all = uses::of_every_tool(&place_on(centre, radius, random));
    // Cuts all of the block, which is no stroke.
    all.retain(|command| !command.to_string().contains(" half-space "));
    all.swap_remove(pick(random, all.len()))
}

/// Returns the memory that a document should take, in MiB.
fn accounted_mib(document: &Document) -> u64 {
    let contents = document.contents();
    let mask = contents.mask.as_ref().map_or(0, |mask| mask.heap_bytes());
    let bytes = contents.grid.heap_bytes() + contents.material.heap_bytes() + mask;
    (bytes + document.history().bytes() as u64) >> 20
}

/// Returns the number of steps made so far that can or could be undone.
fn steps(document: &Document) -> u64 {
    document.history().undo_count() as u64 + document.history().dropped()
}

#[test]
fn a_long_session_at_4096_cubed_takes_only_the_memory_of_what_is_there() {
    if !trials::alone() {
        return;
    }
    let strokes = std::env::var("VS_SOAK_STROKES").map_or(STROKES, |n| n.parse().unwrap());
    let limits = Limits {
        grid_bytes: 1 << 30,
        colour_bytes: 1 << 30,
        history_bytes: 64 << 20,
        history_disk_bytes: 0,
    };
    let mut document = uses::document_within(UVec3::splat(EDGE), true, limits);
    let (mut hollows, mut random) = (Vec::new(), Random(4096));
    let mut changed = 0;
    for batch in 0..strokes / BATCH {
        let (before, steps_before) = (document.contents().clone(), steps(&document));
        for _ in 0..BATCH {
            let command = stroke(&mut hollows, &mut random);
            let applied = document.apply(&command).unwrap_or_else(|e| panic!("{command}: {e}"));
            changed += usize::from(applied.stats.voxels_changed() > 0);
        }
        let after = document.contents().clone();
        let count = steps(&document) - steps_before;
        for (verb, expected) in [("undo", &before), ("redo", &after)] {
            let command = format!("{verb} {count}").parse().unwrap();
            assert_eq!(u64::from(document.apply(&command).unwrap().steps), count, "batch {batch}");
            assert!(document.contents() == expected, "batch {batch}: {verb} {count}");
        }
        drop((before, after));
        if let Some(mib) = trials::resident_mib() {
            let accounted = accounted_mib(&document);
            let most = IDLE_MIB + accounted + accounted / 2;
            assert!(mib <= most, "batch {batch}: {mib} MiB for {accounted} MiB of sculpture");
            trials::note!("batch {batch}: {mib} MiB for {accounted} MiB of sculpture");
        }
    }
    assert!(2 * changed > strokes, "{changed} strokes have changed voxels");
}
