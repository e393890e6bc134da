//! Changes of colours, voxel by voxel, and flood fills, as commands.

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::command::text::parse_script;
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::refusal::{MemoryBudget, OverBudget};
use sculpture_core::sculpture::{ColourDepth, Rgb};

const TINTS: [&str; 3] = [
    "adjust hue=90 saturation=1.5 value=0.5",
    "gradient from=0,0,0 to=0,30,0 colour=#ff0000 end=#0000ff",
    "noise colour=#204060 size=8 amount=1",
];

fn block(colour_depth: ColourDepth, limits: Limits) -> Document {
    let new = NewSculpture {
        dims: UVec3::new(40, 33, 24),
        voxel_size: Vec3::ONE,
        colour_depth,
        base: Rgb::STONE,
        solid: true,
        room_vx: 0,
        grows: false,
    };
    Document::new(&new, limits).unwrap()
}

fn run(document: &mut Document, line: &str) -> Result<u64, CommandError> {
    let command: Command = line.parse().unwrap();
    document.apply(&command).map(|applied| applied.stats.voxels_changed())
}

#[test]
fn a_tint_changes_its_area_and_is_one_step() {
    for tint in TINTS {
        for area in ["grid", "marker", "selection"] {
            let mut document = block(ColourDepth::Bits24, Limits::default());
            run(&mut document, "mark at=3,0,5 size=9,40,7").unwrap();
            run(&mut document, "select add").unwrap();
            run(&mut document, "mark at=12,9,5 size=7,8,9").unwrap();
            let start = document.contents().clone();
            let (verb, rest) = tint.split_once(' ').unwrap();
            let changed = run(&mut document, &format!("{verb} {area} {rest}")).unwrap();
            assert!(changed > 300, "{tint} {area}: {changed}");
            let selection = document.selection().clone();
            let end = document.contents().clone();
            for i in 0..40 * 33 * 24 {
                let v = IVec3::new(i % 40, i / 40 % 33, i / (40 * 33));
                let is_meant = match area {
                    "marker" => selection.marker().contains(v),
                    "selection" => selection.stack().contains(v),
                    _ => true,
                };
                assert!(is_meant || start.colour(v) == end.colour(v), "{tint} {area} {v}");
            }
            assert_eq!(document.history().undo_count(), 1);
            run(&mut document, "undo").unwrap();
            assert!(document.contents() == &start);
            run(&mut document, "redo").unwrap();
            assert!(document.contents() == &end);
        }
    }
}

#[test]
fn a_tint_that_changes_no_colour_is_no_step() {
    let mut document = block(ColourDepth::Bits24, Limits::default());
    for nothing in [
        "adjust",
        "adjust hue=-360",
        "gradient from=0,0,0 to=0,30,0 colour=#ff0000 end=#0000ff strength=0",
        "noise colour=#204060 amount=0",
        "flood at=0,0,0 colour=#c8beaa",
    ] {
        assert_eq!(run(&mut document, nothing).unwrap(), 0, "{nothing}");
    }
    run(&mut document, "clear").unwrap();
    for tint in TINTS {
        assert_eq!(run(&mut document, tint).unwrap(), 0, "{tint} of nothing");
    }
    assert_eq!(document.history().undo_count(), 1);
    assert_eq!(document.material().page_count(), 0);
}

#[test]
fn tints_that_cannot_be_are_refused_and_change_nothing() {
    let little = Limits { colour_bytes: 30 << 10, ..Limits::default() };
    let mut document = block(ColourDepth::Bits24, little);
    for tint in TINTS {
        let refused = run(&mut document, tint);
        assert!(
            matches!(
                refused,
                Err(CommandError::OverBudget(OverBudget { budget: MemoryBudget::Colours, .. }))
            ),
            "{tint}"
        );
    }
    assert_eq!(document.material().page_count(), 0);
    let mut document = block(ColourDepth::None, Limits::default());
    for tint in TINTS.into_iter().chain(["flood at=0,0,0 colour=#ff0000"]) {
        assert!(matches!(run(&mut document, tint), Err(CommandError::NoColour)), "{tint}");
    }
    let mut document = block(ColourDepth::Bits16, Limits::default());
    for (line, message) in [
        ("adjust selection hue=3", "nothing is selected"),
        ("adjust value=9", "the value is a factor from 0 to 8 (given: 9)"),
        (
            "noise colour=#ff0000 size=0",
            "the patches of the noise must be 1 to 1024 voxels large (given: 0)",
        ),
        (
            "flood at=0,0,0 colour=#ff0000 tolerance=2",
            "the tolerance must be a share from 0 to 1 (given: 2)",
        ),
        ("flood at=20,20,12 colour=#ff0000", "there is no voxel of the surface at [20, 20, 12]"),
        ("flood at=40,0,0 colour=#ff0000", "there is no voxel of the surface at [40, 0, 0]"),
        ("flood at=4294967295,0,0 colour=#ff0000", "there is no voxel of the surface"),
    ] {
        let error = run(&mut document, line).unwrap_err().to_string();
        assert!(error.starts_with(message), "{line}: {error}");
    }
    assert_eq!(document.history().undo_count(), 0);
}

#[test]
fn a_flood_stops_at_other_colours_and_at_the_selection_and_is_mirrored() {
    let red = Rgb::new(255, 0, 0);
    let mut document = block(ColourDepth::Bits24, Limits::default());
    // A belt of another colour separates the ends of the block.
    run(&mut document, "recolour cuboid at=20,16,12 half=4,30,30 colour=#00ff00").unwrap();
    let start = document.contents().clone();
    run(&mut document, "flood at=3,32,7 colour=#ff0000").unwrap();
    let colour = |document: &Document, x, y, z| document.contents().rgb(UVec3::new(x, y, z));
    assert_eq!(colour(&document, 0, 0, 0), red);
    assert_eq!(colour(&document, 15, 0, 23), red);
    assert_eq!(colour(&document, 39, 0, 0), Rgb::STONE);
    assert_eq!(colour(&document, 8, 16, 12), Rgb::STONE, "the inside");
    run(&mut document, "undo").unwrap();
    assert!(document.contents() == &start);
    run(&mut document, "symmetry x=even").unwrap();
    run(&mut document, "flood at=3,32,7 colour=#ff0000").unwrap();
    for i in 0..20 * 33 * 24 {
        let [x, y, z] = [i % 20, i / 20 % 33, i / (20 * 33)];
        assert_eq!(colour(&document, x, y, z), colour(&document, 39 - x, y, z), "{x} {y} {z}");
    }
    assert_eq!(colour(&document, 39, 0, 0), red);
    run(&mut document, "undo").unwrap();
    for line in ["symmetry", "mark at=0,0,0 size=40,5,40", "select add", "limit on"] {
        run(&mut document, line).unwrap();
    }
    run(&mut document, "flood at=3,32,7 colour=#ff0000 tolerance=1").unwrap();
    assert_eq!(colour(&document, 39, 4, 0), red);
    assert_eq!(colour(&document, 20, 0, 9), red, "all colours are within the tolerance");
    assert_eq!(colour(&document, 3, 32, 7), Rgb::STONE);
}

/// The script of the gallery: each command has an effect, and the flood fill stays within the pond.
#[test]
fn a_hill_is_coloured_by_commands() {
    let script = include_str!("../../../config/gallery/colours.sculpt");
    let script = parse_script(script).unwrap();
    let (_, Command::New(new)) = &script[0] else { panic!("no sculpture") };
    let mut document = Document::new(new, Limits::default()).unwrap();
    let mut last = 0;
    for (line, command) in &script[1..] {
        last = document.apply(command).unwrap().stats.voxels_changed();
        assert!(last > 500, "line {line}: {last}");
    }
    assert!(last < 3000, "{last}");
}
