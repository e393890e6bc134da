//! Tests images of solids by axis-aligned planes against the mirrored voxels.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;

use super::solid::{Primitive, Solid};
use super::symmetry::*;
use crate::tools::solid::tests::rotation;

proptest! {
    /// Each image covers the mirrored voxels, also where a face passes through their centres. The mirrored solid as a
    /// primitive does so except for those.
    #[test]
    fn images_of_solids_cover_mirrored_voxels(
        dims in prop::array::uniform3(8u32..20),
        axes in prop::array::uniform3(prop::option::of(prop::sample::select(&Parity::ALL[..]))),
        solid in prop::sample::select(&Solid::ALL[..]),
        centre in prop::array::uniform3(prop_oneof![0f32..20.0, (0u8..40).prop_map(|c| f32::from(c) / 2.0)]),
        half in prop::array::uniform3(prop_oneof![1f32..8.0, (1u8..16).prop_map(|h| f32::from(h) / 2.0)]),
        rotation in rotation(),
        to in prop::option::of(prop::array::uniform3(prop_oneof![0f32..20.0, (0u8..40).prop_map(|c| f32::from(c) / 2.0)])),
    ) {
        let dims = UVec3::from(dims);
        let to = to.map(Vec3::from);
        let symmetry = Symmetry::of_axes(axes);
        let primitive = Primitive {
            solid,
            centre_vx: centre.into(),
            half: half.into(),
            rotation,
        };
        let images = symmetry.images(dims, Vec3::ONE);
        prop_assert_eq!(images.len(), 1 << axes.iter().flatten().count());
        let region = primitive.swept_in_grid(to, Vec3::ONE);
        // Slightly smaller and larger, for centres on a face.
        let scaled = |by: f32| Primitive { half: primitive.half * by, ..primitive };
        let (inner, outer) =
            (scaled(0.9999).swept_in_grid(to, Vec3::ONE), scaled(1.0001).swept_in_grid(to, Vec3::ONE));
        for image in &images {
            let placed = primitive.image_in_grid(to, Vec3::ONE, image);
            let mirrored = primitive.image(image);
            prop_assert!(mirrored.check().is_ok());
            let mirrored = mirrored.swept_in_grid(to.map(|to| image.point(to)), Vec3::ONE);
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
    let both = Symmetry::of_axes([Some(Parity::Even), Some(Parity::Odd), None]);
    assert_eq!(both.planes(UVec3::new(64, 64, 64)), [Some(32.0), Some(32.5), None]);
    assert_eq!(both.planes(UVec3::new(65, 65, 65)), [Some(32.0), Some(32.5), None]);
    let images = both.images(UVec3::splat(64), Vec3::ONE);
    assert_eq!(images[3].point(Vec3::new(1.5, 32.5, 7.0)), Vec3::new(62.5, 32.5, 7.0));
    assert_eq!(images[0].point(Vec3::ONE), Vec3::ONE);
}
