use glam::{UVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::sculpture::colour_record::ColourRecord;
use crate::sculpture::material::Page;
use crate::sculpture::record::BrickRecord;
use crate::sculpture::{Brick, ColourDepth, Grid, Material, Rgb};

/// Returns a step that keeps some mixed bricks, or a whole sculpture.
fn step(name: usize, bricks: u8) -> Step {
    let label = format!("step {name}");
    if bricks.is_multiple_of(16) {
        let grid = Grid::new(UVec3::splat(8 + u32::from(bricks)), Vec3::ONE, 1 << 30).unwrap();
        let material = Material::for_grid(&grid, ColourDepth::None, Rgb::default());
        let change = StepChange::Whole(Box::new(Contents::new(grid, material)));
        return Step { label, change, state: State::default() };
    }
    let bits = Brick::below([1, 2, 3]);
    let named = (0..u32::from(bricks).min(64)).map(|x| (UVec3::new(x, 1, 0), bits)).collect();
    let mut record = BrickRecord::of_bricks(named, |_| Brick::FULL);
    if bricks > 0 {
        let colours: Vec<u8> = (0..512).map(|local| local as u8).collect();
        let page = Page::of_bytes(&colours, ColourDepth::Bits8);
        let pages = vec![(UVec3::ZERO, Some(page))];
        record = record.with_colours(ColourRecord::of_pages(pages, ColourDepth::Bits8));
    }
    Step { label, change: StepChange::Bricks(record), state: State::default() }
}

fn recount(history: &History) -> usize {
    history.undo.iter().chain(&history.redo).map(|step| step.heap_bytes()).sum()
}

proptest! {
    /// An undone step comes back with another number of bytes, since full bricks become mixed.
    #[test]
    fn bytes_are_counted_and_within_the_budget(
        budget in 0usize..60_000,
        moves in prop::collection::vec((0u8..4, 0u8..80), 0..80),
    ) {
        let mut history = History::new(budget);
        // Names of the steps that would remain if the budget were unlimited.
        let (mut undo, mut redo): (Vec<usize>, Vec<usize>) = Default::default();
        for (name, (kind, bricks)) in moves.into_iter().enumerate() {
            let named = |label: &str| label["step ".len()..].parse::<usize>().unwrap();
            let bytes = match kind {
                0 | 1 => {
                    let step = step(name, bricks);
                    let bytes = step.heap_bytes();
                    history.push(step);
                    undo.push(name);
                    redo.clear();
                    bytes
                }
                2 => match history.take_undo().unwrap() {
                    None => continue,
                    Some(taken) => {
                        let name = named(&taken.label);
                        prop_assert_eq!(undo.pop(), Some(name));
                        let reverse = step(name, bricks);
                        let bytes = reverse.heap_bytes();
                        history.undone(reverse);
                        redo.push(name);
                        bytes
                    }
                },
                _ => match history.take_redo().unwrap() {
                    None => continue,
                    Some(taken) => {
                        let name = named(&taken.label);
                        prop_assert_eq!(redo.pop(), Some(name));
                        let reverse = step(name, bricks);
                        let bytes = reverse.heap_bytes();
                        history.redone(reverse);
                        undo.push(name);
                        bytes
                    }
                },
            };
            prop_assert_eq!(history.bytes(), recount(&history));
            prop_assert!(history.bytes() <= budget);
            if bytes > budget {
                if kind == 2 { redo.clear() } else { undo.clear() }
            }
            // The newest steps of each stack are left, in order.
            let left: Vec<usize> = history.undo_labels().map(named).collect();
            prop_assert!(undo.ends_with(&left), "{:?} {:?}", undo, left);
            let left: Vec<usize> = history.redo_labels().map(named).collect();
            let next_first: Vec<usize> = redo.iter().rev().copied().collect();
            prop_assert!(next_first.starts_with(&left), "{:?} {:?}", redo, left);
            undo.drain(..undo.len() - history.undo_count());
            redo.drain(..redo.len() - history.redo_count());
        }
    }
}
