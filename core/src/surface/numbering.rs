//! The numbers by which an index map names voxels: 32 bits each, for a grid of any size.
//!
//! Where they suffice, a number is the linear index `x + y*dX + z*dX*dY`. The voxels of larger grids are named by brick:
//! `slot * 512 + x + 8*y + 64*z`, with x, y, z in the brick and a slot for each brick that a part of the picture shows.
//! Threads take slots while they sample; which brick has which slot depends on their order, but what a number names
//! does not.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use glam::UVec3;

use crate::sculpture::NO_VOXEL;
use crate::sculpture::brick::BRICK_EDGE_VX;

/// The most voxels that have linear indices.
const MOST_LINEAR: u64 = NO_VOXEL as u64 - 1;
/// The most slots: the last number is [`NO_VOXEL`].
const MOST_SLOTS: u32 = (1 << (32 - SLOT_SHIFT)) - 1;
const SLOT_SHIFT: u32 = 9;
/// Bits of a brick coordinate in the list.
const COORDINATE_BITS: u32 = 21;

/// How an index map names voxels.
#[derive(Clone, Debug)]
pub struct VoxelNumbering {
    dims: UVec3,
    /// The bricks by slot; `None`: numbers are linear.
    list: Option<BrickList>,
}

/// The numbers of the voxels of a brick: of voxel (x, y, z) in it, `first + x + y * row + z * slice`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BrickNumbers {
    pub first: u32,
    pub row: u32,
    pub slice: u32,
}

/// Bricks by slot.
#[derive(Debug, Default)]
struct BrickList {
    /// Coordinates, [`COORDINATE_BITS`] each, x the lowest. Those from `used` on have no meaning.
    bricks: Vec<AtomicU64>,
    /// The number of slots taken; may be greater than the number of `bricks`.
    used: AtomicU32,
}

impl Default for VoxelNumbering {
    /// Names the voxel of a grid of one.
    fn default() -> VoxelNumbering {
        VoxelNumbering { dims: UVec3::ONE, list: None }
    }
}

impl VoxelNumbering {
    /// Returns the numbering of a map of `pixels` pixels of a grid of `dims` voxels.
    #[cfg(test)]
    pub(crate) fn new(dims: UVec3, pixels: usize) -> VoxelNumbering {
        let mut numbering = VoxelNumbering::default();
        numbering.begin(dims, pixels);
        numbering
    }

    /// Begins to name the voxels of a grid of `dims` voxels in a map of `pixels` pixels. Earlier numbers become
    /// invalid.
    pub(super) fn begin(&mut self, dims: UVec3, pixels: usize) {
        self.dims = dims;
        match is_linear(dims) {
            true => self.list = None,
            false => self.list.get_or_insert_default().begin(pixels),
        }
    }

    /// Returns whether the numbers are those of a grid of this size.
    pub(super) fn fits(&self, dims: UVec3) -> bool {
        self.dims == dims
    }

    /// Returns the coordinates of the voxel of a number.
    #[inline]
    pub fn coords(&self, number: u32) -> UVec3 {
        match &self.list {
            None => {
                let UVec3 { x: row, y: rows, .. } = self.dims;
                let rest = number / row;
                UVec3::new(number % row, rest % rows, rest / rows)
            }
            Some(list) => {
                let local = UVec3::new(number, number >> 3, number >> 6) % BRICK_EDGE_VX;
                list.brick(number >> SLOT_SHIFT) * BRICK_EDGE_VX + local
            }
        }
    }

    /// Returns whether the numbers are linear indices.
    pub fn is_linear(&self) -> bool {
        self.list.is_none()
    }

    /// Returns the size of the grid whose voxels have linear indices; `None` if they are named by brick.
    #[inline]
    pub(crate) fn linear_dims(&self) -> Option<UVec3> {
        self.list.is_none().then_some(self.dims)
    }

    /// Returns the numbers of the voxels of the brick at brick coordinates `b`. Takes a slot if they need one; `None` if
    /// none is left.
    #[inline(always)]
    pub(super) fn of_brick(&self, b: UVec3) -> Option<BrickNumbers> {
        match &self.list {
            None => {
                let (row, slice) = (self.dims.x, self.dims.x * self.dims.y);
                let UVec3 { x, y, z } = b * BRICK_EDGE_VX;
                Some(BrickNumbers { first: x + y * row + z * slice, row, slice })
            }
            Some(list) => {
                Some(BrickNumbers { first: list.add(b)? << SLOT_SHIFT, row: 8, slice: 64 })
            }
        }
    }

    /// Takes slots anew for the bricks that `numbers` name, and changes the numbers accordingly. Does nothing where
    /// `more` of them can be taken.
    pub(super) fn make_room(&mut self, more: usize, numbers: &mut [u32]) {
        let Some(list) = &mut self.list else { return };
        let used = *list.used.get_mut() as usize;
        if used + more <= list.bricks.len() {
            return;
        }
        let mut slots = vec![NO_VOXEL; used.min(list.bricks.len())];
        let (mut next, mut bricks) = (0, Vec::new());
        for number in numbers.iter_mut().filter(|number| **number != NO_VOXEL) {
            let slot = &mut slots[(*number >> SLOT_SHIFT) as usize];
            if *slot == NO_VOXEL {
                bricks.push(pack(list.brick(*number >> SLOT_SHIFT)));
                *slot = next;
                next += 1;
            }
            *number = *slot << SLOT_SHIFT | *number & ((1 << SLOT_SHIFT) - 1);
        }
        for (slot, brick) in list.bricks.iter_mut().zip(bricks) {
            *slot.get_mut() = brick;
        }
        *list.used.get_mut() = next;
    }
}

impl BrickList {
    fn begin(&mut self, pixels: usize) {
        // Twice the pixels: a list need not be compacted before half of them were sampled again.
        let slots = (2 * pixels).min(MOST_SLOTS as usize);
        self.bricks.resize_with(slots, AtomicU64::default);
        *self.used.get_mut() = 0;
        // Number 0 always names a voxel of the grid.
        self.bricks.iter_mut().take(1).for_each(|brick| *brick.get_mut() = 0);
    }

    #[inline]
    fn brick(&self, slot: u32) -> UVec3 {
        let packed = self.bricks[slot as usize].load(Ordering::Relaxed);
        let coordinate =
            |axis: u32| (packed >> (COORDINATE_BITS * axis)) as u32 & ((1 << COORDINATE_BITS) - 1);
        UVec3::new(coordinate(0), coordinate(1), coordinate(2))
    }

    /// Returns a slot for a brick.
    fn add(&self, b: UVec3) -> Option<u32> {
        // Readers come after the join of the sampling threads: no order is needed between slots.
        let slot = self.used.fetch_add(1, Ordering::Relaxed);
        self.bricks.get(slot as usize)?.store(pack(b), Ordering::Relaxed);
        Some(slot)
    }
}

impl Clone for BrickList {
    fn clone(&self) -> BrickList {
        let used = self.used.load(Ordering::Relaxed);
        let copy = |(i, brick): (usize, &AtomicU64)| match i < used as usize {
            true => AtomicU64::new(brick.load(Ordering::Relaxed)),
            false => AtomicU64::default(),
        };
        BrickList { bricks: self.bricks.iter().enumerate().map(copy).collect(), used: used.into() }
    }
}

/// Names voxels one by one. Voxels of the same brick in succession share a slot.
pub(crate) struct VoxelNamer<'a> {
    numbering: &'a VoxelNumbering,
    last: UVec3,
    numbers: Option<BrickNumbers>,
}

impl<'a> VoxelNamer<'a> {
    pub fn new(numbering: &'a VoxelNumbering) -> VoxelNamer<'a> {
        VoxelNamer { numbering, last: UVec3::MAX, numbers: None }
    }

    /// Returns the number of a voxel; [`NO_VOXEL`] if no slot is left.
    #[inline(always)]
    pub fn number(&mut self, voxel: UVec3) -> u32 {
        let (b, local) = (voxel / BRICK_EDGE_VX, voxel % BRICK_EDGE_VX);
        if b != self.last {
            (self.last, self.numbers) = (b, self.numbering.of_brick(b));
        }
        let place =
            |BrickNumbers { first, row, slice }| first + local.x + local.y * row + local.z * slice;
        self.numbers.map_or(NO_VOXEL, place)
    }
}

/// Returns whether the voxels of a grid of `dims` voxels have linear indices, which the device needs.
pub fn is_linear(dims: UVec3) -> bool {
    let [x, y, z] = dims.to_array().map(u64::from);
    x * y * z <= MOST_LINEAR
}

fn pack(b: UVec3) -> u64 {
    let [x, y, z] = b.to_array().map(u64::from);
    x | y << COORDINATE_BITS | z << (2 * COORDINATE_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use crate::sculpture::{Grid, Placement};
    use crate::surface::{IndexMap, PixelRect, quickstep, raycast};
    use crate::view::{Camera, PixelRays};
    use glam::{IVec3, UVec2, Vec3};
    use proptest::prelude::*;

    fn rays(grid: &Grid, at: Vec3, size: UVec2) -> PixelRays {
        let world_from_grid = Placement::default().world_from_grid(grid.dims(), Vec3::ONE);
        let radius = grid.dims().as_vec3().length() * 0.4;
        Camera::framing(radius, at, Vec3::Y).eye(size).pixel_rays(&world_from_grid)
    }

    /// Returns a map that names voxels by brick, whatever the size of the grid.
    fn listed(grid: &Grid, rays: PixelRays) -> IndexMap {
        let mut map = IndexMap::new(rays);
        let mut list = BrickList::default();
        list.begin(map.voxels.len());
        map.numbering = VoxelNumbering { dims: grid.dims(), list: Some(list) };
        map
    }

    /// Samples a rectangle of a map.
    type Sampling = fn(&Grid, &mut IndexMap, PixelRect);

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(30))]
        /// Parts of a picture are sampled again and again, between edits, until slots were taken anew several times.
        #[test]
        fn maps_by_brick_show_what_linear_ones_show(
            size in prop::array::uniform2(1u32..150),
            edits in prop::collection::vec((prop::array::uniform3(0i32..64), prop::array::uniform4(0u32..150)), 1..25),
            at in prop::array::uniform3(-1f32..1.0),
        ) {
            let mut grid = scenes::cheese(64, 20, 3).unwrap();
            let at = Vec3::from(at) + Vec3::new(0.1, 0.2, 0.3);
            for rect in [raycast::sample_rect as Sampling, quickstep::sample_rect] {
                let rays = rays(&grid, at, UVec2::from(size));
                let (mut by_brick, mut linear) = (listed(&grid, rays), IndexMap::new(rays));
                let whole = PixelRect::of_picture(rays.size);
                rect(&grid, &mut by_brick, whole);
                rect(&grid, &mut linear, whole);
                prop_assert!(by_brick == linear && !by_brick.numbering.is_linear());
                for (voxel, [a, b, c, d]) in &edits {
                    grid.set(IVec3::from(*voxel), !grid.get(IVec3::from(*voxel)));
                    let part = PixelRect { min: UVec2::new(*a, *b), max: UVec2::new(*c, *d) };
                    for part in [part, whole] {
                        rect(&grid, &mut by_brick, part);
                        rect(&grid, &mut linear, part);
                    }
                    prop_assert!(by_brick == linear && !by_brick.numbering.is_linear());
                    prop_assert!(by_brick.clone() == linear);
                }
            }
        }
    }

    /// Voxels in all corners of the largest grid are named, and seen where the naive walk of a ray meets them.
    #[test]
    fn corners_of_the_largest_grid_are_seen() {
        let dims = UVec3::splat(4096);
        let mut grid = Grid::new(dims, Vec3::ONE, u64::MAX).unwrap();
        for corner in 0..8u32 {
            let high = UVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let low = (high * 4032).as_ivec3();
            for i in 0..64i32.pow(3) {
                grid.set(low + IVec3::new(i & 63, i >> 6 & 63, i >> 12), true);
            }
        }
        let rays = rays(&grid, Vec3::new(0.8, 0.6, 1.0), UVec2::new(320, 240));
        let mut map = IndexMap::new(rays);
        raycast::sample(&grid, &rays, &mut map);
        let mut corners = std::collections::BTreeSet::new();
        for y in 0..rays.size.y {
            for x in 0..rays.size.x {
                let hit = raycast::cast_pixel(&grid, &rays, x, y);
                assert_eq!(map.voxel(x, y), hit.map(|hit| hit.voxel), "pixel {x}, {y}");
                corners.extend(map.voxel(x, y).map(|v| (v / 2048).to_array()));
            }
        }
        assert!(corners.len() >= 7, "{corners:?}");
    }

    #[test]
    fn the_largest_linear_grid_leaves_a_number_for_none() {
        assert!(is_linear(UVec3::splat(1625)) && is_linear(UVec3::new(4096, 1024, 1023)));
        assert!(!is_linear(UVec3::splat(1626)) && !is_linear(UVec3::new(4096, 1024, 1024)));
    }
}
