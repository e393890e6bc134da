//! A clip: the voxels of a box with their colours, copied from a sculpture to be pasted elsewhere in
//! any [`Orientation`].
//!
//! Reads [`Contents`] and changes nothing; parts without voxels cost next to nothing, whatever their size. Knows no
//! document.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::brick::{BRICK_EDGE_VX, Brick, local_coords};
use super::colour::Rgb;
use super::contents::Contents;
use super::grid::{Grid, GridError, unflatten, uniform_in};
use super::material::Material;
use super::orientation::Orientation;
use super::region::{BrickBox, ListedBricks, VoxelBox};
use crate::refusal::{MemoryBudget, OverBudget};

/// Edge of the cubes of bricks that are looked at as a whole.
const CUBE_BRICKS: u32 = 8;

/// The voxels of a box, as they were copied.
#[derive(Clone, PartialEq, Debug)]
pub struct Clip {
    contents: Contents,
}

impl Clip {
    /// Copies the existing voxels of `from` within `bounds` for which `wanted` is true. The clip has the size of
    /// `bounds` cut to the grid; `None` if that is empty.
    ///
    /// # Errors
    /// If the copy needs more than `budget_bytes`.
    pub fn cut(
        from: &Contents,
        bounds: VoxelBox,
        wanted: impl Fn(IVec3) -> bool + Sync,
        budget_bytes: u64,
    ) -> Result<Option<Clip>, GridError> {
        let bounds = bounds.intersect(VoxelBox::of_grid(&from.grid));
        if bounds.is_empty() {
            return Ok(None);
        }
        let size = bounds.size();
        // Each brick of the source has voxels in at most eight of the clip.
        let mask_bytes = from.mask.as_ref().map_or(0, |mask| mask.heap_bytes());
        let most = (from.grid.heap_bytes() + mask_bytes).saturating_mul(8);
        let needed = Grid::bytes_for(size).min(most);
        let what = format!("a copy of {size} voxels needs");
        OverBudget::check(what, needed, MemoryBudget::Grids, budget_bytes)?;
        let mut grid = Grid::of_size(size, from.grid.voxel_size())?;
        let none = |cube: BrickBox| {
            let VoxelBox { min, max } = cube.voxels();
            let source = VoxelBox { min: min + bounds.min, max: max + bounds.min };
            has_none(&from.grid, source.intersect(bounds)).then_some(false)
        };
        grid.fill_cubes(none, |b| {
            let origin = bounds.min + (b * BRICK_EDGE_VX).as_ivec3();
            gather(|local| {
                let v = origin + local.as_ivec3();
                from.grid.get(v) && bounds.contains(v) && wanted(v)
            })
        });
        let mut material = Material::for_grid(&grid, from.material.depth(), from.material.base());
        for (b, brick) in grid.nonempty_bricks() {
            let origin = bounds.min.as_uvec3() + b * BRICK_EDGE_VX;
            let colour = |local: u32| from.rgb(origin + UVec3::from(local_coords(local)));
            let painted = painted(brick, from.material.base(), colour);
            material.paint_each(b, &painted, colour);
        }
        Ok(Some(Clip { contents: Contents::new(grid, material) }))
    }

    /// Returns a clip of the existing voxels of `contents`, such as one that is read back.
    pub fn from_contents(contents: Contents) -> Clip {
        Clip { contents }
    }

    /// Returns the voxels and colours.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// Returns the size in voxels, before any orientation.
    pub fn size(&self) -> UVec3 {
        self.contents.grid.dims()
    }

    /// Returns the number of existing voxels.
    pub fn voxel_count(&self) -> u64 {
        self.contents.grid.opaque_count()
    }

    /// Returns the box that the clip fills with its lower corner at `at`.
    pub fn bounds(&self, at: IVec3, orientation: Orientation) -> VoxelBox {
        VoxelBox { min: at, max: at + orientation.size(self.size()).as_ivec3() }
    }

    /// Returns the voxels of a grid of `brick_dims` bricks that the clip fills.
    pub fn voxels(&self, at: IVec3, orientation: Orientation, brick_dims: UVec3) -> ListedBricks {
        let bounds = self.bounds(at, orientation);
        let first = bounds.min.max(IVec3::ZERO).as_uvec3() / BRICK_EDGE_VX;
        let end = bounds.max.max(IVec3::ZERO).as_uvec3().map(|v| v.div_ceil(BRICK_EDGE_VX));
        let end = end.min(brick_dims);
        let size = self.size();
        let grid = &self.contents.grid;
        let turned = VoxelBox { min: IVec3::ZERO, max: orientation.size(size).as_ivec3() };
        let is_empty = |bricks: BrickBox| {
            let VoxelBox { min, max } = bricks.voxels();
            let own = VoxelBox { min: min - at, max: max - at }.intersect(turned);
            let source = |v: IVec3| orientation.source(v, size);
            own.is_empty() || {
                let (a, b) = (source(own.min), source(own.max - 1));
                has_none(grid, VoxelBox { min: a.min(b), max: a.max(b) + 1 })
            }
        };
        let in_cube = |low: UVec3| {
            let cube = BrickBox { min: low.max(first), max: (low + CUBE_BRICKS).min(end) };
            let count = if is_empty(cube) { 0 } else { cube.brick_count() as u32 };
            let size = cube.max - cube.min;
            (0..count).filter_map(move |index| {
                let b = cube.min + unflatten(index, size);
                if is_empty(BrickBox { min: b, max: b + 1 }) {
                    return None;
                }
                let origin = (b * BRICK_EDGE_VX).as_ivec3() - at;
                let voxel =
                    |local: UVec3| orientation.source(origin + local.as_ivec3(), self.size());
                let brick = gather(|local| grid.get(voxel(local)));
                (!brick.is_empty()).then_some((b, brick))
            })
        };
        if first.cmpge(end).any() {
            return ListedBricks::default();
        }
        let cubes = BrickBox { min: first / CUBE_BRICKS, max: (end - 1) / CUBE_BRICKS + 1 };
        let count = cubes.brick_count() as u32;
        let low = |index| (cubes.min + unflatten(index, cubes.max - cubes.min)) * CUBE_BRICKS;
        let found = (0..count).into_par_iter().flat_map_iter(|index| in_cube(low(index)));
        let mut bricks: Vec<(UVec3, Brick)> = found.collect();
        bricks.par_sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
        ListedBricks::new(bricks)
    }

    /// Returns the colour of the voxel that the clip puts at `v`, which must be one of its voxels.
    pub fn colour(&self, at: IVec3, orientation: Orientation, v: UVec3) -> Rgb {
        let source = orientation.source(v.as_ivec3() - at, self.size());
        self.contents.rgb(source.max(IVec3::ZERO).as_uvec3().min(self.size() - 1))
    }
}

/// Returns whether no voxel of a box within a grid exists, as far as whole bricks show it.
fn has_none(grid: &Grid, voxels: VoxelBox) -> bool {
    BrickBox::around(&voxels, grid).is_none_or(|bricks| uniform_in(grid, bricks) == Some(false))
}

/// Returns a brick of the local coordinates for which `exists` is true.
fn gather(exists: impl Fn(UVec3) -> bool) -> Brick {
    let mut brick = Brick::EMPTY;
    for (i, word) in brick.words.iter_mut().enumerate() {
        for bit in 0..64 {
            let local = UVec3::from(local_coords(i as u32 * 64 + bit));
            *word |= u64::from(exists(local)) << bit;
        }
    }
    brick
}

/// Returns the voxels of `brick` that do not have the base colour.
fn painted(brick: &Brick, base: Rgb, colour: impl Fn(u32) -> Rgb) -> Brick {
    let mut painted = Brick::EMPTY;
    brick.for_each(|i| {
        painted.words[i as usize / 64] |= u64::from(colour(i) != base) << (i % 64);
    });
    painted
}
