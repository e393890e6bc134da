//! A history at full size: 1024 voxels along each axis, 24 bits of colour, every voxel painted, with many colours in
//! each brick. Steps that the history
//! cannot keep are refused before anything changes.

use std::time::Instant;

use rayon::prelude::*;
use sculpture_core::command::Command;
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::sculpture::history::Contents;

/// Returns a hash of all bits and colours; a copy would take gigabytes.
fn digest(contents: &Contents) -> u64 {
    let Contents { grid, material, .. } = contents;
    let mix = |hash: u64, v: u64| (hash ^ v).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
    let brick = |at: usize| {
        let words = grid.brick_at(at).words.iter().fold(at as u64, |hash, word| mix(hash, *word));
        let mut buffer = [0; 512 * 3];
        material.page(grid.brick_coords(at)).map_or(words, |page| {
            page.write_to(&mut buffer)
                .as_chunks()
                .0
                .iter()
                .fold(words + 1, |hash, v| mix(hash, u64::from_le_bytes(*v)))
        })
    };
    (0..grid.brick_count()).into_par_iter().map(brick).reduce(|| 0, u64::wrapping_add)
}

/// Returns everything that a refused command must not change.
fn all_of(document: &Document) -> (u64, usize, usize, usize, u64) {
    let history = document.history();
    let (undo, redo) = (history.undo_count(), history.redo_count());
    (digest(document.contents()), undo, redo, history.bytes(), history.dropped())
}

fn apply(document: &mut Document, line: &str) -> Result<u32, CommandError> {
    let begun = Instant::now();
    let applied = document.apply(&line.parse().unwrap());
    let (history, pages) = (document.history(), document.material().page_count());
    println!(
        "{line}: {:.2} s, {} steps of {} MiB, {pages} pages{}",
        begun.elapsed().as_secs_f64(),
        history.undo_count(),
        history.bytes() >> 20,
        applied.as_ref().err().map_or(String::new(), |error| format!("; {error}")),
    );
    applied.map(|applied| applied.steps)
}

fn is_refused(result: Result<u32, CommandError>) -> bool {
    matches!(result, Err(CommandError::Irreversible { .. }))
}

#[test]
fn at_1024_cubed_in_24_bits_nothing_vanishes_unasked() {
    if std::env::var_os("SCULPTURE_LARGE").is_none() {
        trials::skip("it takes 8 GB of memory and a minute; SCULPTURE_LARGE=1 runs it");
    }
    let Command::New(new) = "new dims=1024,1024,1024 colour=24".parse().unwrap() else { panic!() };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    for line in ["begin", "dye colour=#804020", "noise colour=#102040 size=8 amount=1", "end"] {
        apply(&mut document, line).unwrap();
    }
    assert_eq!(document.material().page_count(), 1 << 21);
    let painted = digest(document.contents());
    apply(&mut document, "recolour ellipsoid at=300,500,512 half=200 colour=#2040ff").unwrap();
    apply(&mut document, "subtract ellipsoid at=700,500,512 half=300").unwrap();
    apply(&mut document, "orient upright=z").unwrap();
    let before = all_of(&document);
    assert_eq!((before.1, before.4), (4, 0));

    // Steps that would keep 3 GiB of pages in 1 GiB are refused and change nothing.
    assert!(is_refused(apply(&mut document, "dye colour=#102030")));
    assert!(is_refused(apply(&mut document, "new dims=8,8,8")));
    assert_eq!(all_of(&document), before);

    // Undo and redo, exact to the byte.
    assert_eq!(apply(&mut document, "undo 3").unwrap(), 3);
    assert_eq!(digest(document.contents()), painted);
    assert_eq!(apply(&mut document, "redo all").unwrap(), 3);
    // The memory of a step may differ by the spare capacity of its lists.
    let again = all_of(&document);
    assert_eq!((again.0, again.1, again.2, again.4), (before.0, before.1, before.2, before.4));

    // The first step painted everything: its undo would have to keep everything. The others are undone.
    assert_eq!(apply(&mut document, "undo all").unwrap(), 3);
    let before = all_of(&document);
    assert_eq!((before.0, before.1, before.2, before.4), (painted, 1, 3, 0));
    assert!(is_refused(apply(&mut document, "undo")));
    assert_eq!(all_of(&document), before);

    // If irreversible steps are allowed, it is undone.
    apply(&mut document, "irreversible on").unwrap();
    assert_eq!(apply(&mut document, "undo").unwrap(), 1);
    assert_eq!(document.material().page_count(), 0);
    assert!(document.history().dropped() > 0);
}
