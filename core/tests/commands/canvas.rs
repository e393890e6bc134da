//! The box of a sculpture: it is moved by commands and grows with tools; signed coordinates stay what they are.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::format::{Texts, read_sculpture, write_sculpture};
use sculpture_core::sculpture::canvas_frame::CanvasFrame;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::region::VoxelBox;
use sculpture_core::sculpture::{ColourDepth, Digest, Rgb};

use super::strategies::{area_work, canvas_change, new_sculpture, work};

fn document(line: &str, limits: Limits) -> Document {
    let Command::New(new) = line.parse().unwrap() else { panic!("{line}") };
    Document::new(&new, limits).unwrap()
}

fn apply(document: &mut Document, line: &str) {
    document.apply(&line.parse().unwrap()).unwrap_or_else(|error| panic!("{line}: {error}"));
}

/// Returns the voxel at signed coordinates: its colour if it exists, and whether it is masked.
fn at(contents: &Contents, v: IVec3) -> (Option<Rgb>, bool) {
    let v = v - contents.frame.origin;
    (contents.colour(v), contents.is_masked(v))
}

fn voxels(bounds: VoxelBox) -> impl Iterator<Item = IVec3> {
    let VoxelBox { min, max } = bounds;
    (min.z..max.z).flat_map(move |z| {
        (min.y..max.y).flat_map(move |y| (min.x..max.x).map(move |x| IVec3::new(x, y, z)))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Every step returns to identical contents, in and out of strokes, with the canvas growing by commands and tools.
    #[test]
    fn undo_and_redo_restore_every_byte_of_a_canvas(
        new in new_sculpture(24),
        room_vx in 0u32..9,
        commands in prop::collection::vec(
            prop_oneof![3 => work(), 3 => area_work(), 2 => canvas_change(0u32..9).prop_map(Command::Canvas)],
            1..30,
        ),
    ) {
        let mut document = Document::new(&NewSculpture { room_vx, ..new }, Limits::default()).unwrap();
        let mut at_step = vec![(document.contents().clone(), document.selection().marker())];
        apply(&mut document, "canvas auto on");
        at_step.push((document.contents().clone(), document.selection().marker()));
        for command in &commands {
            let steps_before = document.history().undo_count();
            let before = document.contents().clone();
            let revision = document.revision();
            if document.apply(command).is_err() {
                prop_assert_eq!(document.contents(), &before, "{}", command);
                prop_assert_eq!(document.revision(), revision, "{}", command);
            }
            let steps = document.history().undo_count();
            if steps > steps_before && !matches!(command, Command::Redo { .. }) {
                at_step.truncate(steps);
                at_step.push((document.contents().clone(), document.selection().marker()));
            } else if !document.stroke_open() {
                prop_assert_eq!(document.contents(), &at_step[steps].0, "{}", command);
            }
        }
        if document.stroke_open() {
            document.apply(&Command::Cancel).unwrap();
        }
        document.apply(&Command::Redo { steps: None }).unwrap();
        for (contents, _) in at_step.iter().rev() {
            prop_assert_eq!(document.contents(), contents);
            prop_assert_eq!(Digest::of(document.contents()), Digest::of(contents));
            document.apply(&Command::Undo { steps: Some(1) }).unwrap();
        }
        document.apply(&Command::Redo { steps: None }).unwrap();
        prop_assert_eq!(document.contents(), &at_step[at_step.len() - 1].0);
        // Files keep the canvas.
        let file = write_sculpture(document.contents(), &Texts::default()).unwrap();
        let (read, _) = read_sculpture(&file, &Limits::default()).unwrap();
        prop_assert_eq!(&read, document.contents());
    }

}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// A command means the same voxels, wherever the box begins.
    #[test]
    fn coordinates_stay_what_they_are(
        lines in prop::collection::vec(line(), 1..24),
        grow in prop_oneof![Just("canvas grow by=1"), Just("canvas grow by=70 sides=-x,-y,z")],
    ) {
        let mut plain = document("new dims=32,33,34 colour=24 fill=empty", Limits::default());
        let mut grown = document("new dims=32,33,34 colour=24 fill=empty", Limits::default());
        apply(&mut grown, grow);
        let home = VoxelBox { min: IVec3::ZERO, max: IVec3::new(32, 33, 34) };
        for line in &lines {
            let command: Command = line.parse().unwrap();
            let (one, other) = (plain.apply(&command), grown.apply(&command));
            prop_assert_eq!(one.is_ok(), other.is_ok(), "{}: {:?} {:?}", line, one, other);
            for v in voxels(home) {
                prop_assert_eq!(at(plain.contents(), v), at(grown.contents(), v), "{} {}", line, v);
            }
            let marker = |document: &Document| document.selection().marker().shifted(document.origin());
            prop_assert_eq!(marker(&plain), marker(&grown), "{}", line);
        }
        let place = |document: &Document, v: Vec3| {
            document.world_from_grid().transform_point3(v - document.origin().as_vec3())
        };
        prop_assert_eq!(place(&plain, Vec3::new(1.0, 2.0, 3.0)), place(&grown, Vec3::new(1.0, 2.0, 3.0)));
    }
}

/// Returns commands about places within a box of 32 voxels an edge.
fn line() -> impl Strategy<Value = String> {
    let place = prop::array::uniform3(8i32..16);
    (0u8..16, place, 1i32..4, any::<u8>()).prop_map(|(kind, [x, y, z], r, c)| {
        let at = format!("at={x},{y},{z}");
        match kind {
            0..4 => format!("add ellipsoid {at} half={r}.25 colour=#{c:02x}8040"),
            4 => format!("subtract cuboid {at} half={r} to={y},{z},{x}"),
            5 => format!("mask add ellipsoid {at} half={r}.25"),
            6 => format!("flood {at} colour=#10{c:02x}30 tolerance=0.5"),
            7 => format!("mask add patch {at} tolerance=1 depth=1"),
            8 => format!("mark {at} size={r},2,3"),
            9 => "copy".to_string(),
            10 => format!("paste {at}"),
            11 => "symmetry x=even z=odd".to_string(),
            12 => format!("symmetry plane={x},16,{z} normal=0,1,0"),
            13 => format!("gradient from={x},0,0 to={x},{y},30 colour=#000000 end=#ffffff"),
            14 => format!("noise colour=#ff0000 size=8 amount=1 seed={r}"),
            _ => "array count=2 step=1,0,1".to_string(),
        }
    })
}

#[test]
fn the_box_grows_at_each_side_with_the_edit_as_one_step() {
    for (side, low, high) in [
        ("at=-10,10,10", IVec3::new(-64, 0, 0), IVec3::new(20, 20, 20)),
        ("at=30,10,10", IVec3::ZERO, IVec3::new(84, 20, 20)),
        ("at=10,-10,10", IVec3::new(0, -64, 0), IVec3::new(20, 20, 20)),
        ("at=10,30,10", IVec3::ZERO, IVec3::new(20, 84, 20)),
        ("at=10,10,-70", IVec3::new(0, 0, -128), IVec3::new(20, 20, 20)),
        ("at=10,10,30", IVec3::ZERO, IVec3::new(20, 20, 84)),
    ] {
        let mut document = document("new dims=20,20,20 colour=16", Limits::default());
        for line in [
            "recolour ellipsoid at=3,4,5 half=3 colour=#ff0000",
            "mask add cuboid at=15,15,15 half=4",
            "mark at=2,3,4 size=5,6,7",
            "select add",
            "symmetry y=odd plane=1,2,3 normal=1,2,3",
            "symmetry",
            "canvas auto on",
        ] {
            apply(&mut document, line);
        }
        let before = document.contents().clone();
        let steps = document.history().undo_count();
        let placed = document.world_from_grid().transform_point3(Vec3::ZERO);
        apply(&mut document, &format!("add cuboid {side} half=2 colour=#0000ff"));
        assert_eq!(document.history().undo_count(), steps + 1);
        let canvas = document.contents().canvas().bounds_vx();
        assert_eq!((canvas.min, canvas.max), (low, high), "{side}");
        assert_eq!(document.grid().opaque_count(), 8000 + 64);
        let kept = VoxelBox { min: IVec3::ZERO, max: IVec3::splat(20) };
        for v in voxels(kept) {
            assert_eq!(at(document.contents(), v), at(&before, v), "{v}");
        }
        let marker = document.selection().marker().shifted(document.origin());
        assert_eq!(marker, VoxelBox { min: IVec3::new(2, 3, 4), max: IVec3::new(7, 9, 11) });
        assert_eq!(document.selection().boxes()[0].bounds, document.selection().marker());
        let origin = -document.origin().as_vec3();
        assert_eq!(document.world_from_grid().transform_point3(origin), placed);
        let after = document.contents().clone();
        apply(&mut document, "undo");
        assert_eq!(document.contents(), &before);
        assert_eq!(document.selection().marker().min, IVec3::new(2, 3, 4));
        apply(&mut document, "redo");
        assert_eq!(document.contents(), &after);
    }
}

#[test]
fn symmetric_tools_grow_the_box_at_both_sides() {
    let mut document = document("new dims=20,21,22", Limits::default());
    for line in ["canvas auto on", "symmetry x=even", "add ellipsoid at=-5,10,10 half=4"] {
        apply(&mut document, line);
    }
    let canvas = document.contents().canvas().bounds_vx();
    assert_eq!((canvas.min, canvas.max), (IVec3::new(-64, 0, 0), IVec3::new(84, 21, 22)));
    let contents = document.contents();
    for v in voxels(canvas) {
        let mirrored = IVec3::new(19 - v.x, v.y, v.z);
        assert_eq!(at(contents, v).0, at(contents, mirrored).0, "{v}");
    }
}

#[test]
fn the_box_grows_only_for_what_it_then_holds() {
    let mut document = document("new dims=20,20,20", Limits::default());
    apply(&mut document, "canvas auto on");
    let dims = UVec3::splat(20);
    for line in [
        "subtract ellipsoid at=0,0,0 half=5",
        "add cuboid at=10,10,10 half=10",
        "add cuboid at=2,2,2 half=2",
        "deform polish at=0,10,10 radius=6 normal=-1,0,0",
        "fill",
    ] {
        document.apply(&line.parse().unwrap()).ok();
        assert_eq!(document.grid().dims(), dims, "{line}");
    }
    // Within the selection alone.
    apply(&mut document, "mark at=0,0,0 size=9,9,9");
    apply(&mut document, "select add");
    apply(&mut document, "limit on");
    apply(&mut document, "subtract cuboid at=4,4,4 half=3");
    apply(&mut document, "add ellipsoid at=0,0,0 half=8");
    assert_eq!(document.grid().dims(), dims);
    apply(&mut document, "limit off");
    apply(&mut document, "canvas auto off");
    apply(&mut document, "add ellipsoid at=0,0,0 half=8");
    assert_eq!(document.grid().dims(), dims);
}

#[test]
fn brushes_pastes_moves_and_strokes_grow_the_box() {
    let mut document = document("new dims=24,24,24 colour=8", Limits::default());
    apply(&mut document, "canvas auto on");
    let blank = document.contents().clone();
    for lines in [
        &["deform inflate at=24,12,12 radius=6 height=4 falloff=smooth"][..],
        &["grab at=12,24,12 radius=8 by=0,9,0 falloff=smooth"],
        &["mark at=0,0,0 size=8,8,8", "copy", "paste at=-5,20,20"],
        &["mark at=0,0,0 size=8,8,8", "move by=-3,0,0"],
        &["mark at=20,20,20 size=8,8,8", "fill marker"],
        &["add tube points=20,12,12,3;40,12,12,3"],
        &[
            "begin",
            "add ellipsoid at=24,12,12 half=4",
            "add ellipsoid at=-70,12,12 half=4",
            "subtract ellipsoid at=0,12,12 half=6",
            "add ellipsoid at=12,12,100 half=4",
            "end",
        ],
        &[
            "begin",
            "grab at=12,24,12 radius=8 by=0,3,0 falloff=smooth surface=stroke",
            "grab at=12,24,12 radius=8 by=0,9,0 falloff=smooth surface=stroke",
            "grab at=12,24,12 radius=8 by=0,40,0 falloff=smooth surface=stroke",
            "end",
        ],
    ] {
        let mut done = false;
        for line in lines {
            let Ok(command) = line.parse::<Command>() else { panic!("{line}") };
            document.apply(&command).unwrap_or_else(|error| panic!("{line}: {error}"));
            done |= document.grid().dims() != UVec3::splat(24);
        }
        assert!(done, "{lines:?}");
        let after = document.contents().clone();
        apply(&mut document, "undo");
        assert_eq!(document.contents(), &blank, "{lines:?}");
        apply(&mut document, "redo");
        assert_eq!(document.contents(), &after, "{lines:?}");
        apply(&mut document, "undo");
        // A stroke that is cancelled leaves nothing.
        if lines[0] == "begin" {
            lines[..lines.len() - 1].iter().for_each(|line| apply(&mut document, line));
            apply(&mut document, "cancel");
            assert_eq!(document.contents(), &blank, "{lines:?}");
        }
    }
    // Copies of an array grow it as well.
    for line in ["add ellipsoid at=20,12,12 half=3", "array count=4 step=0,0,20"] {
        apply(&mut document, line);
    }
    assert_eq!(document.contents().canvas().bounds_vx().max, IVec3::new(24, 24, 152));
    apply(&mut document, "undo");
    assert_eq!(document.contents(), &blank);
}

#[test]
fn beyond_the_limits_tools_are_clipped() {
    let mut document = document("new dims=8000,40,40", Limits::default());
    apply(&mut document, "canvas auto on");
    let before = document.contents().clone();
    apply(&mut document, "subtract cuboid at=7998,20,20 half=2");
    apply(&mut document, "add cuboid at=8200,20,20 half=204,2,2");
    let grown = document.grid().dims();
    assert_eq!(grown, UVec3::new(8192, 40, 40));
    for line in ["canvas grow by=300", "canvas size dims=9000,1,1", "canvas size dims=0,1,1"] {
        let error = document.apply(&line.parse().unwrap()).unwrap_err().to_string();
        assert!(error.contains("grid of"), "{error}");
        assert_eq!(document.grid().dims(), grown);
    }
    apply(&mut document, "undo 2");
    assert_eq!(document.contents(), &before);
    apply(&mut document, "clear");
    let error = document.apply(&"canvas crop".parse().unwrap()).unwrap_err().to_string();
    assert!(error.contains("no voxels"), "{error}");
    apply(&mut document, "begin");
    assert!(document.apply(&"canvas grow by=1".parse().unwrap()).is_err());
}

#[test]
fn the_box_does_not_grow_for_more_than_the_memory_allows() {
    let mut document =
        document("new dims=40,40,40", Limits { grid_bytes: 20_000, ..Limits::default() });
    apply(&mut document, "canvas auto on");
    let before = document.contents().clone();
    // The shell of this ball alone takes more.
    assert!(document.apply(&"add ellipsoid at=100,20,20 half=60".parse().unwrap()).is_ok());
    assert_eq!(document.contents(), &before);
    apply(&mut document, "add ellipsoid at=41,20,20 half=4");
    assert_eq!(document.grid().dims(), UVec3::new(104, 40, 40));
}

#[test]
fn the_canvas_is_cropped_to_the_content_and_restored() {
    let mut document = document("new dims=200,70,70 colour=24 fill=empty", Limits::default());
    for line in [
        "add cuboid at=150,60,30 half=9 colour=#ff0000",
        "recolour cuboid at=150,60,30 half=5 colour=#00ff00",
        "mask add cuboid at=10,10,10 half=3",
    ] {
        apply(&mut document, line);
    }
    let before = document.contents().clone();
    apply(&mut document, "canvas crop");
    let canvas = document.contents().canvas();
    assert_eq!(canvas.frame.origin, IVec3::new(128, 0, 0));
    assert_eq!(canvas.dims, UVec3::new(31, 69, 39));
    assert!(document.mask().is_none(), "the mask lay beyond");
    assert_eq!(at(document.contents(), IVec3::new(150, 60, 30)).0, Some(Rgb::new(0, 255, 0)));
    apply(&mut document, "undo");
    assert_eq!(document.contents(), &before);
    apply(&mut document, "redo");
    apply(&mut document, "canvas size dims=20,69,39");
    apply(&mut document, "orient axes=y,-x,z");
    apply(&mut document, "undo 3");
    assert_eq!(document.contents(), &before);
}

#[test]
fn a_new_stone_lies_in_the_middle_of_its_room() {
    let document = document("new dims=20,21,22 room=13", Limits::default());
    let contents = document.contents();
    assert_eq!(contents.grid.dims(), UVec3::new(46, 47, 48));
    assert_eq!(contents.frame.origin, IVec3::splat(-13));
    assert_eq!(contents.grid.opaque_count(), 20 * 21 * 22);
    let home = VoxelBox { min: IVec3::ZERO, max: IVec3::new(20, 21, 22) };
    assert!(voxels(home).all(|v| at(contents, v).0.is_some()));
    let centre = document.world_from_grid().transform_point3(Vec3::new(23.0, 23.5, 24.0));
    assert_eq!(centre, Vec3::ZERO);
    let marker = document.selection().marker().shifted(document.origin());
    assert_eq!(marker.min, IVec3::new(5, 5, 5));
}

#[test]
fn only_a_canvas_that_has_moved_is_in_the_file() {
    let mut document = document("new dims=20,21,22", Limits::default());
    let version =
        |document: &Document| write_sculpture(document.contents(), &Texts::default()).unwrap()[8];
    assert_eq!(version(&document), 1);
    for line in ["mask add cuboid at=3,3,3 half=2", "surface cubes", "canvas grow by=3"] {
        apply(&mut document, line);
    }
    assert_eq!(version(&document), 4);
    let file = write_sculpture(document.contents(), &Texts::default()).unwrap();
    let (read, _) = read_sculpture(&file, &Limits::default()).unwrap();
    assert_eq!(&read, document.contents());
    // No damage of the canvas is believed.
    for place in 56..84 {
        let mut damaged = file.clone();
        damaged[place] ^= 0x80;
        assert!(read_sculpture(&damaged, &Limits::default()).is_err(), "{place}");
    }
    apply(&mut document, "undo");
    assert_eq!(version(&document), 3);
    assert_eq!(document.contents().frame, CanvasFrame::of(UVec3::new(20, 21, 22)));
}

#[test]
fn colours_without_depth_and_large_boxes_grow() {
    let mut document = document("new dims=700,300,200 colour=0", Limits::default());
    let depth = document.material().depth();
    assert_eq!(depth, ColourDepth::None);
    let before = document.contents().clone();
    for line in ["canvas grow by=600 sides=-x", "canvas grow by=1 sides=z,-y"] {
        apply(&mut document, line);
    }
    assert_eq!(document.grid().opaque_count(), 700 * 300 * 200);
    assert_eq!(document.contents().canvas().dims, UVec3::new(1340, 364, 201));
    apply(&mut document, "undo all");
    assert_eq!(document.contents(), &before);
}
