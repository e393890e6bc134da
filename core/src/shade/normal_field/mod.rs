//! The normals of all surface voxels of a sculpture, computed once and looked up by every shader; the depth of each
//! voxel below the surface, from which [`super::level_set`] makes the smooth surface; and the openness of each
//! ([`super::occlusion`]), which is computed from the same bits.
//!
//! A normal depends on the voxels within two bricks of its own: `window` estimates it from the smoothed bits, `cells`
//! refines it from its surroundings on the same surface. After an edit only the bricks around it are recomputed, on all
//! cores; those that a picture does not show can be deferred. After opening a sculpture all are computed, in portions,
//! so that no picture waits. Until then, and for voxels that are not on the surface, shaders use [`super::normal`].
//!
//! Takes a grid and its changes; knows no document. Brick-wise results do not depend on the order in which bricks are
//! computed, nor on threads or vector instructions.

mod batch;
mod cells;
mod packed;
mod pages;
mod seen;
mod window;

use fearless_simd::Level;
use glam::{UVec3, Vec3};

use batch::Batch;
pub use batch::Precision;
pub use packed::{PackedDepth, PackedNormal, unpack_many};
pub use pages::{NO_PAGE, PageRecords, PageUnit, Pages, SurfaceRecord};
use seen::sort_from;

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick};
use crate::sculpture::index_set::IndexSet;

/// The distance, in bricks, up to which a changed brick affects others, on every axis.
const REACH_BRICKS: u32 = 2;
/// The most bricks that are computed at once after an edit, regardless of other outstanding work.
const MOST_AT_ONCE: usize = 4096;
/// Edge of the blocks of bricks in which a whole sculpture is computed.
const BLOCK_EDGE_BRICKS_LOG2: u32 = 4;

/// The normals of one grid.
#[derive(Debug, Default)]
pub struct NormalField {
    /// The page of each brick.
    table: Vec<u32>,
    pages: Pages,
    /// A hash of the bits of each brick that the normals reflect: an edit of colours alone changes no normal.
    hashes: Vec<u64>,
    /// Bricks to compute; those from `fresh` on belong to the last edits and come first.
    queue: Vec<u32>,
    fresh: usize,
    /// Bricks without a page that edits have changed and no picture has shown since; and some that are no longer
    /// queued, since they were computed for a picture.
    deferred: Vec<u32>,
    /// Bricks of `queue` and `deferred` that remain to be computed.
    queued: Flags,
    /// Bricks whose first estimates edits have changed since the last update: those with other bits, and their
    /// neighbours.
    inexact: IndexSet,
    /// Bricks of `deferred` that pictures have shown by first estimates, or as they were before a nearby edit; oldest
    /// first.
    estimated: Vec<u32>,
    batch: Batch,
    generation: u64,
}

impl NormalField {
    /// Returns the field of `grid`, complete.
    pub fn of(grid: &Grid) -> NormalField {
        let mut field = NormalField::default();
        field.follow(grid, None);
        field.update(grid, &mut Vec::new(), || true);
        field
    }

    /// Notes that bricks (linear indices) may have changed since the last call; `None`: all, and the size of the grid
    /// may differ.
    pub fn follow(&mut self, grid: &Grid, changed: Option<&[u32]>) {
        let Some(changed) = changed.filter(|_| self.table.len() == grid.brick_count()) else {
            return self.follow_all(grid);
        };
        for &index in changed {
            let hash = hash(grid.brick_at(index as usize));
            if std::mem::replace(&mut self.hashes[index as usize], hash) != hash {
                self.queue_around(grid, index);
            }
        }
    }

    fn follow_all(&mut self, grid: &Grid) {
        let count = grid.brick_count();
        self.generation += 1;
        self.pages.clear();
        self.table.clear();
        self.table.resize(count, NO_PAGE);
        self.hashes.clear();
        self.hashes.resize(count, hash(&Brick::EMPTY));
        self.queued = Flags::new(count);
        self.queue.clear();
        self.deferred.clear();
        self.inexact = IndexSet::new(count);
        self.estimated.clear();
        for (b, brick) in grid.nonempty_bricks() {
            let index = grid.brick_index(b);
            self.hashes[index] = hash(brick);
            self.queue.push(index as u32);
        }
        self.queue.sort_by_cached_key(|index| block(grid, *index));
        self.queue.iter().for_each(|index| self.queued.insert(*index));
        self.fresh = self.queue.len();
    }

    fn queue_around(&mut self, grid: &Grid, index: u32) {
        let NormalField { queued, queue, inexact, .. } = self;
        for_each_around(grid, index, REACH_BRICKS, |index| {
            if !queued.contains(index) {
                queued.insert(index);
                queue.push(index);
            }
        });
        for_each_around(grid, index, 1, |index| inexact.insert(index));
    }

    /// Returns a number that changes when [`NormalField::follow`] starts afresh, without pages.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns whether every normal is that of the grid as it was at the last [`NormalField::follow`].
    pub fn is_complete(&self) -> bool {
        self.queue.is_empty() && self.deferred.is_empty()
    }

    /// Returns whether normals of a newly opened sculpture are missing, so that estimates replace them. Deferred ones
    /// do not count: their bricks are not visible.
    pub fn has_estimates(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Returns the number of bricks whose normals are to be computed, a few of them counted more than once; without
    /// deferred ones.
    pub(crate) fn outstanding(&self) -> usize {
        self.queue.len()
    }

    /// Returns the memory in use, in bytes, without lists of pending work.
    pub fn heap_bytes(&self) -> u64 {
        let brick_bytes = size_of::<u32>() + size_of::<u64>();
        (size_of_val(self.pages.units()) + self.table.len() * brick_bytes) as u64
    }

    /// Computes outstanding normals: first those that edits have changed, then the rest for as long as `go_on` returns
    /// true. An edit of very many bricks is part of the rest; until then they have no normals. Appends the bricks whose
    /// normals differ from before, in ascending order, each once. `grid` must be that of the last
    /// [`NormalField::follow`].
    pub fn update(&mut self, grid: &Grid, changed: &mut Vec<u32>, mut go_on: impl FnMut() -> bool) {
        self.inexact.clear();
        self.retain_deferred();
        if self.deferred.len() > MOST_AT_ONCE {
            self.estimated.clear();
            self.queue.append(&mut self.deferred);
        }
        self.update_deferred(grid, changed, || true);
        if self.queue.is_empty() {
            return;
        }
        let (first, level) = (changed.len(), Level::new());
        let mut fresh = self.queue.split_off(self.fresh);
        fresh.sort_unstable();
        fresh.dedup();
        if fresh.len() <= MOST_AT_ONCE {
            self.compute(level, grid, &fresh, Precision::Refined, changed);
        } else {
            self.forget(&fresh, changed);
            fresh.sort_by_cached_key(|index| block(grid, *index));
            self.queue.append(&mut fresh);
        }
        while !self.queue.is_empty() && go_on() {
            let last = self.queue.last().map(|index| block(grid, *index));
            let from = self.queue.iter().rposition(|index| Some(block(grid, *index)) != last);
            let portion = self.queue.split_off(from.map_or(0, |i| i + 1));
            self.compute(level, grid, &portion, Precision::Refined, changed);
        }
        self.fresh = self.queue.len();
        sort_from(changed, first);
    }

    /// Removes the normals of `bricks`.
    fn forget(&mut self, bricks: &[u32], changed: &mut Vec<u32>) {
        for &index in bricks {
            let page = std::mem::replace(&mut self.table[index as usize], NO_PAGE);
            if page != NO_PAGE {
                self.pages.free(page);
                changed.push(index);
            }
        }
    }

    /// Computes `targets`, in parts if they are far from each other. Estimated ones remain to be refined.
    fn compute(
        &mut self,
        level: Level,
        grid: &Grid,
        targets: &[u32],
        precision: Precision,
        changed: &mut Vec<u32>,
    ) {
        if precision == Precision::Refined {
            targets.iter().for_each(|index| self.queued.remove(*index));
        }
        let NormalField { table, pages, batch, .. } = self;
        batch.for_each_part(grid, targets, &mut |batch, part| {
            batch.compute(level, grid, part, precision);
            for (index, surface) in batch.results() {
                let former = table[index as usize];
                let (page, differs) = pages.store(former, surface.mask, surface.records);
                table[index as usize] = page;
                if differs {
                    changed.push(index);
                }
            }
        });
    }

    /// Returns the normal of a voxel; none if it is not a surface voxel, lies in the middle of a symmetric
    /// neighbourhood, or has not been computed yet.
    #[inline(always)]
    pub fn packed(&self, brick: usize, local: UVec3) -> PackedNormal {
        self.record(brick, local).map_or(PackedNormal::NONE, SurfaceRecord::normal)
    }

    /// Returns the record of a voxel; `None` if it is not a surface voxel, or has not been computed yet.
    #[inline(always)]
    pub(super) fn record(&self, brick: usize, local: UVec3) -> Option<SurfaceRecord> {
        self.pages.record(self.page(brick), local.x | local.y << 3 | local.z << 6)
    }

    /// Returns the page of a brick, or [`NO_PAGE`].
    #[inline(always)]
    pub(super) fn page(&self, brick: usize) -> u32 {
        self.table.get(brick).copied().unwrap_or(NO_PAGE)
    }

    /// Returns the unit normal of a voxel in grid coordinates, if it has one.
    pub fn normal(&self, grid: &Grid, voxel: UVec3) -> Option<Vec3> {
        let brick = grid.brick_index(voxel / BRICK_EDGE_VX);
        self.packed(brick, voxel % BRICK_EDGE_VX).unpack()
    }

    /// Returns the plane of the surface at a voxel of a brick that has a page: its unit normal (0 for none), and the
    /// depth of the voxel's centre below it in units of [`PackedDepth::PER_VX`]. `None` if it is not a surface voxel.
    #[inline(always)]
    pub(super) fn plane(&self, page: u32, local: UVec3) -> Option<(Vec3, f32)> {
        let record = self.pages.record(page, local.x | local.y << 3 | local.z << 6)?;
        Some((record.normal().unpack().unwrap_or(Vec3::ZERO), f32::from(record.depth().0)))
    }

    /// Returns the page of each brick, by linear index; [`NO_PAGE`] for none.
    pub fn table(&self) -> &[u32] {
        &self.table
    }

    /// Returns the pages, and the units of them that were written.
    pub fn pages(&self) -> &Pages {
        &self.pages
    }

    /// Performs [`Pages::take_written`], for this generation.
    pub fn take_written(&mut self, target: &mut Vec<u32>) {
        self.pages.take_written(target);
    }
}

/// Calls `f` with the linear index of each brick within `reach` bricks of that at `index`, itself included.
fn for_each_around(grid: &Grid, index: u32, reach: u32, mut f: impl FnMut(u32)) {
    let b = grid.brick_coords(index as usize);
    let low = b.saturating_sub(UVec3::splat(reach));
    let high = (b + reach).min(grid.brick_dims() - 1);
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            let first = grid.brick_index(UVec3::new(low.x, y, z)) as u32;
            (first..=first + (high.x - low.x)).for_each(&mut f);
        }
    }
}

/// A bit for each brick, by linear index.
#[derive(Debug, Default)]
struct Flags(Vec<u64>);

impl Flags {
    /// Returns flags of which none is set.
    fn new(bricks: usize) -> Flags {
        Flags(vec![0; bricks.div_ceil(64)])
    }

    fn contains(&self, index: u32) -> bool {
        self.0[index as usize / 64] >> (index % 64) & 1 != 0
    }

    fn insert(&mut self, index: u32) {
        self.0[index as usize / 64] |= 1 << (index % 64);
    }

    fn remove(&mut self, index: u32) {
        self.0[index as usize / 64] &= !(1 << (index % 64));
    }
}

/// Returns a key of the block of bricks around the brick of a linear index.
fn block(grid: &Grid, index: u32) -> u64 {
    let UVec3 { x, y, z } = grid.brick_coords(index as usize) >> BLOCK_EDGE_BRICKS_LOG2;
    u64::from(z) << 40 | u64::from(y) << 20 | u64::from(x)
}

/// Returns a hash of the bits of a brick.
fn hash(brick: &Brick) -> u64 {
    const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;
    brick.words.iter().fold(0, |hash: u64, word| (hash.rotate_left(23) ^ word).wrapping_mul(FACTOR))
}

#[cfg(test)]
mod tests;
