//! A mesh that is kept from one export to the next: after edits only what they may change is made anew.
//!
//! Blocks of cells of the lattice are meshed independently, each with all vertices of its faces; where blocks meet, both
//! have a vertex. Put together, each vertex is there once, and the faces are those of the mesh that is made at once, in
//! another order. What has changed is found by comparing the contents with those of the last time. Knows no files.

use std::collections::HashMap;
use std::sync::Arc;

use glam::UVec3;
use rayon::prelude::*;

use super::budget::Pieces;
use super::place::{AtCorners, OnSurface, Place};
use super::rows::Cells;
use super::slab::{CornerKey, Slab};
use super::smoothing::Smoothing;
use super::{Budget, Mesh, MeshError, MeshKind, Part, VertexColours};
use crate::progress::Progress;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::brick_set::BrickSet;
use crate::sculpture::history::Contents;
use crate::sculpture::{Grid, Limits, Rgb};

/// Cells of a block along each axis: a word along x, and few across, as all of a block are made anew for any change.
const BLOCK: UVec3 = UVec3::new(Cells::MOST_ALONG_X, 16, 16);

/// The part of a block, and what its vertices are.
#[derive(Default, Debug)]
struct Block {
    part: Part,
    keys: Vec<CornerKey>,
}

impl Block {
    fn heap_bytes(&self) -> u64 {
        self.part.heap_bytes() + (self.keys.capacity() * size_of::<CornerKey>()) as u64
    }
}

/// See the module text. Greedy meshes cannot be kept: a rectangle may go through all blocks.
#[derive(Debug)]
pub struct KeptMesh {
    kind: MeshKind,
    colours: VertexColours,
    /// What the blocks are of; none before the first time, and after work that was given up.
    contents: Option<Arc<Contents>>,
    /// Of the smooth surface.
    smoothing: Option<Smoothing>,
    /// By x, y, z.
    blocks: Vec<Block>,
}

impl KeptMesh {
    /// A mesh of this kind, of nothing yet. None for kinds that cannot be kept.
    pub fn new(kind: MeshKind, colours: VertexColours) -> Option<KeptMesh> {
        let kept = KeptMesh { kind, colours, contents: None, smoothing: None, blocks: Vec::new() };
        (kind != MeshKind::Greedy).then_some(kept)
    }

    /// Whether it is a mesh of this kind.
    pub fn is_of(&self, kind: MeshKind, colours: VertexColours) -> bool {
        (self.kind, self.colours) == (kind, colours)
    }

    /// Bytes in memory, without those of the contents.
    pub fn heap_bytes(&self) -> u64 {
        let smoothing = self.smoothing.as_ref().map_or(0, Smoothing::heap_bytes);
        smoothing + self.blocks.iter().map(Block::heap_bytes).sum::<u64>()
    }

    /// Makes it the mesh of `contents`, within `limits`. Returns how many of how many blocks were made anew.
    pub fn update(
        &mut self,
        contents: &Arc<Contents>,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<[usize; 2], MeshError> {
        let grid = &contents.grid;
        let before = self.contents.take().filter(|before| {
            let is_coloured = |contents| self.colours.are_in(contents);
            let base = |contents: &Contents| contents.material.base();
            before.grid.dims() == grid.dims()
                && before.grid.voxel_size() == grid.voxel_size()
                && is_coloured(before) == is_coloured(contents)
                && (!is_coloured(contents) || base(before) == base(contents))
        });
        let mut changed = before.as_ref().map(|before| self.changed_bricks(before, contents));
        if self.kind == MeshKind::Smooth {
            let smoothing = match self.smoothing.take() {
                Some(kept) if changed.is_some() => kept,
                _ => Smoothing::new(grid, limits)?,
            };
            let smoothing = self.smoothing.insert(smoothing);
            smoothing.update(grid, changed.as_mut(), progress)?;
        }
        let dims = block_dims(grid);
        let count = dims.element_product() as usize;
        let mut stale = BrickSet::new(count);
        match &changed {
            Some(changed) => changed.iter().for_each(|&brick| {
                for block in blocks_beside(grid, brick) {
                    stale.insert(block);
                }
            }),
            None => {
                self.blocks.clear();
                self.blocks.resize_with(count, Block::default);
                (0..count as u32).for_each(|block| stale.insert(block));
            }
        }
        let mut anew = Vec::new();
        stale.collect_into(&mut anew);
        let budget = Budget::new(limits);
        let kept = self.blocks.iter().map(Block::heap_bytes).sum::<u64>();
        budget.take(kept);
        progress.begin("making the mesh");
        let pieces = Pieces::new(progress, [0.0, 1.0], anew.len());
        let made = match &self.smoothing {
            None => remake(contents, self.colours, &AtCorners, &anew, &budget, &pieces),
            Some(smoothing) => {
                let place = OnSurface::new(grid, smoothing.levels());
                remake(contents, self.colours, &place, &anew, &budget, &pieces)
            }
        };
        progress.end();
        if progress.is_cancelled() {
            return Err(MeshError::Cancelled);
        }
        budget.check()?;
        let made = made.ok_or(MeshError::Cancelled)?;
        for (&block, made) in anew.iter().zip(made) {
            self.blocks[block as usize] = made;
        }
        self.contents = Some(Arc::clone(contents));
        Ok([anew.len(), count])
    }

    /// The bricks whose voxels, or colours if they count, differ; rising.
    fn changed_bricks(&self, before: &Contents, now: &Contents) -> Vec<u32> {
        let colours = self.colours.are_in(now);
        let differs = |&brick: &u32| {
            let brick = brick as usize;
            before.grid.brick_at(brick) != now.grid.brick_at(brick)
                || colours && before.material.page(brick) != now.material.page(brick)
        };
        let all = 0..now.grid.brick_count() as u32;
        all.into_par_iter().with_min_len(1 << 12).filter(differs).collect()
    }

    /// The mesh that it is at present, each vertex once.
    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        let Some(contents) = &self.contents else {
            return Ok(Mesh { parts: Vec::new(), base: Rgb::STONE });
        };
        let dims = block_dims(&contents.grid);
        // The number of the first vertex that each block owns.
        let counts: Vec<u64> = (0..self.blocks.len())
            .into_par_iter()
            .map(|block| {
                let cells = cells_of(&contents.grid, dims, block);
                let keys = self.blocks[block].keys.iter();
                keys.filter(|key| cells.contains(key.corner)).count() as u64
            })
            .collect();
        let all: u64 = counts.iter().sum();
        if all > u64::from(u32::MAX) {
            return Err(MeshError::TooLarge(all));
        }
        let mut firsts = Vec::with_capacity(counts.len());
        let mut first = 0u32;
        for count in counts {
            firsts.push(first);
            first += count as u32;
        }
        // The numbers of the vertices at the lowest sides of blocks, which others have, too.
        let mut shared = HashMap::new();
        for (block, Block { keys, .. }) in self.blocks.iter().enumerate() {
            let cells = cells_of(&contents.grid, dims, block);
            let mut number = firsts[block];
            for key in keys {
                if cells.contains(key.corner) {
                    if cells.is_shared(key.corner) {
                        shared.insert(*key, number);
                    }
                    number += 1;
                }
            }
        }
        let parts = self.blocks.par_iter().enumerate().map(|(block, Block { part, keys })| {
            let cells = cells_of(&contents.grid, dims, block);
            let first = firsts[block];
            let mut own = Part { first_vertex: first, ..Part::default() };
            let mut next = 0;
            let mut numbers = Vec::with_capacity(keys.len());
            for (i, key) in keys.iter().enumerate() {
                if cells.contains(key.corner) {
                    numbers.push(next);
                    next += 1;
                    own.positions.push(part.positions[i]);
                    own.colours.extend(part.colours.get(i));
                } else {
                    // A block that follows has the same corner, and owns it.
                    numbers.push(shared[key] - first);
                }
            }
            let of = |vertex: u32| numbers[vertex as usize];
            own.quads = part.quads.iter().map(|quad| quad.map(of)).collect();
            own.triangles = part.triangles.iter().map(|triangle| triangle.map(of)).collect();
            own
        });
        Ok(Mesh { parts: parts.collect(), base: contents.material.base() })
    }
}

/// Makes blocks; none if there is no room for them or the work is cancelled.
fn remake<P: Place>(
    contents: &Contents,
    colours: VertexColours,
    place: &P,
    blocks: &[u32],
    budget: &Budget,
    pieces: &Pieces,
) -> Option<Vec<Block>>
where
    P::Layer: Send,
{
    let dims = block_dims(&contents.grid);
    let slab = Slab { contents, place, coloured: colours.are_in(contents) };
    let make = |near: &mut P::Layer, &block: &u32| {
        if pieces.is_cancelled() {
            return None;
        }
        let cells = cells_of(&contents.grid, dims, block as usize);
        let (part, keys) = slab.block(&cells, near, budget)?;
        pieces.one();
        Some(Block { part, keys })
    };
    blocks.par_iter().map_init(P::Layer::default, make).collect()
}

/// Number of blocks along each axis.
fn block_dims(grid: &Grid) -> UVec3 {
    // One corner more than voxels.
    (grid.dims() + BLOCK) / BLOCK
}

/// The cells of a block.
fn cells_of(grid: &Grid, dims: UVec3, block: usize) -> Cells {
    let block = block as u32;
    let b = UVec3::new(block % dims.x, block / dims.x % dims.y, block / (dims.x * dims.y));
    let first = b * BLOCK;
    let end = (first + BLOCK).min(grid.dims() + 1);
    Cells { x: first.x..end.x, y: first.y..end.y, z: first.z..end.z }
}

/// The blocks that a brick may change: those with a corner whose octants, or those of the corners beside it, have one of
/// its voxels.
fn blocks_beside(grid: &Grid, brick: u32) -> impl Iterator<Item = u32> {
    let dims = block_dims(grid);
    let first = grid.brick_coords(brick as usize) * BRICK_EDGE_VX;
    // One corner more on each side, as blocks have the corners at their upper sides, too.
    let low = first.saturating_sub(UVec3::splat(3)) / BLOCK;
    let high = ((first + BRICK_EDGE_VX + 2) / BLOCK).min(dims - 1);
    let block = move |x, y, z| x + dims.x * (y + dims.y * z);
    (low.z..=high.z).flat_map(move |z| {
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| block(x, y, z)))
    })
}
