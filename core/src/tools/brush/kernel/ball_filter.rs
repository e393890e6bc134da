//! Applies filters in balls, to the voxels as another change leaves them.
//!
//! From a grid, the preceding change, and the balls of a brush to the combined change. Changes nothing itself.

use glam::IVec3;

use super::ball::BallImage;
use super::rays::{Filtered, Near};
use super::stamp::Stamp;
use crate::sculpture::Grid;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::region::{ListedBricks, VoxelBox};

/// The least share of a brush's effect at which it filters.
const LEAST_SHARE: f32 = 0.5;

/// Returns the changes of `first`, which lie in the balls, followed by those of a filter there. `margin_vx`: how far
/// around a voxel the filter reads.
pub(super) fn after(
    first: &Stamp,
    balls: &[BallImage],
    grid: &Grid,
    margin_vx: u32,
    filter: impl Fn(&Near) -> Filtered,
) -> Stamp {
    let margin = margin_vx as i32;
    let brick_dims = grid.brick_dims();
    Stamp::union(balls.iter().map(|ball| {
        let bounds = ball.bounds(grid);
        if bounds.is_empty() {
            return Stamp::default();
        }
        let before = BitBlock::of_grid(grid, bounds.min - margin, bounds.max + margin);
        let solid = before
            .zip(&part(&first.add, &before), |clay, added| clay | added)
            .zip(&part(&first.remove, &before), |clay, removed| clay & !removed);
        // Includes the changes of the other images: where they overlap, all must give the same result.
        let mut may = before.emptied();
        balls.iter().for_each(|ball| put(ball, bounds, &mut may));
        let near = Near { solid, may };
        let Filtered { add, remove } = filter(&near);
        let mut clay = near.solid;
        if let Some(add) = add {
            clay = clay.zip(&add, |clay, added| clay | added);
        }
        if let Some(remove) = remove {
            clay = clay.zip(&remove, |clay, removed| clay & !removed);
        }
        let changed = |more: &BitBlock, less: &BitBlock| {
            let mut changed = more.zip(less, |more, less| more & !less);
            changed.keep_box(bounds.min, bounds.max);
            ListedBricks::new(changed.bricks(brick_dims))
        };
        Stamp { add: changed(&clay, &before), remove: changed(&before, &clay), ..Stamp::default() }
    }))
}

/// Returns the voxels of a list that lie in a block of the position and size of `block`.
fn part(list: &ListedBricks, block: &BitBlock) -> BitBlock {
    let mut part = block.emptied();
    let first = block.origin() / BRICK_EDGE_VX as i32;
    let end = first + block.size().as_ivec3() / BRICK_EDGE_VX as i32;
    for (b, brick) in list.bricks() {
        let b = b.as_ivec3();
        if b.cmpge(first).all() && b.cmplt(end).all() {
            part.put_brick(b, brick);
        }
    }
    part
}

/// Sets the voxels of `bounds` where the brush's share is large enough.
fn put(ball: &BallImage, bounds: VoxelBox, may: &mut BitBlock) {
    let VoxelBox { min, max } = bounds;
    for z in min.z..max.z {
        for y in min.y..max.y {
            let is_in = |x: &i32| ball.share(ball.relative(IVec3::new(*x, y, z))) >= LEAST_SHARE;
            // The ball is convex.
            let first = (min.x..max.x).find(is_in);
            let last = (min.x..max.x).rev().find(is_in);
            if let (Some(first), Some(last)) = (first, last) {
                may.set_span(first, last, y, z);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::sculpture::brick::local_coords;
    use crate::sculpture::history::{Contents, SurfaceKind};
    use crate::sculpture::{ColourDepth, Material, Rgb};
    use crate::tools::brush::change::{BrushChange, Site};
    use crate::tools::brush::falloff::Falloff;
    use crate::tools::brush::kernel::filter::majority;
    use crate::tools::brush::kernel::offset;
    use crate::tools::brush::keys::{FALLOFF, STRENGTH};
    use crate::tools::brush::{BrushBall as BallOfUse, BrushDirection, BrushId, BrushUse};
    use crate::tools::symmetry::{MirrorPlane, Parity, Radial, Symmetry};

    const EDGE: i32 = 40;

    /// Returns hills of random heights about the middle of a grid, with grains above them.
    fn hills(seed: u64, voxel_size: Vec3) -> Grid {
        let mut grid = Grid::new(UVec3::splat(EDGE as u32), voxel_size, 1 << 30).unwrap();
        let mut random = seed | 1;
        let mut next = |below: u64| {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (random >> 33) % below
        };
        for z in 0..EDGE {
            for x in 0..EDGE {
                let height = 16 + next(7) as i32;
                (0..height).for_each(|y| grid.set(IVec3::new(x, y, z), true));
                grid.set(IVec3::new(x, height + 2, z), next(9) == 0);
            }
        }
        grid
    }

    fn flatten(strength: f32) -> BrushUse {
        let frame = BrushDirection::Normal(Vec3::new(0.1, 1.0, 0.2));
        let ball = BallOfUse { centre_vx: Vec3::new(15.0, 19.0, 17.0), radius: 9.0, frame };
        let used = BrushUse::in_ball(BrushId::Flatten, ball);
        used.with(STRENGTH, strength).with(FALLOFF, Falloff::Flat)
    }

    fn change(grid: &Grid, symmetry: &Symmetry, of: impl Fn(&Site) -> BrushChange) -> BrushChange {
        let material = Material::for_grid(grid, ColourDepth::None, Rgb::STONE);
        let surface = SurfaceKind::Cubes;
        let contents = Contents { surface, ..Contents::new(grid.clone(), material) };
        let images = symmetry.images(grid.dims(), grid.voxel_size());
        of(&Site { contents: &contents, surface: grid, symmetry, images: &images, picture: None })
    }

    fn changed(grid: &Grid, change: &BrushChange) -> Grid {
        let mut after = grid.clone();
        for (list, exists) in [(&change.remove, false), (&change.add, true)] {
            for (b, mask) in list.bricks() {
                mask.for_each(|local| {
                    let v = (*b * 8 + UVec3::from(local_coords(local))).as_ivec3();
                    assert_eq!(after.get(v), !exists, "{v} changes twice, or not at all");
                    after.set(v, exists);
                });
            }
        }
        after
    }

    fn symmetries() -> impl Strategy<Value = Symmetry> {
        let at_vx = Vec3::splat(EDGE as f32 / 2.0);
        prop::sample::select(vec![
            Symmetry::default(),
            Symmetry::of_axes([Some(Parity::Even), None, Some(Parity::Odd)]),
            Symmetry {
                plane: Some(MirrorPlane { at_vx, normal: Vec3::new(1.0, 0.0, 0.3) }),
                ..Symmetry::default()
            },
            Symmetry {
                radial: Some(Radial { at_vx, axis: Vec3::Y, count: 5 }),
                ..Symmetry::default()
            },
        ])
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// In sequence: the surface is levelled everywhere, then all that the balls reach is filtered.
        #[test]
        fn the_filter_follows_on_what_the_first_change_leaves(
            seed: u64, symmetry in symmetries(), flat_voxels: bool, strength in prop::sample::select(vec![0.0f32, 0.5, 1.0]),
        ) {
            let edges = if flat_voxels { Vec3::new(1.0, 1.5, 2.0) } else { Vec3::ONE };
            let grid = hills(seed, edges);
            let used = flatten(strength);
            let both = change(&grid, &symmetry, |site| offset::to_plane_then(&used, site, 2, |near| {
                let (add, remove) = majority(&near.solid, &near.may, 2, 1.0);
                Filtered { add: Some(add), remove: Some(remove) }
            }));
            let levelled = changed(&grid, &change(&grid, &symmetry, |site| offset::to_plane(&used, site, true, true)));
            let images = symmetry.images(grid.dims(), grid.voxel_size());
            let BallOfUse { centre_vx, radius, .. } = *used.ball().unwrap();
            let after = changed(&grid, &both);
            for i in 0..grid.dims().element_product() {
                let v = grid.voxel_coords(i).as_ivec3();
                let away = |centre: Vec3| ((v.as_vec3() + 0.5 - centre) * edges).length() / radius;
                let nearest = images.iter().map(|image| away(image.point(centre_vx)));
                let nearest = nearest.fold(f32::MAX, f32::min);
                let share = Falloff::Flat.at(nearest * nearest);
                if (share - LEAST_SHARE).abs() < 1e-3 {
                    continue;
                }
                let mut clay = 0;
                for d in (0..125).map(|i| IVec3::new(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2)) {
                    clay += u32::from(levelled.contains(v + d) && levelled.get(v + d));
                }
                let exists = if share > LEAST_SHARE { clay > 62 } else { levelled.get(v) };
                prop_assert_eq!(after.get(v), exists, "{} {}", v, share);
            }
        }
    }

    #[test]
    fn a_filter_that_does_nothing_leaves_the_first_change() {
        let (grid, symmetry) =
            (hills(7, Vec3::ONE), Symmetry::of_axes([Some(Parity::Even), None, None]));
        let nothing = |_: &Near| Filtered { add: None, remove: None };
        let used = flatten(1.0);
        let both = change(&grid, &symmetry, |site| offset::to_plane_then(&used, site, 2, nothing));
        let first = change(&grid, &symmetry, |site| offset::to_plane(&used, site, true, true));
        assert_eq!((both.add, both.remove), (first.add, first.remove));
    }
}
