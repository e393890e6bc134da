//! Capsule: a cylinder about the y axis with hemispherical caps, as far as the height has room for them.

use glam::{DVec3, Vec2};

use super::super::body::{Body, ProfilePoint, Stretch};
use super::super::parts::MinkowskiParts;
pub use super::super::parts::{furthest, passes, slack, support};
use super::super::simd_real::SimdReal;
use super::super::spec::{RowMethod, SolidSpec};
use crate::tools::texture;

pub static SPEC: SolidSpec = SolidSpec {
    name: "capsule",
    label: "Capsule",
    help: "Capsule tool: a rod with round ends",
    synonyms: "pill sausage rod limb finger",
    parts,
    rows: RowMethod::Bricks,
    fills_its_box: false,
    is_convex: true,
    image_point: texture::around_ball,
    body: Body::Revolved {
        profile: &[
            Stretch::Arc { core: Vec2::Y, turns: [0.0, 0.25] },
            Stretch::Arc { core: Vec2::NEG_Y, turns: [0.25, 0.5] },
        ],
        rims: &[
            ProfilePoint { core: Vec2::NEG_Y, offset: Vec2::X },
            ProfilePoint { core: Vec2::Y, offset: Vec2::X },
        ],
    },
};

fn parts(half: DVec3) -> MinkowskiParts {
    let core = 1.0 - (half.x.min(half.z) / half.y).min(1.0);
    MinkowskiParts { core: DVec3::Y * core, round: DVec3::new(1.0, 1.0 - core, 1.0) }
}

#[inline(always)]
pub fn holds<N: SimdReal>(parts: &MinkowskiParts, [x, y, z]: [N; 3]) -> N::Mask {
    let up = (y.abs() - parts.core.y).max(x.all(0.0)) / parts.round.y;
    (x * x + z * z + up * up).at_most(x.all(1.0))
}
