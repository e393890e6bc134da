//! Ellipsoid: x^2 + y^2 + z^2 <= 1.

use glam::{DVec3, Vec2};

use super::super::body::{Body, ProfilePoint, Stretch};
use super::super::parts::MinkowskiParts;
pub use super::super::parts::{passes, slack};
use super::super::simd_real::SimdReal;
use super::super::spec::{RowMethod, SolidSpec};
use crate::tools::texture;

pub static SPEC: SolidSpec = SolidSpec {
    name: "ellipsoid",
    label: "Ellipsoid",
    help: "Ellipsoid tool",
    synonyms: "sphere ball round",
    parts: MinkowskiParts::without_core,
    rows: RowMethod::Quadric,
    fills_its_box: false,
    is_convex: true,
    image_point: texture::around_ball,
    body: Body::Revolved {
        profile: &[Stretch::Arc { core: Vec2::ZERO, turns: [0.0, 0.5] }],
        rims: &[ProfilePoint { core: Vec2::ZERO, offset: Vec2::X }],
    },
};

#[inline(always)]
pub fn holds<N: SimdReal>(_: &MinkowskiParts, [x, y, z]: [N; 3]) -> N::Mask {
    (x * x + y * y + z * z).at_most(x.all(1.0))
}

pub fn support(_: &MinkowskiParts, direction: DVec3) -> f64 {
    direction.length()
}

pub fn furthest(_: &MinkowskiParts, direction: DVec3) -> DVec3 {
    direction.normalize_or_zero()
}
