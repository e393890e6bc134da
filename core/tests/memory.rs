//! Tests, in a process with limited memory, that commands without enough memory are refused and leave the document
//! unchanged.

use std::sync::Arc;

use glam::{UVec3, Vec3};
use sculpture_core::command::Command;
use sculpture_core::document::{CommandError, Document};
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{Brick, ColourDepth, Grid, GridError, Limits, Material, Rgb};
use trials::Limiter;

/// Returns a document whose grid takes 66 MiB, as do its bits in a step: each of its bricks has voxels, and none is
/// full.
fn document() -> Document {
    let mut grid = Grid::new(UVec3::new(1024, 1024, 512), Vec3::ONE, 1 << 30).unwrap();
    grid.fill_bricks(|_| Brick::below([7, 7, 7]));
    let material = Material::for_grid(&grid, ColourDepth::None, Rgb::default());
    Document::from_contents(Contents::new(grid, material), Limits::default())
}

fn run(document: &mut Document, line: &str) -> Result<(), CommandError> {
    let command: Command = line.parse().unwrap();
    document.apply(&command).map(|_| ())
}

/// Returns the state that refused commands must not change.
fn summary(document: &Document) -> (u64, u64, usize, usize, bool) {
    let history = document.history();
    let counts = (history.undo_count(), history.redo_count());
    let count = document.grid().opaque_count();
    (count, document.revision(), counts.0, counts.1, document.stroke_open())
}

/// Checks a command that needs 66 MiB: it is refused with 40 available, and done with more.
fn check(document: &mut Document, limiter: &mut Limiter, line: &str) {
    let before = summary(document);
    let error = limiter.within(40, || run(document, line)).unwrap_err();
    let is_told = matches!(error, CommandError::Grid(GridError::NoMemory { .. }));
    assert!(is_told && error.to_string().contains("the system has not the 6"), "{line}: {error}");
    assert_eq!(summary(document), before, "{line}");
    run(document, line).unwrap();
    assert_ne!(summary(document), before, "{line}");
}

#[test]
fn edits_beside_a_snapshot_need_no_memory_for_a_copy() {
    if !trials::alone() {
        return;
    }
    let mut document = document();
    // Allocates threads and their memory before the limit.
    run(&mut document, "subtract cuboid at=40,40,40 half=20").unwrap();
    run(&mut document, "undo").unwrap();
    let mut limiter = Limiter::start();
    for line in ["subtract ellipsoid at=40,40,40 half=9", "surface cubes", "undo", "redo"] {
        let shared = document.share_contents();
        let (before, said) = (Contents::clone(&shared), summary(&document));
        limiter.within(40, || run(&mut document, line)).unwrap();
        assert_ne!(summary(&document), said, "{line}");
        assert!(*shared == before, "{line}: the snapshot stays as it was");
    }
}

#[test]
fn steps_that_there_is_no_memory_to_undo_stay_in_the_history() {
    if !trials::alone() {
        return;
    }
    let mut document = document();
    run(&mut document, "clear grid").unwrap();
    run(&mut document, "undo").unwrap();
    let mut limiter = Limiter::start();
    // The reverse of the step has the bits of all bricks.
    check(&mut document, &mut limiter, "redo");
    // A snapshot of the history shares them: a copy is needed.
    let snapshot = document.history().snapshot();
    check(&mut document, &mut limiter, "undo");
    drop(snapshot);
    check(&mut document, &mut limiter, "redo");
    // The bricks that come back need it too.
    check(&mut document, &mut limiter, "undo");
    assert_eq!(document.grid().opaque_count(), 343 * (128 * 128 * 64));
}

#[test]
fn copies_are_equal_to_what_they_were_made_of() {
    let grid = Grid::new(UVec3::new(20, 9, 33), Vec3::ONE, 1 << 20).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::Bits16, Rgb([9, 80, 200]));
    let mut document = Document::from_contents(Contents::new(grid, material), Limits::default());
    for line in [
        "add ellipsoid at=8,4,9 half=5 colour=#ff0000",
        "mask add grid",
        "add cuboid at=9,4,20 half=4 colour=#00ff00",
    ] {
        run(&mut document, line).unwrap_or_else(|error| panic!("{line}: {error}"));
    }
    let shared: Arc<Contents> = document.share_contents();
    for step in document.history().undo_steps() {
        assert!(step.copied().as_ref() == Ok(step));
    }
    let before = Contents::clone(&shared);
    run(&mut document, "undo 2").unwrap();
    assert!(*shared == before && *document.contents() != before);
}
