//! Cone with its base at y = -1 and its apex at y = +1: |y| <= 1 and x^2 + z^2 <= ((1 - y) / 2)^2.

use glam::{DVec3, Vec2};

use super::super::body::{Body, ProfilePoint, Stretch};
use super::super::parts::MinkowskiParts;
use super::super::simd_real::SimdReal;
use super::super::spec::{RowMethod, SolidSpec};
use super::super::sweep::{PerpendicularMotion, Times, along_circle, widest_base};
use crate::tools::texture;

const RIM: Vec2 = Vec2::new(1.0, -1.0);

pub static SPEC: SolidSpec = SolidSpec {
    name: "cone",
    label: "Cone",
    help: "Cone tool",
    synonyms: "spike tip hat spire",
    parts: MinkowskiParts::without_core,
    rows: RowMethod::Bricks,
    fills_its_box: false,
    is_convex: true,
    image_point: texture::around_side,
    body: Body::Revolved {
        profile: &[Stretch::Line([Vec2::Y, RIM]), Stretch::Line([RIM, Vec2::NEG_Y])],
        rims: &[ProfilePoint { core: Vec2::ZERO, offset: RIM }],
    },
};

#[inline(always)]
pub fn holds<N: SimdReal>(_: &MinkowskiParts, [x, y, z]: [N; 3]) -> N::Mask {
    let one = x.all(1.0);
    let radius = (one - y) * 0.5;
    y.abs().at_most(one) & (x * x + z * z).at_most(radius * radius)
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
    // The radius at the height of the point: at the start, and its growth with time.
    let (radius, grows) = (y * -0.5 + (0.5 + margin), 0.5 * displacement.y);
    let across = PerpendicularMotion::new(x, z, displacement);
    let deepest = times.clamp(across.deepest_in_cone(grows));
    let radius = (radius + deepest * grows).min(x.all(widest_base(margin)));
    let within = across.squared(deepest).at_most(radius * radius);
    times.are_some() & within & x.all(0.0).at_most(radius)
}

pub fn slack(_: &MinkowskiParts, offset: DVec3) -> f64 {
    offset.y.max(offset.x.hypot(offset.z) + 0.5 * offset.y)
}

/// Returns the support of the rim, or of the apex.
pub fn support(_: &MinkowskiParts, direction: DVec3) -> f64 {
    let d = direction;
    (d.x.hypot(d.z) - d.y).max(d.y)
}

/// Returns a point of the rim, or the apex.
pub fn furthest(parts: &MinkowskiParts, direction: DVec3) -> DVec3 {
    match direction.y >= support(parts, direction) {
        true => DVec3::Y,
        false => along_circle(direction) - DVec3::Y,
    }
}
