//! A clip: the voxels of a box with their colours, copied from a sculpture to be pasted elsewhere in
//! any [`Orientation`].
//!
//! Reads [`Contents`] and changes nothing. Knows no document.

use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, Brick, local_coords};
use super::colour::Rgb;
use super::contents::Contents;
use super::grid::{Grid, GridError};
use super::material::Material;
use super::orientation::Orientation;
use super::region::{ListedBricks, VoxelBox};

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
        let mut grid = Grid::new(size, from.grid.voxel_size(), budget_bytes)?;
        grid.fill_bricks(|b| {
            let origin = bounds.min + (b * BRICK_EDGE_VX).as_ivec3();
            gather(|local| {
                let v = origin + local.as_ivec3();
                from.grid.get(v) && bounds.contains(v) && wanted(v)
            })
        });
        let mut material = Material::for_grid(&grid, from.material.depth(), from.material.base());
        for index in 0..grid.brick_count() {
            let b = grid.brick_coords(index);
            let origin = bounds.min.as_uvec3() + b * BRICK_EDGE_VX;
            let colour = |local: u32| from.rgb(origin + UVec3::from(local_coords(local)));
            let painted = painted(grid.brick(b), from.material.base(), colour);
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
        let mut bricks = Vec::new();
        for z in first.z..end.z {
            for y in first.y..end.y {
                for x in first.x..end.x {
                    let b = UVec3::new(x, y, z);
                    let origin = (b * BRICK_EDGE_VX).as_ivec3() - at;
                    let brick = gather(|local| {
                        let v = origin + local.as_ivec3();
                        self.contents.grid.get(orientation.source(v, size))
                    });
                    if !brick.is_empty() {
                        bricks.push((b, brick));
                    }
                }
            }
        }
        ListedBricks::new(bricks)
    }

    /// Returns the colour of the voxel that the clip puts at `v`, which must be one of its voxels.
    pub fn colour(&self, at: IVec3, orientation: Orientation, v: UVec3) -> Rgb {
        let source = orientation.source(v.as_ivec3() - at, self.size());
        self.contents.rgb(source.max(IVec3::ZERO).as_uvec3().min(self.size() - 1))
    }
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
