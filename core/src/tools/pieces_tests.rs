//! Tests the pieces of a grid against a voxel-by-voxel search.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;

use super::pieces::{PiecesError, PiecesOf, fill_holes, keep_largest, pieces};
use crate::progress::{Progress, ProgressReport};
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::brick_set::BrickSet;
use crate::sculpture::edit::{EditOp, edit};
use crate::sculpture::history::Contents;
use crate::sculpture::region::VoxelBox;
use crate::sculpture::stroke::StrokeRecorder;
use crate::sculpture::{Brick, Grid};

const ROOM: u64 = 1 << 30;

fn grid_of(dims: [u32; 3], exists: impl Fn(IVec3) -> bool) -> Grid {
    let mut grid = Grid::new(dims.into(), Vec3::ONE, ROOM).unwrap();
    voxels(&grid).into_iter().for_each(|v| grid.set(v, exists(v)));
    grid
}

fn voxels(grid: &Grid) -> Vec<IVec3> {
    let count: u32 = grid.dims().element_product();
    (0..count).map(|index| grid.voxel_coords(index).as_ivec3()).collect()
}

/// Returns the voxels of each piece in order, found by a plain search.
fn by_search(grid: &Grid, part: PiecesOf) -> Vec<Vec<IVec3>> {
    let is_meant = |v: IVec3| grid.contains(v) && grid.get(v) == (part == PiecesOf::Solid);
    let mut seen = std::collections::HashSet::new();
    let mut found = Vec::new();
    for start in voxels(grid) {
        if !is_meant(start) || !seen.insert(start) {
            continue;
        }
        let (mut piece, mut next) = (vec![start], 0);
        while next < piece.len() {
            for step in [IVec3::X, IVec3::Y, IVec3::Z].into_iter().flat_map(|s| [s, -s]) {
                let v = piece[next] + step;
                if is_meant(v) && seen.insert(v) {
                    piece.push(v);
                }
            }
            next += 1;
        }
        piece.sort_by_key(|v| v.to_array());
        found.push(piece);
    }
    found
}

fn check(grid: &Grid, part: PiecesOf) {
    let mut expected = by_search(grid, part);
    let found = pieces(grid, part, ROOM, &()).unwrap();
    let mut members = vec![Vec::new(); found.list().len()];
    for v in voxels(grid) {
        match found.at(v) {
            Some(piece) => members[piece as usize].push(v),
            None => assert_ne!(grid.get(v), part == PiecesOf::Solid, "{v}"),
        }
    }
    for (number, (piece, members)) in (0..).zip(found.list().iter().zip(&mut members)) {
        members.sort_by_key(|v| v.to_array());
        assert_eq!(piece.voxels as usize, members.len());
        let low = members.iter().copied().reduce(IVec3::min).unwrap();
        let high = members.iter().copied().reduce(IVec3::max).unwrap() + 1;
        assert_eq!(piece.bounds(), (low.as_uvec3(), high.as_uvec3()));
        let at_border =
            |v: &IVec3| v.cmpeq(IVec3::ZERO).any() || (v + 1).cmpeq(grid.dims().as_ivec3()).any();
        assert_eq!(found.reaches_border(number), members.iter().any(at_border));
    }
    let most = found.list().iter().map(|piece| piece.voxels).max();
    assert_eq!(found.largest().map(|piece| found.list()[piece as usize].voxels), most);
    members.sort_by_key(|piece| piece[0].to_array());
    expected.sort_by_key(|piece| piece[0].to_array());
    assert_eq!(members, expected);
}

/// Returns noise that depends on the position alone.
fn noise(v: IVec3, seed: u32) -> u32 {
    let [x, y, z] = v.as_uvec3().to_array();
    let n = x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ z.wrapping_mul(0xC2B2_AE3D);
    let n = (n ^ seed).wrapping_mul(0x27D4_EB2F);
    (n ^ n >> 15).wrapping_mul(0x2C1B_3C6D) >> 24
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn they_are_what_a_search_finds(
        dims in prop::array::uniform3(1u32..22), density in 0u32..=256, seed: u32,
    ) {
        let grid = grid_of(dims, |v| noise(v, seed) < density);
        check(&grid, PiecesOf::Solid);
        check(&grid, PiecesOf::Empty);
    }
}

#[test]
fn full_empty_and_winding_grids() {
    for dims in [[1, 1, 1], [24, 16, 17], [9, 8, 40]] {
        for exists in [true, false] {
            let grid = grid_of(dims, |_| exists);
            check(&grid, PiecesOf::Solid);
            check(&grid, PiecesOf::Empty);
        }
    }
    // One piece that winds through all words, and a checkerboard, where nothing touches.
    let winding = |v: IVec3| match v.y % 4 {
        0 => true,
        1 => v.x == 16,
        2 => true,
        _ => v.x == 0,
    };
    let snake = grid_of([17, 15, 1], winding);
    check(&snake, PiecesOf::Solid);
    assert_eq!(pieces(&snake, PiecesOf::Solid, ROOM, &()).unwrap().list().len(), 1);
    let chequered = grid_of([9, 9, 9], |v| v.element_sum() % 2 == 0);
    assert_eq!(pieces(&chequered, PiecesOf::Solid, ROOM, &()).unwrap().list().len(), 365);
    check(&chequered, PiecesOf::Solid);
}

#[test]
fn many_layers_are_joined_by_all_threads() {
    // Two combs whose teeth stand in all layers, and whose backs join them at the very end.
    let comb = |v: IVec3| (v.x % 2 == 0 && v.y < 20) || (v.y == 21 && v.z == 79);
    let grid =
        grid_of([30, 22, 80], |v| comb(v) || (v.y == 20 && v.x == 4 * (v.x / 4) && v.z > 70));
    let found = pieces(&grid, PiecesOf::Solid, ROOM, &()).unwrap();
    assert_eq!(found.list().len(), by_search(&grid, PiecesOf::Solid).len());
    check(&grid, PiecesOf::Solid);
}

/// Returns a hollow ball with a small ball inside, a speck outside, and a hole that is open to the border.
fn hollow() -> Grid {
    grid_of([40, 40, 40], |v| {
        let r2 = (v - IVec3::splat(19)).length_squared();
        (r2 <= 225 && r2 > 100) || r2 <= 9 || v == IVec3::splat(39) || (v.x == 39 && v.y < 3)
    })
}

#[test]
fn the_largest_piece_stays_and_cavities_are_filled() {
    let grid = hollow();
    let mut ball = grid.clone();
    keep_largest(&mut ball, ROOM, &()).unwrap();
    let expected = grid_of([40, 40, 40], |v| {
        let r2 = (v - IVec3::splat(19)).length_squared();
        r2 <= 225 && r2 > 100
    });
    assert_eq!(ball, expected);
    let mut filled = grid.clone();
    fill_holes(&mut filled, ROOM, &()).unwrap();
    let expected =
        grid_of([40, 40, 40], |v| (v - IVec3::splat(19)).length_squared() <= 225 || grid.get(v));
    assert_eq!(filled, expected);
    // An empty piece that is open at one voxel of the border is no cavity.
    let cup = grid_of([10, 10, 10], |v| {
        let wall = v.min_element() == 0 || v.max_element() == 9;
        wall && v != IVec3::new(5, 5, 9)
    });
    let mut same = cup.clone();
    fill_holes(&mut same, ROOM, &()).unwrap();
    assert_eq!(same, cup);
    let mut none = grid_of([10, 10, 10], |_| false);
    keep_largest(&mut none, ROOM, &()).unwrap();
    assert_eq!(none.opaque_count(), 0);
}

#[test]
fn memory_is_bounded_and_the_work_can_be_cancelled() {
    let grid = grid_of([40, 40, 40], |v| v.element_sum() % 2 == 0);
    let error = pieces(&grid, PiecesOf::Solid, 5000, &()).unwrap_err();
    assert!(
        matches!(error, PiecesError::OverBudget(OverBudget { budget: MemoryBudget::Grids, .. })),
        "{error}"
    );
    let error = pieces(&grid, PiecesOf::Solid, 200_000, &()).unwrap_err().to_string();
    assert!(error.contains("threshold") && error.contains("allowed for grids"), "{error}");
    let report = ProgressReport::default();
    report.cancel();
    assert!(report.is_cancelled());
    let mut same = hollow();
    assert_eq!(keep_largest(&mut same, ROOM, &report), Err(PiecesError::Cancelled));
    assert_eq!(fill_holes(&mut same, ROOM, &report), Err(PiecesError::Cancelled));
    assert_eq!(same, hollow());
    let found = pieces(&same, PiecesOf::Solid, ROOM, &()).unwrap();
    assert_eq!(found.at(IVec3::new(-1, 0, 0)), None);
    assert_eq!(found.at(UVec3::splat(40).as_ivec3()), None);
}

/// Returns a full grid without the voxels of some boxes.
fn carved(dims: UVec3, boxes: &[([u32; 3], [u32; 3])]) -> Grid {
    let mut contents = Contents::of_bits(Grid::new(dims, Vec3::ONE, 1 << 32).unwrap());
    contents.grid.fill_bricks(|_| Brick::FULL);
    let (mut recorder, mut dirty) = (StrokeRecorder::default(), BrickSet::default());
    for (corner, size) in boxes {
        let min = (UVec3::from(*corner) % dims).as_ivec3();
        let cuboid = VoxelBox { min, max: min + UVec3::from(*size).as_ivec3() };
        edit(&mut contents, &cuboid, EditOp::Subtract, &mut recorder, &mut dirty);
    }
    contents.grid
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    /// Sizes of several leaves and nodes, cut by the border, with cubes that are uniform.
    #[test]
    fn cubes_of_any_size_belong_to_pieces(
        dims in prop::sample::select(&[
            [100u32, 65, 70], [700, 3, 70], [7, 600, 9], [64, 64, 128], [1, 1, 1030], [520, 20, 12],
        ][..]),
        boxes in prop::collection::vec(
            (prop::array::uniform3(0u32..1030), prop::array::uniform3(prop_oneof![1u32..3, 30u32..600])), 0..7,
        ),
        speckles in prop::collection::vec(prop::array::uniform3(0u32..1030), 0..30),
    ) {
        let mut grid = carved(dims.into(), &boxes);
        for at in speckles {
            let v = (UVec3::from(at) % grid.dims()).as_ivec3();
            grid.set(v, !grid.get(v));
        }
        check(&grid, PiecesOf::Solid);
        check(&grid, PiecesOf::Empty);
    }
}

#[test]
fn pieces_are_numbered_in_the_order_of_their_first_bricks() {
    // In linear order, the speck comes before the slab, in the order of the tree behind it.
    let dims = UVec3::new(200, 20, 20);
    let grid = carved(
        dims,
        &[([0, 0, 0], [199, 20, 8]), ([199, 1, 0], [1, 19, 8]), ([0, 0, 8], [200, 20, 1])],
    );
    let found = pieces(&grid, PiecesOf::Solid, ROOM, &()).unwrap();
    assert_eq!(found.list().len(), 2);
    assert_eq!(found.at(IVec3::new(199, 0, 0)), Some(0));
    assert_eq!(found.at(IVec3::new(0, 0, 10)), Some(1));
}

#[test]
fn a_large_grid_with_few_cavities_is_quick() {
    let boxes = [
        ([300, 300, 300], [1, 1, 1]),
        ([500, 500, 500], [100, 100, 100]),
        ([0, 700, 9], [1, 1, 1]),
    ];
    let mut grid = carved(UVec3::splat(2100), &boxes);
    let found = pieces(&grid, PiecesOf::Empty, 1 << 20, &()).unwrap();
    let voxels: Vec<u64> = found.list().iter().map(|piece| piece.voxels).collect();
    assert_eq!(voxels, [1, 1, 1_000_000]);
    assert!(found.reaches_border(0) && !found.reaches_border(1) && !found.reaches_border(2));
    assert_eq!(found.list()[2].bounds(), (UVec3::splat(500), UVec3::splat(600)));
    let solid = pieces(&grid, PiecesOf::Solid, 1 << 20, &()).unwrap();
    assert_eq!(solid.list().len(), 1);
    assert_eq!(solid.list()[0].voxels, grid.opaque_count());
    assert_eq!(solid.at(IVec3::splat(2099)), Some(0));
    assert_eq!(solid.at(IVec3::splat(550)), None);
    fill_holes(&mut grid, ROOM, &()).unwrap();
    assert_eq!(grid.opaque_count(), 2100u64.pow(3) - 1);
}
