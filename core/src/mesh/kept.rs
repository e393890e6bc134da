//! A mesh that is kept from one export to the next: after edits, only the affected blocks are rebuilt.
//!
//! Blocks of cells of the lattice are meshed independently, each with all vertices of its faces; adjacent blocks both
//! have the vertices between them. The joined mesh has each vertex once, and the faces of a mesh that is built whole,
//! in another order. Takes the contents and the bricks that have changed since the last time; keeps no contents, so
//! that the next edit need not copy them. Knows no files.

use std::collections::HashMap;

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::budget::StagePieces;
use super::place::{AtCorners, OnSurface, VertexPlacement};
use super::rows::LatticeCells;
use super::slab::{CornerKey, Slab, SlabScratch};
use super::{Budget, Mesh, MeshError, MeshKind, MeshPart, VertexColours};
use crate::progress::Progress;
use crate::sculpture::brick::{BRICK_EDGE_VX, BrickKind};
use crate::sculpture::history::Contents;
use crate::sculpture::index_set::IndexSet;
use crate::sculpture::{Grid, Limits, Rgb};
use crate::shade::SmoothField;

/// Cells of a block along each axis: a word along x, and few across, since any change rebuilds a whole block.
const BLOCK: UVec3 = UVec3::new(LatticeCells::MOST_ALONG_X, 16, 16);

/// The part of a block, and the keys of its vertices.
#[derive(Default, Debug)]
struct MeshBlock {
    part: MeshPart,
    keys: Vec<CornerKey>,
}

impl MeshBlock {
    fn heap_bytes(&self) -> u64 {
        self.part.heap_bytes() + (self.keys.capacity() * size_of::<CornerKey>()) as u64
    }
}

/// A version of the contents to mesh; versions are consecutive.
#[derive(Clone, Debug)]
pub struct ContentsVersion {
    /// One more than that of the previous version.
    pub number: u64,
    /// The bricks that have changed since the previous version, in ascending order; `None` if all may have.
    pub changed: Option<Vec<u32>>,
}

/// The subject of a mesh: the properties that all its blocks share.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Subject {
    dims: UVec3,
    voxel_size: Vec3,
    base: Rgb,
    coloured: bool,
}

/// See the module text. Greedy meshes cannot be kept: a rectangle may extend through all blocks.
#[derive(Debug)]
pub struct KeptMesh {
    kind: MeshKind,
    colours: VertexColours,
    /// The subject and version of the blocks; `None` at first, and after aborted work.
    of: Option<(Subject, u64)>,
    /// The smooth surface.
    smoothing: Option<SmoothField>,
    /// The blocks in the order x, y, z.
    blocks: Vec<MeshBlock>,
}

impl KeptMesh {
    /// Returns an empty mesh of this kind; `None` for kinds that cannot be kept.
    pub fn new(kind: MeshKind, colours: VertexColours) -> Option<KeptMesh> {
        let kept = KeptMesh { kind, colours, of: None, smoothing: None, blocks: Vec::new() };
        (kind != MeshKind::Greedy).then_some(kept)
    }

    /// Returns whether it is a mesh of this kind.
    pub fn is_of(&self, kind: MeshKind, colours: VertexColours) -> bool {
        (self.kind, self.colours) == (kind, colours)
    }

    /// Returns the bytes in memory.
    pub fn heap_bytes(&self) -> u64 {
        let smoothing = self.smoothing.as_ref().map_or(0, SmoothField::heap_bytes);
        smoothing + self.blocks.iter().map(MeshBlock::heap_bytes).sum::<u64>()
    }

    /// Updates the mesh to `contents`, which have version `version`, within `limits`. Returns the number of rebuilt
    /// blocks and of all blocks.
    pub fn update(
        &mut self,
        contents: &Contents,
        version: &ContentsVersion,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<[usize; 2], MeshError> {
        let grid = &contents.grid;
        let subject = Subject {
            dims: grid.dims(),
            voxel_size: grid.voxel_size(),
            base: contents.material.base(),
            coloured: self.colours.are_in(contents),
        };
        let follows = self.of.take() == version.number.checked_sub(1).map(|last| (subject, last));
        let mut changed = version.changed.clone().filter(|_| follows);
        if self.kind == MeshKind::Smooth {
            let smoothing = match self.smoothing.take() {
                Some(kept) if changed.is_some() => kept,
                _ => SmoothField::new(grid, limits)?,
            };
            let smoothing = self.smoothing.insert(smoothing);
            if !smoothing.update(grid, changed.as_mut(), progress) {
                return Err(MeshError::Cancelled);
            }
        }
        let count = block_dims(grid.dims()).element_product();
        let stale = match &changed {
            Some(changed) => blocks_of(grid, changed),
            None => {
                self.blocks.clear();
                self.blocks.resize_with(count as usize, MeshBlock::default);
                (0..count).collect()
            }
        };
        let budget = Budget::new(limits);
        budget.take(self.blocks.iter().map(MeshBlock::heap_bytes).sum::<u64>());
        let taken = |&block: &u32| (block, std::mem::take(&mut self.blocks[block as usize]));
        let mut anew: Vec<(u32, MeshBlock)> = stale.iter().map(taken).collect();
        progress.begin("making the mesh");
        let pieces = StagePieces::new(progress, [0.0, 1.0], anew.len());
        match &self.smoothing {
            None => remake(contents, subject.coloured, &AtCorners, &mut anew, &budget, &pieces),
            Some(smoothing) => {
                let place = OnSurface::new(grid, smoothing.levels());
                remake(contents, subject.coloured, &place, &mut anew, &budget, &pieces);
            }
        }
        progress.end();
        if progress.is_cancelled() {
            return Err(MeshError::Cancelled);
        }
        budget.check()?;
        let anew_count = anew.len();
        for (block, made) in anew {
            self.blocks[block as usize] = made;
        }
        self.of = Some((subject, version.number));
        Ok([anew_count, count as usize])
    }

    /// Returns the present mesh, each vertex once.
    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        let Some((Subject { dims, base, .. }, _)) = self.of else {
            return Ok(Mesh { parts: Vec::new(), base: Rgb::STONE });
        };
        // The index of the first vertex that each block owns.
        let counts: Vec<u64> = (0..self.blocks.len())
            .into_par_iter()
            .map(|block| {
                let cells = cells_of(dims, block);
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
        // The indices of the vertices at the lowest sides of blocks, which other blocks share.
        let mut shared = HashMap::new();
        for (block, MeshBlock { keys, .. }) in self.blocks.iter().enumerate() {
            let cells = cells_of(dims, block);
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
        let parts = self.blocks.par_iter().enumerate().map(|(block, MeshBlock { part, keys })| {
            let cells = cells_of(dims, block);
            let first = firsts[block];
            let mut own = MeshPart { first_vertex: first, ..MeshPart::default() };
            let mut next = 0;
            let mut numbers = Vec::with_capacity(keys.len());
            for (i, key) in keys.iter().enumerate() {
                if cells.contains(key.corner) {
                    numbers.push(next);
                    next += 1;
                    own.positions.push(part.positions[i]);
                    own.colours.extend(part.colours.get(i));
                } else {
                    // A later block has the same corner, and owns it.
                    numbers.push(shared[key] - first);
                }
            }
            let of = |vertex: u32| numbers[vertex as usize];
            own.quads = part.quads.iter().map(|quad| quad.map(of)).collect();
            own.triangles = part.triangles.iter().map(|triangle| triangle.map(of)).collect();
            own
        });
        Ok(Mesh { parts: parts.collect(), base })
    }
}

/// Rebuilds blocks in their existing memory. Stops if memory is exhausted or the work is cancelled.
fn remake<P: VertexPlacement>(
    contents: &Contents,
    coloured: bool,
    place: &P,
    blocks: &mut [(u32, MeshBlock)],
    budget: &Budget,
    pieces: &StagePieces,
) {
    let slab = Slab { contents, place, coloured };
    let make = |scratch: &mut SlabScratch<P::Layer>, (block, made): &mut (u32, MeshBlock)| {
        if pieces.is_cancelled() {
            return false;
        }
        let cells = cells_of(contents.grid.dims(), *block as usize);
        let is_made = match is_uniform(&contents.grid, &cells) {
            true => {
                *made = MeshBlock::default();
                true
            }
            false => slab.fill_block(&cells, scratch, budget, (&mut made.part, &mut made.keys)),
        };
        pieces.one();
        is_made
    };
    // A row of cells is one word.
    blocks.par_iter_mut().map_init(|| SlabScratch::new(1), make).all(|is_made| is_made);
}

/// Returns the number of blocks along each axis of a grid of `dims` voxels.
fn block_dims(dims: UVec3) -> UVec3 {
    // One corner more than voxels.
    (dims + BLOCK) / BLOCK
}

/// Returns the cells of a block of a grid of `dims` voxels.
fn cells_of(dims: UVec3, block: usize) -> LatticeCells {
    let (block, blocks) = (block as u32, block_dims(dims));
    let (x, rest) = (block % blocks.x, block / blocks.x);
    let first = UVec3::new(x, rest % blocks.y, rest / blocks.y) * BLOCK;
    let end = (first + BLOCK).min(dims + 1);
    LatticeCells { x: first.x..end.x, y: first.y..end.y, z: first.z..end.z }
}

/// Returns whether the bricks with voxels beside the corners of the cells are all empty, or all full: then there is no
/// surface.
fn is_uniform(grid: &Grid, cells: &LatticeCells) -> bool {
    let voxels = [&cells.x, &cells.y, &cells.z].map(|range| (range.start, range.end));
    let (first, last) = (UVec3::from(voxels.map(|v| v.0)), UVec3::from(voxels.map(|v| v.1)));
    // Beyond the grid, all is empty.
    let reaches_out = first.cmpeq(UVec3::ZERO).any() || last.cmpge(grid.dims()).any();
    let low = first.saturating_sub(UVec3::ONE) / BRICK_EDGE_VX;
    let high = (last / BRICK_EDGE_VX).min(grid.brick_dims() - 1);
    let kind = |x, y, z| grid.brick_kind(grid.brick_index(UVec3::new(x, y, z)));
    let expected = if reaches_out { BrickKind::Empty } else { kind(low.x, low.y, low.z) };
    expected != BrickKind::Mixed
        && (low.z..=high.z)
            .all(|z| (low.y..=high.y).all(|y| (low.x..=high.x).all(|x| kind(x, y, z) == expected)))
}

/// Returns the blocks that some bricks may change, in ascending order: those with a corner that has one of their voxels
/// among its octants.
fn blocks_of(grid: &Grid, bricks: &[u32]) -> Vec<u32> {
    let dims = block_dims(grid.dims());
    let mut blocks = IndexSet::new(dims.element_product() as usize);
    for &brick in bricks {
        let first = grid.brick_coords(brick as usize) * BRICK_EDGE_VX;
        // Blocks have the corners at their upper sides, too.
        let low = first.saturating_sub(UVec3::ONE) / BLOCK;
        let high = ((first + BRICK_EDGE_VX) / BLOCK).min(dims - 1);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                (low.x..=high.x).for_each(|x| blocks.insert(x + dims.x * (y + dims.y * z)));
            }
        }
    }
    let mut listed = Vec::new();
    blocks.collect_into(&mut listed);
    listed
}
