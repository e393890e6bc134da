//! Documents whose history has little memory: steps that do not fit are refused, unless irreversible steps are allowed.

use glam::{UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::Command;
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::sculpture::ColourDepth;
use sculpture_core::sculpture::clip::Clip;
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::selection::Selection;

use super::document::{ball, painted};
use super::strategies::{new_sculpture, work};

/// Returns everything that a refused command must not change.
fn all_of(document: &Document) -> (Contents, [usize; 3], bool, Option<Clip>, Selection) {
    let history = document.history();
    let steps = [history.undo_count(), history.redo_count(), history.bytes()];
    let clip = document.clip().cloned();
    let selection = document.selection().clone();
    (document.contents().clone(), steps, document.can_repeat(), clip, selection)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn undo_returns_to_earlier_states_with_any_budget(
        new in new_sculpture(24),
        commands in prop::collection::vec(work(), 1..40),
        history_bytes in 0usize..40_000,
        irreversible in any::<bool>(),
    ) {
        let mut document = Document::new(&new, Limits { history_bytes, ..Limits::default() }).unwrap();
        document.apply(&Command::Irreversible(irreversible)).unwrap();
        let mut states = vec![document.contents().clone()];
        for command in &commands {
            let (before, dropped) = (all_of(&document), document.history().dropped());
            let refused = document.apply(command).is_err();
            prop_assert!(document.history().bytes() <= history_bytes);
            if refused {
                prop_assert!(all_of(&document) == before, "{}", command);
            }
            let (undo, redo) = (before.1[0], before.1[1]);
            let goes_on = !matches!(command, Command::Undo { .. } | Command::Redo { .. });
            if !irreversible && goes_on && document.contents() != &before.0 {
                // Only old steps are dropped to make room, never the new one.
                let room = document.stroke_open() || document.history().undo_count() > 0;
                prop_assert!(room || matches!(command, Command::Cancel), "{}", command);
            } else if !irreversible && !goes_on {
                let dropped = (document.history().dropped() - dropped) as usize;
                let left = document.history().undo_count() + document.history().redo_count();
                prop_assert_eq!(left + dropped, undo + redo);
            }
            states.push(document.contents().clone());
        }
        if document.apply(&Command::End).is_err() && document.stroke_open() {
            document.apply(&Command::Cancel).unwrap();
        }
        states.push(document.contents().clone());
        document.apply(&Command::Irreversible(true)).unwrap();
        let mut steps = document.history().undo_count();
        while steps > 0 {
            document.apply(&Command::Undo { steps: Some(1) }).unwrap();
            prop_assert!(states.contains(document.contents()));
            prop_assert!(document.history().bytes() <= history_bytes);
            // Redo may need more memory than undo did.
            prop_assert!(document.history().undo_count() < steps);
            steps = document.history().undo_count();
        }
        document.apply(&Command::Redo { steps: None }).unwrap();
        prop_assert!(states.contains(document.contents()));
    }
}

#[test]
fn a_step_beyond_the_budget_is_refused_unless_irreversible_steps_are_allowed() {
    let limits = Limits { history_bytes: 20_000, ..Limits::default() };
    let new = painted(UVec3::splat(64), ColourDepth::Bits24, false);
    let mut document = Document::new(&new, limits).unwrap();
    let apply = |document: &mut Document, line: &str| document.apply(&line.parse().unwrap());
    apply(&mut document, "add ellipsoid at=10,10,10 half=3 colour=#ff0000").unwrap();
    apply(&mut document, "irreversible on").unwrap();
    apply(&mut document, "fill colour=#ff0000").unwrap();
    // So many colours that each brick keeps one for each voxel.
    apply(&mut document, "noise colour=#203040 size=8 amount=1").unwrap();
    // No brick is full, so the bits of each must be kept.
    for i in 0..512 {
        let at = |shift: u32| (i >> shift & 7) as f32 * 8.0 + 0.5;
        let hole = format!("subtract cuboid at={},{},{} half=0.5", at(0), at(3), at(6));
        apply(&mut document, &hole).unwrap();
    }
    apply(&mut document, "irreversible off").unwrap();
    apply(&mut document, "add ellipsoid at=10,10,10 half=3 colour=#00ff00").unwrap();
    apply(&mut document, "mark at=0,0,0 size=9,9,9").unwrap();
    apply(&mut document, "copy").unwrap();
    apply(&mut document, "mark at=8,8,8 size=50,50,50").unwrap();
    let before = all_of(&document);
    // The pages painted over take more than 20 kB.
    let large = "ellipsoid at=30,30,30 half=20";
    for line in [
        &format!("recolour {large} colour=#0000ff"),
        "dye colour=#00ff00",
        "dye marker colour=#00ff00",
        "cut",
        "move by=3,0,0 axes=y,x,z",
        "array count=20 step=2,0,0",
        "new dims=8,8,8",
    ] {
        if line.starts_with("array") {
            // A small operation with many repetitions.
            apply(&mut document, "irreversible on").unwrap();
            apply(&mut document, "recolour cuboid at=8,32,32 half=8 colour=#123456").unwrap();
            apply(&mut document, "irreversible off").unwrap();
        }
        let before = all_of(&document);
        let (state, marker) = (document.state(), document.selection().marker());
        let error = apply(&mut document, line).expect_err(line);
        assert!(matches!(error, CommandError::Irreversible { .. }), "{line}: {error}");
        let text = error.to_string();
        assert!(
            text.contains("allowed for undo steps") && text.contains("irreversible on"),
            "{text}"
        );
        assert!(all_of(&document) == before, "{line}");
        assert_eq!((document.state(), document.selection().marker()), (state, marker), "{line}");
    }
    assert!(before.1[0] > 0, "there is something to lose");

    // In a stroke, `end` is refused; the stroke can still be cancelled.
    let before = document.contents().clone();
    apply(&mut document, "begin").unwrap();
    apply(&mut document, &format!("recolour {large} colour=#0000ff")).unwrap();
    assert!(matches!(apply(&mut document, "end"), Err(CommandError::Irreversible { .. })));
    assert!(document.stroke_open());
    apply(&mut document, "cancel").unwrap();
    assert_eq!(document.contents(), &before);
    // Or kept, if that is allowed; then no earlier step can be undone.
    apply(&mut document, "begin").unwrap();
    apply(&mut document, &format!("recolour {large} colour=#0000ff")).unwrap();
    apply(&mut document, "irreversible on").unwrap();
    apply(&mut document, "end").unwrap();
    apply(&mut document, "irreversible off").unwrap();
    assert_ne!(document.contents(), &before);
    assert_eq!(document.history().undo_count(), 0);
    assert_eq!(document.history().bytes(), 0);
    assert_eq!(document.apply(&Command::Undo { steps: None }).unwrap().steps, 0);
    // The next step that fits is an ordinary one.
    document.apply(&ball(EditOp::Subtract, Vec3::splat(10.0), 3.0)).unwrap();
    assert_eq!(document.history().undo_count(), 1);
}

/// A painting step stores little: that there were no pages. Its undo would have to store all pages, which have many
/// colours.
#[test]
fn an_undo_whose_redo_cannot_be_kept_is_refused_unless_irreversible_steps_are_allowed() {
    let limits = Limits { history_bytes: 20_000, ..Limits::default() };
    let new = painted(UVec3::splat(64), ColourDepth::Bits24, true);
    let mut document = Document::new(&new, limits).unwrap();
    document.apply(&"noise colour=#ff0000 size=8 amount=1".parse().unwrap()).unwrap();
    document.apply(&ball(EditOp::Subtract, Vec3::splat(4.0), 2.0)).unwrap();
    let after = document.apply(&Command::Undo { steps: None }).unwrap();
    assert_eq!(after.steps, 1, "as far as redo can be kept");
    let before = all_of(&document);
    let (state, undo) = (document.state(), Command::Undo { steps: Some(1) });
    let error = document.apply(&undo).unwrap_err();
    assert!(error.to_string().contains("undo noise"), "{error}");
    assert!(all_of(&document) == before);
    assert_eq!(document.state(), state);
    document.apply(&Command::Irreversible(true)).unwrap();
    assert_eq!(document.apply(&undo).unwrap().steps, 1);
    assert_eq!(document.material().page_count(), 0);
    assert_eq!((document.history().undo_count(), document.history().redo_count()), (0, 0));
}
