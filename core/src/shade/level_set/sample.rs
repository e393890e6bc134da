//! Index maps of the smooth surface.
//!
//! The exact ray caster finds the first cell of every pixel, [`super::ray`] the place on the surface from there on.
//! A map names the nearest voxel of each pixel, as any other sampler's does, and has the normals between voxels.

use glam::Vec3;
use rayon::prelude::*;

use super::LevelSet;
use super::ray::{Cell, Scene};
use crate::sculpture::{Grid, NO_VOXEL};
use crate::shade::NormalField;
use crate::shade::normal_field::PackedNormal;
use crate::surface::{IndexMap, PixelRect, raycast};
use crate::view::PixelRays;

/// Samples pictures of one eye. Keeps its memory.
#[derive(Debug)]
pub struct LevelSampler {
    /// The first cell of each pixel.
    cells: IndexMap,
}

impl Default for LevelSampler {
    fn default() -> LevelSampler {
        LevelSampler { cells: IndexMap::new(PixelRays::of_nothing()) }
    }
}

impl LevelSampler {
    /// Fills `map` with what `rays` see of the smooth surface. `levels` must be up to date with `grid` and `normals`.
    pub fn sample(
        &mut self,
        grid: &Grid,
        normals: &NormalField,
        levels: &LevelSet,
        rays: &PixelRays,
        map: &mut IndexMap,
    ) {
        map.reset_with_normals(*rays);
        self.sample_rect(grid, normals, levels, PixelRect::of_picture(rays.size), map);
    }

    /// Samples again the pixels of `rect` (cut to the picture) of a map of the smooth surface.
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
        self.cells.reset(LevelSet::rays_of_cells(&map.rays));
        raycast::sample_rect(levels.cells(), &mut self.cells, rect);
        let scene = Scene { grid, normals, levels };
        let rays = self.cells.rays;
        let width = map.rays.size.x;
        let rows = rect.rows_of_mut(&mut map.voxels, width).par_chunks_mut(width as usize);
        let rows =
            rows.zip(rect.rows_of_mut(&mut map.normals, width).par_chunks_mut(width as usize));
        let cells = rect.rows_of(&self.cells.voxels, width).par_chunks(width as usize);
        rows.zip(cells).zip(rect.rows()).for_each(|(((voxels, normals), cells), y)| {
            let mut last = Cell::default();
            for x in rect.min.x..rect.max.x {
                let i = x as usize;
                let seen = match cells[i] {
                    NO_VOXEL => None,
                    cell => {
                        let cell = levels.cells().voxel_coords(cell);
                        let direction: Vec3 = rays.direction(x, y);
                        scene.hit(rays.origin, direction, cell, &mut last)
                    }
                };
                (voxels[i], normals[i]) = match seen {
                    Some(hit) => (grid.voxel_index(hit.voxel), hit.normal.0),
                    None => (NO_VOXEL, PackedNormal::NONE.0),
                };
            }
        });
    }
}
