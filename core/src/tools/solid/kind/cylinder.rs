//! Cylinder about the y axis: |y| <= 1 and x^2 + z^2 <= 1.

use glam::{DVec3, Vec2};

use super::super::body::{Body, ProfilePoint, Stretch};
use super::super::parts::MinkowskiParts;
use super::super::simd_real::SimdReal;
use super::super::spec::{RowMethod, SolidSpec};
use super::super::sweep::{PerpendicularMotion, Times, along_circle};
use crate::tools::texture;

const TOP: Vec2 = Vec2::new(1.0, 1.0);
const BOTTOM: Vec2 = Vec2::new(1.0, -1.0);

pub static SPEC: SolidSpec = SolidSpec {
    name: "cylinder",
    label: "Cylinder",
    help: "Cylinder tool",
    synonyms: "tube rod column pillar disc can wheel",
    parts: MinkowskiParts::without_core,
    rows: RowMethod::Bricks,
    fills_its_box: false,
    is_convex: true,
    image_point: texture::around_side,
    body: Body::Revolved {
        profile: &[
            Stretch::Line([Vec2::Y, TOP]),
            Stretch::Line([TOP, BOTTOM]),
            Stretch::Line([BOTTOM, Vec2::NEG_Y]),
        ],
        rims: &[
            ProfilePoint { core: Vec2::ZERO, offset: BOTTOM },
            ProfilePoint { core: Vec2::ZERO, offset: TOP },
        ],
    },
};

#[inline(always)]
pub fn holds<N: SimdReal>(_: &MinkowskiParts, [x, y, z]: [N; 3]) -> N::Mask {
    let one = x.all(1.0);
    y.abs().at_most(one) & (x * x + z * z).at_most(one)
}

#[inline(always)]
pub fn passes<N: SimdReal>(
    _: &MinkowskiParts,
    [x, y, z]: [N; 3],
    displacement: DVec3,
    margin: f64,
) -> N::Mask {
    let most = 1.0 + margin;
    let mut times = Times::all(x);
    times.keep_within(y, displacement.y, most);
    let across = PerpendicularMotion::new(x, z, displacement);
    let squared = across.squared(times.clamp(across.foot));
    times.are_some()
        & squared.at_most(x.all(most.max(0.0) * most))
        & x.all(0.0).at_most(x.all(most))
}

pub fn slack(_: &MinkowskiParts, offset: DVec3) -> f64 {
    offset.y.max(offset.x.hypot(offset.z))
}

pub fn support(_: &MinkowskiParts, direction: DVec3) -> f64 {
    direction.y.abs() + direction.x.hypot(direction.z)
}

/// Returns a point of a rim.
pub fn furthest(_: &MinkowskiParts, direction: DVec3) -> DVec3 {
    along_circle(direction) + DVec3::Y.copysign(direction)
}
