//! Selection, symmetry, copies and arrays, compared with their definition voxel by voxel.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Area, Command, NewSculpture, SelectOp};
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::sculpture::orientation::Orientation;
use sculpture_core::sculpture::region::VoxelBox;
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::tools::symmetry::{Parity, Symmetry};
use sculpture_core::tools::texture::Texture;

use super::strategies::{area_work, marker, new_sculpture, op, orientation, primitive, work};

const RED: Rgb = Rgb::new(255, 0, 0);

fn voxels(dims: UVec3) -> impl Iterator<Item = IVec3> {
    let d = dims.as_ivec3();
    (0..d.z)
        .flat_map(move |z| (0..d.y).flat_map(move |y| (0..d.x).map(move |x| IVec3::new(x, y, z))))
}

fn document(dims: [u32; 3], solid: bool) -> Document {
    let new = NewSculpture {
        dims: dims.into(),
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb::STONE,
        solid,
        room_vx: 0,
        grows: false,
    };
    Document::new(&new, Limits::default()).unwrap()
}

fn run(document: &mut Document, script: &str) {
    for line in script.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let command: Command = line.parse().unwrap();
        document.apply(&command).unwrap_or_else(|error| panic!("{line}: {error}"));
    }
}

/// Returns any command of normal work.
fn any_work() -> impl Strategy<Value = Command> {
    prop_oneof![1 => work(), 2 => area_work()]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, ..ProptestConfig::default() })]

    #[test]
    fn work_respects_the_limit_is_refused_as_a_whole_and_undone_exactly(
        new in new_sculpture(24),
        commands in prop::collection::vec(any_work(), 1..40),
    ) {
        let mut document = Document::new(&new, Limits::default()).unwrap();
        let mut begun = document.contents().clone();
        for command in &commands {
            let before = document.contents().clone();
            if !document.stroke_open() {
                begun = before.clone();
            }
            let selection = document.selection().clone();
            let steps = document.history().undo_count();
            let result = document.apply(command);
            if result.is_err() {
                prop_assert_eq!(document.contents(), &before, "{}", command);
                prop_assert_eq!(document.selection(), &selection, "{}", command);
                prop_assert_eq!(document.history().undo_count(), steps);
                continue;
            }
            let free = matches!(
                command,
                Command::New(_)
                    | Command::Orient(_)
                    | Command::Undo { .. }
                    | Command::Redo { .. }
                    | Command::Cancel
            );
            // It reverts the stroke so far, wherever that was, and pulls within the limit.
            let replaces = matches!(command, Command::Brush(used) if used.replaces_stroke());
            let before = if replaces { &begun } else { &before };
            if let (Some(stack), false) = (selection.limit(), free) {
                for v in voxels(before.grid.dims()).filter(|v| !stack.contains(*v)) {
                    let (was, is) = (before.colour(v), document.contents().colour(v));
                    prop_assert_eq!(was, is, "{} at {}", command, v);
                }
            }
        }
        if document.stroke_open() {
            document.apply(&Command::End).unwrap();
        }
        let end = document.contents().clone();
        // As long as there are steps: the oldest may precede an earlier `undo all`.
        document.apply(&Command::Undo { steps: None }).unwrap();
        let start = Document::new(&new, Limits::default()).unwrap();
        prop_assert_eq!(document.contents(), start.contents());
        document.apply(&Command::Redo { steps: None }).unwrap();
        let undone = document.history().redo_count();
        prop_assert_eq!(undone, 0);
        if !commands.iter().any(|c| matches!(c, Command::Undo { .. })) {
            prop_assert_eq!(document.contents(), &end);
        }
    }

    #[test]
    fn a_copy_is_pasted_voxel_by_voxel(
        shapes in prop::collection::vec((op(), primitive(0.0..20.0, 1.0..9.0)), 1..5),
        from in marker(-6..20, 18),
        at in prop::array::uniform3(-12i32..20),
        orientation in orientation(),
        cut in any::<bool>(),
    ) {
        let mut document = document([20, 17, 23], false);
        for (op, primitive) in shapes {
            document.apply(&Command::Construct { op, primitive, to_vx: None }).unwrap();
        }
        document.apply(&Command::Mark(from)).unwrap();
        let before = document.contents().clone();
        let taken = if cut { Command::Cut } else { Command::Copy };
        let bounds = from.intersect(VoxelBox::of_grid(&before.grid));
        let held: Vec<(IVec3, Rgb)> = voxels(before.grid.dims())
            .filter(|v| from.contains(*v))
            .filter_map(|v| Some((v, before.colour(v)?)))
            .collect();
        if held.is_empty() {
            prop_assert!(matches!(document.apply(&taken), Err(CommandError::NothingMarked(_))));
            return Ok(());
        }
        document.apply(&taken).unwrap();
        let mut wanted: Vec<Option<Rgb>> = voxels(before.grid.dims())
            .map(|v| before.colour(v).filter(|_| !(cut && from.contains(v))))
            .collect();
        let at = IVec3::from(at);
        let size = bounds.size();
        let turned = orientation.size(size).as_ivec3();
        for (target, slot) in voxels(before.grid.dims()).zip(&mut wanted) {
            let local = target - at;
            if local.cmpge(IVec3::ZERO).all() && local.cmplt(turned).all() {
                let source = bounds.min + orientation.source(local, size);
                if let Some((_, colour)) = held.iter().find(|(v, _)| *v == source) {
                    *slot = Some(*colour);
                }
            }
        }
        document.apply(&Command::Paste { at, orientation }).unwrap();
        let got: Vec<_> =
            voxels(before.grid.dims()).map(|v| document.contents().colour(v)).collect();
        prop_assert_eq!(got, wanted);
        document.apply(&Command::Undo { steps: None }).unwrap();
        prop_assert_eq!(document.grid().opaque_count(), 0);
    }

    #[test]
    fn an_array_repeats_the_operation_at_offsets(
        shapes in prop::collection::vec((op(), primitive(0.0..24.0, 1.0..6.0)), 1..4),
        step in prop::array::uniform3(-8i32..8),
        count in 1u32..5,
    ) {
        let step = IVec3::from(step);
        let (mut one, mut other) = (document([24; 3], true), document([24; 3], true));
        one.apply(&Command::Begin { label: "three".into() }).unwrap();
        for i in 0..=count {
            for (op, primitive) in &shapes {
                let mut primitive = *primitive;
                primitive.centre_vx += (step * i as i32).as_vec3();
                let construct = Command::Construct { op: *op, primitive, to_vx: None };
                other.apply(&construct).unwrap();
                if i == 0 {
                    one.apply(&construct).unwrap();
                }
            }
        }
        one.apply(&Command::End).unwrap();
        let before = one.contents().clone();
        let steps = one.history().undo_count();
        one.apply(&Command::Array { count, step }).unwrap();
        prop_assert_eq!(one.contents(), other.contents());
        if one.contents() != &before {
            prop_assert_eq!(one.history().undo_count(), steps + 1);
            one.apply(&Command::Undo { steps: Some(1) }).unwrap();
            prop_assert_eq!(one.contents(), &before);
        }
    }
}

#[test]
fn mirrored_tools_leave_a_mirrored_sculpture() {
    // The plane stands in the middle of the block.
    for (parity, edge) in [(Parity::Even, 32), (Parity::Odd, 33)] {
        for axes in 1..8 {
            let mut document = document([edge; 3], true);
            let axes: [Option<Parity>; 3] =
                std::array::from_fn(|axis| (axes >> axis & 1 == 1).then_some(parity));
            document.apply(&Command::Symmetry(Symmetry::of_axes(axes))).unwrap();
            run(
                &mut document,
                "subtract ellipsoid at=9.2,25.1,11.7 half=5.3,4,6.6 turn=20,30,40
                 subtract pyramid at=20.4,6.3,7.9 half=5,8,5 turn=-30,10,70
                 recolour cuboid at=3.3,14.6,28.2 half=7,5,4 turn=11,22,33 colour=#ff0000
                 spray devourer eye=90.3,60.2,80.1 aim=-80,-48,-70 across=1,0,-1 down=0,-1.5,0 \
                 radius=3 reach=3",
            );
            let (contents, planes) =
                (document.contents(), document.symmetry().planes(UVec3::splat(edge)));
            assert!(contents.grid.opaque_count() < u64::from(edge).pow(3) - 500);
            for v in voxels(contents.grid.dims()) {
                for (axis, plane) in planes.iter().enumerate() {
                    let Some(plane) = plane else { continue };
                    let mut other = v;
                    other[axis] = (2.0 * plane) as i32 - 1 - v[axis];
                    assert_eq!(contents.colour(v), contents.colour(other), "{v}");
                }
            }
        }
    }
}

#[test]
fn moving_rotates_about_the_centre_and_moves_the_marker() {
    let mut document = document([40, 30, 20], false);
    run(
        &mut document,
        "add cuboid at=10,10,10 half=4,2,1 colour=#ff0000
         recolour cuboid at=7,10,10 half=1,2,1 colour=#00ff00
         mark at=6,8,9 size=8,4,2",
    );
    let before = document.contents().clone();
    run(&mut document, "move by=5,0,0 axes=y,-x,z");
    let moved = VoxelBox { min: IVec3::new(13, 6, 9), max: IVec3::new(17, 14, 11) };
    assert_eq!(document.selection().marker(), moved);
    assert_eq!(document.grid().opaque_count(), before.grid.opaque_count());
    // The left end is now the lower one: x has become y.
    assert_eq!(document.contents().colour(IVec3::new(14, 6, 9)), Some(Rgb::new(0, 255, 0)));
    run(&mut document, "move by=-5,0,0 axes=-y,x,z");
    for v in voxels(before.grid.dims()) {
        assert_eq!(document.contents().colour(v), before.colour(v), "{v}");
    }
    assert_eq!(document.history().undo_count(), 4);
}

#[test]
fn areas_are_filled_cleared_and_recoloured() {
    let mut document = document([16; 3], false);
    assert!(matches!(
        document.apply(&Command::Fill { area: Area::Selection, colour: None }),
        Err(CommandError::NothingSelected)
    ));
    assert!(matches!(
        document.apply(&Command::Select(SelectOp::Drop)),
        Err(CommandError::NothingSelected)
    ));
    run(
        &mut document,
        "mark at=0,0,0 size=8,8,8
         select add
         mark at=4,4,4 size=4,4,4
         select subtract
         fill selection colour=#ff0000",
    );
    assert_eq!(document.grid().opaque_count(), 512 - 64);
    run(&mut document, "limit on\nclear grid\nfill colour=#0000ff\nlimit off");
    assert_eq!(document.grid().opaque_count(), 512 - 64);
    run(&mut document, "fill marker\ndye marker colour=#00ff00\nselect drop\nclear selection");
    assert_eq!(document.grid().opaque_count(), 0);
    assert_eq!(document.history().undo_labels().last(), Some("clear selection"));
}

#[test]
fn arrays_of_arrays_and_their_bounds() {
    let mut document = document([64; 3], false);
    let array = |count, x, z| Command::Array { count, step: IVec3::new(x, 0, z) };
    assert!(matches!(document.apply(&array(1, 8, 0)), Err(CommandError::NothingToRepeat)));
    run(&mut document, "add cuboid at=2,2,2 half=2 colour=#ff0000\narray count=7 step=8,0,0");
    run(&mut document, "array count=7 step=0,0,8");
    assert_eq!(document.grid().opaque_count(), 64 * 64);
    assert_eq!(document.history().undo_count(), 3);
    for count in [0, 2000] {
        let refused = document.apply(&array(count, 1, 0));
        let Err(CommandError::Invalid(invalid)) = refused else { panic!("{count}: {refused:?}") };
        assert_eq!((invalid.field, invalid.value), ("array", Some(count.to_string())));
    }
    run(&mut document, "undo");
    assert!(matches!(document.apply(&array(1, 8, 0)), Err(CommandError::NothingToRepeat)));
    assert_eq!(document.grid().opaque_count(), 64 * 8);
}

#[test]
fn a_picture_colours_existing_voxels_inside_a_solid() {
    let mut document = document([32; 3], true);
    let texture: Command = "texture flag.png cuboid at=16,16,16 half=8".parse().unwrap();
    assert!(matches!(document.apply(&texture), Err(CommandError::NoPicture(_))));
    let blue = Rgb::new(0, 0, 255);
    // The left half is red, the right half blue.
    let flag = Texture::new(16, (0..16 * 2).map(|i| [RED, blue][i / 8 % 2]).collect()).unwrap();
    document.learn_picture("flag.png".as_ref(), flag);
    let applied = document.apply(&texture).unwrap();
    assert_eq!(applied.stats.voxels_recoloured, 16 * 16 * 16);
    // The front, seen from +z.
    assert_eq!(document.contents().colour(IVec3::new(9, 16, 23)), Some(RED));
    assert_eq!(document.contents().colour(IVec3::new(22, 16, 23)), Some(blue));
    // The right side, seen from +x: towards -z is right.
    assert_eq!(document.contents().colour(IVec3::new(23, 16, 21)), Some(RED));
    assert_eq!(document.contents().colour(IVec3::new(23, 16, 9)), Some(blue));
    assert_eq!(document.contents().colour(IVec3::new(7, 16, 16)), Some(Rgb::STONE));
    document.apply(&Command::Undo { steps: Some(1) }).unwrap();
    assert_eq!(document.material().page_count(), 0);
    let orientation = Orientation::UPRIGHT;
    assert!(matches!(
        document.apply(&Command::Paste { at: IVec3::ZERO, orientation }),
        Err(CommandError::NothingToPaste)
    ));
}
