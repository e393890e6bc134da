//! Index maps of the smooth surface.
//!
//! The exact ray caster finds the first cell of every pixel; [`super::ray`] finds the point on the surface from there
//! on. A map names the nearest voxel of each pixel, as any other sampler's does, and has the normals between voxels.
//! The further samples of an antialiased picture name any voxel next to the point, nearer ones more often: in their
//! mean, values that are shaded by voxel, such as colours, change gradually from one voxel to the next.

use rayon::prelude::*;

use super::LevelSet;
use super::ray::{CellCache, LevelScene, Naming};
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
    /// The index of the sample in an antialiased picture; 0 selects the nearest voxels.
    pub sample: u32,
}

impl Default for LevelSampler {
    fn default() -> LevelSampler {
        LevelSampler { cells: IndexMap::new(PixelRays::of_nothing()), sample: 0 }
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
        let rect = rect.intersect(PixelRect::of_picture(map.rays.size));
        if rect.is_empty() {
            return;
        }
        self.cells.reset(levels.cells().dims(), LevelSet::rays_of_cells(&map.rays));
        raycast::sample_exact_rect(levels.cells(), &mut self.cells, rect);
        let scene = LevelScene { grid, normals, levels };
        let (rays, sample) = (self.cells.rays, self.sample);
        map.renew(grid.dims(), rect);
        let (numbering, cell_numbering) = (&map.numbering, &self.cells.numbering);
        let (width, band) = (map.rays.size.x, map.rays.size.x as usize * BAND_ROWS);
        let voxels = rect.rows_of_mut(&mut map.voxels, width).par_chunks_mut(band);
        let normals = rect.rows_of_mut(&mut map.normals, width).par_chunks_mut(band);
        let cells = rect.rows_of(&self.cells.voxels, width).par_chunks(band);
        let bands = voxels.zip(normals).zip(cells).enumerate();
        bands.for_each_init(CellCache::default, |cache, (band, ((voxels, normals), cells))| {
            let first_y = rect.min.y + (band * BAND_ROWS) as u32;
            let rows = 0..(cells.len() / width as usize) as u32;
            let mut namer = VoxelNamer::new(numbering);
            for left in (rect.min.x..rect.max.x).step_by(STRIP_PX) {
                let strip = left..rect.max.x.min(left + STRIP_PX as u32);
                for (row, x) in rows.clone().flat_map(|row| strip.clone().map(move |x| (row, x))) {
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
            }
        });
    }
}
