//! Owns the construction solids: ellipsoid, cuboid and pyramid at any pose.
//!
//! Takes a pose in voxel coordinates; gives a [`Region`] that names, brick by brick, the voxels
//! whose centres lie inside. Knows no document.

use glam::{DMat3, DQuat, DVec3, IVec3, Quat, UVec3, Vec3};

use crate::sculpture::Brick;
use crate::sculpture::edit::{Coverage, Region, VoxelBox};

/// The shape of a solid in tool space, where it fills [-1, 1] on every axis.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Solid {
    /// x^2 + y^2 + z^2 <= 1
    Ellipsoid,
    /// |x|, |y|, |z| <= 1
    Cuboid,
    /// Base at y = -1, apex at y = +1: |y| <= 1 and max(|x|, |z|) <= (1 - y) / 2
    Pyramid,
}

impl Solid {
    pub const ALL: [Solid; 3] = [Solid::Ellipsoid, Solid::Cuboid, Solid::Pyramid];

    /// The word for it in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            Solid::Ellipsoid => "ellipsoid",
            Solid::Cuboid => "cuboid",
            Solid::Pyramid => "pyramid",
        }
    }

    /// The inside test in tool space.
    #[inline(always)]
    pub fn contains(self, p: DVec3) -> bool {
        match self {
            Solid::Ellipsoid => p.length_squared() <= 1.0,
            Solid::Cuboid => p.abs().max_element() <= 1.0,
            Solid::Pyramid => p.y.abs() <= 1.0 && p.x.abs().max(p.z.abs()) <= 0.5 * (1.0 - p.y),
        }
    }
}

/// A solid at a pose.
///
/// Lengths are in edges of the sculpture's smallest voxel edge, so that a ball is a ball in the
/// world even where voxels are not cubes; with cubic voxels that is voxels.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Primitive {
    pub solid: Solid,
    /// Centre in voxel coordinates (the centre of voxel 0 is 0.5).
    pub centre_vx: Vec3,
    /// Half the extent along each axis of the tool, before rotation.
    pub half: Vec3,
    /// Rotation of the tool's axes against the grid's.
    pub rotation: Quat,
}

impl Primitive {
    /// Names the first field that cannot be used, if any.
    pub fn check(&self) -> Result<(), &'static str> {
        if !self.centre_vx.is_finite() {
            return Err("the centre");
        }
        if !self.half.is_finite() || self.half.min_element() <= 0.0 {
            return Err("the half extent");
        }
        if !self.rotation.is_finite() || !self.rotation.is_normalized() {
            return Err("the rotation");
        }
        Ok(())
    }

    /// The region this solid covers in a grid whose voxels have edges of `voxel_size`.
    pub fn in_grid(&self, voxel_size: Vec3) -> PlacedSolid {
        PlacedSolid::new(self, voxel_size)
    }
}

/// A solid in the voxel coordinates of one grid.
#[derive(Clone, Copy, Debug)]
pub struct PlacedSolid {
    solid: Solid,
    centre_vx: DVec3,
    /// Linear part of the map from voxel coordinates (less the centre) to tool space.
    tool_from_vx: DMat3,
    bounds: VoxelBox,
}

impl PlacedSolid {
    fn new(primitive: &Primitive, voxel_size: Vec3) -> PlacedSolid {
        let stretch = (voxel_size / voxel_size.min_element()).as_dvec3();
        let rotation = DMat3::from_quat(DQuat::from(primitive.rotation.as_dquat()).normalize());
        let tool_from_vx = DMat3::from_diagonal(primitive.half.as_dvec3().recip())
            * rotation.transpose()
            * DMat3::from_diagonal(stretch);
        let centre_vx = primitive.centre_vx.as_dvec3();
        let vx_from_tool = tool_from_vx.inverse();
        // Extent of the image of the cube [-1, 1]^3 along each voxel axis.
        let reach =
            vx_from_tool.x_axis.abs() + vx_from_tool.y_axis.abs() + vx_from_tool.z_axis.abs();
        let limit = DVec3::splat(1e9);
        let min = (centre_vx - reach - 1.0).clamp(-limit, limit).floor().as_ivec3();
        let max = (centre_vx + reach + 1.0).clamp(-limit, limit).ceil().as_ivec3();
        PlacedSolid {
            solid: primitive.solid,
            centre_vx,
            tool_from_vx,
            bounds: VoxelBox { min, max },
        }
    }

    /// Whether the centre of a voxel lies inside: the definition that every fast path must equal.
    #[inline(always)]
    pub fn contains_voxel(&self, v: IVec3) -> bool {
        self.solid.contains(self.tool_from_vx * (v.as_dvec3() + 0.5 - self.centre_vx))
    }
}

impl Region for PlacedSolid {
    fn bounds_vx(&self) -> VoxelBox {
        self.bounds
    }

    fn coverage(&self, origin_vx: UVec3) -> Coverage {
        let mut mask = Brick::EMPTY;
        for z in 0..8 {
            for y in 0..8 {
                for x in 0..8 {
                    let v = (origin_vx + UVec3::new(x, y, z)).as_ivec3();
                    mask.set(x, y, z, self.contains_voxel(v));
                }
            }
        }
        Coverage::Some(mask)
    }
}
