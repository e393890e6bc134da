//! The index map of an eye: the voxel visible through each pixel. Written by samplers on CPU and GPU, read by shaders.
//! Also the pixel rectangle.

use std::ops::Range;

use glam::{UVec2, UVec3};

use super::numbering::VoxelNumbering;
use crate::sculpture::NO_VOXEL;
use crate::view::PixelRays;

/// The number of a voxel per pixel, row by row from the top, [`NO_VOXEL`] where the ray meets nothing; with the rays that
/// it was made with.
#[derive(Clone, Debug)]
pub struct IndexMap {
    /// The view of the map.
    pub rays: PixelRays,
    /// `rays.size.x * rays.size.y` values, or none ([`IndexMap::forget`]).
    pub voxels: Vec<u32>,
    /// The voxels that the numbers name.
    pub numbering: VoxelNumbering,
    /// The normal of each pixel, packed as [`crate::shade::normal_field::PackedNormal`], from a sampler that knows the
    /// surface between voxels. Otherwise empty: the voxels' own normals apply.
    pub normals: Vec<u16>,
}

impl IndexMap {
    /// Returns a map without visible voxels.
    pub fn new(rays: PixelRays) -> IndexMap {
        let pixels = rays.size.x as usize * rays.size.y as usize;
        let numbering = VoxelNumbering::default();
        IndexMap { rays, voxels: vec![NO_VOXEL; pixels], numbering, normals: Vec::new() }
    }

    /// Changes the view of the map, keeping its memory, for a grid of `dims` voxels. The values are left as they are, but
    /// name no voxels any more, unless the grid is one of linear indices and as large as before.
    pub fn reset(&mut self, dims: UVec3, rays: PixelRays) {
        self.rays = rays;
        self.voxels.resize(rays.size.x as usize * rays.size.y as usize, NO_VOXEL);
        self.normals.clear();
        self.numbering.begin(dims, self.voxels.len());
    }

    /// Performs [`IndexMap::reset`] for a map that has normals.
    pub fn reset_with_normals(&mut self, dims: UVec3, rays: PixelRays) {
        let normals = std::mem::take(&mut self.normals);
        self.reset(dims, rays);
        self.normals = normals;
        self.normals.resize(self.voxels.len(), u16::MAX);
    }

    /// Changes the view of the map, keeping only the rays in memory: the voxels are only on the device.
    pub fn forget(&mut self, rays: PixelRays) {
        self.rays = rays;
        self.voxels.clear();
        self.normals.clear();
    }

    /// Prepares to sample the pixels of `rect` again, in a grid of `dims` voxels. A map of another size must name no
    /// voxels.
    pub fn renew(&mut self, dims: UVec3, rect: PixelRect) {
        if !self.numbering.fits(dims) {
            return self.numbering.begin(dims, self.voxels.len());
        }
        let rect = rect.intersect(PixelRect::of_picture(self.rays.size));
        self.numbering.make_room(rect.pixel_count() as usize, &mut self.voxels);
    }

    /// Returns whether the voxels are in memory.
    pub fn is_known(&self) -> bool {
        !self.voxels.is_empty()
    }

    /// Returns the voxel visible through pixel (x, y), if there is one and it is in memory.
    pub fn get(&self, x: u32, y: u32) -> Option<u32> {
        let voxel = *self.voxels.get((x + y * self.rays.size.x) as usize)?;
        (voxel != NO_VOXEL).then_some(voxel)
    }

    /// Returns the coordinates of the voxel visible through pixel (x, y).
    pub fn voxel(&self, x: u32, y: u32) -> Option<UVec3> {
        self.get(x, y).map(|number| self.numbering.coords(number))
    }

    /// Returns the number of pixels through which a voxel is visible.
    pub fn covered(&self) -> usize {
        self.voxels.iter().filter(|&&v| v != NO_VOXEL).count()
    }
}

impl PartialEq for IndexMap {
    /// Compares what the maps show: numbers may differ.
    fn eq(&self, other: &IndexMap) -> bool {
        let same = |(&a, &b): (&u32, &u32)| match (a, b) {
            (NO_VOXEL, _) | (_, NO_VOXEL) => a == b,
            _ => self.numbering.coords(a) == other.numbering.coords(b),
        };
        self.rays == other.rays
            && self.normals == other.normals
            && self.voxels.len() == other.voxels.len()
            && self.voxels.iter().zip(&other.voxels).all(same)
    }
}

/// A rectangle of pixels, `min` inclusive and `max` exclusive; empty if `min` is not below `max`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PixelRect {
    /// Upper left pixel.
    pub min: UVec2,
    /// One past the lower right pixel.
    pub max: UVec2,
}

impl PixelRect {
    /// Returns the whole of a picture of `size` pixels.
    pub fn of_picture(size: UVec2) -> PixelRect {
        PixelRect { min: UVec2::ZERO, max: size }
    }

    /// A rectangle of no pixels.
    pub const EMPTY: PixelRect = PixelRect { min: UVec2::ZERO, max: UVec2::ZERO };

    /// Returns whether the rectangle holds no pixel.
    pub fn is_empty(self) -> bool {
        !self.min.cmplt(self.max).all()
    }

    /// Returns the number of pixels in the rectangle.
    pub fn pixel_count(self) -> u64 {
        self.max.saturating_sub(self.min).as_u64vec2().element_product()
    }

    /// Returns the rows that it touches.
    pub fn rows(self) -> Range<u32> {
        if self.is_empty() { 0..0 } else { self.min.y..self.max.y }
    }

    /// Returns the rows of a picture, `width` pixels wide, that it touches, in full width.
    pub fn rows_of<T>(self, pixels: &[T], width: u32) -> &[T] {
        let Range { start, end } = self.rows();
        &pixels[(start * width) as usize..(end * width) as usize]
    }

    /// Performs [`PixelRect::rows_of`] on mutable pixels.
    pub fn rows_of_mut<T>(self, pixels: &mut [T], width: u32) -> &mut [T] {
        let Range { start, end } = self.rows();
        &mut pixels[(start * width) as usize..(end * width) as usize]
    }

    /// Returns the upper left corner and the size.
    pub fn corner_and_size(self) -> ([u32; 2], [u32; 2]) {
        (self.min.to_array(), self.max.saturating_sub(self.min).to_array())
    }

    /// Returns the pixels in both.
    pub fn intersect(self, other: PixelRect) -> PixelRect {
        PixelRect { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Returns the smallest rectangle that holds both, neither of which may be empty.
    pub fn union(self, other: PixelRect) -> PixelRect {
        PixelRect { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Returns the rectangle extended by `px` on every side, but not beyond pixel 0. An empty one stays empty.
    pub fn grown(self, px: u32) -> PixelRect {
        if self.is_empty() {
            return self;
        }
        PixelRect { min: self.min.saturating_sub(UVec2::splat(px)), max: self.max + px }
    }
}
