//! Brushes under an outline: exact undo, strokes on the surface as it was at their beginning, and the permitted and
//! forbidden changes of each tool in random sculptures.

use glam::{UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::refusal::{MemoryBudget, OverBudget};
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::tools::brush::footprint::{Coverage, Footprint, Outline};
use sculpture_core::tools::brush::keys::{
    AROUND, BITE, COLOUR, COVER, REACH, ROUNDING, STRENGTH, THRESHOLD,
};
use sculpture_core::tools::brush::{BrushId, BrushSurface, BrushUse};
use sculpture_core::tools::solid::{Primitive, Solid};

const RED: Rgb = Rgb::new(220, 20, 30);

fn block(colour_depth: ColourDepth) -> Document {
    let new = NewSculpture {
        dims: UVec3::new(40, 36, 44),
        voxel_size: Vec3::ONE,
        colour_depth,
        base: Rgb::STONE,
        solid: true,
        room_vx: 0,
        grows: false,
    };
    Document::new(&new, Limits::default()).unwrap()
}

/// Returns a footprint seen from `eye` towards `target`, with rays half a voxel apart there.
fn looking(eye: Vec3, target: Vec3, radius: f32, coverage: Coverage) -> Footprint {
    let aim = target - eye;
    let across = aim.any_orthonormal_vector();
    let down = aim.cross(across).normalize_or(Vec3::Y);
    Footprint {
        eye_vx: eye,
        aim,
        across: across * 0.5,
        down: down * 0.5,
        radius,
        outline: Outline::Round,
        coverage,
    }
}

/// Returns a brush that changes voxels or colours, under a footprint.
fn brush_use(footprint: Footprint) -> impl Strategy<Value = BrushUse> {
    let used = move |brush| BrushUse::under(brush, footprint);
    let smooth = (0f32..=1.0, 0f32..=1.0).prop_map(move |(strength, rounding)| {
        used(BrushId::Smooth).with(STRENGTH, strength).with(ROUNDING, rounding)
    });
    prop_oneof![
        Just(used(BrushId::Paint).with(COLOUR, RED).with(COVER, 0.7)),
        Just(used(BrushId::Devour).with(BITE, Outline::Round)),
        Just(used(BrushId::Devour).with(BITE, Outline::Square)),
        Just(used(BrushId::Erode).with(THRESHOLD, 14)),
        Just(used(BrushId::Dilate).with(THRESHOLD, 8).with(COLOUR, RED)),
        Just(used(BrushId::Grow).with(THRESHOLD, 12).with(COLOUR, RED)),
        Just(used(BrushId::Smooth).with(AROUND, 2)),
        smooth,
        Just(used(BrushId::Clay).with(COLOUR, RED)),
    ]
    .prop_map(|used| used.with(REACH, 2.5))
}

/// Returns a use from a direction at a point.
fn aimed(coverage: Coverage) -> impl Strategy<Value = BrushUse> {
    (point(), point(), 0f32..10.0).prop_flat_map(move |(direction, target, radius)| {
        let eye = target + (direction - 18.0).normalize_or(Vec3::Z) * 90.0;
        brush_use(looking(eye, target, radius, coverage))
    })
}

fn point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(0f32..36.0).prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn sprays_change_only_what_they_may_and_undo_exactly(
        bites in prop::collection::vec((point(), 3f32..9.0), 1..5),
        uses in prop::sample::select(&Coverage::ALL)
            .prop_flat_map(|coverage| prop::collection::vec(aimed(coverage), 1..6)),
    ) {
        let mut document = block(ColourDepth::Bits16);
        for (centre_vx, half) in bites {
            let primitive = Primitive {
                solid: Solid::Ellipsoid,
                centre_vx,
                half: Vec3::splat(half),
                rotation: glam::Quat::IDENTITY,
            };
            document.apply(&Command::Construct { op: EditOp::Subtract, primitive, to_vx: None }).unwrap();
        }
        let before = document.contents().clone();
        let steps = document.history().undo_count();
        for used in uses {
            let brush = used.brush();
            let old = document.contents().clone();
            let stats = document.apply(&Command::Brush(used)).unwrap().stats;
            match brush {
                BrushId::Paint => {
                    prop_assert_eq!(document.grid(), &old.grid);
                }
                BrushId::Devour | BrushId::Erode => {
                    prop_assert_eq!(stats.voxels_added, 0);
                    prop_assert_eq!(document.material(), &old.material);
                }
                BrushId::Dilate | BrushId::Grow | BrushId::Clay => {
                    prop_assert_eq!(stats.voxels_removed, 0);
                }
                _ => {}
            }
            let count = old.grid.opaque_count() + stats.voxels_added - stats.voxels_removed;
            prop_assert_eq!(document.grid().opaque_count(), count);
        }
        let after = document.contents().clone();
        let undo = (document.history().undo_count() - steps) as u32;
        document.apply(&Command::Undo { steps: Some(undo) }).unwrap();
        prop_assert_eq!(document.contents(), &before);
        document.apply(&Command::Redo { steps: None }).unwrap();
        prop_assert_eq!(document.contents(), &after);
    }
}

#[test]
fn a_stroke_on_its_first_surface_cuts_each_voxel_once() {
    let removed = |surface| {
        let mut document = block(ColourDepth::None);
        let footprint = looking(
            Vec3::new(20.0, 90.0, 20.0),
            Vec3::new(20.0, 36.0, 20.0),
            4.0,
            Coverage::Visible,
        );
        let used = BrushUse::under(BrushId::Devour, footprint).with(REACH, 2.0).on(surface);
        document.apply(&Command::Begin { label: "groove".to_string() }).unwrap();
        let bite = || Command::Brush(used.clone());
        let first = document.apply(&bite()).unwrap().stats.voxels_removed;
        let second = document.apply(&bite()).unwrap().stats.voxels_removed;
        document.apply(&Command::End).unwrap();
        assert_eq!(document.history().undo_count(), 1);
        // The next stroke begins with the present surface.
        document.apply(&Command::Begin { label: "again".to_string() }).unwrap();
        let third = document.apply(&bite()).unwrap().stats.voxels_removed;
        document.apply(&Command::End).unwrap();
        (first, second, third)
    };
    let (first, second, third) = removed(BrushSurface::Stroke);
    assert!(first > 0 && second == 0 && third > 0);
    let (first, second, _) = removed(BrushSurface::Now);
    assert!(first > 0 && second > 0);
}

#[test]
fn unusable_sprays_are_refused_and_change_nothing() {
    let mut document = block(ColourDepth::None);
    let before = document.contents().clone();
    let footprint =
        looking(Vec3::new(20.0, 90.0, 20.0), Vec3::new(20.0, 36.0, 20.0), 4.0, Coverage::Visible);
    let mut apply = |used: BrushUse| document.apply(&Command::Brush(used));
    let used = |brush| BrushUse::under(brush, footprint);
    let paint = used(BrushId::Paint).with(COLOUR, RED);
    assert!(matches!(apply(paint), Err(CommandError::NoColour)));
    let far = apply(used(BrushId::Devour).with(REACH, 1e9)).unwrap_err();
    assert_eq!(far.to_string(), "the reach of the brush must be from 0 to 64 (given: 1000000000)");
    let colourless = apply(used(BrushId::Clay)).unwrap_err();
    assert_eq!(colourless.to_string(), "the colour of the brush is missing");
    assert_eq!(document.contents(), &before);
}

/// Returns a block painted red in the lower half of x and blue in the upper, with pits across the border.
fn painted_with_pits(colour_depth: ColourDepth) -> Document {
    let mut document = block(colour_depth);
    let script = "dye colour=#dc141e
        mark at=20,0,0 size=20,36,44
        dye marker colour=#0000ff
        subtract ellipsoid at=20,30,14 half=3.4
        subtract cuboid at=20,34,30 half=6,2,3
        subtract cuboid at=8,35,30 half=1,1,1";
    script.lines().for_each(|line| {
        document.apply(&line.trim().parse().unwrap()).unwrap();
    });
    document
}

#[test]
fn voxels_that_filters_add_take_the_surrounding_colours() {
    for depth in [ColourDepth::Bits8, ColourDepth::Bits16, ColourDepth::Bits24] {
        for filter in ["smooth around=3", "dilation threshold=7", "growth threshold=9"] {
            let mut document = painted_with_pits(depth);
            let before = document.contents().clone();
            let (mut added, steps) = (0, document.history().undo_count());
            let (name, option) = filter.split_once(' ').unwrap();
            for z in [14, 30] {
                let spray = format!(
                    "spray {name} eye=20,200,{z} aim=0,-1,0 across=0.005,0,0 down=0,0,0.005 \
                     radius=16 reach=6 {option}"
                );
                added += document.apply(&spray.parse().unwrap()).unwrap().stats.voxels_added;
            }
            assert!(added > 20, "{filter} filled {added} voxels");
            let quantised = [RED, Rgb::new(0, 0, 255)].map(|colour| depth.quantise(colour));
            let after = document.contents();
            let mut met = [0; 2];
            for voxel in 0..after.grid.dims().element_product() {
                let v = after.grid.voxel_coords(voxel).as_ivec3();
                let Some(colour) = after.colour(v).filter(|_| !before.grid.get(v)) else {
                    continue;
                };
                // Six voxels from the border, there is no trace of the other colour.
                for (side, far) in [v.x < 14, v.x >= 26].into_iter().enumerate() {
                    if far {
                        assert_eq!(colour, quantised[side], "{filter} {depth:?} {v}");
                    }
                    met[side] += u32::from(colour == quantised[side]);
                }
                // In between: a mixture of red and blue, never the green of stone.
                assert!(colour.0[1] <= 40, "{filter} {depth:?} {v}: {colour}");
            }
            assert!(met.iter().all(|count| *count > 0), "{filter} {depth:?} {met:?}");
            let done = document.history().undo_count() - steps;
            document.apply(&Command::Undo { steps: Some(done as u32) }).unwrap();
            assert_eq!(document.contents(), &before, "{filter} {depth:?}");
        }
    }
}

#[test]
fn inherited_colours_are_mirrored_and_bounded() {
    let mut document = block(ColourDepth::Bits24);
    let script = "symmetry x=even
        recolour ellipsoid at=9,30,20 half=7 colour=#ff8000
        recolour ellipsoid at=13,33,22 half=4 colour=#004080
        subtract ellipsoid at=12,34,20 half=4";
    for line in script.lines() {
        document.apply(&line.trim().parse().unwrap()).unwrap();
    }
    let smooth = "spray smooth eye=12.4,200,20.3 aim=0,-1,0 across=0.005,0,0 down=0,0,0.005 radius=20 \
                  reach=6 around=4";
    assert!(document.apply(&smooth.parse().unwrap()).unwrap().stats.voxels_added > 0);
    let contents = document.contents();
    for voxel in 0..contents.grid.dims().element_product() {
        let v = contents.grid.voxel_coords(voxel).as_ivec3();
        assert_eq!(contents.colour(v), contents.colour(v.with_x(39 - v.x)), "{v}");
    }
    // Without memory for colours, nothing is filled, and the command is refused.
    let pages = contents.material.page_count() as u64;
    let limits = Limits { colour_bytes: contents.material.heap_bytes(), ..Limits::default() };
    let mut full = Document::from_contents(contents.clone(), limits);
    full.apply(&"subtract cuboid at=20,36,20 half=20,4,20".parse().unwrap()).unwrap();
    assert_eq!(full.material().page_count() as u64, pages);
    let clay = "spray clay eye=36,200,36 aim=0,-1,0 across=0.005,0,0 down=0,0,0.005 radius=9 \
                reach=4 colour=#ff0000";
    let refused = full.apply(&clay.parse().unwrap()).unwrap_err();
    assert!(
        matches!(
            refused,
            CommandError::OverBudget(OverBudget { budget: MemoryBudget::Colours, .. })
        ),
        "{refused}"
    );
}
