//! Cuboid: |x|, |y|, |z| <= 1.

use glam::{DVec3, Vec3};

use super::super::body::Body;
use super::super::parts::MinkowskiParts;
use super::super::planes::FaceHalfSpace;
use super::super::simd_real::SimdReal;
use super::super::spec::{RowMethod, SolidSpec};
use super::super::sweep::Times;
use crate::tools::texture;

pub static SPEC: SolidSpec = SolidSpec {
    name: "cuboid",
    label: "Cuboid",
    help: "Cuboid tool",
    synonyms: "cube box block brick square",
    parts: MinkowskiParts::without_core,
    rows: RowMethod::Planes(&[
        FaceHalfSpace::new(1.0, 0.0, 0.0, 1.0),
        FaceHalfSpace::new(-1.0, 0.0, 0.0, 1.0),
        FaceHalfSpace::new(0.0, 1.0, 0.0, 1.0),
        FaceHalfSpace::new(0.0, -1.0, 0.0, 1.0),
        FaceHalfSpace::new(0.0, 0.0, 1.0, 1.0),
        FaceHalfSpace::new(0.0, 0.0, -1.0, 1.0),
    ]),
    fills_its_box: true,
    is_convex: true,
    image_point: texture::on_faces,
    body: Body::Faces {
        corners: &[
            Vec3::new(-1.0, -1.0, -1.0),
            Vec3::new(1.0, -1.0, -1.0),
            Vec3::new(-1.0, 1.0, -1.0),
            Vec3::new(1.0, 1.0, -1.0),
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::new(-1.0, 1.0, 1.0),
            Vec3::new(1.0, 1.0, 1.0),
        ],
        faces: &[
            &[2, 0, 4, 6],
            &[1, 3, 7, 5],
            &[4, 0, 1, 5],
            &[2, 6, 7, 3],
            &[1, 0, 2, 3],
            &[4, 5, 7, 6],
        ],
    },
};

#[inline(always)]
pub fn holds<N: SimdReal>(_: &MinkowskiParts, [x, y, z]: [N; 3]) -> N::Mask {
    x.abs().max(y.abs()).max(z.abs()).at_most(x.all(1.0))
}

#[inline(always)]
pub fn passes<N: SimdReal>(
    _: &MinkowskiParts,
    [x, y, z]: [N; 3],
    displacement: DVec3,
    margin: f64,
) -> N::Mask {
    let mut times = Times::all(x);
    for (at, along) in [(x, displacement.x), (y, displacement.y), (z, displacement.z)] {
        times.keep_within(at, along, 1.0 + margin);
    }
    times.are_some()
}

pub fn slack(_: &MinkowskiParts, offset: DVec3) -> f64 {
    offset.max_element()
}

pub fn support(_: &MinkowskiParts, direction: DVec3) -> f64 {
    direction.abs().element_sum()
}

/// Returns a corner.
pub fn furthest(_: &MinkowskiParts, direction: DVec3) -> DVec3 {
    DVec3::ONE.copysign(direction)
}
