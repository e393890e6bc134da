//! Owns what the slicing renderer draws: rectangles of bricks ("areas") in the slabs of a grid,
//! and the layers in which an eye meets them, front to back.
//!
//! A slab is one layer of bricks across an axis. Empty bricks are left out, and so are buried
//! ones: full, with the touching layers of all six neighbours full, so that every ray that
//! comes to them from outside has met a voxel before. The others are joined to areas by dividing
//! a slab's rectangle in two until it is dense enough. An area may thus hold bricks that need
//! not be drawn; every brick that needs to be is in exactly one.
//!
//! Areas are kept per axis and rebuilt only in slabs where a brick began or ceased to need
//! drawing. Knows grids and rays, no Vulkan.

mod areas;
mod exposure;
mod layers;

pub use areas::{Area, SlabAreas};
pub use layers::{Layer, LayerRect, Layers, facing_axis};

use glam::UVec3;

use crate::sculpture::Grid;
use exposure::Exposure;

/// The areas of a grid along each axis, kept until the geometry changes.
#[derive(Debug, Default)]
pub struct SliceAreas {
    exposure: Exposure,
    axes: [Option<AxisAreas>; 3],
}

#[derive(Debug)]
struct AxisAreas {
    slabs: Vec<SlabAreas>,
    stale: Vec<bool>,
}

impl SliceAreas {
    /// Takes note of changed bricks (linear indices); `None` means that all of the grid, perhaps
    /// with other dimensions, is new.
    pub fn update(&mut self, grid: &Grid, changed: Option<&[u32]>) {
        match changed {
            Some(bricks) if self.exposure.fits(grid) => {
                let axes = &mut self.axes;
                self.exposure.update(grid, bricks, |brick| {
                    for (axis, areas) in axes.iter_mut().enumerate() {
                        if let Some(areas) = areas {
                            areas.stale[brick[axis] as usize] = true;
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

    /// The areas of every slab across `axis`, in rising order.
    pub fn along(&mut self, axis: usize) -> &[SlabAreas] {
        let exposure = &self.exposure;
        let areas = self.axes[axis].get_or_insert_with(|| {
            let count = exposure.brick_dims()[axis] as usize;
            AxisAreas { slabs: vec![SlabAreas::default(); count], stale: vec![true; count] }
        });
        areas::rebuild(exposure, axis, &mut areas.slabs, &mut areas.stale);
        &areas.slabs
    }

    /// Whether the brick at `b` needs drawing.
    pub fn is_exposed(&self, b: UVec3) -> bool {
        self.exposure.get(b)
    }
}

#[cfg(test)]
mod tests;
