//! Documents compared with a model that stores each voxel separately, under random work.

use std::collections::HashSet;

use glam::{IVec3, Quat, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Area, Command, NewSculpture};
use sculpture_core::document::{CommandError, Document, Heeds, Limits};
use sculpture_core::refusal::{MemoryBudget, OverBudget};
use sculpture_core::sculpture::brick::local_index;
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{ColourDepth, Grid, Material, Placement, Rgb};
use sculpture_core::tools::solid::{Primitive, Solid};

use super::model::{Done, Model, Voxels};
use super::strategies::{new_sculpture, work};

/// Compares every voxel and its colour.
fn agree(contents: &Contents, model: &Voxels) -> Result<(), TestCaseError> {
    let Contents { grid, material, .. } = contents;
    prop_assert_eq!(grid.dims(), model.dims);
    prop_assert_eq!(material.depth(), model.depth);
    let existing = model.colours.iter().flatten().count();
    prop_assert_eq!(grid.opaque_count(), existing as u64);
    for (v, colour) in model.all().zip(&model.colours) {
        let [x, y, z] = (v.as_uvec3() % 8).to_array();
        let here = grid.get(v).then(|| material.rgb(v.as_uvec3() / 8, local_index(x, y, z)));
        prop_assert!(here == *colour, "{v}: {here:?}, but the model: {colour:?}");
    }
    Ok(())
}

/// Checks the invariants of a grid: counts, occupancy, no bits beyond its border.
fn sound(grid: &Grid) -> Result<(), TestCaseError> {
    let mut copy = Grid::new(grid.dims(), grid.voxel_size(), u64::MAX).unwrap();
    copy.fill_bricks(|b| *grid.brick(b));
    prop_assert_eq!(&copy, grid);
    Ok(())
}

/// Returns the bricks whose bits or colours differ.
fn changed_bricks(before: &Contents, after: &Contents) -> HashSet<u32> {
    let differs = |&brick: &u32| {
        let b = before.grid.brick_coords(brick as usize);
        before.grid.brick(b) != after.grid.brick(b)
            || before.material.page(b) != after.material.page(b)
    };
    (0..before.grid.brick_count() as u32).filter(differs).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    /// A trial leaves no trace, and predicts the result of the actual command.
    #[test]
    fn a_trial_leaves_nothing_behind(
        new in new_sculpture(24),
        commands in prop::collection::vec(work(), 1..20),
        tried in prop::collection::vec(work(), 1..4),
        heeds in (any::<bool>(), any::<bool>()).prop_map(|(limit, mask)| Heeds { limit, mask }),
    ) {
        let mut document = Document::new(&new, Limits::default()).unwrap();
        for command in &commands {
            let _ = document.apply(command);
        }
        let of = |document: &Document| {
            let history = document.history();
            (
                document.contents().clone(),
                (document.state(), document.revision(), document.stroke_open()),
                (history.undo_count(), history.redo_count(), document.can_repeat()),
                (document.selection().clone(), document.clip().cloned()),
            )
        };
        let before = of(&document);
        document.would_change(&tried, heeds);
        prop_assert!(of(&document) == before);
        if !document.stroke_open() {
            let expected = document.would_change(&tried[..1], Heeds { limit: true, mask: true });
            let is_tool = matches!(
                tried[0],
                Command::Construct { .. } | Command::Fill { .. } | Command::Clear { .. } | Command::Dye { .. }
            );
            match document.apply(&tried[0]) {
                Ok(done) if is_tool => prop_assert_eq!(done.stats, expected),
                _ => {}
            }
        }
    }

    #[test]
    fn random_work_agrees_with_the_model(
        new in new_sculpture(24),
        commands in prop::collection::vec(work(), 1..40),
        look_every in 1usize..5,
    ) {
        let mut document = Document::new(&new, Limits::default()).unwrap();
        let mut model = Model::new(&new);
        let mut seen = document.drain_changes(|contents, dirty| {
            assert!(dirty.is_none());
            contents.clone()
        });
        for (i, command) in commands.iter().enumerate() {
            let before = document.contents().clone();
            let (revision, undo) = (document.revision(), document.history().undo_count());
            let expected = model.apply(command);
            match (document.apply(command), expected) {
                (Ok(applied), Some(done)) => {
                    let stats = applied.stats;
                    let got = Done {
                        added: stats.voxels_added,
                        removed: stats.voxels_removed,
                        recoloured: stats.voxels_recoloured,
                        steps: applied.steps,
                    };
                    prop_assert_eq!(got, done, "{}", command);
                    if got != Done::default() && got.steps == 0 {
                        let changed = changed_bricks(&before, document.contents());
                        prop_assert_eq!(stats.bricks_changed, changed.len() as u64);
                    }
                }
                (Err(_), None) => {
                    prop_assert_eq!(document.contents(), &before);
                    prop_assert_eq!(document.revision(), revision);
                    prop_assert_eq!(document.history().undo_count(), undo);
                }
                (result, expected) => {
                    let text = format!("{command}: {result:?}, but the model: {expected:?}");
                    return Err(TestCaseError::fail(text));
                }
            }
            agree(document.contents(), &model.now)?;
            sound(document.grid())?;
            prop_assert_eq!(document.stroke_open(), model.stroke_open());
            prop_assert_eq!(document.history().undo_count(), model.undo.len());
            prop_assert_eq!(document.history().redo_count(), model.redo.len());
            if document.contents() != &before {
                prop_assert!(document.revision() > revision);
            }
            if i % look_every == 0 {
                seen = document.drain_changes(|contents, dirty| {
                    match dirty {
                        None => {}
                        Some(_) if seen.grid.dims() != contents.grid.dims() => {
                            return Err(TestCaseError::fail("another grid, but not all is dirty"));
                        }
                        Some(dirty) => {
                            prop_assert!(dirty.is_sorted_by(|a, b| a < b));
                            let dirty: HashSet<u32> = dirty.iter().copied().collect();
                            let changed = changed_bricks(&seen, contents);
                            prop_assert!(changed.is_subset(&dirty), "{changed:?} {dirty:?}");
                        }
                    }
                    Ok(contents.clone())
                })?;
            }
        }
    }

    #[test]
    fn undo_and_redo_return_to_identical_contents(
        new in new_sculpture(24),
        commands in prop::collection::vec(work(), 1..40),
    ) {
        let mut document = Document::new(&new, Limits::default()).unwrap();
        // The sculpture after each number of undo steps.
        let mut at_step = vec![document.contents().clone()];
        for command in &commands {
            let steps_before = document.history().undo_count();
            let stroke_began = match command {
                Command::Begin { .. } if !document.stroke_open() => Some(document.contents().clone()),
                _ => None,
            };
            let _ = document.apply(command);
            if let Some(began) = stroke_began {
                // A stroke that is cancelled leaves no trace, whatever it did.
                let edits = commands.iter().filter(|c| matches!(c, Command::Construct { .. }));
                for edit in edits.take(5) {
                    let _ = document.apply(edit);
                }
                document.apply(&Command::Cancel).unwrap();
                prop_assert_eq!(document.contents(), &began);
                document.apply(command).unwrap();
            }
            let steps = document.history().undo_count();
            if steps > steps_before && !matches!(command, Command::Redo { .. }) {
                at_step.truncate(steps);
                at_step.push(document.contents().clone());
            } else if !document.stroke_open() {
                prop_assert_eq!(document.contents(), &at_step[steps]);
            }
        }
        if document.stroke_open() {
            document.apply(&Command::End).unwrap();
        }
        document.apply(&Command::Redo { steps: None }).unwrap();
        let end = document.contents().clone();
        let steps = document.history().undo_count() as u32;
        let undone = document.apply(&Command::Undo { steps: None }).unwrap();
        prop_assert_eq!(undone.steps, steps);
        prop_assert_eq!(document.contents(), &at_step[0]);
        let redone = document.apply(&Command::Redo { steps: None }).unwrap();
        prop_assert_eq!(redone.steps, steps);
        prop_assert_eq!(document.contents(), &end);
    }
}

pub fn painted(dims: UVec3, depth: ColourDepth, solid: bool) -> NewSculpture {
    NewSculpture {
        room_vx: 0,
        grows: false,
        dims,
        voxel_size: Vec3::ONE,
        colour_depth: depth,
        base: Rgb::new(200, 190, 170),
        solid,
    }
}

pub fn ball(op: EditOp, centre: Vec3, radius: f32) -> Command {
    let primitive = Primitive {
        solid: Solid::Ellipsoid,
        centre_vx: centre,
        half: Vec3::splat(radius),
        rotation: Quat::IDENTITY,
    };
    Command::Construct { op, primitive, to_vx: None }
}

pub const RED: Rgb = Rgb::new(255, 0, 0);

/// Large enough to be divided among threads, with sides that are not multiples of a brick.
#[test]
fn large_edits_equal_the_definition() {
    let dims = UVec3::new(131, 126, 141);
    let turned = Quat::from_xyzw(0.2, -0.3, 0.4, 0.5).normalize();
    for (i, solid) in Solid::ALL.into_iter().enumerate() {
        let rotation = [turned, Quat::IDENTITY, turned][i % 3];
        let new = painted(dims, ColourDepth::Bits16, false);
        let mut document = Document::new(&new, Limits::default()).unwrap();
        let start = document.contents().clone();
        let mut model = Voxels::new(&new);
        let at = |x: f32, half: f32| Primitive {
            solid,
            centre_vx: Vec3::new(x, 60.25, 71.5),
            half: Vec3::splat(half),
            rotation,
        };
        let steps = [
            (EditOp::Add(Some(RED)), at(66.0, 75.0)),
            (EditOp::Subtract, at(80.0, 62.0)),
            (EditOp::Recolour(Rgb::new(0, 90, 255)), at(60.0, 66.0)),
            (EditOp::Add(None), at(90.0, 64.0)),
        ];
        document.apply(&Command::Begin { label: "large".into() }).unwrap();
        for (op, primitive) in steps {
            let applied =
                document.apply(&Command::Construct { op, primitive, to_vx: None }).unwrap();
            let placed = primitive.in_grid(Vec3::ONE);
            let done = model.edit(op, |v| placed.contains_voxel(v));
            let stats = applied.stats;
            let got = [stats.voxels_added, stats.voxels_removed, stats.voxels_recoloured];
            assert_eq!(got, [done.added, done.removed, done.recoloured], "{op:?} {solid:?}");
            assert!(applied.stats.voxels_changed() > 0);
        }
        document.apply(&Command::End).unwrap();
        agree(document.contents(), &model).unwrap();
        sound(document.grid()).unwrap();
        let dirty = document.drain_changes(|contents, dirty| {
            assert!(dirty.is_none());
            contents.clone()
        });
        document.apply(&Command::Undo { steps: None }).unwrap();
        assert_eq!(document.contents(), &start);
        document.apply(&Command::Redo { steps: None }).unwrap();
        assert_eq!(document.contents(), &dirty);
    }
}

#[test]
fn a_512_clear_is_one_small_step() {
    let new = painted(UVec3::splat(512), ColourDepth::None, true);
    let mut document = Document::new(&new, Limits::default()).unwrap();
    let before = document.contents().clone();
    let applied = document.apply(&Command::Clear { area: Area::Grid }).unwrap();
    assert_eq!(applied.stats.voxels_removed, 1 << 27);
    assert_eq!(applied.stats.bricks_changed, 1 << 18);
    assert_eq!(document.grid().opaque_count(), 0);
    assert_eq!(document.history().undo_count(), 1);
    assert!(document.history().bytes() <= 80 << 10, "{} bytes", document.history().bytes());
    document.apply(&Command::Undo { steps: Some(1) }).unwrap();
    assert_eq!(document.contents(), &before);
}

#[test]
fn colours_stay_within_their_budget() {
    // A page of two colours takes 88 bytes and an entry in a node.
    let (page, node) = (120, 256);
    let limits = Limits { colour_bytes: 10 * page + node, ..Limits::default() };
    let new = painted(UVec3::splat(32), ColourDepth::Bits24, false);
    let mut document = Document::new(&new, limits).unwrap();
    // The box around this ball has 27 bricks; the ball itself touches fewer, 7.
    let fits = ball(EditOp::Add(Some(RED)), Vec3::splat(12.0), 4.6);
    document.apply(&fits).unwrap();
    assert_eq!(document.material().page_count(), 7);
    let before = document.contents().clone();
    let too_much = ball(EditOp::Add(Some(RED)), Vec3::splat(20.0), 9.0);
    let refused = document.apply(&too_much).unwrap_err();
    assert!(
        matches!(
            refused,
            CommandError::OverBudget(OverBudget { budget: MemoryBudget::Colours, .. })
        ),
        "{refused}"
    );
    assert!(refused.to_string().contains("MiB for colours"), "{refused}");
    assert_eq!(document.contents(), &before);
    assert_eq!(document.history().undo_count(), 1);
    // Commands that need no new pages are always possible: again, base colour, subtract.
    document.apply(&ball(EditOp::Recolour(Rgb::new(0, 0, 9)), Vec3::splat(12.0), 4.6)).unwrap();
    document.apply(&ball(EditOp::Add(None), Vec3::splat(20.0), 9.0)).unwrap();
    document.apply(&ball(EditOp::Recolour(RED), Vec3::splat(20.0), 9.0)).unwrap_err();
    document.apply(&ball(EditOp::Subtract, Vec3::splat(20.0), 9.0)).unwrap();
    assert!(document.material().heap_bytes() <= limits.colour_bytes);
}

/// An edit that has changed nothing must not pass for the beginning of the next one.
#[test]
fn colours_are_undone_after_a_paste_outside_the_grid() {
    let mut document =
        Document::new(&painted(UVec3::ONE, ColourDepth::Bits8, true), Limits::default()).unwrap();
    let original = document.contents().clone();
    for line in ["cut", "fill colour=#a02010", "paste at=0,0,-1", "undo all", "dye colour=#a02010"]
    {
        document.apply(&line.parse().unwrap()).unwrap();
    }
    assert_eq!(document.material().page_count(), 1);
    document.apply(&"undo".parse().unwrap()).unwrap();
    assert_eq!(document.contents(), &original);
}

#[test]
fn refusals_name_the_reason_and_change_nothing() {
    let new = painted(UVec3::splat(16), ColourDepth::None, true);
    let mut document = Document::new(&new, Limits::default()).unwrap();
    let before = document.contents().clone();
    let place =
        |rotation, translation, scale| Command::Place(Placement { rotation, translation, scale });
    let cases = [
        (Command::End, "`end` without an open stroke"),
        (Command::Cancel, "`cancel` without an open stroke"),
        (Command::Open { path: "a".into(), import: Default::default() }, "`open` works on files"),
        (Command::Save { path: "a".into(), export: Default::default() }, "`save` works on files"),
        (ball(EditOp::Recolour(RED), Vec3::splat(8.0), 4.0), "this sculpture has no colours"),
        (ball(EditOp::Subtract, Vec3::NAN, 4.0), "the centre of the solid"),
        (ball(EditOp::Subtract, Vec3::ONE, 0.0), "the half extent of the solid"),
        (ball(EditOp::Subtract, Vec3::ONE, f32::INFINITY), "the half extent of the solid"),
        (
            Command::New(painted(UVec3::new(1, 9000, 1), ColourDepth::None, true)),
            "grid of 1x9000x1 voxels",
        ),
        (
            place(Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), Vec3::ZERO, 1.0),
            "the rotation of the placement",
        ),
        (place(Quat::IDENTITY, Vec3::NAN, 1.0), "the translation of the placement"),
        (place(Quat::IDENTITY, Vec3::ZERO, 0.0), "the scale of the placement"),
    ];
    for (command, message) in cases {
        let error = document.apply(&command).expect_err(message).to_string();
        assert!(error.starts_with(message), "{command}\n  says    {error}\n  not     {message}");
    }
    document.apply(&Command::Begin { label: "s".into() }).unwrap();
    let while_open = [
        Command::Begin { label: "t".into() },
        Command::New(new),
        Command::Undo { steps: None },
        Command::Redo { steps: None },
    ];
    for command in while_open {
        let error = document.apply(&command).unwrap_err();
        assert!(matches!(error, CommandError::StrokeOpen(verb) if verb == command.verb()));
    }
    assert!(document.replace(before.clone(), "open").is_err());
    document.apply(&Command::End).unwrap();
    assert_eq!(document.contents(), &before);
    assert_eq!((document.history().undo_count(), document.revision()), (0, 0));
}

/// The bytes that the bits take count, not the size of the box; an edit that would take more than allowed changes
/// nothing, and edits that take less remain possible.
#[test]
fn an_edit_beyond_the_memory_for_grids_is_refused() {
    let limits = Limits { grid_bytes: 1 << 20, ..Limits::default() };
    let mut document =
        Document::new(&painted(UVec3::splat(1024), ColourDepth::None, true), limits).unwrap();
    let (mut carved, mut refused) = (0, 0);
    for i in 0..40u32 {
        let place = Vec3::new((i % 4) as f32, (i / 4 % 4) as f32, (i / 16) as f32) * 250.0 + 130.0;
        let command = ball(EditOp::Subtract, place, 80.0);
        let before = document.contents().clone();
        match document.apply(&command) {
            Ok(_) => carved += 1,
            Err(CommandError::OverBudget(over)) => {
                assert!(over.budget == MemoryBudget::Grids && over.budget_mib == 1, "{over}");
                assert!(*document.contents() == before);
                refused += 1;
            }
            Err(error) => panic!("{error}"),
        }
        assert!(document.grid().heap_bytes() <= 1 << 20);
    }
    assert!(carved >= 5 && refused >= 5, "{carved} carved, {refused} refused");
    // Most of the allowed memory was put to use.
    assert!(document.grid().heap_bytes() > 800 << 10, "{}", document.grid().heap_bytes());
    // Filling the whole takes none.
    let carved = document.contents().clone();
    let all = Command::Fill { area: Area::Grid, colour: None };
    document.apply(&all).unwrap();
    assert_eq!(document.grid().opaque_count(), 1 << 30);
    document.apply(&Command::Undo { steps: Some(1) }).unwrap();
    assert!(*document.contents() == carved);
}

#[test]
fn replacing_is_one_step_and_marks_all_dirty() {
    let new = painted(UVec3::splat(16), ColourDepth::Bits8, true);
    let mut document = Document::new(&new, Limits::default()).unwrap();
    document.apply(&ball(EditOp::Recolour(RED), Vec3::splat(8.0), 4.0)).unwrap();
    document.drain_changes(|_, _| ());
    let before = document.contents().clone();
    let grid = Grid::new(UVec3::new(9, 30, 4), Vec3::ONE, 1 << 20).unwrap();
    let other = Contents::new(grid.clone(), Material::for_grid(&grid, ColourDepth::None, RED));
    document.replace(other.clone(), "open").unwrap();
    assert!(document.drain_changes(|_, dirty| dirty.is_none()));
    document.apply(&ball(EditOp::Add(Some(RED)), Vec3::new(4.0, 20.0, 2.0), 3.0)).unwrap();
    assert!(document.drain_changes(|_, dirty| dirty.is_some_and(|d| !d.is_empty())));
    assert!(document.grid().get(IVec3::new(4, 20, 2)));
    document.apply(&Command::Undo { steps: Some(2) }).unwrap();
    assert_eq!(document.contents(), &before);
    assert!(document.drain_changes(|_, dirty| dirty.is_none()));
    assert!(document.drain_changes(|_, dirty| dirty.is_some_and(<[u32]>::is_empty)));
    document.apply(&Command::Redo { steps: Some(1) }).unwrap();
    assert_eq!(document.contents(), &other);
}
