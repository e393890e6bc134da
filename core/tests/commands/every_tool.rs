//! Every tool at the edges of what there is: on empty and full grids, at borders and corners and outside, with no strength.

use glam::{UVec3, Vec3};
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::tools::texture::Texture;

/// Each use of a tool, with `@` where it is and `%` a little further.
const USES: &[&str] = &[
    "add ellipsoid at=@ half=7,5,6 turn=10,20,30 colour=#ff0000",
    "subtract ellipsoid at=@ half=6 to=%",
    "add cuboid at=@ half=5,3,4 turn=10,20,30 to=% colour=#00ff00",
    "subtract pyramid at=@ half=7 to=%",
    "recolour cylinder at=@ half=6,3,5 turn=0,0,40 to=% colour=#00ff00",
    "add cone at=@ half=6 turn=70,0,0 to=%",
    "subtract torus at=@ half=8,3,8 turn=30,0,0 to=%",
    "add capsule at=@ half=4,8,4 to=% colour=#0000ff",
    "subtract rounded-cuboid at=@ half=6 turn=0,45,0 to=%",
    "subtract half-space at=@ normal=1,2,3",
    "add ring at=@ radius=7 tube=3 turn=20,30,40",
    "add lathe at=@ profile=0,-5;6,-3;2,6 turn=20,0,0",
    "subtract extrusion at=@ depth=12 outline=-4,-4;6,-2;0,5",
    "spray paintbrush eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 colour=#ffff00",
    "spray devourer eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 reach=3",
    "spray clay eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 reach=4 colour=#ffffff",
    "spray erosion eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9",
    "spray dilation eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9",
    "spray growth eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9",
    "spray smooth eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 reach=4",
    "spray mask eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 reach=3",
    "stencil \"stripes\" eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 cover=1",
    "mask add cuboid at=@ half=5 to=%",
    "grab at=@ radius=9 by=5,-4,3",
    "deform inflate at=@ radius=9 height=4",
    "deform inflate at=@ radius=9 height=-4",
    "deform flatten at=@ radius=9 normal=1,3,2 strength=1",
    "deform scrape at=@ radius=9 normal=1,3,2 strength=1",
    "deform fill at=@ radius=9 normal=1,3,2 strength=1",
    "deform draw at=@ radius=9 normal=1,3,2 height=4",
    "deform crease at=@ radius=9 normal=1,3,2 height=-4",
    "deform pinch at=@ radius=9 normal=1,3,2 strength=0.9",
    "deform twist at=@ radius=9 normal=1,3,2 angle=70",
];

/// The same tools with no strength; what may be refused is.
const WITHOUT_STRENGTH: &[&str] = &[
    "spray paintbrush eye=20,60,20 aim=0,-1,0 across=0.1,0,0 down=0,0,0.1 radius=9 colour=#ffff00 cover=0",
    "stencil \"stripes\" eye=20,60,20 aim=0,-1,0 across=0.1,0,0 down=0,0,0.1 radius=9 cover=0",
    "grab at=20,20,20 radius=9 by=0,0,0",
    "deform inflate at=20,20,20 radius=9 height=0",
    "deform flatten at=20,18,20 radius=9 normal=1,3,2 strength=0",
    "deform scrape at=20,18,20 radius=9 normal=1,3,2 strength=0",
    "deform fill at=20,22,20 radius=9 normal=1,3,2 strength=0",
    "deform draw at=20,20,20 radius=9 normal=1,3,2 height=0",
    "deform crease at=20,20,20 radius=9 normal=1,3,2 height=0",
    "deform pinch at=20,20,20 radius=9 normal=1,3,2 strength=0",
    "deform twist at=20,20,20 radius=9 normal=1,3,2 angle=0",
    "adjust grid hue=0",
    "noise grid colour=#204060 size=8 amount=0",
];

const DIMS: UVec3 = UVec3::new(41, 33, 28);

fn document(fill: &[&str], solid: bool) -> Document {
    let new = NewSculpture {
        dims: DIMS,
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::Bits24,
        base: Rgb::STONE,
        solid,
    };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    let stripes = (0..64).map(|i| if i % 8 < 4 { Rgb::STONE } else { Rgb::new(1, 2, 3) });
    document.learn_picture("stripes".as_ref(), Texture::new(8, stripes.collect()).unwrap());
    fill.iter().for_each(|line| assert!(run(&mut document, line).unwrap() > 0, "{line}"));
    document
}

fn run(document: &mut Document, line: &str) -> Result<u64, CommandError> {
    let command: Command = line.parse().unwrap_or_else(|error| panic!("{line}: {error}"));
    document.apply(&command).map(|applied| applied.stats.voxels_changed())
}

const CLAY: &[&str] =
    &["add cuboid at=20,8,14 half=22,12,15 colour=#c08040", "add ellipsoid at=20,18,14 half=9"];

#[test]
fn every_tool_works_at_borders_and_on_empty_and_full_grids_and_is_undone_exactly() {
    let places = [
        "20,20,14",
        "0,0,0",
        "41,33,28",
        "0,16.5,14",
        "20.5,33,0",
        "41,16,28",
        "-6,-6,-6",
        "20,-30,14",
        "1e6,16,14",
    ];
    for (fill, solid) in [(CLAY, false), (&[], false), (&[], true)] {
        let mut document = document(fill, solid);
        let before = document.contents().clone();
        for line in USES {
            let mut changed = 0;
            for place in places {
                let further = "33,11,9";
                let line = line.replace('@', place).replace('%', further);
                let changes = run(&mut document, &line).unwrap_or_else(|e| panic!("{line}: {e}"));
                let same = *document.contents() == before;
                assert_eq!(changes == 0, same, "{line}: {changes} changes");
                if changes > 0 {
                    assert_eq!(document.apply(&"undo".parse().unwrap()).unwrap().steps, 1);
                    assert!(*document.contents() == before, "{line}");
                    assert_eq!(run(&mut document, "redo").unwrap(), 0, "{line}");
                    run(&mut document, "undo").unwrap();
                }
                changed += changes;
            }
            if !fill.is_empty() {
                assert!(changed > 0, "{line} never changes anything");
            }
            if !solid && fill.is_empty() {
                let makes = line.starts_with("add") || line.starts_with("mask");
                assert!(changed == 0 || makes, "{line} made something of nothing");
            }
        }
    }
}

#[test]
fn tools_without_strength_change_nothing() {
    for line in WITHOUT_STRENGTH {
        let mut document = document(CLAY, false);
        let before = document.contents().clone();
        if let Ok(changes) = run(&mut document, line) {
            assert_eq!(changes, 0, "{line}");
        }
        assert!(*document.contents() == before, "{line}");
    }
}

#[test]
fn an_array_repeats_what_is_a_use_of_a_tool_and_nothing_else() {
    let others = ["fill grid", "clear grid", "dye grid colour=#123456", "mark at=0,0,0 size=9,9,9"];
    for line in USES.iter().chain(WITHOUT_STRENGTH).chain(&others) {
        let line = line.replace('@', "20,20,14").replace('%', "33,11,9");
        let command: Command = line.parse().unwrap();
        let mut document = document(&[], true);
        if run(&mut document, &line).is_ok() {
            assert_eq!(command.is_tool_use(), document.can_repeat(), "{line}");
        }
    }
}
