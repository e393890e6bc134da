//! Builds a grid by layers of leaves, the lowest first: for loaders whose input is larger than their result.
//!
//! Takes the bits of a layer as rows of leaves along x, written on all threads. Holds a row in work per thread beside the
//! finished leaves, and knows at any time how many bytes those take.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::UVec3;
use rayon::prelude::*;

use super::build::{Value, leaf_of, node_of};
use super::node::{Child, NODE_EDGE_LOG2, TreeNode};
use super::{Grid, LEAF_EDGE_VX};
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick};

/// Rows of voxels in a row of leaves, which is one word of 64 voxels long per leaf.
const ROWS: usize = (LEAF_EDGE_VX * LEAF_EDGE_VX) as usize;

/// A grid that is being built.
pub(crate) struct GridLayers {
    /// Still empty.
    grid: Grid,
    /// The leaves so far, x fastest, then y, then z.
    leaves: Vec<Child>,
    bytes: u64,
}

/// The voxels of a row of leaves.
pub(crate) struct LeafRow<'a> {
    /// Words of 64 voxels along x, the first in the lowest bit: those of a row of voxels follow one another. Rows follow
    /// along y, 64 of them, then along z. 0 at first; bits beyond the grid do not count.
    pub words: &'a mut [u64],
    /// Words in a row of voxels.
    pub width: usize,
    /// The lowest y.
    pub y: u32,
}

impl LeafRow<'_> {
    /// Returns a row of voxels, at y and z in the row of leaves.
    #[inline(always)]
    pub fn row(&mut self, y: u32, z: u32) -> &mut [u64] {
        let from = (y + LEAF_EDGE_VX * z) as usize * self.width;
        &mut self.words[from..from + self.width]
    }
}

impl GridLayers {
    /// Begins to build a grid of the size of `grid`, which must be empty.
    pub fn new(grid: Grid) -> GridLayers {
        GridLayers { grid, leaves: Vec::new(), bytes: 0 }
    }

    /// Returns the number of layers, of 64 voxels along z.
    pub fn count(&self) -> u32 {
        self.leaf_dims().z
    }

    /// Adds the next layer: `f` writes each of its rows of leaves. Returns the bytes of all layers so far.
    pub fn add(&mut self, f: &(dyn Fn(&mut LeafRow) + Sync)) -> u64 {
        let leaf_dims = self.leaf_dims();
        let z = self.leaves.len() as u32 / (leaf_dims.x * leaf_dims.y);
        let (width, extent) = (leaf_dims.x as usize, self.grid.extent);
        let bytes = AtomicU64::new(0);
        let rows = (0..leaf_dims.y).into_par_iter().map_init(
            || vec![0u64; width * ROWS],
            |words, y| {
                words.fill(0);
                f(&mut LeafRow { words, width, y: y * LEAF_EDGE_VX });
                let leaf = |x: u32| {
                    let at = UVec3::new(x, y, z);
                    let child = match uniform(words, width, x as usize) {
                        Some(false) => Child::Empty,
                        Some(true) if extent.holds_brick((at << NODE_EDGE_LOG2) + 7) => Child::Full,
                        _ => leaf_of(&extent, at, |b, valid| {
                            Value::of(brick_of(words, width, b).and(valid))
                        }),
                    };
                    if let Child::Mixed(node) = &child {
                        bytes.fetch_add(node.heap_bytes(), Ordering::Relaxed);
                    }
                    child
                };
                (0..leaf_dims.x).map(leaf).collect::<Vec<Child>>()
            },
        );
        let rows: Vec<Vec<Child>> = rows.collect();
        self.leaves.extend(rows.into_iter().flatten());
        self.bytes += bytes.into_inner();
        self.bytes + (self.leaves.len() * size_of::<Child>()) as u64
    }

    /// Returns the grid. Layers that were not added are empty.
    pub fn finish(self) -> Grid {
        let leaf_dims = self.leaf_dims();
        let GridLayers { mut grid, mut leaves, .. } = self;
        let mut take = |leaf: UVec3| {
            let index = (leaf.x + leaf_dims.x * (leaf.y + leaf_dims.y * leaf.z)) as usize;
            leaves.get_mut(index).map_or(Child::Empty, |leaf| std::mem::replace(leaf, Child::Empty))
        };
        let root: TreeNode = node_of(&grid.extent, UVec3::ZERO, grid.levels, &mut take);
        grid.root = Arc::new(root);
        grid
    }

    fn leaf_dims(&self) -> UVec3 {
        (self.grid.extent.bricks + 7) >> NODE_EDGE_LOG2
    }
}

/// Returns whether all bits of the leaf at `x` of a row are 0 (`false`) or 1.
fn uniform(words: &[u64], width: usize, x: usize) -> Option<bool> {
    let first = words[x];
    let same = words[x..].iter().step_by(width).all(|word| *word == first);
    match first {
        0 if same => Some(false),
        u64::MAX if same => Some(true),
        _ => None,
    }
}

/// Returns the bits of the brick at `b` of a row of leaves.
fn brick_of(words: &[u64], width: usize, b: UVec3) -> Brick {
    let low = (b % 8) * BRICK_EDGE_VX;
    let word = (b.x >> NODE_EDGE_LOG2) as usize;
    let rows = std::array::from_fn(|z| {
        (0..8).fold(0, |slice, y| {
            let row = low.y as usize + y + LEAF_EDGE_VX as usize * (low.z as usize + z);
            slice | (words[word + width * row] >> low.x & 0xFF) << (8 * y)
        })
    });
    Brick::from_rows(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Random;
    use glam::{IVec3, Vec3};

    #[test]
    fn layers_make_the_grid_of_their_bits() {
        let mut random = Random(5);
        for dims in [UVec3::new(130, 70, 65), UVec3::new(64, 128, 192), UVec3::new(1, 3, 200)] {
            for share in [0, 1, 50, 99, 100] {
                let empty = Grid::of_size(dims, Vec3::ONE).unwrap();
                let mut expected = empty.clone();
                for index in 0..dims.element_product() {
                    let v = UVec3::new(
                        index % dims.x,
                        index / dims.x % dims.y,
                        index / (dims.x * dims.y),
                    );
                    // Cubes of 16 voxels with dust.
                    let cube = (v / 16).dot(UVec3::new(1, 7, 31)) % 100;
                    let exists = cube < share && (share == 100 || random.unit() > 0.001);
                    expected.set(v.as_ivec3(), exists);
                }
                let mut layers = GridLayers::new(empty);
                for layer in 0..layers.count() {
                    layers.add(&|row| {
                        for (z, y) in (0..64).flat_map(|z| (0..64).map(move |y| (z, y))) {
                            let at = IVec3::new(0, (row.y + y) as i32, (64 * layer + z) as i32);
                            for x in 0..64 * row.width as i32 {
                                // Bits beyond the grid do not count.
                                let exists = expected.get(at + IVec3::X * x)
                                    || !expected.contains(at + IVec3::X * x);
                                row.row(y, z)[x as usize / 64] |= u64::from(exists) << (x % 64);
                            }
                        }
                    });
                }
                let found = layers.finish();
                assert_eq!(found, expected, "{dims}, {share}");
                assert_eq!(found.opaque_count(), expected.opaque_count());
                super::super::node::tests::check(
                    &found.root,
                    UVec3::ZERO,
                    found.levels,
                    &found.extent,
                );
            }
        }
    }
}
