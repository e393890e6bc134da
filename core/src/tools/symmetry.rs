//! Mirror planes: the mirror images of a tool that are used together with it.
//!
//! Planes are perpendicular to the axes of the grid at its centre: between two voxels (even) or through
//! the middle of one (odd). Computes mirrored tools; changes nothing itself.

use glam::{Quat, UVec3, Vec3};

use super::construct::{PlacedSolid, Primitive};
use super::form::Form;
use super::form_region::PlacedForm;
use super::spray::Footprint;
use crate::sculpture::grid::Grid;

/// The position of a mirror plane relative to the voxels.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Parity {
    /// Between two voxels: mirrored shapes have an even number of voxels across.
    Even,
    /// Through the middle of a voxel, which is its own image.
    Odd,
}

impl Parity {
    /// Both parities.
    pub const ALL: [Parity; 2] = [Parity::Even, Parity::Odd];

    /// Its name in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            Parity::Even => "even",
            Parity::Odd => "odd",
        }
    }
}

/// The mirror planes in use, by the axis that they are perpendicular to.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Symmetry {
    /// For each axis the parity of its mirror plane, if it has one.
    pub axes: [Option<Parity>; 3],
}

impl Symmetry {
    /// Positions of the planes in a grid of `dims` voxels, in voxel coordinates.
    pub fn planes(&self, dims: UVec3) -> [Option<f32>; 3] {
        std::array::from_fn(|axis| {
            let middle = (dims[axis] / 2) as f32;
            self.axes[axis].map(|parity| match parity {
                Parity::Even => middle,
                Parity::Odd => middle + 0.5,
            })
        })
    }

    /// All images, starting with the identity: 1, 2, 4 or 8.
    pub fn images(&self, dims: UVec3) -> Vec<Image> {
        let mut images = vec![Image { planes: [None; 3] }];
        for (axis, plane) in self.planes(dims).into_iter().enumerate() {
            if plane.is_some() {
                let more: Vec<Image> = images
                    .iter()
                    .map(|image| {
                        let mut image = *image;
                        image.planes[axis] = plane;
                        image
                    })
                    .collect();
                images.extend(more);
            }
        }
        images
    }
}

/// One mirror image: reflected at the plane of each axis that has one.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Image {
    planes: [Option<f32>; 3],
}

impl Image {
    /// The mirror image of a point in grid coordinates.
    pub fn point(&self, mut p: Vec3) -> Vec3 {
        for (axis, plane) in self.planes.into_iter().enumerate() {
            if let Some(plane) = plane {
                p[axis] = 2.0 * plane - p[axis];
            }
        }
        p
    }

    /// The mirror image of a direction in grid coordinates.
    pub fn vector(&self, mut v: Vec3) -> Vec3 {
        for (axis, plane) in self.planes.into_iter().enumerate() {
            if plane.is_some() {
                v[axis] = -v[axis];
            }
        }
        v
    }

    /// The voxels that the mirrored solid covers.
    pub fn placed(&self, primitive: &Primitive, voxel_size: Vec3) -> PlacedSolid {
        primitive.mirrored_in_grid(voxel_size, self.planes)
    }

    /// The voxels that the mirrored form covers.
    pub fn form(&self, form: &Form, grid: &Grid) -> PlacedForm {
        PlacedForm::new(form, grid, self.planes)
    }

    /// The mirrored solid as a primitive, for drawing. A reflection is no rotation; but every solid is
    /// symmetric about its own x plane, so that a further reflection there makes it one.
    pub fn primitive(&self, primitive: &Primitive) -> Primitive {
        let mirrored = self.planes.iter().filter(|plane| plane.is_some()).count();
        let mut rotation = primitive.rotation;
        for (axis, plane) in self.planes.into_iter().enumerate() {
            if plane.is_some() {
                rotation = conjugated(rotation, axis);
            }
        }
        // S R = (S R S) S, and S X is a rotation by half a turn, or by none.
        let odd = mirrored % 2 == 1;
        let own: [bool; 3] =
            std::array::from_fn(|axis| self.planes[axis].is_some() ^ (odd && axis == 0));
        rotation *= match own {
            [false, true, true] => Quat::from_xyzw(1.0, 0.0, 0.0, 0.0),
            [true, false, true] => Quat::from_xyzw(0.0, 1.0, 0.0, 0.0),
            [true, true, false] => Quat::from_xyzw(0.0, 0.0, 1.0, 0.0),
            _ => Quat::IDENTITY,
        };
        Primitive { centre_vx: self.point(primitive.centre_vx), rotation, ..*primitive }
    }

    /// The mirror image of a footprint.
    pub fn footprint(&self, footprint: &Footprint) -> Footprint {
        Footprint {
            eye_vx: self.point(footprint.eye_vx),
            aim: self.vector(footprint.aim),
            across: self.vector(footprint.across),
            down: self.vector(footprint.down),
            ..*footprint
        }
    }
}

/// S R S for the mirroring S of an axis: the part about that axis stays, the others turn the
/// other way.
fn conjugated(rotation: Quat, axis: usize) -> Quat {
    let mut v = -rotation.xyz();
    v[axis] = -v[axis];
    Quat::from_xyzw(v.x, v.y, v.z, rotation.w)
}

#[cfg(test)]
mod tests {
    use glam::IVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::tools::construct::Solid;
    use crate::tools::construct_tests::rotation;

    proptest! {
        /// Each image covers the mirrored voxels, also where a face passes through their centres;
        /// the mirrored solid as a primitive does so but for those.
        #[test]
        fn images_of_solids_cover_mirrored_voxels(
            dims in prop::array::uniform3(8u32..20),
            axes in prop::array::uniform3(prop::option::of(prop::sample::select(&Parity::ALL[..]))),
            solid in prop::sample::select(&Solid::ALL[..]),
            centre in prop::array::uniform3(prop_oneof![0f32..20.0, (0u8..40).prop_map(|c| f32::from(c) / 2.0)]),
            half in prop::array::uniform3(prop_oneof![1f32..8.0, (1u8..16).prop_map(|h| f32::from(h) / 2.0)]),
            rotation in rotation(),
        ) {
            let dims = UVec3::from(dims);
            let symmetry = Symmetry { axes };
            let primitive = Primitive {
                solid,
                centre_vx: centre.into(),
                half: half.into(),
                rotation,
            };
            let images = symmetry.images(dims);
            prop_assert_eq!(images.len(), 1 << axes.iter().flatten().count());
            let region = primitive.in_grid(Vec3::ONE);
            // Slightly smaller and larger, for centres on a face.
            let scaled = |by: f32| Primitive { half: primitive.half * by, ..primitive };
            let (inner, outer) = (scaled(0.9999).in_grid(Vec3::ONE), scaled(1.0001).in_grid(Vec3::ONE));
            for image in &images {
                let placed = image.placed(&primitive, Vec3::ONE);
                let mirrored = image.primitive(&primitive);
                prop_assert!(mirrored.check().is_ok());
                let mirrored = mirrored.in_grid(Vec3::ONE);
                for i in 0..4000 {
                    let v = IVec3::new(i % 16, i / 16 % 16, i / 256) + 2;
                    let other = (image.point(v.as_vec3() + 0.5) - 0.5).as_ivec3();
                    prop_assert_eq!(region.contains_voxel(v), placed.contains_voxel(other));
                    if inner.contains_voxel(v) == outer.contains_voxel(v) {
                        prop_assert_eq!(region.contains_voxel(v), mirrored.contains_voxel(other));
                    }
                }
            }
        }
    }

    #[test]
    fn planes_stand_between_voxels_or_through_one() {
        let both = Symmetry { axes: [Some(Parity::Even), Some(Parity::Odd), None] };
        assert_eq!(both.planes(UVec3::new(64, 64, 64)), [Some(32.0), Some(32.5), None]);
        assert_eq!(both.planes(UVec3::new(65, 65, 65)), [Some(32.0), Some(32.5), None]);
        let images = both.images(UVec3::splat(64));
        assert_eq!(images[3].point(Vec3::new(1.5, 32.5, 7.0)), Vec3::new(62.5, 32.5, 7.0));
        assert_eq!(images[0].point(Vec3::ONE), Vec3::ONE);
    }
}
