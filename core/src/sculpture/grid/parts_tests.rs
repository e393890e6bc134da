//! Tests the walk by nodes against a walk brick by brick.

use glam::Vec3;
use proptest::prelude::*;

use super::*;

/// Returns whether a brick that is full within the grid is part of it, by a list of all bricks.
fn kinds_of(grid: &Grid) -> Vec<Option<bool>> {
    (0..grid.brick_count())
        .map(|index| {
            let brick = grid.brick_at(index);
            match () {
                () if brick.is_empty() => Some(false),
                () if *brick == grid.valid_mask(grid.brick_coords(index)) => Some(true),
                () => None,
            }
        })
        .collect()
}

fn bricks_of(within: BrickBox) -> impl Iterator<Item = UVec3> {
    let BrickBox { min, max } = within;
    (min.z..max.z).flat_map(move |z| {
        (min.y..max.y).flat_map(move |y| (min.x..max.x).map(move |x| UVec3::new(x, y, z)))
    })
}

fn check(grid: &Grid, within: BrickBox) {
    let kinds = kinds_of(grid);
    let mut seen = vec![0; grid.brick_count()];
    for_each_part(grid, within, &mut |part| match part {
        GridPart::Uniform { bricks, is_full } => bricks_of(bricks).for_each(|b| {
            let index = grid.brick_index(b);
            assert_eq!(kinds[index], Some(is_full), "{b}");
            seen[index] += 1;
        }),
        GridPart::Mixed(b, brick) => {
            let index = grid.brick_index(b);
            assert_eq!((kinds[index], brick), (None, grid.brick(b)), "{b}");
            seen[index] += 1;
        }
    });
    let inside = BrickBox { max: within.max.min(grid.brick_dims()), ..within };
    let mut uniform = None;
    let mut is_uniform = true;
    for b in bricks_of(inside) {
        let index = grid.brick_index(b);
        assert_eq!(std::mem::take(&mut seen[index]), 1, "{b}");
        let known = *uniform.get_or_insert(kinds[index]);
        is_uniform &= known.is_some() && known == kinds[index];
    }
    assert!(seen.iter().all(|count| *count == 0));
    assert_eq!(uniform_in(grid, within), uniform.flatten().filter(|_| is_uniform));
}

proptest! {
    #[test]
    fn parts_cover_a_box_once(
        dims in prop::array::uniform3(1u32..90),
        long in 0usize..4,
        fills in prop::collection::vec((any::<prop::sample::Index>(), 1usize..2000, 0u32..3), 0..8),
        corners in prop::array::uniform2(prop::array::uniform3(0u32..80)),
    ) {
        let mut dims = UVec3::from(dims);
        if long < 3 {
            dims[long] *= 9;
        }
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
        for (index, len, kind) in fills {
            let first = index.index(grid.brick_count());
            for index in first..grid.brick_count().min(first + len) {
                let valid = grid.valid_mask(grid.brick_coords(index));
                let odd = Brick { words: [0x1234_5678_9ABC_DEF0; 8] };
                grid.set_brick(index, [Brick::EMPTY, valid, odd.and(&valid)][kind as usize]);
            }
        }
        let [a, b] = corners.map(UVec3::from);
        check(&grid, BrickBox { min: UVec3::ZERO, max: grid.brick_dims() });
        check(&grid, BrickBox { min: a.min(b), max: a.max(b) + 1 });
    }

    #[test]
    fn a_mask_of_a_box_is_the_box(a in prop::array::uniform3(0u32..8), b in prop::array::uniform3(0u32..8)) {
        let (first, last) = (UVec3::from(a).min(b.into()), UVec3::from(a).max(b.into()));
        let mask = box_mask(first, last);
        for index in 0..512 {
            let at = UVec3::from(local_coords(index));
            let inside = at.cmpge(first).all() && at.cmple(last).all();
            prop_assert_eq!(mask.get(at.x, at.y, at.z), inside);
        }
        let mut listed = Vec::new();
        mask.for_each(|index| listed.push(index));
        prop_assert_eq!(indices(mask).collect::<Vec<_>>(), listed);
    }
}

#[test]
fn a_large_uniform_cube_is_one_part() {
    let mut grid = Grid::new(UVec3::splat(1100), Vec3::ONE, 1 << 32).unwrap();
    let parts = |grid: &Grid| {
        let mut count = 0;
        let all = BrickBox { min: UVec3::ZERO, max: grid.brick_dims() };
        for_each_part(grid, all, &mut |_| count += 1);
        count
    };
    let uniform = parts(&grid);
    assert!(uniform <= 512, "{uniform}");
    assert_eq!(
        uniform_in(&grid, BrickBox { min: UVec3::ZERO, max: grid.brick_dims() }),
        Some(false)
    );
    grid.set(glam::IVec3::splat(700), true);
    // The path to the brick: a node and a leaf of 512 children each.
    assert_eq!(parts(&grid), uniform + 2 * 511);
}
