//! Spray tools through the door of commands: exact undo, strokes on the surface at their
//! beginning, and what each tool may and may not do to random sculptures.

// A test that cannot go on has failed.
#![allow(clippy::unwrap_used)]

use glam::{UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Command, NewSculpture, SpraySurface};
use sculpture_core::document::{CommandError, Document, Limits};
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::tools::construct::{Primitive, Solid};
use sculpture_core::tools::spray::{Effect, Footprint, Outline, Spray};

const RED: Rgb = Rgb::new(220, 20, 30);

fn block(colour_depth: ColourDepth) -> Document {
    let new = NewSculpture {
        dims: UVec3::new(40, 36, 44),
        voxel_size: Vec3::ONE,
        colour_depth,
        base: Rgb::STONE,
        solid: true,
    };
    Document::new(&new, Limits::default()).unwrap()
}

/// A footprint that looks from `eye` at `target`, with rays half a voxel apart there.
fn looking(eye: Vec3, target: Vec3, radius: f32) -> Footprint {
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
    }
}

fn effect() -> impl Strategy<Value = Effect> {
    prop_oneof![
        Just(Effect::Paintbrush { colour: RED, cover: 0.7 }),
        Just(Effect::Devourer { outline: Outline::Round }),
        Just(Effect::Devourer { outline: Outline::Square }),
        Just(Effect::Erosion { threshold: 14 }),
        Just(Effect::Dilation { threshold: 8, colour: RED }),
        Just(Effect::Growth { threshold: 12, colour: RED }),
        Just(Effect::Smooth { radius_vx: 2 }),
        Just(Effect::Clay { colour: RED }),
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(0f32..36.0).prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn sprays_do_only_what_they_are_for_and_undo_exactly(
        bites in prop::collection::vec((point(), 3f32..9.0), 1..5),
        sprays in prop::collection::vec((effect(), point(), point(), 0f32..10.0), 1..6),
    ) {
        let mut document = block(ColourDepth::Bits16);
        for (centre_vx, half) in bites {
            let primitive = Primitive {
                solid: Solid::Ellipsoid,
                centre_vx,
                half: Vec3::splat(half),
                rotation: glam::Quat::IDENTITY,
            };
            document.apply(&Command::Construct { op: EditOp::Subtract, primitive }).unwrap();
        }
        let before = document.contents().clone();
        let steps = document.history().undo_count();
        for (effect, direction, target, radius) in sprays {
            let eye = target + (direction - 18.0).normalize_or(Vec3::Z) * 90.0;
            let spray = Spray { effect, footprint: looking(eye, target, radius), reach_vx: 2.5 };
            let old = document.contents().clone();
            let command = Command::Spray { spray, surface: SpraySurface::Now };
            let stats = document.apply(&command).unwrap().stats;
            match effect {
                Effect::Paintbrush { .. } => {
                    prop_assert_eq!(document.grid(), &old.grid);
                }
                Effect::Devourer { .. } | Effect::Erosion { .. } => {
                    prop_assert_eq!(stats.voxels_added, 0);
                    prop_assert_eq!(document.material(), &old.material);
                }
                Effect::Dilation { .. } | Effect::Growth { .. } | Effect::Clay { .. } => {
                    prop_assert_eq!(stats.voxels_removed, 0);
                }
                Effect::Smooth { .. } => {}
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
fn a_stroke_on_its_first_surface_does_not_bite_twice() {
    let removed = |surface| {
        let mut document = block(ColourDepth::None);
        let effect = Effect::Devourer { outline: Outline::Round };
        let footprint = looking(Vec3::new(20.0, 90.0, 20.0), Vec3::new(20.0, 36.0, 20.0), 4.0);
        let spray = Spray { effect, footprint, reach_vx: 2.0 };
        document.apply(&Command::Begin { label: "groove".to_string() }).unwrap();
        let bite = || Command::Spray { spray, surface };
        let first = document.apply(&bite()).unwrap().stats.voxels_removed;
        let second = document.apply(&bite()).unwrap().stats.voxels_removed;
        document.apply(&Command::End).unwrap();
        assert_eq!(document.history().undo_count(), 1);
        // The next stroke begins with the surface as it is then.
        document.apply(&Command::Begin { label: "again".to_string() }).unwrap();
        let third = document.apply(&bite()).unwrap().stats.voxels_removed;
        document.apply(&Command::End).unwrap();
        (first, second, third)
    };
    let (first, second, third) = removed(SpraySurface::Stroke);
    assert!(first > 0 && second == 0 && third > 0);
    let (first, second, _) = removed(SpraySurface::Now);
    assert!(first > 0 && second > 0);
}

#[test]
fn unusable_sprays_are_refused_and_change_nothing() {
    let mut document = block(ColourDepth::None);
    let before = document.contents().clone();
    let footprint = looking(Vec3::new(20.0, 90.0, 20.0), Vec3::new(20.0, 36.0, 20.0), 4.0);
    let paint = Effect::Paintbrush { colour: RED, cover: 1.0 };
    let mut apply = |effect, reach_vx| {
        let spray = Spray { effect, footprint, reach_vx };
        document.apply(&Command::Spray { spray, surface: SpraySurface::Now })
    };
    assert!(matches!(apply(paint, 2.0), Err(CommandError::NoColour)));
    let devourer = Effect::Devourer { outline: Outline::Round };
    assert!(matches!(apply(devourer, 1e9), Err(CommandError::Spray("the reach"))));
    assert_eq!(document.contents(), &before);
}
