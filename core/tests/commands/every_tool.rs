//! Tests every tool in edge cases: on empty and full grids, at borders, in corners and outside, and with no strength.

use glam::{UVec3, Vec3};
use sculpture_core::command::Command;
use sculpture_core::document::{CommandError, Document};
use sculpture_core::sculpture::edit::EditOp;

use super::uses::{self, Place};

/// The point where sweeps end.
const FURTHER_VX: Vec3 = Vec3::new(33.0, 11.0, 9.0);

/// Uses with other arguments than in [`uses`]: `@` stands for their position, `%` for a point a little further.
const FURTHER_USES: &[&str] = &[
    "subtract ellipsoid at=@ half=6 to=%",
    "subtract torus at=@ half=8,3,8 turn=30,0,0 to=%",
    "add ring at=@ radius=7 tube=3 turn=20,30,40",
    "add lathe at=@ profile=0,-5;6,-3;2,6 turn=20,0,0",
    "subtract extrusion at=@ depth=12 outline=-4,-4;6,-2;0,5",
    "spray clay eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 reach=4 colour=#ffffff",
    "spray smooth eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 reach=4",
    "stencil \"stripes\" eye=@ aim=1,-1,0.5 across=0.1,0,0 down=0,0,0.1 radius=9 cover=1",
    "deform pinch at=@ radius=9 normal=1,3,2 strength=0.9",
    "deform twist at=@ radius=9 normal=1,3,2 angle=70",
];

/// Returns the uses of every tool at a place.
fn uses_at(at_vx: Vec3) -> Vec<Command> {
    let text = |v: Vec3| format!("{},{},{}", v.x, v.y, v.z);
    let line = |line: &&str| line.replace('@', &text(at_vx)).replace('%', &text(FURTHER_VX));
    let further = FURTHER_USES.iter().map(|use_| line(use_).parse().unwrap());
    let aim = Vec3::new(1.0, -1.0, 0.5);
    let place = Place { at_vx, ball_vx: at_vx, further_vx: FURTHER_VX, eye_vx: at_vx, aim };
    uses::of_every_tool(&place).into_iter().chain(further).collect()
}

/// The same tools with no strength; they may also be refused.
const WITHOUT_STRENGTH: &[&str] = &[
    "stencil \"stripes\" eye=20,60,20 aim=0,-1,0 across=0.1,0,0 down=0,0,0.1 radius=9 cover=0",
    "spray paintbrush eye=20,60,20 aim=0,-1,0 across=0.1,0,0 down=0,0,0.1 radius=9 colour=#ffff00 cover=0",
    "grab at=20,20,20 radius=9 by=0,0,0",
    "deform fill at=20,22,20 radius=9 normal=1,3,2 strength=0",
    "adjust grid hue=0",
    "noise grid colour=#204060 size=8 amount=0",
];

fn without_strength() -> Vec<Command> {
    let (eye_vx, aim) = (Vec3::new(20.0, 60.0, 20.0), Vec3::NEG_Y);
    let at = |at_vx| Place { at_vx, ball_vx: at_vx, further_vx: FURTHER_VX, eye_vx, aim };
    let mut none = uses::without_strength(&at(Vec3::new(20.0, 20.0, 20.0)));
    none.extend(uses::without_strength(&at(Vec3::new(20.0, 18.0, 20.0))));
    none.extend(WITHOUT_STRENGTH.iter().map(|line| line.parse().unwrap()));
    none
}

const DIMS: UVec3 = UVec3::new(41, 33, 28);

fn document(fill: &[&str], solid: bool) -> Document {
    let mut document = uses::document(DIMS, solid);
    fill.iter().for_each(|line| assert!(run(&mut document, line).unwrap() > 0, "{line}"));
    document
}

fn run(document: &mut Document, line: &str) -> Result<u64, CommandError> {
    let command: Command = line.parse().unwrap_or_else(|error| panic!("{line}: {error}"));
    apply(document, &command)
}

fn apply(document: &mut Document, command: &Command) -> Result<u64, CommandError> {
    document.apply(command).map(|applied| applied.stats.voxels_changed())
}

const CLAY: &[&str] = &[
    "add cuboid at=20,8,14 half=22,12,15 colour=#c08040",
    "add ellipsoid at=20,18,14 half=9",
    "mask add cuboid at=36,16,24 half=5",
];

/// Returns whether a use may create voxels in empty space.
fn makes(command: &Command) -> bool {
    match command {
        Command::Construct { op, .. } | Command::DrawnSolid { op, .. } => {
            matches!(op, EditOp::Add(_))
        }
        Command::Mask(_) => true,
        _ => false,
    }
}

#[test]
fn every_tool_works_at_borders_and_on_empty_and_full_grids_and_is_undone_exactly() {
    let places = [
        [20.0, 20.0, 14.0],
        [0.0, 0.0, 0.0],
        [41.0, 33.0, 28.0],
        [0.0, 16.5, 14.0],
        [20.5, 33.0, 0.0],
        [41.0, 16.0, 28.0],
        [-6.0, -6.0, -6.0],
        [20.0, -30.0, 14.0],
        [1e6, 16.0, 14.0],
    ];
    for (fill, solid) in [(CLAY, false), (&[], false), (&[], true)] {
        let mut document = document(fill, solid);
        let before = document.contents().clone();
        let mut changed = vec![0; uses_at(Vec3::ZERO).len()];
        for (i, command) in
            places.iter().flat_map(|at| uses_at((*at).into()).into_iter().enumerate())
        {
            let command = &command;
            let changes =
                apply(&mut document, command).unwrap_or_else(|e| panic!("{command}: {e}"));
            let same = *document.contents() == before;
            assert_eq!(changes == 0, same, "{command}: {changes} changes");
            if changes > 0 {
                assert_eq!(document.apply(&"undo".parse().unwrap()).unwrap().steps, 1);
                assert!(*document.contents() == before, "{command}");
                assert_eq!(run(&mut document, "redo").unwrap(), 0, "{command}");
                run(&mut document, "undo").unwrap();
            }
            changed[i] += changes;
        }
        for (command, changed) in uses_at(Vec3::ZERO).iter().zip(changed) {
            if !fill.is_empty() {
                assert!(changed > 0, "{command} never changes anything");
            }
            if !solid && fill.is_empty() {
                assert!(changed == 0 || makes(command), "{command} made something of nothing");
            }
        }
    }
}

#[test]
fn tools_without_strength_change_nothing() {
    for command in without_strength() {
        let mut document = document(CLAY, false);
        let before = document.contents().clone();
        if let Ok(changes) = apply(&mut document, &command) {
            assert_eq!(changes, 0, "{command}");
        }
        assert!(*document.contents() == before, "{command}");
    }
}

#[test]
fn an_array_repeats_what_is_a_use_of_a_tool_and_nothing_else() {
    let others = ["fill grid", "clear grid", "dye grid colour=#123456", "mark at=0,0,0 size=9,9,9"];
    let others = others.iter().map(|line| line.parse().unwrap());
    let uses = uses_at(Vec3::new(20.0, 20.0, 14.0));
    for command in uses.into_iter().chain(without_strength()).chain(others) {
        let mut document = document(&[], true);
        if apply(&mut document, &command).is_ok() {
            assert_eq!(command.is_tool_use(), document.can_repeat(), "{command}");
        }
    }
}
