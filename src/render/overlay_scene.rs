//! The overlay of a picture as values: the visible tools and lines, and their view.
//!
//! Knows no device and no pass.

use glam::{Affine3A, Mat3, Mat4, Quat, Vec3};

use crate::sculpture::Rgb;
use crate::tools::solid::Primitive;

/// For half heights of pictures at distance 1 below this, factors on depths shrink in proportion: a narrow view is one
/// from afar, where the same share of the depth is a longer distance.
const NARROW: f32 = 0.2;
/// Largest distance between the surface of voxels and the solid that made them, in voxels along the normal. A voxel
/// exists if its centre is inside, so none of its corners is farther outside than half its diagonal, 0.87.
const STEPS_VX: f32 = 1.0;
/// Faces of boxes within this distance of planes between voxels coincide with the surface of voxels.
const ON_PLANE_VX: f32 = 1e-3;

/// A line in grid coordinates.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OverlayLine {
    pub from: Vec3,
    pub to: Vec3,
    pub colour: Rgb,
    pub width_px: f32,
    /// Opacity in front of the sculpture and behind it.
    pub opacity: [f32; 2],
}

/// The displayed tool.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ToolPreview {
    pub primitive: Primitive,
    /// Edge lengths of the grid's voxels.
    pub voxel_size: Vec3,
    pub colour: Rgb,
    /// Opacity in front of the sculpture and behind it.
    pub opacity: [f32; 2],
}

impl ToolPreview {
    /// Returns the largest distance between it and the surface of the voxels that it makes.
    pub(super) fn steps_vx(&self) -> f32 {
        let Primitive { solid, centre_vx, half, rotation } = self.primitive;
        let half_vx = half * self.voxel_size.min_element() / self.voxel_size;
        let on_planes = |at: Vec3| (at - at.round()).abs().max_element() < ON_PLANE_VX;
        let has_steps = !solid.spec().fills_its_box
            || !rotation.abs_diff_eq(Quat::IDENTITY, 1e-6)
            || ![centre_vx - half_vx, centre_vx + half_vx].into_iter().all(on_planes);
        if has_steps { STEPS_VX } else { 0.0 }
    }
}

/// The overlay of one picture.
#[derive(Clone, Copy, Debug)]
pub struct OverlayDrawing<'a> {
    pub eye_from_grid: Affine3A,
    pub projection: Mat4,
    /// Pixels.
    pub size: [u32; 2],
    /// The tools.
    pub previews: &'a [ToolPreview],
    pub lines: &'a [OverlayLine],
}

impl OverlayDrawing<'_> {
    /// Returns the factor on depths, which is `usual` for common view angles.
    pub(super) fn nearer(&self, usual: f32) -> f32 {
        let half_height = self.projection.y_axis.y.abs().recip();
        1.0 + (usual - 1.0) * (half_height / NARROW).min(1.0)
    }
}

/// Maps tool space, where a solid fills [-1, 1], to voxel coordinates: the inverse of what the
/// tool itself computes.
pub(super) fn grid_from_tool(primitive: &Primitive, voxel_size: Vec3) -> Affine3A {
    let shrink = voxel_size.min_element() / voxel_size;
    let linear = Mat3::from_diagonal(shrink)
        * Mat3::from_quat(primitive.rotation)
        * Mat3::from_diagonal(primitive.half);
    Affine3A::from_mat3_translation(linear, primitive.centre_vx)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::solid::Solid;

    #[test]
    fn the_ghost_stands_where_the_tool_works() {
        let primitive = Primitive {
            solid: Solid::Cuboid,
            centre_vx: Vec3::new(20.0, 30.0, 10.0),
            half: Vec3::new(3.0, 5.0, 8.0),
            rotation: Quat::from_euler(glam::EulerRot::XYZ, 0.4, 1.0, -0.3),
        };
        let voxel_size = Vec3::new(1.0, 2.0, 0.5);
        let placed = primitive.in_grid(voxel_size);
        let grid_from_tool = grid_from_tool(&primitive, voxel_size);
        // Points at a random place of tool space: the voxel around one is inside the tool if the point is inside the
        // solid, except for points too near to the surface to tell.
        let mut told = 0;
        for i in 0..1000u32 {
            let unit =
                |salt: u32| (i.wrapping_mul(salt) >> 8 & 0xffff) as f32 / 65535.0 * 3.0 - 1.5;
            let p = Vec3::new(unit(2654435761), unit(2246822519), unit(3266489917));
            let voxel = grid_from_tool.transform_point3(p).floor().as_ivec3();
            let depth = p.abs().max_element();
            if (depth - 1.0).abs() > 0.4 {
                told += 1;
                assert_eq!(placed.contains_voxel(voxel), depth < 1.0, "{p}");
            }
        }
        assert!(told > 100, "{told}");
        let middle = grid_from_tool.transform_point3(Vec3::ZERO);
        assert!(middle.abs_diff_eq(primitive.centre_vx, 1e-5));
    }
}
