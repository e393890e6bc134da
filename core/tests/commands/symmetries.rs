//! Symmetry about any plane and around an axis: tools act symmetrically, and invalid symmetries are refused.

use glam::{DVec3, IVec3, UVec3, Vec3};
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::orientation::Orientation;
use sculpture_core::sculpture::{ColourDepth, Rgb};

use super::uses;

const EDGE: u32 = 48;

/// Returns a ball in the middle of a grid of 48 voxels an edge, which is symmetric in every way.
fn ball(voxel_size: Vec3) -> Document {
    let new = NewSculpture {
        dims: UVec3::splat(EDGE),
        voxel_size,
        colour_depth: ColourDepth::Bits24,
        base: Rgb::STONE,
        solid: false,
        room_vx: 0,
        grows: false,
    };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    run(&mut document, "add ellipsoid at=24,24,24 half=14").unwrap();
    document
}

fn run(document: &mut Document, line: &str) -> Result<u64, CommandError> {
    let command: Command = line.parse().unwrap_or_else(|error| panic!("{line}: {error}"));
    document.apply(&command).map(|applied| applied.stats.voxels_changed())
}

fn every() -> impl Iterator<Item = IVec3> {
    let edge = EDGE as i32;
    (0..edge)
        .flat_map(move |z| (0..edge).flat_map(move |y| (0..edge).map(move |x| IVec3::new(x, y, z))))
}

/// Returns what `f` returns for every voxel, at [`index`].
fn dense<T>(f: impl Fn(IVec3) -> T) -> Vec<T> {
    every().map(f).collect()
}

/// Returns the place of a voxel in the order of [`every`]; `None` beyond the grid.
fn index(v: IVec3) -> Option<usize> {
    let edge = EDGE as i32;
    let inside = v.cmpge(IVec3::ZERO).all() && v.cmplt(IVec3::splat(edge)).all();
    inside.then(|| (v.x + edge * (v.y + edge * v.z)) as usize)
}

/// A tool of each kind, off every plane.
const TOOLS: &[&str] = &[
    "add ellipsoid at=31,33,29 half=5,4,6 turn=10,20,30 colour=#ff0000",
    "subtract cuboid at=33,32,30 half=4,5,3 turn=10,20,30",
    "recolour torus at=33,31,29 half=6,2,6 turn=40,0,20 colour=#00ff00",
    "add tube points=24,38,30,3;30,40,33,2;37,33,31,2 colour=#0000ff",
    "subtract extrusion at=32,32,31 depth=30 outline=-3,-3;4,-2;1,4 turn=20,30,10",
    "subtract lathe at=34,33,31 profile=0,-4;4,-3;2,5 turn=30,10,20",
    "add half-space at=40,40,36 normal=1,1.2,0.7",
    "add cuboid at=31,33,29 half=4,2,3 turn=10,20,30 to=36,40,31 colour=#ff0000",
    "subtract cylinder at=31,33,29 half=4,5,3 turn=10,20,30 to=36,36,35",
    "spray devourer eye=60,70,55 aim=-29,-39,-26 across=0.5,-0.4,0 down=0,0.3,-0.5 radius=5 reach=3",
    "spray clay eye=60,70,55 aim=-29,-39,-26 across=0.5,-0.4,0 down=0,0.3,-0.5 radius=5 reach=4 colour=#ffff00",
    "spray smooth eye=60,70,55 aim=-29,-39,-26 across=0.5,-0.4,0 down=0,0.3,-0.5 radius=6 reach=4",
    "spray mask eye=60,70,55 aim=-29,-39,-26 across=0.5,-0.4,0 down=0,0.3,-0.5 radius=5 reach=3",
    "mask add capsule at=32,33,30 half=4,7,4 turn=10,20,30",
    "grab at=31,34,29 radius=8 by=4,5,-2",
    "deform twist at=31,34,29 radius=9 normal=1,1.3,0.6 angle=50",
    "deform pinch at=31,34,29 radius=9 normal=1,1.3,0.6 strength=0.6",
    "deform inflate at=31,34,29 radius=9 height=4",
    "deform draw at=31,34,29 radius=9 normal=1,1.3,0.6 height=4",
    "deform flatten at=30,33,29 radius=9 normal=1,1.3,0.6 strength=1",
];

/// These, and every drawn solid.
fn tools() -> Vec<String> {
    let drawn = uses::drawn_solids(Vec3::new(32.0, 33.0, 30.0), 5.0);
    let added = |drawn| Command::DrawnSolid { op: EditOp::Add(None), drawn }.to_string();
    let drawn = drawn.map(added);
    TOOLS.iter().map(|line| line.to_string()).chain(drawn).collect()
}

/// Returns how many voxels differ from their images, and how many lie near the surface.
fn asymmetry(document: &Document) -> (usize, usize) {
    let contents = document.contents();
    let images = document.images();
    let states = dense(|v| (contents.colour(v), contents.is_masked(v)));
    let is = |v: IVec3| index(v).map_or((None, false), |i| states[i]);
    let (mut differing, mut surface) = (0, 0);
    for v in every() {
        let beside =
            [IVec3::X, IVec3::Y, IVec3::Z].into_iter().flat_map(|step| [v + step, v - step]);
        surface += usize::from(beside.into_iter().any(|other| is(other) != is(v)));
        for image in &images[1..] {
            let there = image.point_exactly(v.as_dvec3() + 0.5).floor().as_ivec3();
            let inside = there.cmpge(IVec3::splat(1)).all()
                && there.cmplt(IVec3::splat(EDGE as i32 - 1)).all();
            differing += usize::from(inside && is(there) != is(v));
        }
    }
    (differing / (images.len() - 1).max(1), surface)
}

#[test]
fn planes_along_the_grid_and_half_turns_are_exact() {
    for symmetry in [
        "symmetry plane=24,9,9 normal=1,0,0",
        "symmetry plane=9,24,9 normal=0,-3,0",
        "symmetry x=even plane=24,24,24 normal=0,0,2",
        "symmetry radial=2 about=24,9,24 axis=0,1,0",
        "symmetry y=even radial=2 about=24,9,24 axis=0,1,0",
        "symmetry radial=4 about=24,24,24 axis=0,0,1",
        "symmetry x=even radial=4 about=24,24,24 axis=1,0,0",
    ] {
        for tool in &tools() {
            let mut document = ball(Vec3::ONE);
            run(&mut document, symmetry).unwrap();
            let before = document.contents().clone();
            assert!(run(&mut document, tool).unwrap() > 0, "{symmetry}: {tool}");
            let (differing, surface) = asymmetry(&document);
            // Quarter turns round values at the middle of a voxel's edge in the other direction.
            let allowed = if symmetry.contains("radial=4") { surface / 100 } else { 0 };
            assert!(differing <= allowed, "{symmetry}: {tool}: {differing} of {surface}");
            run(&mut document, "undo").unwrap();
            assert!(*document.contents() == before, "{symmetry}: {tool}");
        }
    }
}

#[test]
fn any_plane_and_any_turn_is_symmetric_to_the_voxel_at_the_surface() {
    for (symmetry, voxel_size) in [
        ("symmetry plane=24,24,24 normal=1,1,0", Vec3::ONE),
        ("symmetry plane=25,23.5,24 normal=1,-0.4,0.3", Vec3::ONE),
        ("symmetry radial=3 about=24,24,24 axis=0,1,0", Vec3::ONE),
        ("symmetry radial=5 about=23,24,25 axis=1,2,-1", Vec3::ONE),
        ("symmetry y=even radial=6 about=24,24,24 axis=0,1,0", Vec3::ONE),
        ("symmetry plane=24,24,24 normal=1,0,1 radial=2 about=24,24,24 axis=0,1,0", Vec3::ONE),
        ("symmetry plane=24,24,24 normal=1,1,0", Vec3::new(1.0, 1.5, 2.0)),
        ("symmetry radial=3 about=24,24,24 axis=0,0,1", Vec3::new(1.0, 1.5, 2.0)),
    ] {
        for tool in &tools() {
            let mut document = ball(voxel_size);
            run(&mut document, symmetry).unwrap();
            // As symmetric as a ball of voxels can be.
            let (at_first, _) = asymmetry(&document);
            // With long voxels the ball is flatter, and some tools miss it.
            match run(&mut document, tool).unwrap() {
                0 if voxel_size != Vec3::ONE => continue,
                changed => assert!(changed > 0, "{symmetry}: {tool}"),
            }
            let (differing, surface) = asymmetry(&document);
            // A voxel's image lies between voxels: some of those at the surface fall on the other side.
            assert!(
                differing <= at_first + surface / 2,
                "{symmetry} {voxel_size}: {tool}: {differing} ({at_first}) of {surface}"
            );
            let deep = deep_asymmetry(&document);
            assert!(deep <= surface / 50, "{symmetry} {voxel_size}: {tool}: {deep} of {surface}");
        }
    }
}

/// Returns how many voxels differ from their images although all voxels within two of the image are alike.
fn deep_asymmetry(document: &Document) -> usize {
    let bits = dense(|v| document.grid().get(v));
    // Beyond the grid all is empty.
    let is = |v: IVec3| index(v).is_some_and(|i| bits[i]);
    let mut differing = 0;
    for image in &document.images()[1..] {
        for v in every() {
            let there = image.point_exactly(v.as_dvec3() + DVec3::splat(0.5)).floor().as_ivec3();
            let inside = there.cmpge(IVec3::splat(3)).all()
                && there.cmplt(IVec3::splat(EDGE as i32 - 3)).all();
            let alike = |other: IVec3| is(other) == is(there);
            if inside && is(v) != is(there) {
                let around = (0..125).map(|i| there + IVec3::new(i % 5, i / 5 % 5, i / 25) - 2);
                differing += usize::from(around.into_iter().all(alike));
            }
        }
    }
    differing
}

#[test]
fn an_invalid_symmetry_is_refused_and_leaves_the_present_one_alone() {
    let mut document = ball(Vec3::ONE);
    run(&mut document, "symmetry x=even radial=3 about=1,2,3 axis=0,1,0").unwrap();
    let before = document.symmetry();
    for (line, field) in [
        ("symmetry plane=1,2,3 normal=0,0,0", "normal of the mirror plane"),
        ("symmetry plane=1e9,2,3 normal=0,0,1", "mirror plane"),
        ("symmetry radial=1 about=1,2,3 axis=0,1,0", "rotation"),
        ("symmetry radial=65 about=1,2,3 axis=0,1,0", "rotation"),
        ("symmetry radial=3 about=1,2,3 axis=0,0,0", "axis of rotation"),
        ("symmetry radial=3 about=1,2,-1e7 axis=0,0,1", "axis of rotation"),
        ("symmetry x=even y=odd radial=17 about=1,2,3 axis=0,1,0", "symmetry"),
    ] {
        let refused = run(&mut document, line);
        let Err(CommandError::Invalid(invalid)) = refused else { panic!("{line}: {refused:?}") };
        assert_eq!(invalid.field, field, "{line}");
    }
    for text in [
        "symmetry plane=1,2,3",
        "symmetry normal=1,2,3",
        "symmetry radial=3 about=1,2,3",
        "symmetry radial=-3 about=1,2,3 axis=0,1,0",
        "symmetry plane=nan,2,3 normal=0,1,0",
    ] {
        assert!(text.parse::<Command>().is_err(), "{text}");
    }
    assert_eq!(document.symmetry(), before);
    assert_eq!(document.images().len(), 6);
}

#[test]
fn plane_and_axis_are_reoriented_with_the_sculpture() {
    for orientation in Orientation::all() {
        let mut document = ball(Vec3::new(1.0, 1.5, 2.0));
        let line =
            "symmetry plane=20,23.5,25 normal=1,-0.4,0.3 radial=3 about=23,24,25 axis=1,2,-1";
        run(&mut document, line).unwrap();
        let before = document.images();
        run(&mut document, &format!("orient axes={orientation}")).unwrap();
        let dims = UVec3::splat(EDGE);
        let place = |p: DVec3| {
            let a = orientation.destination(IVec3::ZERO, dims);
            let axis = |step: IVec3| (orientation.destination(step, dims) - a).as_dvec3();
            (p.x - 0.5) * axis(IVec3::X)
                + (p.y - 0.5) * axis(IVec3::Y)
                + (p.z - 0.5) * axis(IVec3::Z)
                + a.as_dvec3()
                + 0.5
        };
        for p in [DVec3::new(3.0, 7.0, 12.0), DVec3::new(40.0, 22.0, 9.5)] {
            let mut there: Vec<DVec3> =
                document.images().iter().map(|image| image.point_exactly(place(p))).collect();
            for image in &before {
                let wanted = place(image.point_exactly(p));
                let found = there.iter().position(|other| other.distance(wanted) < 1e-3);
                there.swap_remove(found.unwrap_or_else(|| panic!("{orientation}: {wanted}")));
            }
        }
        run(&mut document, "undo").unwrap();
    }
}
