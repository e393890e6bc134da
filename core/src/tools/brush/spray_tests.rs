//! Tests of the voxels that sprays add, remove and paint.

use super::footprint::{Coverage, Footprint, Outline};
use super::spray::{Effect, Smoothing, Spray, Stamp};
use crate::sculpture::brick::local_coords;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{Brick, ColourDepth, Grid, Rgb};
use glam::{IVec3, UVec3, Vec3};

const COLOUR: Rgb = Rgb::new(200, 30, 40);

/// A slab that fills y < 20 of a 64^3 grid.
fn slab() -> Grid {
    let mut grid = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 30).unwrap();
    grid.fill_bricks(|b| Brick::below([8, (20 - (b.y * 8).min(20)).min(8), 8]));
    grid
}

/// A footprint that looks straight down on (32, 32), a ray a voxel at the slab's surface.
fn from_above(radius: f32, outline: Outline) -> Footprint {
    let height = 100.0;
    Footprint {
        eye_vx: Vec3::new(32.5, 20.0 + height, 32.5),
        aim: Vec3::NEG_Y,
        across: Vec3::X / height,
        down: Vec3::Z / height,
        radius,
        outline,
        coverage: Coverage::Rays,
    }
}

fn spray(effect: Effect, footprint: Footprint, reach_vx: f32) -> Spray {
    Spray { effect, footprint, reach_vx }
}

fn voxels(bricks: &ListedBricks) -> Vec<IVec3> {
    let mut all = Vec::new();
    for (b, mask) in bricks.bricks() {
        mask.for_each(|i| all.push((*b * 8 + UVec3::from(local_coords(i))).as_ivec3()));
    }
    all
}

#[test]
fn the_paintbrush_paints_what_is_seen_under_the_disc() {
    let grid = slab();
    let effect = Effect::Paintbrush { colour: COLOUR, cover: 1.0 };
    let stamp = spray(effect, from_above(6.0, Outline::Round), 3.0).stamp(&grid, &grid);
    let mut painted = voxels(&stamp.paint);
    painted.sort_by_key(|v| (v.z, v.x));
    let mut disc = Vec::new();
    for z in -6i32..=6 {
        for x in -6i32..=6 {
            if x * x + z * z <= 36 {
                disc.push(IVec3::new(32 + x, 19, 32 + z));
            }
        }
    }
    assert_eq!(painted, disc);
    assert!(stamp.add.bricks().is_empty() && stamp.remove.bricks().is_empty());
}

#[test]
fn cover_is_the_share_of_the_colour_that_a_pass_mixes_in() {
    let grid = slab();
    let grey = Rgb::new(100, 100, 100);
    for depth in [ColourDepth::Bits8, ColourDepth::Bits16, ColourDepth::Bits24] {
        let now = depth.quantise(grey);
        let mix = |cover: f32, eye: f32| {
            let mut footprint = from_above(20.0, Outline::Square);
            footprint.eye_vx.y += eye;
            let spray = spray(Effect::Paintbrush { colour: COLOUR, cover }, footprint, 0.0);
            let paint = spray.paint(depth).unwrap();
            let seen = voxels(&spray.stamp(&grid, &grid).paint);
            assert_eq!(seen.len(), 41 * 41);
            let kept = |v: &IVec3| depth.quantise(paint(v.as_uvec3(), now));
            seen.iter().map(kept).collect::<Vec<Rgb>>()
        };
        let mixed = mix(0.3, 0.0);
        for channel in 0..3 {
            let sum: f32 = mixed.iter().map(|c| f32::from(c.0[channel])).sum();
            let mean = sum / mixed.len() as f32;
            let (from, to) = (f32::from(now.0[channel]), f32::from(COLOUR.0[channel]));
            let wanted = from + 0.3 * (to - from);
            assert!((mean - wanted).abs() < 3.0, "{depth:?} {channel}: {mean} not {wanted}");
        }
        assert_eq!(mixed, mix(0.3, 0.0), "a pass replayed is the same pass");
        if depth == ColourDepth::Bits8 {
            assert_ne!(mixed, mix(0.3, 0.001), "another pass scatters otherwise");
        }
        assert!(mix(0.0, 0.0).iter().all(|c| *c == now));
        assert!(mix(1.0, 0.0).iter().all(|c| *c == depth.quantise(COLOUR)));
    }
}

#[test]
fn a_square_footprint_is_square() {
    let grid = slab();
    let effect = Effect::Paintbrush { colour: COLOUR, cover: 1.0 };
    let stamp = spray(effect, from_above(4.0, Outline::Square), 0.0).stamp(&grid, &grid);
    assert_eq!(voxels(&stamp.paint).len(), 9 * 9);
}

#[test]
fn the_devourer_bites_a_ball_or_a_cube() {
    let grid = slab();
    for (outline, expected) in [(Outline::Round, 33), (Outline::Square, 125)] {
        let one = from_above(0.0, Outline::Round);
        let stamp = spray(Effect::Devourer { outline }, one, 2.0).stamp(&grid, &grid);
        let bitten = voxels(&stamp.remove);
        assert_eq!(bitten.len(), expected);
        let centre = IVec3::new(32, 19, 32);
        assert!(bitten.iter().all(|v| (*v - centre).abs().max_element() <= 2));
    }
}

#[test]
fn rays_are_cast_on_the_surface_at_the_beginning_of_the_stroke() {
    let (surface, mut grid) = (slab(), slab());
    grid.set(IVec3::new(32, 19, 32), false);
    let effect = Effect::Devourer { outline: Outline::Round };
    let spray = spray(effect, from_above(0.0, Outline::Round), 0.0);
    let at_beginning = voxels(&spray.stamp(&grid, &surface).remove);
    let now = voxels(&spray.stamp(&grid, &grid).remove);
    assert_eq!(at_beginning, [IVec3::new(32, 19, 32)]);
    assert_eq!(now, [IVec3::new(32, 18, 32)]);
}

#[test]
fn filters_leave_a_plane_alone() {
    let grid = slab();
    for effect in [
        Effect::Erosion { threshold: 14 },
        Effect::Dilation { threshold: 10, colour: Some(COLOUR) },
        Effect::Growth { threshold: 12, colour: Some(COLOUR) },
        Effect::Smooth(Smoothing::Majority { radius_vx: 2 }),
    ] {
        let stamp = spray(effect, from_above(8.0, Outline::Round), 4.0).stamp(&grid, &grid);
        assert_eq!(stamp, Stamp::default(), "{}", effect.name());
    }
}

#[test]
fn smoothing_takes_a_single_voxel_and_fills_a_single_hole() {
    let mut grid = slab();
    grid.set(IVec3::new(32, 20, 32), true);
    grid.set(IVec3::new(36, 19, 32), false);
    let effect = Effect::Smooth(Smoothing::Majority { radius_vx: 1 });
    let stamp = spray(effect, from_above(8.0, Outline::Round), 3.0).stamp(&grid, &grid);
    assert_eq!(voxels(&stamp.remove), [IVec3::new(32, 20, 32)]);
    assert_eq!(voxels(&stamp.add), [IVec3::new(36, 19, 32)]);
}

#[test]
fn clay_is_a_mound_highest_in_the_middle() {
    let grid = slab();
    let effect = Effect::Clay { colour: COLOUR };
    let stamp = spray(effect, from_above(10.0, Outline::Round), 5.0).stamp(&grid, &grid);
    let clay = voxels(&stamp.add);
    let height = |x: i32| clay.iter().filter(|v| v.x == x && v.z == 32).map(|v| v.y).max();
    assert_eq!(height(32), Some(24));
    assert!(height(38) < height(34) && height(41) < height(38));
    assert!(clay.iter().all(|v| (*v - IVec3::new(32, 19, 32)).abs().max_element() <= 12));
}

#[test]
fn what_meets_nothing_does_nothing_and_nonsense_is_refused() {
    let grid = slab();
    let mut up = from_above(5.0, Outline::Round);
    up.aim = Vec3::Y;
    let effect = Effect::Devourer { outline: Outline::Round };
    assert_eq!(spray(effect, up, 3.0).stamp(&grid, &grid), Stamp::default());
    assert!(spray(effect, up, f32::NAN).check().is_err());
    assert!(spray(effect, from_above(1e9, Outline::Round), 3.0).check().is_err());
    let effect = Effect::Erosion { threshold: 99 };
    assert_eq!(spray(effect, up, 3.0).check(), Err("the threshold"));
}
