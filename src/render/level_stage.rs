//! The smooth surface of a renderer's pictures: when it is drawn, and what has changed of it.
//!
//! Follows the grid and the normals of one document. The surface between voxels is drawn where a voxel covers more
//! than a pixel of any picture; farther away nobody could see it. It is computed when it is first drawn.

use crate::sculpture::{Grid, Limits};
use crate::shade::{LevelSampler, LevelSet, NormalField};
use crate::surface::{IndexMap, PixelRect, PixelRects, changed_pixels, pixels_of_grid};
use crate::view::PixelRays;

/// Reach of a voxel's level beyond the voxel: cells lie between the middles of voxels.
const LEVEL_REACH_VX: u32 = 1;

/// See the module text.
#[derive(Default)]
pub(super) struct LevelStage {
    levels: Option<LevelSet>,
    sampler: LevelSampler,
    /// The present picture shows the smooth surface.
    active: bool,
    /// Bricks whose levels differ from those of the last picture, rising.
    changed: Vec<u32>,
}

impl LevelStage {
    /// Brings the surface up to date for a picture of `grid`, if it shows it. `wanted`: its mode can, and it is to.
    /// `reshaded`: the bricks that have changed, or have other normals, since the last call; none: all may have.
    pub fn update(
        &mut self,
        grid: &Grid,
        normals: &NormalField,
        reshaded: Option<&[u32]>,
        wanted: bool,
    ) {
        match (reshaded, &mut self.levels) {
            (Some(changed), Some(levels)) if levels.fits(grid) => levels.follow(grid, changed),
            (_, levels) => *levels = None,
        }
        self.show(grid, normals, wanted);
    }

    /// Decides whether the next pictures show the surface, and if so, brings it up to date.
    pub fn show(&mut self, grid: &Grid, normals: &NormalField, wanted: bool) {
        self.changed.clear();
        self.active = wanted;
        if !wanted {
            return;
        }
        let levels = match &mut self.levels {
            Some(levels) => levels,
            // A grid that is too large for it shows its voxels.
            none => match LevelSet::new(grid, Limits::default().grid_bytes) {
                Ok(levels) => none.insert(levels),
                Err(_) => return self.active = false,
            },
        };
        levels.update(grid, normals, &mut self.changed);
    }

    /// Whether the picture shows the smooth surface; if so, whether it differs from that of the last picture.
    pub fn state(&self) -> Option<bool> {
        self.active.then_some(!self.changed.is_empty())
    }

    /// The bricks whose levels differ from those of the last picture.
    pub fn changed(&self) -> &[u32] {
        &self.changed
    }

    /// The surface, if the picture shows it, for a sample of antialiased pictures ([`super::FrameDesc::sample`]).
    pub fn surface<'a>(
        &'a mut self,
        normals: &'a NormalField,
        sample: u32,
    ) -> Option<SampledLevels<'a>> {
        let levels = self.levels.as_ref().filter(|_| self.active)?;
        self.sampler.sample = sample;
        Some(SampledLevels { levels, normals, changed: &self.changed, sampler: &mut self.sampler })
    }
}

/// The smooth surface, ready to be sampled.
pub(super) struct SampledLevels<'a> {
    levels: &'a LevelSet,
    normals: &'a NormalField,
    changed: &'a [u32],
    sampler: &'a mut LevelSampler,
}

impl SampledLevels<'_> {
    /// The pixels in which anything can be seen.
    pub fn visible(&self, rays: &PixelRays) -> PixelRect {
        pixels_of_grid(self.levels.cells(), &LevelSet::rays_of_cells(rays))
    }

    /// Samples the pixels of `rect` of a map that has its rays.
    pub fn sample_rect(&mut self, grid: &Grid, rect: PixelRect, map: &mut IndexMap) {
        self.sampler.sample_rect(grid, self.normals, self.levels, rect, map);
    }

    /// Samples `map` with `rays`, or only what has changed since it was sampled with them; returns the pixels then.
    pub fn sample(
        &mut self,
        grid: &Grid,
        rays: &PixelRays,
        partially: bool,
        map: &mut IndexMap,
    ) -> Option<PixelRects> {
        let SampledLevels { levels, normals, changed, sampler } = self;
        if !partially {
            sampler.sample(grid, normals, levels, rays, map);
            return None;
        }
        let rects = changed_pixels(grid, changed, rays, LEVEL_REACH_VX);
        for rect in rects.as_slice() {
            sampler.sample_rect(grid, normals, levels, *rect, map);
        }
        Some(rects)
    }
}
