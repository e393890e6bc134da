//! The bricks that are visible from outside: those neither empty nor buried.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use crate::sculpture::brick::BrickKind;
use crate::sculpture::{Brick, Grid};

/// One flag per brick, by its linear index.
#[derive(Debug, Default)]
pub(super) struct Exposure {
    flags: Vec<bool>,
    dims: UVec3,
    brick_dims: UVec3,
}

impl Exposure {
    pub fn of(grid: &Grid) -> Exposure {
        let brick_dims = grid.brick_dims();
        let per_slab = (brick_dims.x * brick_dims.y) as usize;
        let mut flags = vec![false; grid.brick_count()];
        flags.par_chunks_mut(per_slab).enumerate().for_each(|(slab, flags)| {
            for (i, flag) in flags.iter_mut().enumerate() {
                *flag = exposed(grid, slab * per_slab + i);
            }
        });
        Exposure { flags, dims: grid.dims(), brick_dims }
    }

    /// Returns whether the flags are those of a grid of the same size.
    pub fn fits(&self, grid: &Grid) -> bool {
        self.dims == grid.dims()
    }

    pub fn brick_dims(&self) -> UVec3 {
        self.brick_dims
    }

    pub fn get(&self, b: UVec3) -> bool {
        self.flags[self.index(b)]
    }

    fn index(&self, b: UVec3) -> usize {
        (b.x + self.brick_dims.x * (b.y + self.brick_dims.y * b.z)) as usize
    }

    /// Updates the changed bricks and their neighbours. Calls `flipped` with the coordinates of each whose flag has
    /// changed.
    pub fn update(&mut self, grid: &Grid, changed: &[u32], mut flipped: impl FnMut(UVec3)) {
        for &brick in changed {
            let b = grid.brick_coords(brick as usize).as_ivec3();
            for (offset, _) in NEIGHBOURS.into_iter().chain([([0; 3], SELF)]) {
                let near = b + IVec3::from(offset);
                if near.cmplt(IVec3::ZERO).any() || near.as_uvec3().cmpge(self.brick_dims).any() {
                    continue;
                }
                let near = near.as_uvec3();
                let index = self.index(near);
                let now = exposed(grid, index);
                if std::mem::replace(&mut self.flags[index], now) != now {
                    flipped(near);
                }
            }
        }
    }
}

/// The layer of a neighbour that touches a brick: its words, and the bits in each.
type Face = ([usize; 4], u64);

/// No face: a brick beside itself.
const SELF: Face = ([0; 4], 0);

/// The six neighbours of a brick, each with the layer by which it touches that brick.
const NEIGHBOURS: [([i32; 3], Face); 6] = [
    ([-1, 0, 0], ([1, 3, 5, 7], 0x8888_8888_8888_8888)),
    ([1, 0, 0], ([0, 2, 4, 6], 0x1111_1111_1111_1111)),
    ([0, -1, 0], ([2, 3, 6, 7], 0xF000_F000_F000_F000)),
    ([0, 1, 0], ([0, 1, 4, 5], 0x000F_000F_000F_000F)),
    ([0, 0, -1], ([4, 5, 6, 7], 0xFFFF_0000_0000_0000)),
    ([0, 0, 1], ([0, 1, 2, 3], 0x0000_0000_0000_FFFF)),
];

/// Returns whether a brick may be visible. A brick with an empty and an existing voxel has two of them side by side, so
/// it may be; a full one may be unless every voxel that touches it exists.
fn exposed(grid: &Grid, index: usize) -> bool {
    match grid.brick_kind(index) {
        BrickKind::Empty => return false,
        BrickKind::Mixed => return true,
        BrickKind::Full => (),
    }
    let b = grid.brick_coords(index).as_ivec3();
    let dims = grid.brick_dims().as_ivec3();
    NEIGHBOURS.into_iter().any(|(offset, face)| {
        let near = b + IVec3::from(offset);
        if near.cmplt(IVec3::ZERO).any() || near.cmpge(dims).any() {
            return true;
        }
        let near = grid.brick_index(near.as_uvec3());
        grid.brick_kind(near) != BrickKind::Full && !covers(grid.brick_at(near), face)
    })
}

fn covers(brick: &Brick, (words, mask): Face) -> bool {
    words.into_iter().all(|word| brick.words[word] & mask == mask)
}
