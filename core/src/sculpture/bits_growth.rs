//! How much memory an edit of bits may need: an upper bound, before anything changes.
//!
//! Takes a grid and the region of an edit; gives bytes. Knows no limit and changes nothing.

use glam::UVec3;
use rustc_hash::FxHashSet;

use super::brick::Brick;
use super::brick_set::LeafKey;
use super::grid::{Grid, LEAF_BYTES};
use super::region::{BrickBox, ListedBricks, Region};
use super::to_paint::{PaintTarget, for_each_portion};

/// Bytes of a mixed brick.
const BRICK_BYTES: u64 = size_of::<Brick>() as u64;

/// Returns an upper bound of the bytes by which adding the voxels of a region, or removing them, makes a grid larger: a
/// quick one, or a close one.
pub(crate) fn bits_growth(grid: &Grid, region: &impl Region, adds: bool, is_close: bool) -> u64 {
    let Some(bricks) = BrickBox::around(region, grid) else { return 0 };
    if !is_close {
        let leaves = (bricks.max - 1) / 8 - bricks.min / 8 + 1;
        return bricks.brick_count() * BRICK_BYTES
            + leaves.as_u64vec3().element_product() * LEAF_BYTES;
    }
    let wanted = if adds { PaintTarget::Missing } else { PaintTarget::Existing };
    let mut growth = BitsGrowth::default();
    for_each_portion(grid, region, wanted, true, &mut |portion| {
        // Around a cube that becomes uniform, nodes may have to be opened.
        growth.bytes += portion.cubes.len() as u64 * LEAF_BYTES;
        for (b, mask) in portion.bricks {
            growth.add(grid, b, &mask, adds);
        }
    });
    growth.bytes
}

/// Returns an upper bound of the bytes by which adding listed voxels makes a grid larger.
pub(crate) fn bits_growth_of(grid: &Grid, voxels: &ListedBricks) -> u64 {
    let mut growth = BitsGrowth::default();
    for (b, mask) in voxels.bricks() {
        growth.add(grid, *b, mask, true);
    }
    growth.bytes
}

#[derive(Default)]
struct BitsGrowth {
    bytes: u64,
    /// The leaves with changed bricks.
    leaves: FxHashSet<UVec3>,
}

impl BitsGrowth {
    fn add(&mut self, grid: &Grid, b: UVec3, mask: &Brick, adds: bool) {
        let old = grid.brick(b);
        let new = if adds { old.or(mask) } else { old.and_not(mask) };
        let is_mixed = |bits: &Brick| !bits.is_empty() && *bits != grid.valid_mask(b);
        if is_mixed(&new) && !is_mixed(old) {
            self.bytes += BRICK_BYTES;
        }
        let leaf = b / 8;
        if self.leaves.insert(leaf) && grid.leaf_bits(LeafKey::of(leaf)).is_uniform() {
            self.bytes += LEAF_BYTES;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::brick_set::BrickSet;
    use crate::sculpture::edit::{EditOp, edit};
    use crate::sculpture::history::Contents;
    use crate::sculpture::region::VoxelBox;
    use crate::sculpture::stroke::StrokeRecorder;
    use glam::{IVec3, Vec3};
    use proptest::prelude::*;

    proptest! {
        /// No edit makes a grid larger than foretold, and the close bound is at most the quick one.
        #[test]
        fn edits_take_no_more_than_foretold(
            dims in prop::array::uniform3(1u32..600),
            edits in prop::collection::vec((prop::array::uniform2(prop::array::uniform3(-20i32..620)), any::<bool>()), 1..6),
        ) {
            let mut contents = Contents::of_bits(Grid::of_size(UVec3::from(dims), Vec3::ONE).unwrap());
            let (mut recorder, mut dirty) = (StrokeRecorder::default(), BrickSet::default());
            for (corners, adds) in edits {
                let [a, b] = corners.map(IVec3::from);
                let region = VoxelBox { min: a.min(b), max: a.max(b) };
                let [quick, close] = [false, true].map(|is_close| bits_growth(&contents.grid, &region, adds, is_close));
                let before = contents.grid.heap_bytes();
                let op = if adds { EditOp::Add(None) } else { EditOp::Subtract };
                edit(&mut contents, &region, op, &mut recorder, &mut dirty);
                let grown = contents.grid.heap_bytes().saturating_sub(before);
                prop_assert!(grown <= close && close <= quick, "{grown} {close} {quick}");
            }
        }
    }

    #[test]
    fn the_close_bound_is_near_the_truth() {
        let mut grid = Grid::of_size(UVec3::splat(512), Vec3::ONE).unwrap();
        grid.fill_bricks(|_| Brick::FULL);
        let mut contents = Contents::of_bits(grid);
        let (mut recorder, mut dirty) = (StrokeRecorder::default(), BrickSet::default());
        let region = VoxelBox { min: IVec3::new(3, 5, 7), max: IVec3::new(403, 405, 407) };
        let close = bits_growth(&contents.grid, &region, false, true);
        let before = contents.grid.heap_bytes();
        edit(&mut contents, &region, EditOp::Subtract, &mut recorder, &mut dirty);
        let grown = contents.grid.heap_bytes() - before;
        assert!(close >= grown && close <= grown + grown / 2, "{grown}, foretold {close}");
    }
}
