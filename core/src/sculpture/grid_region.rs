//! The voxels of a grid as a region: whole cubes of the tree are covered at once, whatever their size.
//!
//! Knows no tool.

use fearless_simd::Simd;
use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, Brick};
use super::grid::{Grid, uniform_in};
use super::region::{BoxCoverage, BrickBox, Region, RowReach, VoxelBox};

/// The existing voxels of a grid, for edits of another one of the same size.
#[derive(Clone, Copy, Debug)]
pub struct GridRegion<'a>(pub &'a Grid);

impl Region for GridRegion<'_> {
    /// The coordinates of the row in bricks, with x = 0.
    type Row = UVec3;

    fn bounds_vx(&self) -> VoxelBox {
        let (min, max) = self.0.bounds_vx().unwrap_or_default();
        VoxelBox { min: min.as_ivec3(), max: max.as_ivec3() }
    }

    fn cut_row<S: Simd>(&self, _: S, y_vx: u32, z_vx: u32, row: &mut UVec3) -> RowReach {
        let dims = self.0.brick_dims();
        *row = UVec3::new(0, y_vx / BRICK_EDGE_VX, z_vx / BRICK_EDGE_VX);
        if row.cmpge(dims).any() {
            return RowReach::NONE;
        }
        let mut reach = RowReach::NONE;
        for (x, _) in self.0.nonempty_in_row(row.y, row.z) {
            let first = if reach.touched.is_empty() { x } else { reach.touched.start };
            reach.touched = first..x + 1;
        }
        reach
    }

    fn mask<S: Simd>(&self, _: S, row: &UVec3, _: &RowReach, brick_x: u32) -> Brick {
        let b = row.with_x(brick_x);
        if b.cmplt(self.0.brick_dims()).all() { *self.0.brick(b) } else { Brick::EMPTY }
    }

    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
        let inside = bounds.intersect(VoxelBox::of_grid(self.0));
        if inside.is_empty() {
            return BoxCoverage::None;
        }
        let edge = BRICK_EDGE_VX as i32;
        let bricks = BrickBox {
            min: (inside.min / edge).as_uvec3(),
            max: ((inside.max + (edge - 1)) / IVec3::splat(edge)).as_uvec3(),
        };
        match uniform_in(self.0, bricks) {
            Some(false) => BoxCoverage::None,
            // Those beyond the border may count as covered.
            Some(true) => BoxCoverage::All,
            None => BoxCoverage::Part,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;
    use crate::sculpture::brick_set::BrickSet;
    use crate::sculpture::contents::Contents;
    use crate::sculpture::edit::{EditOp, edit};
    use crate::sculpture::stroke::StrokeRecorder;

    fn scattered(dims: UVec3, fills: Vec<(prop::sample::Index, usize, u32)>) -> Grid {
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
        for (index, len, kind) in fills {
            let first = index.index(grid.brick_count());
            for index in first..grid.brick_count().min(first + len) {
                let valid = grid.valid_mask(grid.brick_coords(index));
                let odd = Brick { words: [0x1234_5678_9ABC_DEF0; 8] };
                grid.set_brick(index, [Brick::EMPTY, valid, odd.and(&valid)][kind as usize]);
            }
        }
        grid
    }

    proptest! {
        #[test]
        fn an_edit_by_a_grid_changes_its_voxels(
            dims in prop::array::uniform3(1u32..90),
            long in 0usize..4,
            fills in prop::array::uniform2(prop::collection::vec(
                (any::<prop::sample::Index>(), 1usize..2000, 0u32..3), 0..8,
            )),
            adds: bool,
        ) {
            let mut dims = UVec3::from(dims);
            if long < 3 {
                dims[long] *= 9;
            }
            let [of_region, of_edited] = fills;
            let region = scattered(dims, of_region);
            let mut contents = Contents::of_bits(scattered(dims, of_edited));
            let before = contents.grid.clone();
            let op = if adds { EditOp::Add(None) } else { EditOp::Subtract };
            let (mut recorder, mut dirty) = (StrokeRecorder::default(), BrickSet::default());
            edit(&mut contents, &GridRegion(&region), op, &mut recorder, &mut dirty);
            for index in 0..region.brick_count() {
                let (old, mask) = (before.brick_at(index), region.brick_at(index));
                let expected = if adds { old.or(mask) } else { old.and_not(mask) };
                prop_assert_eq!(*contents.grid.brick_at(index), expected);
            }
        }
    }
}
