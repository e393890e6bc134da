//! Index maps of the smooth surface.
//!
//! The exact ray caster finds the first cell of every pixel; [`super::ray`] finds the point on the surface from there
//! on. A map names the nearest voxel of each pixel, as any other sampler's does, and has the normals between voxels.
//! The further samples of an antialiased picture name any voxel next to the point, nearer ones more often: in their
//! mean, values that are shaded by voxel, such as colours, change gradually from one voxel to the next.
//!
//! Levels can be complete, or computed as rays meet them: then parts of a picture are sampled again until none is
//! missing.

use std::cell::Cell;

use glam::UVec3;
use rayon::prelude::*;

use super::ray::{CellCache, LevelScene, Naming};
use super::{LevelSet, around};
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::brick_set::BrickSet;
use crate::sculpture::{Grid, NO_VOXEL};
use crate::shade::NormalField;
use crate::shade::normal_field::PackedNormal;
use crate::surface::{IndexMap, PixelRect, VoxelNamer, raycast};
use crate::view::PixelRays;

/// Rows of pixels that one parallel task samples, and the width of its strips: pixels of a strip examine the same
/// cells.
const BAND_ROWS: usize = 16;
const STRIP_PX: usize = 64;

/// Returns how a sample of a pixel selects voxels: by different numbers for each pixel, evenly distributed over its
/// samples (multiples of the golden ratio).
#[inline(always)]
fn naming(sample: u32, [x, y]: [u32; 2]) -> Naming {
    const GOLDEN: u32 = 0x9E37_79B9;
    if sample == 0 {
        return Naming::Nearest;
    }
    // The finaliser of MurmurHash3.
    let mut hash = x ^ y << 16 ^ y >> 16;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85EB_CA6B);
    hash = (hash ^ hash >> 13).wrapping_mul(0xC2B2_AE35);
    let number = (hash ^ hash >> 16).wrapping_add(sample.wrapping_mul(GOLDEN));
    Naming::ByShare((number >> 8) as f32 / (1 << 24) as f32)
}

/// Samples pictures of one eye. Keeps its memory.
#[derive(Debug)]
pub struct LevelSampler {
    /// The first cell of each pixel.
    cells: IndexMap,
    /// The strips of bands to be sampled, those of a band after each other.
    strips: Vec<bool>,
    /// The index of the sample in an antialiased picture; 0 selects the nearest voxels.
    pub sample: u32,
}

impl Default for LevelSampler {
    fn default() -> LevelSampler {
        let cells = IndexMap::new(PixelRays::of_nothing());
        LevelSampler { cells, strips: Vec::new(), sample: 0 }
    }
}

impl LevelSampler {
    /// Fills `map` with the smooth surface seen along `rays`. `levels` must be up to date with `grid` and `normals`.
    pub fn sample(
        &mut self,
        grid: &Grid,
        normals: &NormalField,
        levels: &LevelSet,
        rays: &PixelRays,
        map: &mut IndexMap,
    ) {
        map.reset_with_normals(grid.dims(), *rays);
        self.sample_rect(grid, normals, levels, PixelRect::of_picture(rays.size), map);
    }

    /// Resamples the pixels of `rect` (cut to the picture) of a map of the smooth surface.
    pub fn sample_rect(
        &mut self,
        grid: &Grid,
        normals: &NormalField,
        levels: &LevelSet,
        rect: PixelRect,
        map: &mut IndexMap,
    ) {
        if let Some(rect) = self.begin(grid, levels, rect, map) {
            self.sample_strips(LevelScene { grid, normals, levels }, rect, map);
        }
    }

    /// Performs [`LevelSampler::sample`] with levels of which any may be outstanding. Computes those that the picture
    /// shows, with the normals that they are made of.
    pub fn sample_completing(
        &mut self,
        grid: &Grid,
        (normals, levels): (&mut NormalField, &mut LevelSet),
        rays: &PixelRays,
        map: &mut IndexMap,
    ) {
        map.reset_with_normals(grid.dims(), *rays);
        let rect = PixelRect::of_picture(rays.size);
        self.complete_rect(grid, (normals, levels), rect, map, &mut || true);
    }

    /// Performs [`LevelSampler::sample_rect`] with levels of which any may be outstanding. Computes a portion of them at
    /// least, and others while `goes_on` returns true. Returns whether all pixels are sampled; if not, the next call needs
    /// to compute less.
    pub fn complete_rect(
        &mut self,
        grid: &Grid,
        (normals, levels): (&mut NormalField, &mut LevelSet),
        rect: PixelRect,
        map: &mut IndexMap,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> bool {
        let Some(rect) = self.begin(grid, levels, rect, map) else { return true };
        let mut changed = Vec::new();
        let mut outstanding = self.bricks_of_cells(grid, rect);
        let is_over = Cell::new(false);
        let mut goes_on = || {
            is_over.set(!goes_on());
            !is_over.get()
        };
        while levels.complete(grid, normals, &outstanding, &mut changed, &mut goes_on) {
            let found = self.sample_strips(LevelScene { grid, normals, levels }, rect, map);
            if found.is_empty() {
                return true;
            }
            if is_over.get() {
                break;
            }
            // Rays go on into the bricks beside them.
            outstanding = around(grid, found.into_iter(), 1);
        }
        false
    }

    /// Finds the first cells of the pixels of `rect`, cut to the picture. Returns that; `None` if it is empty.
    fn begin(
        &mut self,
        grid: &Grid,
        levels: &LevelSet,
        rect: PixelRect,
        map: &mut IndexMap,
    ) -> Option<PixelRect> {
        let rect = rect.intersect(PixelRect::of_picture(map.rays.size));
        if rect.is_empty() {
            return None;
        }
        self.cells.reset(levels.cells().dims(), LevelSet::rays_of_cells(&map.rays));
        raycast::sample_exact_rect(levels.cells(), &mut self.cells, rect);
        map.renew(grid.dims(), rect);
        let bands = (rect.max.y - rect.min.y).div_ceil(BAND_ROWS as u32) as usize;
        self.strips.clear();
        self.strips.resize(bands * strips_of(rect), true);
        Some(rect)
    }

    /// Returns the bricks of the voxels of the first cells.
    fn bricks_of_cells(&self, grid: &Grid, rect: PixelRect) -> BrickSet {
        let (mut bricks, mut last) = (BrickSet::default(), UVec3::MAX);
        let width = self.cells.rays.size.x as usize;
        let last_brick = grid.brick_dims() - 1;
        for row in rect.rows_of(&self.cells.voxels, width as u32).chunks(width) {
            let row = &row[rect.min.x as usize..rect.max.x as usize];
            for &cell in row.iter().filter(|cell| **cell != NO_VOXEL) {
                let b = (self.cells.numbering.coords(cell) / BRICK_EDGE_VX).min(last_brick);
                if b != last {
                    bricks.insert(b);
                    last = b;
                }
            }
        }
        bricks
    }

    /// Samples the pixels of the strips. Returns the bricks whose levels were needed and are outstanding; the strips that
    /// need them remain to be sampled.
    fn sample_strips(
        &mut self,
        scene: LevelScene,
        rect: PixelRect,
        map: &mut IndexMap,
    ) -> Vec<UVec3> {
        let (rays, sample) = (self.cells.rays, self.sample);
        let (numbering, cell_numbering) = (&map.numbering, &self.cells.numbering);
        let (width, band) = (map.rays.size.x, map.rays.size.x as usize * BAND_ROWS);
        let voxels = rect.rows_of_mut(&mut map.voxels, width).par_chunks_mut(band);
        let normals = rect.rows_of_mut(&mut map.normals, width).par_chunks_mut(band);
        let cells = rect.rows_of(&self.cells.voxels, width).par_chunks(band);
        let strips = self.strips.par_chunks_mut(strips_of(rect));
        let bands = voxels.zip(normals).zip(cells.zip(strips)).enumerate();
        let found = bands.map_init(
            CellCache::default,
            |cache, (band, ((voxels, normals), (cells, strips)))| {
                let first_y = rect.min.y + (band * BAND_ROWS) as u32;
                let rows = 0..(cells.len() / width as usize) as u32;
                let mut namer = VoxelNamer::new(numbering);
                for (left, wanted) in (rect.min.x..rect.max.x).step_by(STRIP_PX).zip(strips) {
                    if !std::mem::take(wanted) {
                        continue;
                    }
                    let known = cache.outstanding.len();
                    let strip = left..rect.max.x.min(left + STRIP_PX as u32);
                    for (row, x) in
                        rows.clone().flat_map(|row| strip.clone().map(move |x| (row, x)))
                    {
                        let i = (row * width + x) as usize;
                        let seen = match cells[i] {
                            NO_VOXEL => None,
                            cell => {
                                let cell = cell_numbering.coords(cell);
                                let direction = rays.direction(x, first_y + row);
                                let naming = naming(sample, [x, first_y + row]);
                                scene.hit(naming, rays.origin, direction, cell, cache)
                            }
                        };
                        (voxels[i], normals[i]) = match seen {
                            Some(hit) => (namer.number(hit.voxel), hit.normal.0),
                            None => (NO_VOXEL, PackedNormal::NONE.0),
                        };
                    }
                    *wanted = cache.outstanding.len() > known;
                }
                let mut found = std::mem::take(&mut cache.outstanding);
                found.sort_unstable_by_key(|b| b.to_array());
                found.dedup();
                found
            },
        );
        found.flatten_iter().collect()
    }
}

/// Returns the number of strips of a band.
fn strips_of(rect: PixelRect) -> usize {
    ((rect.max.x - rect.min.x) as usize).div_ceil(STRIP_PX)
}
