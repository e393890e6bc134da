//! The geometry of the slicing renderer: rectangles of bricks ("areas") in the slabs of a grid, and the layers of a
//! view, front to back.
//!
//! A slab is one or several layers of bricks across an axis. Empty bricks are left out, and so are buried ones: full,
//! with the touching layers of all six neighbours full, so that every ray from outside hits another voxel first. The
//! others are grouped into areas by dividing a slab's rectangle in two until it is dense enough. An area may thus hold
//! bricks that need not be drawn; every brick that needs to be is in exactly one.
//!
//! Areas are stored per axis and rebuilt only in slabs where a brick began or ceased to need drawing. Knows grids and
//! rays, no Vulkan.

mod areas;
mod exposure;
mod layers;

pub use areas::{SlabAreas, SliceArea};
pub use layers::{LayerRect, SliceLayer, SliceLayers, facing_axis};

use glam::UVec3;

use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;
use exposure::Exposure;

/// The areas of a grid along each axis, kept until the geometry changes.
#[derive(Debug)]
pub struct SliceAreas {
    exposure: Exposure,
    axes: [Option<AxisAreas>; 3],
    slab_bricks: u32,
}

/// Layers of bricks in a slab. More layers mean fewer fragments that start a ray, but more empty bricks to traverse.
const SLAB_BRICKS: u32 = 2;

impl Default for SliceAreas {
    fn default() -> Self {
        SliceAreas::with_slab_bricks(SLAB_BRICKS)
    }
}

#[derive(Debug)]
struct AxisAreas {
    slabs: Vec<SlabAreas>,
    stale: Vec<bool>,
}

impl SliceAreas {
    /// Returns areas for slabs of `slab_bricks` (at least 1) layers of bricks.
    pub fn with_slab_bricks(slab_bricks: u32) -> SliceAreas {
        let exposure = Exposure::default();
        SliceAreas { exposure, axes: Default::default(), slab_bricks: slab_bricks.max(1) }
    }

    /// Returns the number of voxels from one slab to the next.
    pub fn slab_vx(&self) -> u32 {
        self.slab_bricks * BRICK_EDGE_VX
    }

    /// Marks changed bricks (linear indices); `None` means that the whole grid is new, possibly with another size.
    pub fn update(&mut self, grid: &Grid, changed: Option<&[u32]>) {
        match changed {
            Some(bricks) if self.exposure.fits(grid) => {
                let (axes, slab_bricks) = (&mut self.axes, self.slab_bricks);
                self.exposure.update(grid, bricks, |brick| {
                    for (axis, areas) in axes.iter_mut().enumerate() {
                        if let Some(areas) = areas {
                            areas.stale[(brick[axis] / slab_bricks) as usize] = true;
                        }
                    }
                });
            }
            _ => {
                self.exposure = Exposure::of(grid);
                self.axes = Default::default();
            }
        }
    }

    /// Returns the areas of every slab across `axis`, in ascending order.
    pub fn along(&mut self, axis: usize) -> &[SlabAreas] {
        let exposure = &self.exposure;
        let areas = self.axes[axis].get_or_insert_with(|| {
            let count = exposure.brick_dims()[axis].div_ceil(self.slab_bricks) as usize;
            AxisAreas { slabs: vec![SlabAreas::default(); count], stale: vec![true; count] }
        });
        areas::rebuild(exposure, axis, self.slab_bricks, &mut areas.slabs, &mut areas.stale);
        &areas.slabs
    }

    /// Returns whether the brick at `b` needs drawing.
    pub fn is_exposed(&self, b: UVec3) -> bool {
        self.exposure.get(b)
    }
}

#[cfg(test)]
mod tests;
