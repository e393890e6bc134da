use glam::Quat;
use proptest::prelude::*;

use super::*;
use crate::tools::solid::{Primitive, Solid};

const DIMS: UVec3 = UVec3::new(40, 32, 36);

fn grid() -> Grid {
    Grid::new(DIMS, Vec3::ONE, 1 << 20).unwrap()
}

fn with(voxels: impl Fn(IVec3) -> bool) -> Grid {
    let mut grid = grid();
    for v in every() {
        grid.set(v, voxels(v));
    }
    grid
}

fn every() -> impl Iterator<Item = IVec3> {
    let d = DIMS.as_ivec3();
    (0..d.z)
        .flat_map(move |z| (0..d.y).flat_map(move |y| (0..d.x).map(move |x| IVec3::new(x, y, z))))
}

fn has(list: &ListedBricks, v: IVec3) -> bool {
    let b = v.as_uvec3() / BRICK_EDGE_VX;
    let [x, y, z] = (v.as_uvec3() % BRICK_EDGE_VX).to_array();
    list.bricks().iter().any(|(brick, bits)| *brick == b && bits.get(x, y, z))
}

#[test]
fn a_mask_that_grows_and_shrinks_again_is_as_before() {
    let ball = |v: IVec3| (v - IVec3::new(19, 15, 17)).length_squared() <= 64;
    let mask = with(ball);
    for by in 1..=6 {
        let added = grown(&mask, by);
        let all = with(|v| ball(v) || has(&added, v));
        // Round to about a voxel.
        let from = |v: IVec3| (v - IVec3::new(19, 15, 17)).as_vec3().length() - 8.0;
        for v in every() {
            let far = from(v);
            assert!(!all.get(v) || far <= 1.4 * by as f32 + 0.5, "{v} of {by}");
            assert!(all.get(v) || far >= 0.8 * by as f32 - 0.8, "{v} of {by}");
        }
        let removed = shrunk(&all, by);
        let back = with(|v| all.get(v) && !has(&removed, v));
        for v in every().filter(|v| back.get(*v) != mask.get(*v)) {
            // Tips one voxel wide may go, and furrows one voxel wide stay filled.
            assert!(from(v).abs() <= 1.0, "{v} after {by}");
        }
    }
}

#[test]
fn a_mask_of_everything_stays_and_one_at_the_border_shrinks_from_within() {
    let all = with(|_| true);
    assert!(shrunk(&all, 3).bricks().is_empty());
    assert!(grown(&all, 3).bricks().is_empty());
    let slab = with(|v| v.x < 10);
    let removed = shrunk(&slab, 2);
    for v in every() {
        assert_eq!(has(&removed, v), (8..10).contains(&v.x), "{v}");
    }
    let nothing = grid();
    assert!(grown(&nothing, 5).bricks().is_empty() && shrunk(&nothing, 5).bricks().is_empty());
    assert_eq!(evened(&nothing, 2), Default::default());
}

#[test]
fn a_mask_is_evened_as_if_it_went_on_beyond_the_border() {
    for radius in [1, 3, 8] {
        let all = with(|_| true);
        assert_eq!(evened(&all, radius), Default::default(), "{radius}");
        // Planes that end at the border keep their full extent there.
        let slab = with(|v| v.x < 10);
        assert_eq!(evened(&slab, radius), Default::default(), "{radius}");
        let high = with(|v| v.z >= 30 && v.y >= 21);
        let (added, removed) = evened(&high, radius);
        let end =
            |x: i32, v: IVec3| has(&removed, IVec3 { x, ..v }) || has(&added, IVec3 { x, ..v });
        for v in every().filter(|v| v.x == 20) {
            assert!((0..DIMS.x as i32).all(|x| end(x, v) == end(20, v)), "{v} of {radius}");
        }
    }
    // Voxel by voxel, in a grid that ends inside a brick and at a brick border.
    let dims = DIMS.as_ivec3();
    let noise = |v: IVec3| (v.x * 7 + v.y * 13 + v.z * 29 + v.x * v.y * 3 + v.y * v.z) % 5 < 3;
    let mask = with(noise);
    let (added, removed) = evened(&mask, 2);
    for v in every().filter(|v| (*v - dims / 2).abs().cmpgt(dims / 2 - 4).any()) {
        let around = (0..125).filter(|i| {
            let at = v + IVec3::new(i % 5, i / 5 % 5, i / 25) - 2;
            noise(at.clamp(IVec3::ZERO, dims - 1))
        });
        let most = around.count() > 62;
        assert_eq!(has(&added, v), most && !noise(v), "{v}");
        assert_eq!(has(&removed, v), !most && noise(v), "{v}");
    }
}

#[test]
fn smoothing_removes_bumps_of_an_outline_and_keeps_planes() {
    let bump = |v: IVec3| v.x < 16 || (v == IVec3::new(16, 12, 12));
    let (added, removed) = evened(&with(bump), 2);
    assert!(has(&removed, IVec3::new(16, 12, 12)));
    let inner = |v: IVec3| v.cmpge(IVec3::splat(3)).all() && (v + 3).cmplt(DIMS.as_ivec3()).all();
    assert!(
        every().filter(|v| inner(*v) && v.x != 16).all(|v| !has(&removed, v) && !has(&added, v))
    );
}

#[test]
fn cavities_are_furrows_and_corners_but_not_planes_nor_ridges() {
    // A block with a furrow along z in its upper face, and a ridge.
    let clay = |v: IVec3| match v.x {
        10..13 => v.y < 12,
        26..29 => v.y < 20,
        _ => v.y < 16,
    };
    let found = cavities(&with(clay), 3);
    assert!(has(&found, IVec3::new(11, 11, 18)), "the bottom of the furrow");
    assert!(!has(&found, IVec3::new(19, 15, 18)), "the plane");
    assert!(!has(&found, IVec3::new(27, 19, 18)), "the ridge");
    assert!(has(&found, IVec3::new(25, 15, 18)), "the foot of the ridge");
    assert!(found.bricks().iter().all(|(b, bits)| {
        let mut within = true;
        bits.for_each(|local| {
            let v = (*b * BRICK_EDGE_VX + UVec3::from(local_coords(local))).as_ivec3();
            within &= clay(v) && flood::is_on_surface(&with(clay), v);
        });
        within
    }));
}

#[test]
fn a_flat_patch_is_the_face_of_a_solid() {
    let cube = Primitive {
        solid: Solid::Cuboid,
        centre_vx: DIMS.as_vec3() * 0.5,
        half: Vec3::splat(10.0),
        rotation: Quat::IDENTITY,
    };
    let region = cube.in_grid(Vec3::ONE);
    let clay = with(|v| region.contains_voxel(v));
    let patch = flat_patch(&clay, UVec3::new(20, 25, 18), 20.0);
    for v in every() {
        if has(&patch, v) {
            assert_eq!(v.y, 25, "{v} lies on another face");
        }
        let inside = (v - IVec3::new(20, 25, 18)).abs();
        if v.y == 25 && inside.x < 5 && inside.z < 5 {
            assert!(has(&patch, v), "{v} of the face is missing");
        }
    }
    // All around, whatever the direction.
    let all = flat_patch(&clay, UVec3::new(20, 25, 18), 180.0);
    let surface = every().filter(|v| flood::is_on_surface(&clay, *v)).count();
    let count: u32 = all.bricks().iter().map(|(_, bits)| u32::from(bits.count())).sum();
    assert_eq!(count as usize, surface);
    // A voxel inside yields none.
    assert!(flat_patch(&clay, UVec3::new(20, 18, 18), 180.0).bricks().is_empty());
}

#[test]
fn thickening_reaches_into_the_air_and_into_the_clay() {
    let clay = with(|v| v.y < 16);
    let patch = flat_patch(&clay, UVec3::new(20, 15, 18), 5.0);
    let thick = thickened(&patch, clay.brick_dims(), 2);
    for (y, is) in [(12, false), (13, true), (15, true), (17, true), (18, false)] {
        assert_eq!(has(&thick, IVec3::new(20, y, 18)), is, "{y}");
    }
    assert_eq!(thickened(&patch, clay.brick_dims(), 0), patch);
    assert!((normal_at(&clay, UVec3::new(20, 15, 18)) - Vec3::Y).length() < 1e-6);
}

/// Returns the growth of a mask, computed in a single block.
fn naive_grown(mask: &Grid, by: u32) -> ListedBricks {
    let inside = VoxelBox::of_grid(mask);
    let reach = by as i32 + 1;
    let bits = BitBlock::of_grid(mask, inside.min - reach, inside.max + reach);
    let mut added = spread(bits.clone(), &filled(&bits), by).zip(&bits, |all, old| all & !old);
    added.keep_box(inside.min, inside.max);
    ListedBricks::new(added.bricks(mask.brick_dims()))
}

/// Returns what a mask loses when it shrinks, computed in a single block.
fn naive_shrunk(mask: &Grid, by: u32) -> ListedBricks {
    let inside = VoxelBox::of_grid(mask);
    let mut bits = BitBlock::of_grid(mask, inside.min - 1, inside.max + 1);
    let mut may = filled(&bits);
    may.keep_box(inside.min, inside.max);
    bits = bits.zip(&may, |bits, inside| bits | !inside);
    let start = bits.clone();
    for round in (0..by).rev() {
        let removed = filter::erosion(&bits, &may, 27 - ROUNDS[round as usize % 2]);
        bits = bits.zip(&removed, |bits, removed| bits & !removed);
    }
    ListedBricks::new(start.zip(&bits, |old, left| old & !left).bricks(mask.brick_dims()))
}

/// Returns the changes of an evened mask, computed in a single block.
fn naive_evened(mask: &Grid, radius_vx: u32) -> (ListedBricks, ListedBricks) {
    let inside = VoxelBox::of_grid(mask);
    let reach = radius_vx as i32;
    let mut bits = BitBlock::of_grid(mask, inside.min - reach, inside.max + reach);
    bits.extend_border(inside.min, inside.max);
    let mut may = filled(&bits);
    may.keep_box(inside.min, inside.max);
    let (added, removed) = filter::majority(&bits, &may, radius_vx, 1.0);
    let bricks = |block: BitBlock| ListedBricks::new(block.bricks(mask.brick_dims()));
    (bricks(added), bricks(removed))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]
    #[test]
    fn tiles_give_what_a_single_block_gives(
        dims in prop::array::uniform3(1u32..150),
        long in prop_oneof![Just(None), Just(Some([700, 3, 70])), Just(Some([9, 400, 66]))],
        filled: bool,
        boxes in prop::collection::vec((prop::array::uniform3(0u32..700), prop::array::uniform3(1u32..70)), 0..6),
        speckled: bool,
        by in 1u32..12,
    ) {
        let dims = UVec3::from(long.unwrap_or(dims));
        let mut mask = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
        if filled {
            mask.fill_bricks(|_| Brick::FULL);
        }
        for (corner, size) in boxes {
            let low = UVec3::from(corner) % dims;
            let size = (UVec3::from(size)).min(dims - low);
            for i in 0..size.element_product() {
                let at = UVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y));
                let exists = speckled && at.element_sum().is_multiple_of(2);
                mask.set((low + at).as_ivec3(), exists != filled);
            }
        }
        prop_assert_eq!(grown(&mask, by), naive_grown(&mask, by));
        prop_assert_eq!(shrunk(&mask, by), naive_shrunk(&mask, by));
        let radius = by.min(4);
        prop_assert_eq!(evened(&mask, radius), naive_evened(&mask, radius));
        let reach = by.min(MAX_REACH_VX);
        let found = cavities(&mask, reach);
        let all = mask.nonempty_bricks().filter(|(b, _)| flood::surface_of(&mask, *b) != [0; 8]);
        let near = surface_leaves(&mask).into_iter().flat_map(|leaf| {
            indices(bricks_beside_empty(&mask, leaf)).map(move |index| leaf * 8 + UVec3::from(local_coords(index)))
        });
        let near: std::collections::HashSet<UVec3> = near.collect();
        for (b, _) in all {
            prop_assert!(near.contains(&b), "{}", b);
        }
        prop_assert!(found.bricks().iter().all(|(b, _)| near.contains(b)));
    }
}

#[test]
fn a_mask_with_large_uniform_cubes_changes_at_its_outline_alone() {
    let mut mask = Grid::new(UVec3::splat(1100), Vec3::ONE, 1 << 32).unwrap();
    mask.fill_bricks(|_| Brick::FULL);
    let hole = IVec3::new(700, 511, 64);
    mask.set(hole, false);
    assert_eq!(grown(&mask, 1).bricks().len(), 1);
    assert!(grown(&mask, 1).bricks()[0].1.count() == 1);
    let lost: u32 = shrunk(&mask, 1).bricks().iter().map(|(_, mask)| u32::from(mask.count())).sum();
    assert_eq!(lost, 26);
}
