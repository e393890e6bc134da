//! Pyramid with its base at y = -1 and its apex at y = +1: |y| <= 1 and max(|x|, |z|) <= (1 - y) / 2.

use glam::{DVec3, Vec2, Vec3, vec2};

use super::super::body::Body;
use super::super::parts::MinkowskiParts;
use super::super::planes::FaceHalfSpace;
use super::super::simd_real::SimdReal;
use super::super::spec::{RowMethod, SolidSpec};
use super::super::sweep::{Times, widest_base};
use crate::tools::texture;

pub static SPEC: SolidSpec = SolidSpec {
    name: "pyramid",
    label: "Pyramid",
    help: "Pyramid tool",
    synonyms: "roof triangle",
    parts: MinkowskiParts::without_core,
    rows: RowMethod::Planes(&[
        FaceHalfSpace::new(0.0, -1.0, 0.0, 1.0),
        FaceHalfSpace::new(1.0, 0.5, 0.0, 0.5),
        FaceHalfSpace::new(-1.0, 0.5, 0.0, 0.5),
        FaceHalfSpace::new(0.0, 0.5, 1.0, 0.5),
        FaceHalfSpace::new(0.0, 0.5, -1.0, 0.5),
    ]),
    fills_its_box: false,
    is_convex: true,
    image_point,
    body: Body::Faces {
        corners: &[
            Vec3::new(-1.0, -1.0, -1.0),
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(1.0, -1.0, 1.0),
            Vec3::new(1.0, -1.0, -1.0),
            Vec3::Y,
        ],
        faces: &[&[3, 2, 1, 0], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
    },
};

#[inline(always)]
pub fn holds<N: SimdReal>(_: &MinkowskiParts, [x, y, z]: [N; 3]) -> N::Mask {
    let one = x.all(1.0);
    y.abs().at_most(one) & x.abs().max(z.abs()).at_most((one - y) * 0.5)
}

#[inline(always)]
pub fn passes<N: SimdReal>(
    _: &MinkowskiParts,
    [x, y, z]: [N; 3],
    displacement: DVec3,
    margin: f64,
) -> N::Mask {
    let mut times = Times::all(x);
    times.keep_within(y, displacement.y, 1.0 + margin);
    let (height, rise) = (y * 0.5 - (0.5 + margin), -0.5 * displacement.y);
    for (side, along) in [(x, displacement.x), (z, displacement.z)] {
        times.keep_within(side, along, widest_base(margin));
        times.keep(height + side, rise - along);
        times.keep(height - side, rise + along);
    }
    times.are_some()
}

pub fn slack(_: &MinkowskiParts, offset: DVec3) -> f64 {
    offset.y.max(offset.x.max(offset.z) + 0.5 * offset.y)
}

/// Returns the support of a corner of the base, or of the apex.
pub fn support(_: &MinkowskiParts, direction: DVec3) -> f64 {
    let d = direction;
    (d.x.abs() + d.z.abs() - d.y).max(d.y)
}

/// Returns a corner of the base, or the apex.
pub fn furthest(parts: &MinkowskiParts, direction: DVec3) -> DVec3 {
    match direction.y >= support(parts, direction) {
        true => DVec3::Y,
        false => DVec3::ONE.copysign(direction).with_y(-1.0),
    }
}

/// Maps a point to the image, which narrows with the sides from layer to layer.
fn image_point(p: Vec3) -> Vec2 {
    let half_width = (0.5 * (1.0 - p.y)).max(f32::MIN_POSITIVE);
    vec2((texture::on_side(p) / half_width).clamp(-1.0, 1.0), p.y) * 0.5 + 0.5
}
