//! The bound of the memory of normals. Beyond a share of it, none are made ahead of pictures; beyond all of it, those of
//! the blocks that no picture has shown for the longest time are removed, and made anew when they are seen again.
//!
//! A field that never shows a picture ([`NormalField::complete_seen`]) has all normals, whatever their memory.

use glam::UVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{BLOCK_EDGE_BRICKS_LOG2, NormalField};
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::{Grid, NO_VOXEL};
use crate::surface::IndexMap;

/// The share of the bound that is filled ahead of pictures, and that a removal leaves.
const KEPT_SHARE: f64 = 0.75;
/// The share of the bound from which on it is noted which blocks pictures show.
const NOTED_SHARE: f64 = 0.5;

/// The logarithm of a block's edge in voxels, and in leaves of 8^3 bricks.
const BLOCK_EDGE_VX_LOG2: u32 = BLOCK_EDGE_BRICKS_LOG2 + BRICK_EDGE_VX.ilog2();
const BLOCK_EDGE_LEAVES_LOG2: u32 = BLOCK_EDGE_BRICKS_LOG2 - 3;

/// The bound, and when pictures last showed each block.
#[derive(Debug)]
pub(super) struct CacheUse {
    limit_bytes: u64,
    /// Size in blocks.
    size: UVec3,
    /// The number of the last picture that showed each block.
    last: Vec<u32>,
    /// The number of the last picture.
    picture: u32,
    /// The last picture has all normals that it shows.
    is_shown: bool,
}

impl Default for CacheUse {
    fn default() -> CacheUse {
        let (limit_bytes, size) = (u64::MAX, UVec3::ZERO);
        CacheUse { limit_bytes, size, last: Vec::new(), picture: 0, is_shown: false }
    }
}

impl CacheUse {
    /// Starts with a sculpture of so many blocks.
    pub fn restart(&mut self, size: UVec3) {
        *self = CacheUse { limit_bytes: self.limit_bytes, size, ..CacheUse::default() };
    }

    fn share(&self, share: f64) -> u64 {
        (self.limit_bytes as f64 * share) as u64
    }

    /// Notes a picture, and the blocks that it shows.
    fn note(&mut self, map: &IndexMap) {
        let size = self.size;
        let rows = map.voxels.par_chunks((map.rays.size.x as usize).max(1));
        let found = rows.fold(Vec::new, |mut found, row| {
            let (mut last_voxel, mut last) = (NO_VOXEL, UVec3::MAX);
            for &voxel in row {
                if voxel != last_voxel && voxel != NO_VOXEL {
                    let block = map.numbering.coords(voxel) >> BLOCK_EDGE_VX_LOG2;
                    if block != last {
                        found.push(block);
                    }
                    last = block;
                }
                last_voxel = voxel;
            }
            found
        });
        for block in found.collect::<Vec<Vec<UVec3>>>().into_iter().flatten() {
            let at = (block.x + size.x * (block.y + size.y * block.z)) as usize;
            if let Some(last) = self.last.get_mut(at) {
                *last = self.picture;
            }
        }
    }
}

impl NormalField {
    /// Sets the most memory that normals take besides those that the last picture shows.
    pub fn set_limit(&mut self, bytes: u64) {
        self.cache.limit_bytes = bytes;
    }

    /// Returns the memory of normals, in bytes: that which is in use for surface voxels.
    fn used_bytes(&self) -> u64 {
        (self.pages.used_bytes() + self.table.page_bytes()) as u64
    }

    /// Returns whether normals may be made ahead of pictures.
    pub(super) fn has_room_ahead(&self) -> bool {
        self.used_bytes() < self.cache.share(KEPT_SHARE)
    }

    /// Returns whether [`NormalField::complete_seen`] has work: normals are missing, or take too much memory.
    pub fn follows_pictures(&self) -> bool {
        self.has_estimates() || self.used_bytes() > self.cache.limit_bytes
    }

    /// Returns whether the last picture has all normals that it shows, and no others are to be made ahead. Those of
    /// another picture may be missing.
    pub fn is_settled(&self) -> bool {
        let is_filled = self.cache.is_shown && !self.has_room_ahead();
        self.is_complete() || is_filled && !self.has_backlog() && self.deferred() == 0
    }

    /// Notes that the last picture shows these maps, and whether it has all normals that it shows. If memory is short,
    /// removes those that have not been shown for the longest time, and appends their bricks to `changed`.
    pub(super) fn note_shown<'a>(
        &mut self,
        grid: &Grid,
        maps: impl IntoIterator<Item = &'a IndexMap>,
        has_all: bool,
        changed: &mut Vec<u32>,
    ) {
        let cache = &mut self.cache;
        cache.is_shown = has_all;
        if self.pages.used_bytes() as u64 <= cache.share(NOTED_SHARE) {
            return;
        }
        cache.picture += 1;
        cache.last.resize(cache.size.element_product() as usize, 0);
        maps.into_iter().for_each(|map| self.cache.note(map));
        if self.used_bytes() > self.cache.limit_bytes {
            self.remove_unseen(grid, changed);
        }
    }

    /// Removes the normals of the blocks that have not been shown for the longest time.
    fn remove_unseen(&mut self, grid: &Grid, changed: &mut Vec<u32>) {
        let CacheUse { size, picture, .. } = self.cache;
        let mut unseen: Vec<(u32, UVec3)> = Vec::new();
        for (at, &last) in (0..).zip(&self.cache.last).filter(|(_, last)| **last != picture) {
            unseen.push((
                last,
                UVec3::new(at % size.x, at / size.x % size.y, at / (size.x * size.y)),
            ));
        }
        unseen.sort_by_key(|(last, _)| *last);
        let listed: FxHashSet<UVec3> = self.blocks.iter().copied().collect();
        let mut removed = Vec::new();
        for (_, block) in unseen {
            if self.has_room_ahead() {
                break;
            }
            let first = changed.len();
            self.remove_block(grid, block, changed);
            if changed.len() > first && !listed.contains(&block) {
                removed.push(block);
            }
        }
        // They come last.
        removed.append(&mut self.blocks);
        self.blocks = removed;
    }

    fn remove_block(&mut self, grid: &Grid, block: UVec3, changed: &mut Vec<u32>) {
        let low = block << BLOCK_EDGE_LEAVES_LOG2;
        let high = (low + (1 << BLOCK_EDGE_LEAVES_LOG2)).min(self.table.leaf_dims());
        let NormalField { table, pages, .. } = self;
        for z in low.z..high.z {
            for y in low.y..high.y {
                for x in low.x..high.x {
                    table.take_pages(UVec3::new(x, y, z), |b, page| {
                        pages.free(page);
                        changed.push(grid.brick_index(b) as u32);
                    });
                }
            }
        }
    }
}
