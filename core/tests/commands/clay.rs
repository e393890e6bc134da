//! Strokes that pull at clay: each pull replaces the previous one, and the stroke is one step.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::Command;
use sculpture_core::command::text::parse_script;
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::Rgb;
use sculpture_core::tools::brush::{BrushBall, BrushDirection, BrushId, BrushSurface, BrushUse};

use super::strategies::{new_sculpture, work};

fn block(limits: Limits) -> Document {
    let Ok(Command::New(new)) = "new dims=40,40,40 colour=24 fill=empty".parse() else { panic!() };
    let mut document = Document::new(&new, limits).unwrap();
    document.apply(&"add cuboid at=20,10,20 half=20,10,20".parse().unwrap()).unwrap();
    document
}

fn pull(by_vx: Vec3, surface: BrushSurface) -> Command {
    let frame = BrushDirection::Displacement(by_vx);
    let ball = BrushBall { centre_vx: Vec3::splat(20.0), radius: 9.0, frame };
    Command::Brush(BrushUse::in_ball(BrushId::Grab, ball).on(surface))
}

fn begin() -> Command {
    Command::Begin { label: "grab".into() }
}

#[test]
fn however_long_the_drag_the_clay_is_pulled_once() {
    let mut once = block(Limits::default());
    let mut dragged = once_more(&once);
    let before = dragged.contents().clone();
    once.apply(&pull(Vec3::new(1.0, 6.0, -2.0), BrushSurface::Now)).unwrap();
    dragged.apply(&begin()).unwrap();
    for i in 0..12 {
        let by = Vec3::new(0.3 * i as f32, i as f32, 5.0 - i as f32);
        dragged.apply(&pull(by, BrushSurface::Stroke)).unwrap();
    }
    dragged.apply(&pull(Vec3::new(1.0, 6.0, -2.0), BrushSurface::Stroke)).unwrap();
    assert!(dragged.contents() == once.contents());
    dragged.apply(&Command::End).unwrap();
    assert_eq!(dragged.history().undo_count(), once.history().undo_count());
    // An array repeats the pull, not the path to it, and each copy leaves the others alone.
    let array = Command::Array { count: 2, step: IVec3::new(3, 0, 0) };
    dragged.apply(&array).unwrap();
    once.apply(&array).unwrap();
    assert!(dragged.contents() == once.contents());
    dragged.apply(&Command::Undo { steps: Some(1) }).unwrap();
    let pulled = dragged.contents().clone();
    dragged.apply(&Command::Undo { steps: Some(1) }).unwrap();
    assert!(*dragged.contents() == before);
    dragged.apply(&Command::Redo { steps: Some(1) }).unwrap();
    assert!(*dragged.contents() == pulled);
}

fn once_more(document: &Document) -> Document {
    let other = block(Limits::default());
    assert!(other.contents() == document.contents());
    other
}

#[test]
fn clay_that_is_let_go_where_it_was_leaves_no_step() {
    let mut document = block(Limits::default());
    let (before, steps) = (document.contents().clone(), document.history().undo_count());
    document.apply(&begin()).unwrap();
    document.apply(&pull(Vec3::Y * 7.0, BrushSurface::Stroke)).unwrap();
    assert!(*document.contents() != before);
    document.apply(&pull(Vec3::ZERO, BrushSurface::Stroke)).unwrap();
    assert!(*document.contents() == before);
    document.apply(&Command::End).unwrap();
    assert_eq!(document.history().undo_count(), steps);
}

/// A pull that exceeds the memory for colours is refused; the earlier changes of the stroke remain and are undone in
/// one step.
#[test]
fn a_pull_that_is_refused_leaves_the_stroke_as_it_was() {
    let limits = Limits { colour_bytes: 16 * 125 + 4 * 1536, ..Limits::default() };
    let mut document = block(limits);
    for command in ["recolour cuboid at=20,19,20 half=4,1,4 colour=#ff0000", "begin \"grab\""] {
        document.apply(&command.parse().unwrap()).unwrap();
    }
    let before = document.contents().clone();
    document.apply(&pull(Vec3::Y * 0.6, BrushSurface::Stroke)).unwrap();
    let small = document.contents().clone();
    assert!(small != before);
    assert!(document.apply(&pull(Vec3::new(7.0, 19.0, 9.0), BrushSurface::Stroke)).is_err());
    assert!(*document.contents() == small);
    document.apply(&pull(Vec3::Y * 0.9, BrushSurface::Stroke)).unwrap();
    document.apply(&pull(Vec3::Y * 0.6, BrushSurface::Stroke)).unwrap();
    assert!(*document.contents() == small);
    assert!(document.apply(&pull(Vec3::new(7.0, 19.0, 9.0), BrushSurface::Stroke)).is_err());
    document.apply(&Command::End).unwrap();
    document.apply(&Command::Undo { steps: Some(1) }).unwrap();
    assert!(*document.contents() == before);
    assert_eq!(document.contents().rgb(UVec3::new(20, 19, 20)), Rgb::new(255, 0, 0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// A pull from the start of a stroke gives the same as the pull alone, regardless of the stroke so far, and undo is exact.
    #[test]
    fn a_pull_from_the_start_takes_the_place_of_the_stroke(
        new in new_sculpture(24),
        commands in prop::collection::vec(work(), 0..12),
        by in prop::array::uniform3(-9.0f32..9.0),
    ) {
        let limits = Limits { history_bytes: 1 << 30, ..Limits::default() };
        let mut document = Document::new(&new, limits).unwrap();
        document.apply(&"add ellipsoid at=10,10,10 half=8".parse().unwrap()).unwrap();
        let before = document.contents().clone();
        document.apply(&begin()).unwrap();
        for command in &commands {
            let stays = match command {
                Command::Construct { .. } => true,
                Command::Brush(used) => used.footprint().is_some(),
                _ => false,
            };
            if stays {
                let _ = document.apply(command);
            }
        }
        let pull = pull(by.into(), BrushSurface::Stroke);
        document.apply(&pull).unwrap();
        document.apply(&Command::End).unwrap();
        let pulled = document.contents().clone();
        if pulled != before {
            document.apply(&Command::Undo { steps: Some(1) }).unwrap();
        }
        prop_assert!(*document.contents() == before);
        document.apply(&pull).unwrap();
        prop_assert!(*document.contents() == pulled);
    }
}

/// Uses of a brush in a stroke do not add up where they overlap, whatever their order; undo is exact.
#[test]
fn brushes_work_on_the_surface_from_before_the_stroke() {
    let dab = |x: i32, brush: &str| -> Command {
        format!("deform {brush} at={x},20,20 radius=9 falloff=flat surface=stroke").parse().unwrap()
    };
    for brush in ["inflate height=3", "inflate height=-3", "scrape normal=0,1,0.3"] {
        let stroke = |order: &[i32]| {
            let mut document = block(Limits::default());
            document.apply(&begin()).unwrap();
            for x in order {
                document.apply(&dab(*x, brush)).unwrap();
            }
            document.apply(&Command::End).unwrap();
            document
        };
        let mut once = stroke(&[14, 17, 20, 23, 26]);
        assert!(once.contents() == stroke(&[26, 20, 14, 14, 23, 17, 20]).contents(), "{brush}");
        let changed = once.contents().clone();
        let before = block(Limits::default());
        assert!(changed != *before.contents(), "{brush}");
        // The next stroke continues from there.
        once.apply(&begin()).unwrap();
        once.apply(&dab(20, brush)).unwrap();
        once.apply(&Command::End).unwrap();
        assert!(once.contents() != &changed, "{brush}");
        once.apply(&Command::Undo { steps: None }).unwrap();
        once.apply(&Command::Redo { steps: Some(2) }).unwrap();
        assert!(once.contents() == &changed, "{brush}");
    }
}

#[test]
fn swollen_clay_has_the_colours_around_it_and_keeps_to_the_selection() {
    let mut document = block(Limits::default());
    for command in [
        "dye grid colour=#123456",
        "mark at=0,0,0 size=20,40,40",
        "select add",
        "limit on",
        "deform inflate at=20,20,20 radius=9 height=3 falloff=flat",
    ] {
        document.apply(&command.parse().unwrap()).unwrap();
    }
    let grid = document.grid();
    assert!(grid.get(IVec3::new(19, 22, 20)) && !grid.get(IVec3::new(20, 20, 20)));
    assert_eq!(document.contents().rgb(UVec3::new(19, 22, 20)), Rgb::new(0x12, 0x34, 0x56));
}

/// The script of the gallery: each command has an effect, and both halves are alike.
#[test]
fn a_bust_is_made_in_less_than_a_hundred_commands() {
    let script = parse_script(include_str!("../../../config/gallery/bust.sculpt")).unwrap();
    assert!(script.len() < 100, "{}", script.len());
    let (_, Command::New(new)) = &script[0] else { panic!("no sculpture") };
    let mut document = Document::new(new, Limits::default()).unwrap();
    for (line, command) in &script[1..] {
        let done = document.apply(command).unwrap();
        let shapes = matches!(command, Command::Construct { .. } | Command::Brush(_));
        assert!(!shapes || done.stats.voxels_changed() > 0, "line {line} does nothing");
    }
    let grid = document.grid();
    for i in 0..grid.dims().element_product() {
        let v = grid.voxel_coords(i).as_ivec3();
        let mirrored = IVec3::new(159 - v.x, v.y, v.z);
        assert_eq!(grid.get(v), grid.get(mirrored), "{v}");
    }
}
