//! The placement of a sculpture in the world. The grid itself never moves.

use std::fmt::Display;

use glam::{Affine3A, Quat, UVec3, Vec3};

use super::canvas_frame::CanvasFrame;
use crate::refusal::InvalidValue;

/// Rotation about the centre of the home box, scale, then translation of that centre. The home box is that with which
/// the sculpture began: the grid itself, unless it has grown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Placement {
    /// Rotation about that centre.
    pub rotation: Quat,
    /// World position of that centre.
    pub translation: Vec3,
    /// World units per unit of voxel size.
    pub scale: f32,
}

impl Default for Placement {
    fn default() -> Self {
        Placement { rotation: Quat::IDENTITY, translation: Vec3::ZERO, scale: 1.0 }
    }
}

impl Placement {
    /// Checks all parts. The error names the first invalid one.
    pub fn check(&self) -> Result<(), InvalidValue> {
        let Placement { rotation, translation, scale } = *self;
        let check = |is_valid, field, value: &dyn Display| {
            let rule = "is not valid: it must be finite, and the scale above zero";
            InvalidValue::check(is_valid, field, rule, value).map_err(|error| error.of("placement"))
        };
        check(rotation.is_finite() && rotation.is_normalized(), "rotation", &rotation)?;
        check(translation.is_finite(), "translation", &translation)?;
        check(scale.is_finite() && scale > 0.0, "scale", &scale)
    }

    /// Maps grid coordinates (in voxels; voxel (x,y,z) covers [x,x+1) etc.) to the world, for a grid of `dims` voxels
    /// that has not grown: the centre moves to the origin, then the grid is scaled by the voxel size, rotated and
    /// translated.
    pub fn world_from_grid(&self, dims: UVec3, voxel_size: Vec3) -> Affine3A {
        self.world_from_centred(dims.as_vec3() * 0.5, voxel_size)
    }

    /// Maps grid coordinates to the world, for a grid in a frame: the centre of the home box moves to the origin.
    pub fn world_from_framed(&self, frame: &CanvasFrame, voxel_size: Vec3) -> Affine3A {
        self.world_from_centred(frame.centre_vx(), voxel_size)
    }

    fn world_from_centred(&self, centre_vx: Vec3, voxel_size: Vec3) -> Affine3A {
        Affine3A::from_scale_rotation_translation(
            voxel_size * self.scale,
            self.rotation,
            self.translation,
        ) * Affine3A::from_translation(-centre_vx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_centre_is_the_pivot() {
        let placement = Placement {
            rotation: Quat::from_rotation_z(std::f32::consts::FRAC_PI_2),
            translation: Vec3::new(1.0, 2.0, 3.0),
            scale: 2.0,
        };
        let world_from_grid =
            placement.world_from_grid(UVec3::new(4, 6, 8), Vec3::new(1.0, 0.5, 2.0));
        let centre = world_from_grid.transform_point3(Vec3::new(2.0, 3.0, 4.0));
        assert!(centre.abs_diff_eq(placement.translation, 1e-5));
        let corner = world_from_grid.transform_point3(Vec3::ZERO) - centre;
        assert!(corner.abs_diff_eq(Vec3::new(3.0, -4.0, -16.0), 1e-4), "{corner}");
    }
}
