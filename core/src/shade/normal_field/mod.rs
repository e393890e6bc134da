//! The normals of all surface voxels of a sculpture, computed once and looked up by every shader; the depth of each
//! voxel below the surface, from which [`super::level_set`] makes the smooth surface; and the openness of each
//! ([`super::occlusion`]), which is computed from the same bits.
//!
//! A normal depends on the voxels within two bricks of its own: `window` estimates it from the smoothed bits, `cells`
//! refines it from its surroundings on the same surface. After an edit only the bricks around it are recomputed, on all
//! cores; those that a picture does not show can be deferred. After opening a sculpture all are computed, in portions,
//! so that no picture waits; a single picture computes those that it shows alone. Until then, and for voxels that are
//! not on the surface, shaders use [`super::normal`]. Their memory can be bounded (`cache`): then those that pictures
//! showed last are kept.
//!
//! Takes a grid and its changes; knows no document. Brick-wise results do not depend on the order in which bricks are
//! computed, nor on threads or vector instructions. Bricks without surface take no memory.

mod batch;
mod cache;
mod cells;
mod packed;
mod pages;
mod seen;
mod table;
mod window;

use fearless_simd::Level;
use glam::{UVec3, Vec3};

use batch::Batch;
pub use batch::Precision;
use cache::CacheUse;
pub use packed::{PackedDepth, PackedNormal, unpack_many};
pub use pages::{NO_PAGE, PageRecords, PageUnit, Pages, SurfaceRecord};
pub(super) use seen::sort_from;
pub use table::PageTable;

use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::brick_set::{BrickSet, LeafKey, for_each_in};

/// The distance, in bricks, up to which a changed brick affects others, on every axis.
pub(super) const REACH_BRICKS: u32 = 2;
/// The most bricks that are computed at once after an edit, regardless of other outstanding work.
const MOST_AT_ONCE: usize = 4096;
/// Edge of the blocks of bricks in which a whole sculpture is computed.
const BLOCK_EDGE_BRICKS_LOG2: u32 = 4;
/// About the bricks of a block that have surface.
const SURFACE_BRICKS: usize = 512;

/// The normals of one grid.
#[derive(Debug, Default)]
pub struct NormalField {
    table: PageTable,
    pages: Pages,
    /// The bits that the normals reflect: an edit of colours alone changes no normal. `None` before the first grid.
    followed: Option<Grid>,
    /// Blocks of a newly opened sculpture that have not been computed, those to come first last. Any of their bricks may
    /// have been computed or estimated for a picture.
    blocks: Vec<UVec3>,
    /// Bricks that edits have changed; those from `fresh` on belong to the last edits and come first. Some of them are no
    /// longer outstanding, since they were computed for a picture.
    queue: Vec<u32>,
    fresh: usize,
    /// Bricks without a page that edits have changed and no picture has shown since; and some that are no longer
    /// outstanding, since they were computed for a picture.
    deferred: Vec<u32>,
    /// Bricks whose first estimates edits have changed since the last update: those with other bits, and their
    /// neighbours.
    inexact: BrickSet,
    /// Bricks of `deferred` that pictures have shown by first estimates, or as they were before a nearby edit; oldest
    /// first.
    estimated: Vec<u32>,
    batch: Batch,
    cache: CacheUse,
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
        let before = self.followed.replace(grid.clone());
        let before = before.filter(|before| before.dims() == grid.dims());
        let (Some(changed), Some(before)) = (changed, before) else {
            return self.follow_all(grid);
        };
        for &index in changed {
            let b = grid.brick_coords(index as usize);
            if before.brick(b) != grid.brick(b) {
                self.queue_around(grid, b);
            }
        }
    }

    fn follow_all(&mut self, grid: &Grid) {
        self.generation += 1;
        self.pages.clear();
        self.table = PageTable::new(grid.brick_dims());
        self.queue.clear();
        self.fresh = 0;
        self.deferred.clear();
        self.inexact.clear();
        self.estimated.clear();
        self.blocks.clear();
        let size = grid.brick_dims().map(|edge| edge.div_ceil(1 << BLOCK_EDGE_BRICKS_LOG2));
        let coords =
            |at: u32| UVec3::new(at % size.x, at / size.x % size.y, at / (size.x * size.y));
        self.blocks.extend((0..size.element_product()).map(coords));
        self.cache.restart(size);
    }

    fn queue_around(&mut self, grid: &Grid, b: UVec3) {
        let NormalField { table, queue, inexact, .. } = self;
        for_each_around(grid, b, REACH_BRICKS, |b| {
            if table.set_outstanding(b, true) {
                queue.push(grid.brick_index(b) as u32);
            }
        });
        for_each_around(grid, b, 1, |b| inexact.insert(b));
    }

    /// Returns a number that changes when [`NormalField::follow`] starts afresh, without pages.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns whether every normal is that of the grid as it was at the last [`NormalField::follow`].
    pub fn is_complete(&self) -> bool {
        !self.has_estimates() && self.deferred.is_empty()
    }

    /// Returns whether normals are missing, so that estimates replace them. Deferred ones do not count: their bricks are
    /// not visible.
    pub fn has_estimates(&self) -> bool {
        !self.blocks.is_empty() || self.has_backlog()
    }

    /// Returns whether edits of very many bricks remain to be followed: until then no bricks are deferred.
    pub fn has_backlog(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Returns whether an estimate replaces the normals of the brick at `b`.
    pub(super) fn is_estimated(&self, b: UVec3) -> bool {
        self.has_estimates() && self.table.is_outstanding(b)
    }

    /// Returns about the number of bricks whose normals are to be computed, without deferred ones.
    pub(crate) fn outstanding(&self) -> usize {
        self.queue.len() + self.blocks.len() * SURFACE_BRICKS
    }

    /// Returns the memory in use, in bytes, without lists of pending work.
    pub fn heap_bytes(&self) -> u64 {
        (size_of_val(self.pages.units()) + self.table.heap_bytes()) as u64
    }

    /// Computes outstanding normals: first those that edits have changed, then the rest for as long as `go_on` returns
    /// true. An edit of very many bricks is part of the rest; until then they have no normals. Appends the bricks whose
    /// normals differ from before, in ascending order, each once. `grid` must be that of the last
    /// [`NormalField::follow`].
    pub fn update(&mut self, grid: &Grid, changed: &mut Vec<u32>, mut go_on: impl FnMut() -> bool) {
        self.forget_inexact();
        self.retain_deferred(grid);
        if self.deferred.len() > MOST_AT_ONCE {
            self.estimated.clear();
            self.queue.append(&mut self.deferred);
        }
        self.update_deferred(grid, changed, || true);
        if !self.has_estimates() {
            return;
        }
        let (first, level) = (changed.len(), Level::new());
        let mut fresh = self.queue.split_off(self.fresh);
        fresh.sort_unstable();
        fresh.dedup();
        self.retain_outstanding(grid, &mut fresh);
        if fresh.len() <= MOST_AT_ONCE {
            self.compute(level, grid, &fresh, Precision::Refined, changed);
        } else {
            self.forget(grid, &fresh, changed);
            fresh.sort_by_cached_key(|index| block(grid, *index));
            self.queue.append(&mut fresh);
        }
        while !self.queue.is_empty() && go_on() {
            let last = self.queue.last().map(|index| block(grid, *index));
            let from = self.queue.iter().rposition(|index| Some(block(grid, *index)) != last);
            let mut portion = self.queue.split_off(from.map_or(0, |i| i + 1));
            self.retain_outstanding(grid, &mut portion);
            self.compute(level, grid, &portion, Precision::Refined, changed);
        }
        self.fresh = self.queue.len();
        while self.has_room_ahead()
            && go_on()
            && let Some(block) = self.blocks.pop()
        {
            let portion = self.outstanding_in_block(grid, block);
            self.compute(level, grid, &portion, Precision::Refined, changed);
        }
        sort_from(changed, first);
    }

    /// Returns the outstanding bricks of a block that may have surface. Nothing of the others remains to be computed.
    fn outstanding_in_block(&mut self, grid: &Grid, block: UVec3) -> Vec<u32> {
        let mut found = Vec::new();
        let low = block << (BLOCK_EDGE_BRICKS_LOG2 - 3);
        let high = (low + (1 << (BLOCK_EDGE_BRICKS_LOG2 - 3))).min(self.table.leaf_dims());
        for z in low.z..high.z {
            for y in low.y..high.y {
                for x in low.x..high.x {
                    self.add_outstanding(grid, UVec3::new(x, y, z), &mut found);
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// Adds the outstanding bricks of a leaf that may have surface.
    fn add_outstanding(&mut self, grid: &Grid, leaf: UVec3, found: &mut Vec<u32>) {
        let key = LeafKey::of(leaf);
        let surface = grid.bricks_near_surface(key);
        if surface.is_empty() {
            self.table.finish_untouched(leaf);
        }
        let outstanding = self.table.outstanding_in(leaf);
        for_each_in(key, &outstanding.and_not(&surface), |b| {
            if b.cmplt(grid.brick_dims()).all() {
                self.table.set_outstanding(b, false);
            }
        });
        for_each_in(key, &outstanding.and(&surface), |b| found.push(grid.brick_index(b) as u32));
    }

    /// Keeps those of `bricks` that remain to be computed.
    fn retain_outstanding(&self, grid: &Grid, bricks: &mut Vec<u32>) {
        bricks.retain(|index| self.table.is_outstanding(grid.brick_coords(*index as usize)));
    }

    /// Removes the normals of `bricks`.
    fn forget(&mut self, grid: &Grid, bricks: &[u32], changed: &mut Vec<u32>) {
        for &index in bricks {
            if self.free_page(grid.brick_coords(index as usize)) {
                changed.push(index);
            }
        }
    }

    /// Removes the page of a brick. Returns whether it had one.
    fn free_page(&mut self, b: UVec3) -> bool {
        let page = self.table.replace_page(b, NO_PAGE);
        self.pages.free(page);
        page != NO_PAGE
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
            for index in targets {
                self.table.set_outstanding(grid.brick_coords(*index as usize), false);
            }
        }
        let NormalField { table, pages, batch, .. } = self;
        batch.for_each_part(grid, targets, &mut |batch, part| {
            batch.compute(level, grid, part, precision);
            for (index, surface) in batch.results() {
                let b = grid.brick_coords(index as usize);
                let (page, differs) = pages.store(table.page(b), surface.mask, surface.records);
                table.replace_page(b, page);
                if differs {
                    changed.push(index);
                }
            }
        });
    }

    /// Returns the normal of the voxel `local` of the brick at `b`; none if it is not a surface voxel, lies in the middle
    /// of a symmetric neighbourhood, or has not been computed yet.
    #[inline(always)]
    pub fn packed(&self, b: UVec3, local: UVec3) -> PackedNormal {
        self.record(b, local).map_or(PackedNormal::NONE, SurfaceRecord::normal)
    }

    /// Returns the record of a voxel; `None` if it is not a surface voxel, or has not been computed yet.
    #[inline(always)]
    pub(super) fn record(&self, b: UVec3, local: UVec3) -> Option<SurfaceRecord> {
        self.pages.record(self.table.page(b), local.x | local.y << 3 | local.z << 6)
    }

    /// Returns the unit normal of a voxel in grid coordinates, if it has one.
    pub fn normal(&self, voxel: UVec3) -> Option<Vec3> {
        self.packed(voxel / BRICK_EDGE_VX, voxel % BRICK_EDGE_VX).unpack()
    }

    /// Returns the plane of the surface at a voxel of a brick that has a page: its unit normal (0 for none), and the
    /// depth of the voxel's centre below it in units of [`PackedDepth::PER_VX`]. `None` if it is not a surface voxel.
    #[inline(always)]
    pub(super) fn plane(&self, page: u32, local: UVec3) -> Option<(Vec3, f32)> {
        let record = self.pages.record(page, local.x | local.y << 3 | local.z << 6)?;
        Some((record.normal().unpack().unwrap_or(Vec3::ZERO), f32::from(record.depth().0)))
    }

    /// Returns the page of each brick.
    pub fn table(&self) -> &PageTable {
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

/// Calls `f` with each brick of a grid within `reach` bricks of that at `b`, itself included.
pub(super) fn for_each_around(grid: &Grid, b: UVec3, reach: u32, mut f: impl FnMut(UVec3)) {
    let low = b.saturating_sub(UVec3::splat(reach));
    let high = (b + reach).min(grid.brick_dims() - 1);
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            (low.x..=high.x).for_each(|x| f(UVec3::new(x, y, z)));
        }
    }
}

/// Returns a key of the block of bricks around the brick of a linear index.
fn block(grid: &Grid, index: u32) -> u64 {
    let UVec3 { x, y, z } = grid.brick_coords(index as usize) >> BLOCK_EDGE_BRICKS_LOG2;
    u64::from(z) << 40 | u64::from(y) << 20 | u64::from(x)
}

#[cfg(test)]
mod tests;
