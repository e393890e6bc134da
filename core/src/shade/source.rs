//! A sculpture in the form that shaders take: voxels, colours, and the normals of its surface.

use glam::{UVec3, Vec3};

use super::mask_tint::ShownColours;
use super::normal::gradient;
use super::normal_field::{NormalField, PackedNormal};
use super::occlusion::OpennessTables;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::{Grid, Material, Rgb};

/// The sculpture to shade.
#[derive(Clone, Copy, Debug)]
pub struct ShadeSource<'a> {
    /// The voxels.
    pub grid: &'a Grid,
    /// Their colours.
    pub material: &'a Material,
    /// The normals of `grid`. While they are incomplete, estimates replace missing ones.
    pub normals: &'a NormalField,
    /// The voxels that are shown as protected: a grid of the same size. `None`: the mask is not shown.
    pub mask: Option<&'a Grid>,
}

impl<'a> ShadeSource<'a> {
    /// Returns the colours to light. If `instead` is given, it replaces the colours of all voxels.
    pub fn colours(&self, instead: Option<Rgb>) -> ShownColours<'a> {
        let ShadeSource { grid, material, mask, .. } = *self;
        ShownColours { grid, material, instead, mask }
    }

    /// Returns the packed normal of a voxel.
    #[inline(always)]
    pub(super) fn normal(&self, voxel: UVec3) -> PackedNormal {
        self.normals.packed(voxel / BRICK_EDGE_VX, voxel % BRICK_EDGE_VX)
    }

    /// Returns the share of ambient light that reaches a voxel.
    #[inline(always)]
    pub(super) fn openness(&self, tables: &mut OpennessTables, voxel: UVec3) -> f32 {
        match self.normals.record(voxel / BRICK_EDGE_VX, voxel % BRICK_EDGE_VX) {
            Some(record) => f32::from(record.openness()) * (1.0 / 255.0),
            None => tables.openness(self.grid, voxel),
        }
    }

    /// Returns the vector out of the solid at a voxel with this packed normal: a covector of grid coordinates, of any
    /// length. 0 if no side is outside: such a voxel faces the eye.
    #[inline(always)]
    pub(super) fn outwards(&self, voxel: UVec3, normal: PackedNormal) -> Vec3 {
        normal.unpack().unwrap_or_else(|| self.estimate(voxel))
    }

    /// Returns the vector out of the solid at a voxel that has no normal.
    pub(super) fn estimate(&self, voxel: UVec3) -> Vec3 {
        match self.normals.is_estimated(voxel / BRICK_EDGE_VX) {
            true => gradient(self.grid, voxel),
            false => Vec3::ZERO,
        }
    }
}
