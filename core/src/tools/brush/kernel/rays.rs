//! Brushes under an outline in the picture: the voxels around the surface voxels that a footprint selects.
//!
//! The footprint lies in the picture, so that the brush works on exactly what is on the screen (J. Mueller 2005:
//! "congruent with the picture"). Changes nothing itself.

use glam::IVec3;

use super::stamp::Stamp;
use crate::sculpture::Grid;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::region::ListedBricks;
use crate::tools::brush::BrushUse;
use crate::tools::brush::change::Site;
use crate::tools::brush::footprint::{Footprint, Outline, TouchedVoxel};
use crate::tools::brush::keys::{REACH, THRESHOLD};

/// The surface voxels under a footprint, and a box of all that may change around them.
struct Touched {
    touches: Vec<TouchedVoxel>,
    min: IVec3,
    max: IVec3,
}

/// The voxels that filters read: existing ones near the surface, and those that may change.
pub struct Near {
    /// Existing voxels.
    pub solid: BitBlock,
    /// Voxels that may change.
    pub may: BitBlock,
}

/// The voxels that a filter adds, and those that it removes.
pub struct Filtered {
    /// The voxels to add.
    pub add: Option<BitBlock>,
    /// The voxels to remove.
    pub remove: Option<BitBlock>,
}

/// Returns the change under the footprint of a use and its mirror images.
pub fn under(used: &BrushUse, site: &Site, one: impl Fn(&Footprint) -> Stamp) -> Stamp {
    let Some(footprint) = used.footprint() else { return Stamp::default() };
    Stamp::union(site.images.iter().map(|image| one(&footprint.image(image))))
}

/// Returns the surface voxels under one footprint.
pub fn seen(footprint: &Footprint, site: &Site) -> ListedBricks {
    let Some(touched) = Touched::under(footprint, site.surface, 0) else {
        return ListedBricks::default();
    };
    let mut seen = BitBlock::empty(touched.min, touched.max);
    touched
        .touches
        .iter()
        .for_each(|TouchedVoxel { voxel: v, .. }| seen.set_span(v.x, v.x, v.y, v.z));
    ListedBricks::new(seen.bricks(site.contents.grid.brick_dims()))
}

/// Returns the voxels around the surface voxels under a use and its mirror images. `share`: maps the distance from the
/// centre of the footprint (0) to its rim (1) to a share of the reach.
pub fn around(
    used: &BrushUse,
    site: &Site,
    share: impl Fn(f32) -> f32,
    outline: Outline,
) -> ListedBricks {
    let reach_vx = used.get(REACH);
    let margin = reach_vx.ceil() as i32 + 1;
    let dims = site.contents.grid.brick_dims();
    let stamp = under(used, site, |footprint| {
        let touched = Touched::under(footprint, site.surface, margin);
        let around = touched.map(|touched| {
            let around = touched.around(|offset| reach_vx * share(offset), outline);
            ListedBricks::new(around.bricks(dims))
        });
        Stamp { add: around.unwrap_or_default(), ..Stamp::default() }
    });
    stamp.add
}

/// Applies a filter to the voxels near the surface under one footprint. `margin`: how far around voxels that may change
/// the filter reads.
pub fn filtered(
    footprint: &Footprint,
    site: &Site,
    reach_vx: f32,
    margin: u32,
    filter: impl Fn(&Near) -> Filtered,
) -> Stamp {
    let margin = reach_vx.ceil() as i32 + margin as i32;
    let Some(touched) = Touched::under(footprint, site.surface, margin) else {
        return Stamp::default();
    };
    let may = touched.around(|_| reach_vx, Outline::Round);
    let solid = BitBlock::of_grid(&site.contents.grid, touched.min, touched.max);
    let Filtered { add, remove } = filter(&Near { solid, may });
    let dims = site.contents.grid.brick_dims();
    let listed = |block: Option<BitBlock>| {
        block.map(|block| ListedBricks::new(block.bricks(dims))).unwrap_or_default()
    };
    Stamp { add: listed(add), remove: listed(remove), ..Stamp::default() }
}

/// Applies a filter that compares neighbour counts with the threshold of a use, under it and its mirror images.
pub(crate) fn by_threshold(
    used: &BrushUse,
    site: &Site,
    filter: impl Fn(&Near, u32) -> BitBlock,
) -> ListedBricks {
    let (reach_vx, threshold) = (used.get(REACH), used.get(THRESHOLD));
    let stamp = under(used, site, |footprint| {
        filtered(footprint, site, reach_vx, 1, |near| Filtered {
            add: Some(filter(near, threshold)),
            remove: None,
        })
    });
    stamp.add
}

impl Touched {
    /// Returns `None` if there is no surface under the footprint.
    fn under(footprint: &Footprint, surface: &Grid, margin: i32) -> Option<Touched> {
        let touches = footprint.touched(surface);
        let min = touches.iter().map(|touch| touch.voxel).reduce(IVec3::min)?;
        let max = touches.iter().map(|touch| touch.voxel).reduce(IVec3::max)?;
        Some(Touched { touches, min: min - margin, max: max + margin + 1 })
    }

    fn around(&self, reach_vx: impl Fn(f32) -> f32, outline: Outline) -> BitBlock {
        // Distances between voxels are roots of integers, so all reaches between two of them are equivalent.
        let steps = |offset: f32| match outline {
            Outline::Round => reach_vx(offset).max(0.0).powi(2) as u32,
            Outline::Square => reach_vx(offset).max(0.0) as u32,
        };
        let touches = self.touches.iter();
        let mut seeds: Vec<(u32, IVec3)> =
            touches.map(|touch| (steps(touch.offset), touch.voxel)).collect();
        seeds.sort_unstable_by_key(|(steps, _)| *steps);
        let mut around = BitBlock::empty(self.min, self.max);
        for alike in seeds.chunk_by(|(a, _), (b, _)| a == b) {
            let mut seeds = around.emptied();
            alike.iter().for_each(|(_, v)| seeds.set_span(v.x, v.x, v.y, v.z));
            match outline {
                Outline::Round => around.add_balls(&seeds, alike[0].0),
                Outline::Square => around.add_cubes(&seeds, alike[0].0),
            }
        }
        around
    }
}
