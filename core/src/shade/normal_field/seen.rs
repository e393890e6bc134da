//! Selects the normals that a picture after an edit waits for: those of its visible bricks. The rest is deferred until
//! the view rests or another reader needs them.
//!
//! A picture that is needed at once has first estimates ([`super::window`]) where bits have changed. Pictures of the
//! view at rest have the refined normals, however many bricks a stroke has left behind: refining them earlier would
//! delay each picture ten times as long as estimating them. Refined normals reach a brick farther, where a picture
//! shows them as they were before the edit.

use fearless_simd::Level;
use glam::UVec3;
use rayon::prelude::*;

use super::batch::Precision;
use super::{MOST_AT_ONCE, NO_PAGE, NormalField, PageTable, block};
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::brick_set::{BrickSet, for_each_in};
use crate::sculpture::{Grid, NO_VOXEL};
use crate::surface::{IndexMap, PixelRect, PixelRects};

/// Deferred bricks that are computed together.
const DEFERRED_PORTION: usize = 256;
/// The most bricks that are refined at once for a picture that is needed at once.
const PROMPT_PORTION: usize = 24;
/// The most bricks that a picture may show by first estimates: those of a sculpture that fills a screen. Beyond it, or
/// beyond [`MOST_AT_ONCE`] to be refined, normals are computed in portions, and until then every picture waits for some
/// of them and estimates the others itself. For edits after an undo of many at once, that took far longer than these
/// estimates.
const MOST_ESTIMATED: usize = 1 << 15;
/// The edge of a pixel, in voxels, from which on no picture shows more of refined normals than of first estimates: these
/// are means over about as many voxels.
const REFINED_BELOW_VX: f32 = 3.0;
/// Rows of a picture in which a thread looks for bricks.
const ROWS_AT_ONCE: usize = 64;

impl NormalField {
    /// Defers the changes of the last edits, except for the bricks that are visible in `pixels` of `maps`; these must
    /// be all in which they can be visible. No other pictures may be used before the next [`NormalField::update`]. With
    /// [`Precision::Estimated`], many bricks have first estimates until [`NormalField::update_deferred`]. Reports
    /// bricks as `update` does. Does nothing while edits of very many bricks remain to be followed, or if very many of
    /// the bricks are visible.
    pub fn update_seen<'a>(
        &mut self,
        grid: &Grid,
        views: impl IntoIterator<Item = (&'a IndexMap, PixelRects)>,
        precision: Precision,
        changed: &mut Vec<u32>,
    ) {
        if self.fresh > 0 {
            return;
        }
        let mut seen = BrickSet::default();
        for (map, rects) in views {
            for rect in rects.as_slice() {
                bricks_in(map, *rect, &self.table, &mut seen);
            }
        }
        let mut targets = indices(grid, &seen);
        let most = match precision {
            Precision::Estimated => MOST_ESTIMATED,
            Precision::Refined => MOST_AT_ONCE,
        };
        if targets.len() > most {
            return;
        }
        let inexact = std::mem::take(&mut self.inexact);
        // A brick that was deferred before may have a page, and be changed again.
        let mut queue = std::mem::take(&mut self.queue);
        self.retain_outstanding(grid, &mut queue);
        queue.retain(|index| {
            let b = grid.brick_coords(*index as usize);
            let is_deferred = !seen.contains(b);
            if is_deferred {
                self.free_page(b);
            }
            is_deferred
        });
        self.deferred.append(&mut queue);
        self.queue = queue;
        for (leaf, bricks) in inexact.leaves() {
            for_each_in(leaf, &bricks.and_not(&seen.of_leaf(leaf)), |b| {
                self.free_page(b);
            });
        }
        self.fresh = 0;
        let first = changed.len();
        if precision == Precision::Refined || targets.len() <= PROMPT_PORTION {
            self.retain_outstanding(grid, &mut targets);
            self.compute(Level::new(), grid, &targets, Precision::Refined, changed);
        } else {
            self.estimate(grid, targets, &inexact, changed);
        }
        sort_from(changed, first);
        self.inexact = inexact;
        self.inexact.clear();
        if self.deferred.len() > grid.brick_count() {
            self.retain_deferred(grid);
        }
    }

    /// Computes the outstanding normals of bricks that are visible in these maps, however many they are, for as long as
    /// `go_on` returns true. All others stay outstanding: pictures of an opened sculpture need no more. Bricks whose
    /// voxels are far smaller than a pixel ([`REFINED_BELOW_VX`]) have first estimates, and stay outstanding, too.
    /// Reports bricks as `update` does.
    pub fn complete_seen<'a>(
        &mut self,
        grid: &Grid,
        maps: impl IntoIterator<Item = &'a IndexMap> + Clone,
        changed: &mut Vec<u32>,
        mut go_on: impl FnMut() -> bool,
    ) {
        if self.is_complete() && !self.follows_pictures() {
            return;
        }
        let mut seen = BrickSet::default();
        let mut edges = Vec::new();
        for map in maps.clone() {
            bricks_in(map, PixelRect::of_picture(map.rays.size), &self.table, &mut seen);
            edges.push(map.rays.pixel_edges_vx());
        }
        self.forget_inexact();
        let mut targets = indices(grid, &seen);
        targets.sort_by_cached_key(|index| (block(grid, *index), *index));
        let is_refined = |index: &u32| {
            let centre = (grid.brick_coords(*index as usize) * BRICK_EDGE_VX).as_vec3()
                + 0.5 * BRICK_EDGE_VX as f32;
            edges.iter().any(|edge| edge(centre) < REFINED_BELOW_VX)
        };
        let (first, mut is_finished) = (changed.len(), true);
        for portion in targets.chunk_by(|a, b| block(grid, *a) == block(grid, *b)) {
            if !go_on() {
                is_finished = false;
                break;
            }
            let (refined, mut estimated): (Vec<u32>, Vec<u32>) =
                portion.iter().partition(|i| is_refined(i));
            self.compute(Level::new(), grid, &refined, Precision::Refined, changed);
            estimated.retain(|i| self.table.page(grid.brick_coords(*i as usize)) == NO_PAGE);
            self.compute(Level::new(), grid, &estimated, Precision::Estimated, changed);
        }
        self.note_shown(grid, maps, is_finished, changed);
        sort_from(changed, first);
    }

    /// Computes the outstanding normals of these bricks. Reports bricks as `update` does.
    pub(in crate::shade) fn complete_bricks(
        &mut self,
        grid: &Grid,
        bricks: &BrickSet,
        changed: &mut Vec<u32>,
    ) {
        let (first, mut targets) = (changed.len(), Vec::new());
        for (leaf, wanted) in bricks.leaves() {
            let outstanding = self.table.outstanding_in(leaf.coords()).and(&wanted);
            let near = match outstanding.is_empty() {
                true => continue,
                false => outstanding.and(&grid.bricks_near_surface(leaf)),
            };
            for_each_in(leaf, &near, |b| targets.push(grid.brick_index(b) as u32));
        }
        targets.sort_by_cached_key(|index| (block(grid, *index), *index));
        for portion in targets.chunk_by(|a, b| block(grid, *a) == block(grid, *b)) {
            self.compute(Level::new(), grid, portion, Precision::Refined, changed);
        }
        sort_from(changed, first);
    }

    /// Forgets which first estimates edits have made inexact, and removes those of an opened sculpture that remains to be
    /// computed.
    pub(super) fn forget_inexact(&mut self) {
        let inexact = std::mem::take(&mut self.inexact);
        if !self.blocks.is_empty() {
            for (leaf, bricks) in inexact.leaves() {
                for_each_in(leaf, &bricks, |b| {
                    if self.table.is_outstanding(b) {
                        self.free_page(b);
                    }
                });
            }
        }
        self.inexact = inexact;
        self.inexact.clear();
    }

    /// Gives first estimates to those of `targets` that are `inexact` or have none.
    fn estimate(
        &mut self,
        grid: &Grid,
        mut targets: Vec<u32>,
        inexact: &BrickSet,
        changed: &mut Vec<u32>,
    ) {
        let coords = |index: u32| grid.brick_coords(index as usize);
        let mut known = BrickSet::default();
        self.estimated.iter().for_each(|index| known.insert(coords(*index)));
        self.retain_outstanding(grid, &mut targets);
        self.estimated.extend(targets.iter().filter(|index| !known.contains(coords(**index))));
        self.deferred.extend_from_slice(&targets);
        targets.retain(|index| {
            let b = coords(*index);
            inexact.contains(b) || self.table.page(b) == NO_PAGE
        });
        self.compute(Level::new(), grid, &targets, Precision::Estimated, changed);
    }

    /// Keeps those of `deferred` that remain to be computed, each once, in ascending order.
    pub(super) fn retain_deferred(&mut self, grid: &Grid) {
        let mut deferred = std::mem::take(&mut self.deferred);
        deferred.sort_unstable();
        deferred.dedup();
        self.retain_outstanding(grid, &mut deferred);
        self.deferred = deferred;
    }

    /// Returns an upper bound of the number of deferred bricks.
    pub fn deferred(&self) -> usize {
        self.deferred.len()
    }

    /// Computes deferred normals, for as long as `go_on` returns true. Reports bricks as [`NormalField::update`] does.
    pub fn update_deferred(
        &mut self,
        grid: &Grid,
        changed: &mut Vec<u32>,
        mut go_on: impl FnMut() -> bool,
    ) {
        if self.deferred.is_empty() {
            return;
        }
        let first = changed.len();
        while !self.estimated.is_empty() && go_on() {
            let count = self.estimated.len().min(DEFERRED_PORTION);
            let mut portion: Vec<u32> = self.estimated.drain(..count).collect();
            self.retain_outstanding(grid, &mut portion);
            portion.sort_unstable();
            self.compute(Level::new(), grid, &portion, Precision::Refined, changed);
        }
        self.retain_deferred(grid);
        self.deferred.sort_by_cached_key(|index| (block(grid, *index), *index));
        while !self.deferred.is_empty() && go_on() {
            let from = self.deferred.len().saturating_sub(DEFERRED_PORTION);
            let mut portion = self.deferred.split_off(from);
            portion.sort_unstable();
            self.compute(Level::new(), grid, &portion, Precision::Refined, changed);
            // Whether they differ from those before the edit is unknown.
            changed.extend_from_slice(&portion);
        }
        sort_from(changed, first);
    }
}

/// Sorts `list` from `first` on, and removes duplicates.
pub(in crate::shade) fn sort_from(list: &mut Vec<u32>, first: usize) {
    let mut own = list.split_off(first);
    own.sort_unstable();
    own.dedup();
    list.append(&mut own);
}

/// Returns the linear indices of bricks, ascending.
fn indices(grid: &Grid, bricks: &BrickSet) -> Vec<u32> {
    let mut indices = Vec::new();
    for (leaf, bricks) in bricks.leaves() {
        for_each_in(leaf, &bricks, |b| indices.push(grid.brick_index(b) as u32));
    }
    indices.sort_unstable();
    indices
}

/// Adds to `seen` the bricks whose voxels are visible in `rect`, of those that are outstanding in `table`.
fn bricks_in(map: &IndexMap, rect: PixelRect, table: &PageTable, seen: &mut BrickSet) {
    let rect = rect.intersect(PixelRect::of_picture(map.rays.size));
    let (left, right) = (rect.min.x as usize, rect.max.x as usize);
    if left >= right {
        return;
    }
    // Each brick once for every run of voxels in it.
    let in_rows = |rows: &[u32], found: &mut Vec<UVec3>| {
        for row in rows.chunks_exact(map.rays.size.x as usize) {
            let (mut last_voxel, mut last) = (NO_VOXEL, UVec3::MAX);
            for &voxel in &row[left..right] {
                if voxel != last_voxel && voxel != NO_VOXEL {
                    let b = map.numbering.coords(voxel) / BRICK_EDGE_VX;
                    if b != last && table.is_outstanding(b) {
                        found.push(b);
                    }
                    last = b;
                }
                last_voxel = voxel;
            }
        }
    };
    let rows = rect.rows_of(&map.voxels, map.rays.size.x);
    let parts = rows.par_chunks(ROWS_AT_ONCE * map.rays.size.x as usize);
    let found = parts.fold(Vec::new, |mut found, rows| {
        in_rows(rows, &mut found);
        found
    });
    let found: Vec<Vec<UVec3>> = found.collect();
    found.iter().flatten().for_each(|b| seen.insert(*b));
}
