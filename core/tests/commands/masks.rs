//! Masks: no command changes protected voxels, and masks are undone, saved and oriented with the sculpture.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Command, MaskArea, MaskChange, NewSculpture, PatchRule};
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::format::Texts;
use sculpture_core::format::history::{ContentsShape, read_step, write_step};
use sculpture_core::format::{read_sculpture, write_sculpture};
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::orientation::Orientation;
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::tools::drawn::DrawnSolid;
use sculpture_core::tools::texture::Texture;

use super::strategies::{area, colour};
use super::uses::{self, Place};

/// Returns changes of the mask, with solids, voxels, numbers and lengths from the given strategies.
pub fn mask(
    drawn: impl Strategy<Value = DrawnSolid>,
    voxel: std::ops::Range<i32>,
    number: impl Strategy<Value = f32> + Clone,
    length: std::ops::Range<u32>,
) -> impl Strategy<Value = MaskChange> {
    let at = || prop::array::uniform3(voxel.clone()).prop_map(IVec3::from);
    let rule = prop_oneof![
        number.clone().prop_map(PatchRule::Colour),
        number.clone().prop_map(PatchRule::Flat),
    ];
    let what = prop_oneof![
        area().prop_map(MaskArea::Area),
        drawn.prop_map(MaskArea::DrawnSolid),
        (colour(), number).prop_map(|(colour, tolerance)| MaskArea::Colour { colour, tolerance }),
        (length.clone(), length.clone())
            .prop_map(|(reach_vx, depth_vx)| MaskArea::Cavities { reach_vx, depth_vx }),
        (at(), rule, length.clone()).prop_map(|(at, by, depth_vx)| MaskArea::Patch {
            at,
            by,
            depth_vx
        }),
        at().prop_map(|at| MaskArea::Piece { at }),
    ];
    prop_oneof![
        1 => Just(MaskChange::Clear),
        1 => Just(MaskChange::Invert),
        1 => length.clone().prop_map(MaskChange::Grow),
        1 => length.clone().prop_map(MaskChange::Shrink),
        1 => length.prop_map(MaskChange::Smooth),
        4 => (any::<bool>(), what).prop_map(|(adds, what)| MaskChange::Put { adds, what }),
    ]
}

const DIMS: UVec3 = UVec3::new(40, 33, 28);

fn document() -> Document {
    let new = NewSculpture {
        dims: DIMS,
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb::STONE,
        solid: false,
        room_vx: 0,
        grows: false,
    };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    let stripes = (0..64).map(|i| if i % 8 < 4 { Rgb::STONE } else { Rgb::new(1, 2, 3) });
    document.learn_picture(uses::PICTURE.as_ref(), Texture::new(8, stripes.collect()).unwrap());
    // Clay with a rounded top, a tower, a piece of its own and a cavity, in two colours.
    for line in [
        "add cuboid at=20,8,14 half=18,8,13 colour=#c08040",
        "add ellipsoid at=20,16,14 half=10,6,9",
        "add cylinder at=8,20,8 half=3,8,3 colour=#2040ff",
        "add cuboid at=33,26,20 half=3",
        "subtract ellipsoid at=20,9,14 half=3",
    ] {
        run(&mut document, line).unwrap();
    }
    document
}

fn run(document: &mut Document, line: &str) -> Result<u64, CommandError> {
    let command: Command = line.parse().unwrap_or_else(|error| panic!("{line}: {error}"));
    document.apply(&command).map(|applied| applied.stats.voxels_changed())
}

fn every() -> impl Iterator<Item = IVec3> {
    let d = DIMS.as_ivec3();
    (0..d.z)
        .flat_map(move |z| (0..d.y).flat_map(move |y| (0..d.x).map(move |x| IVec3::new(x, y, z))))
}

fn masked(contents: &Contents) -> usize {
    every().filter(|v| contents.is_masked(*v)).count()
}

/// All commands that change voxels, except those that reorient or replace the whole sculpture.
const CHANGES: &[&str] = &[
    "add ellipsoid at=20,16,14 half=12 colour=#ff0000",
    "subtract cuboid at=20,12,14 half=30 turn=10,20,30",
    "recolour torus at=20,16,14 half=16,6,16 colour=#00ff00",
    "add half-space at=0,16,0 normal=0,1,0",
    "subtract cone at=8,14,8 half=6 turn=60,0,0 to=30,20,20",
    "add capsule at=8,14,8 half=5 to=34,26,20 colour=#808000",
    "subtract tube points=0,16,14,6;20,18,14,4;40,10,14,5",
    "recolour extrusion at=20,16,14 depth=60 outline=-20,-20;20,-20;20,20;-20,20 colour=#123456",
    "spray paintbrush eye=20,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=24 colour=#ffff00",
    "spray devourer eye=20,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=24 reach=4",
    "spray clay eye=20,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=24 reach=6 colour=#ffffff",
    "spray erosion eye=20,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=24",
    "spray dilation eye=20,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=24",
    "spray growth eye=20,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=24",
    "spray smooth eye=20,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=24 reach=6",
    "grab at=20,20,14 radius=14 by=5,6,-3",
    "deform inflate at=20,20,14 radius=14 height=4",
    "deform flatten at=20,20,14 radius=14 normal=0,1,0 strength=1",
    "deform scrape at=20,18,14 radius=14 normal=0,1,0 strength=1",
    "deform fill at=20,20,14 radius=14 normal=0,1,0 strength=1",
    "deform draw at=20,22,14 radius=14 normal=0,1,0 height=5",
    "deform crease at=20,22,14 radius=14 normal=0,1,0 height=-5",
    "deform pinch at=20,20,14 radius=14 normal=0,1,0 strength=0.8",
    "deform twist at=20,20,14 radius=14 normal=0,1,0 angle=60",
    "fill grid colour=#010203",
    "clear grid",
    "dye grid colour=#0a0b0c",
    "adjust grid hue=120",
    "gradient grid from=0,0,0 to=0,30,0 colour=#ff0000 end=#0000ff",
    "noise grid colour=#204060 size=8 amount=1",
    "remove-islands keep=largest",
    "fill-cavities",
    "thicken to=8",
    "drain diameter=3",
    "cut",
    "move by=7,3,2",
];

/// These, and a use of every tool that does not change the mask.
fn changes() -> Vec<String> {
    let place = Place {
        at_vx: Vec3::new(20.0, 14.0, 14.0),
        ball_vx: Vec3::new(20.0, 22.0, 14.0),
        further_vx: Vec3::new(8.0, 16.0, 8.0),
        eye_vx: Vec3::new(20.0, 90.0, 14.0),
        aim: Vec3::NEG_Y,
    };
    let uses = uses::of_every_tool(&place);
    let uses = uses.iter().filter(|command| !uses::is_of_mask(command)).map(Command::to_string);
    CHANGES.iter().map(|line| line.to_string()).chain(uses).collect()
}

#[test]
fn nothing_that_is_masked_changes_and_the_rest_does() {
    for mirrored in ["symmetry", "symmetry x=even"] {
        for line in &changes() {
            let mut document = document();
            run(&mut document, mirrored).unwrap();
            run(&mut document, "mark at=6,2,4 size=24,24,20").unwrap();
            run(&mut document, "mask add ellipsoid at=14,18,10 half=7,8,7").unwrap();
            run(&mut document, "mask add cuboid at=33,26,20 half=2").unwrap();
            let before = document.contents().clone();
            let changed = run(&mut document, line).unwrap();
            let after = document.contents();
            assert_eq!(after.mask, before.mask, "{line}");
            for v in every().filter(|v| before.is_masked(*v)) {
                assert_eq!(after.grid.get(v), before.grid.get(v), "{line}: {v}");
                assert_eq!(after.rgb(v.as_uvec3()), before.rgb(v.as_uvec3()), "{line}: {v}");
            }
            assert!(changed > 0 && *after != before, "{line} has changed nothing at all");
            run(&mut document, "undo").unwrap();
            assert!(*document.contents() == before, "{line}: undo");
        }
    }
}

#[test]
fn pasting_and_repeating_change_no_masked_voxel() {
    let mut document = document();
    run(&mut document, "mark at=4,0,4 size=12,30,12").unwrap();
    run(&mut document, "copy").unwrap();
    run(&mut document, "mask add grid").unwrap();
    run(&mut document, "mask subtract cuboid at=30,20,14 half=3").unwrap();
    let before = document.contents().clone();
    assert!(run(&mut document, "paste at=24,4,8").unwrap() > 0);
    assert!(run(&mut document, "add ellipsoid at=20,20,14 half=3").is_ok());
    run(&mut document, "array count=4 step=3,0,0").unwrap();
    for v in every().filter(|v| before.is_masked(*v)) {
        assert_eq!(document.contents().colour(v), before.colour(v), "{v}");
    }
    // Copying ignores the mask; cutting removes only unprotected voxels.
    let protected = "mask add grid";
    run(&mut document, protected).unwrap();
    assert!(run(&mut document, "copy").is_ok());
    assert!(matches!(run(&mut document, "cut"), Err(CommandError::NothingMarked(_))));
    assert!(matches!(run(&mut document, "move by=1,0,0"), Err(CommandError::NothingMarked(_))));
}

/// All changes of masks, each after the previous ones.
const MASKS: &[&str] = &[
    "mask add ellipsoid at=14,18,10 half=7,8,7",
    "mask add tube points=0,16,14,3;20,18,14,4;40,10,14,2",
    "mask grow by=2",
    "mask smooth around=2",
    "mask subtract cuboid at=14,18,10 half=4 turn=10,20,30",
    "mask shrink by=1",
    "mask invert",
    "mask subtract selection",
    "mask add marker",
    "spray mask eye=20,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=9 reach=4",
    "spray unmask eye=24,90,14 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=5 reach=6",
    "mask clear",
    "mask add colour colour=#2040ff tolerance=0.05",
    "mask add cavities within=3 depth=1",
    "mask add patch at=20,15,26 angle=20 depth=2",
    "mask add patch at=8,27,8 tolerance=0.1",
    "mask add piece at=33,28,20",
    "mask subtract grid",
];

#[test]
fn changes_of_masks_are_undone_exactly_and_change_no_voxel() {
    let mut document = document();
    run(&mut document, "mark at=2,2,2 size=20,12,12").unwrap();
    run(&mut document, "select add").unwrap();
    let mut states = vec![document.contents().clone()];
    for line in MASKS {
        let changed = run(&mut document, line).unwrap();
        let now = document.contents().clone();
        let before = states.last().unwrap();
        assert!(now.grid == before.grid && now.material == before.material, "{line}");
        let differing = every().filter(|v| now.is_masked(*v) != before.is_masked(*v)).count();
        // Voxels that are removed and added again at once are counted twice.
        assert!(differing > 0 && changed >= differing as u64, "{line}: {changed}, {differing}");
        assert!(now.mask.as_ref().is_none_or(|mask| mask.opaque_count() > 0));
        assert_eq!(document.history().undo_labels().last(), Some(label(line)), "{line}");
        states.push(now);
    }
    assert!(document.mask().is_none());
    for state in states.iter().rev().skip(1) {
        run(&mut document, "undo").unwrap();
        assert!(document.contents() == state);
    }
    for state in &states[1..] {
        run(&mut document, "redo").unwrap();
        assert!(document.contents() == state);
    }
}

fn label(line: &str) -> &str {
    match line.starts_with("spray ") {
        true => line.split(' ').nth(1).unwrap(),
        false => {
            let words = line.match_indices(' ').nth(1).map_or(line.len(), |(at, _)| at);
            &line[..words]
        }
    }
}

#[test]
fn a_stroke_may_mask_and_sculpt_and_is_one_step() {
    let mut document = document();
    let before = document.contents().clone();
    for line in [
        "begin",
        "subtract ellipsoid at=20,20,14 half=5",
        "mask add ellipsoid at=20,20,14 half=4",
        "add ellipsoid at=20,20,14 half=5 colour=#ff0000",
        "mask grow",
        "grab at=20,16,14 radius=8 by=3,4,0 surface=stroke",
        "mask add marker",
    ] {
        run(&mut document, line).unwrap();
    }
    // A pull from the stroke's start reverts the earlier changes, masks as well.
    let marker = document.selection().marker();
    assert!(every().all(|v| document.contents().is_masked(v) == marker.contains(v)));
    run(&mut document, "end").unwrap();
    let after = document.contents().clone();
    run(&mut document, "undo").unwrap();
    assert!(*document.contents() == before);
    run(&mut document, "redo").unwrap();
    assert!(*document.contents() == after);
    run(&mut document, "begin").unwrap();
    run(&mut document, "mask invert").unwrap();
    run(&mut document, "clear").unwrap();
    run(&mut document, "cancel").unwrap();
    assert!(*document.contents() == after);
}

#[test]
fn masks_and_their_steps_are_kept_in_files_to_the_byte() {
    let mut document = document();
    for line in ["mask add ellipsoid at=14,18,10 half=7,8,7", "mask invert"] {
        run(&mut document, line).unwrap();
        let contents = document.contents();
        let file = write_sculpture(contents, &Texts::default()).unwrap();
        assert!(read_sculpture(&file, &Limits::default()).unwrap().0 == *contents);
        for cut in [1, 40, 100] {
            assert!(read_sculpture(&file[..file.len() - cut], &Limits::default()).is_err());
        }
        let step = document.history().undo_steps().next().unwrap();
        let packed = write_step(step).unwrap();
        let shape = ContentsShape::of(contents);
        let read = read_step(&packed, shape, &Limits::default()).unwrap();
        assert_eq!((&read.label, read.state), (&step.label, step.state));
        assert!(read.change == step.change);
        assert!(read_step(&packed[..packed.len() - 1], shape, &Limits::default()).is_err());
    }
    let without =
        write_sculpture(&Contents { mask: None, ..document.contents().clone() }, &Texts::default());
    assert_eq!(without.unwrap()[8], 1, "files without a mask are of version 1");
}

#[test]
fn a_mask_is_reoriented_with_the_sculpture() {
    for orientation in Orientation::all() {
        let mut document = document();
        run(&mut document, "mask add ellipsoid at=14,18,10 half=7,8,7").unwrap();
        let before = document.contents().clone();
        run(&mut document, &format!("orient axes={orientation}")).unwrap();
        if orientation == Orientation::UPRIGHT {
            assert!(*document.contents() == before);
            continue;
        }
        let after = document.contents();
        for v in every() {
            let there = orientation.destination(v, DIMS);
            assert_eq!(after.is_masked(there), before.is_masked(v), "{orientation} {v}");
        }
        run(&mut document, "undo").unwrap();
        assert!(*document.contents() == before);
    }
}

#[test]
fn masks_are_mirrored_and_limited_to_the_selection() {
    let mut document = document();
    run(&mut document, "clear").unwrap();
    run(&mut document, "add cuboid at=20,8,14 half=18,8,13").unwrap();
    run(&mut document, "symmetry x=even").unwrap();
    run(&mut document, "mask add ellipsoid at=8,20,8 half=5").unwrap();
    run(
        &mut document,
        "spray mask eye=8.5,90,20.5 aim=0,-1,0 across=0.01,0,0 down=0,0,0.01 radius=6",
    )
    .unwrap();
    let contents = document.contents();
    assert!(masked(contents) > 300);
    for v in every() {
        assert_eq!(contents.is_masked(v), contents.is_masked(v.with_x(39 - v.x)), "{v}");
    }
    run(&mut document, "symmetry").unwrap();
    run(&mut document, "mask clear").unwrap();
    run(&mut document, "mark at=10,10,10 size=5,6,7").unwrap();
    run(&mut document, "select add").unwrap();
    run(&mut document, "limit on").unwrap();
    run(&mut document, "mask add grid").unwrap();
    let marker = document.selection().marker();
    assert!(every().all(|v| document.contents().is_masked(v) == marker.contains(v)));
    run(&mut document, "mask invert").unwrap();
    assert!(document.mask().is_none(), "outside of the selection nothing is inverted");
}

#[test]
fn invalid_masks_are_refused() {
    let mut document = document();
    let before = document.contents().clone();
    for line in [
        "mask grow by=0",
        "mask grow by=65",
        "mask shrink by=65",
        "mask smooth around=9",
        "mask add selection",
        "mask add ellipsoid at=1,1,1 half=0",
        "mask add colour colour=#000000 tolerance=2",
        "mask add cavities within=5",
        "mask add cavities depth=5",
        "mask add patch at=20,15,26 angle=181",
        "mask add patch at=20,15,26 tolerance=-1",
        "mask add patch at=0,32,0 angle=10",
        "mask add piece at=4000000000,0,0",
    ] {
        assert!(run(&mut document, line).is_err(), "{line}");
    }
    for text in [
        "mask",
        "mask add",
        "mask freeze",
        "mask add nonsense",
        "mask add patch at=1,2,3 angle=3 tolerance=0.1",
        "mask grow by=-1",
        "mask add cavities within=nan",
    ] {
        assert!(text.parse::<Command>().is_err(), "{text}");
    }
    assert!(*document.contents() == before);
    // Without a mask, there is nothing to change.
    for line in ["mask clear", "mask shrink", "mask grow", "mask smooth", "mask subtract grid"] {
        assert_eq!(run(&mut document, line).unwrap(), 0, "{line}");
    }
    assert!(*document.contents() == before);
    assert!(document.history().undo_labels().last().unwrap().starts_with("subtract"));
    let new = NewSculpture {
        dims: UVec3::splat(64),
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::None,
        base: Rgb::STONE,
        solid: true,
        room_vx: 0,
        grows: false,
    };
    let limits = Limits { grid_bytes: 4 << 10, ..Limits::default() };
    let mut small = Document::new(&new, limits).unwrap();
    assert_eq!(run(&mut small, "mask add grid").unwrap(), 64 * 64 * 64);
    run(&mut small, "mask clear").unwrap();
    let refused =
        run(&mut small, "mask add ellipsoid at=32,32,32 half=30").unwrap_err().to_string();
    assert!(refused.contains("MiB allowed for grids"), "{refused}");
    assert!(matches!(
        run(&mut small, "mask add colour colour=#000000"),
        Err(CommandError::NoColour)
    ));
}

proptest! {
    /// Empty and full grids, masks at the border, and everything combined.
    #[test]
    fn a_mask_holds_whatever_is_done(
        masks in prop::collection::vec(prop::sample::select(MASKS), 1..4),
        changes in prop::collection::vec(prop::sample::select(changes()), 1..4),
        fill in prop::sample::select(&["fill grid", "clear grid", "dye grid colour=#112233"][..]),
    ) {
        let mut document = document();
        run(&mut document, fill).unwrap();
        // Changes for which the grid has no suitable voxel are refused.
        masks.iter().for_each(|line| drop(run(&mut document, line)));
        let before = document.contents().clone();
        changes.iter().for_each(|line| drop(run(&mut document, line)));
        for v in every().filter(|v| before.is_masked(*v)) {
            prop_assert_eq!(document.contents().colour(v), before.colour(v), "{}", v);
        }
        run(&mut document, "undo all").unwrap();
        prop_assert_eq!(document.grid().opaque_count(), 0);
        prop_assert!(document.mask().is_none());
    }
}
