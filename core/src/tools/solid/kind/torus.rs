//! Torus about the y axis: the Minkowski sum of a circle and an ellipsoid. Its tube is round and as thick as the solid
//! is high, but at most a third of the outer radius.

use glam::{DVec3, Vec2};

use super::super::body::{Body, ProfilePoint, Stretch};
use super::super::parts::MinkowskiParts;
use super::super::simd_real::SimdReal;
use super::super::spec::{RowMethod, SolidSpec};
use super::super::sweep::{Times, along_circle, behind};
use crate::tools::texture;

pub static SPEC: SolidSpec = SolidSpec {
    name: "torus",
    label: "Torus",
    help: "Torus tool: a ring as thick as it is high",
    synonyms: "ring donut doughnut handle tyre",
    parts,
    rows: RowMethod::Bricks,
    fills_its_box: false,
    is_convex: false,
    image_point: texture::around_ball,
    body: Body::Revolved {
        profile: &[Stretch::Arc { core: Vec2::X, turns: [0.0, 1.0] }],
        rims: &[
            ProfilePoint { core: Vec2::X, offset: Vec2::X },
            ProfilePoint { core: Vec2::X, offset: Vec2::NEG_X },
            ProfilePoint { core: Vec2::X, offset: Vec2::Y },
            ProfilePoint { core: Vec2::X, offset: Vec2::NEG_Y },
        ],
    },
};

/// Largest radius of the tube, as a fraction of the outer radius.
const THICKEST_TUBE: f64 = 1.0 / 3.0;
/// Smallest change of the value between two samples along the displacement: a thousandth of the tube's radius.
pub const FINEST: f64 = 1e-3;
/// Greatest number of samples along the displacement while it is in the box around the torus.
pub const MOST_STEPS: f64 = 16384.0;
/// Times from 0 to 1 that differ by less than this may be equal.
const NO_TIME: f64 = 1e-15;

fn parts(half: DVec3) -> MinkowskiParts {
    let width = half.x.min(half.z);
    let tube = half.y.min(width * THICKEST_TUBE);
    let core = 1.0 - tube / width;
    // Places the outermost points exactly at 1, rounded or not.
    let round = DVec3::new(1.0 - core, tube / half.y, 1.0 - core);
    MinkowskiParts { core: DVec3::new(core, 0.0, core), round }
}

#[inline(always)]
pub fn holds<N: SimdReal>(parts: &MinkowskiParts, [x, y, z]: [N; 3]) -> N::Mask {
    let out = ((x * x + z * z).sqrt() - parts.core.x) / parts.round.x;
    let up = y / parts.round.y;
    (out * out + up * up).at_most(x.all(1.0))
}

/// Marches along the displacement while it is in the box around the solid. Each step is as long as the value guarantees
/// that the point stays outside.
#[inline(always)]
pub fn passes<N: SimdReal>(
    parts: &MinkowskiParts,
    p: [N; 3],
    displacement: DVec3,
    margin: f64,
) -> N::Mask {
    let zero = p[0].all(0.0);
    let mut times = Times::all(zero);
    let box_half = 1.0 + margin.max(0.0);
    for (at, along) in p.into_iter().zip(displacement.to_array()) {
        times.keep_within(at, along, box_half);
    }
    let Times { from, to } = times;
    let inverse = slack(parts, displacement.abs()).max(f64::MIN_POSITIVE).recip();
    let least = ((to - from) * MOST_STEPS.recip()).max(zero.all(FINEST * inverse + NO_TIME));
    let mut t = from;
    let mut value = value(parts, behind(p, displacement, t), margin);
    let mut inside = value.at_most(zero) & times.are_some();
    while !N::is_all(inside | to.at_most(t)) {
        t = (t + (value * inverse).max(least)).min(to);
        value = self::value(parts, behind(p, displacement, t), margin);
        inside = inside | (value.at_most(zero) & times.are_some());
    }
    inside
}

#[inline(always)]
fn value<N: SimdReal>(parts: &MinkowskiParts, [x, y, z]: [N; 3], margin: f64) -> N {
    let out = ((x * x + z * z).sqrt() - parts.core.x) / parts.round.x;
    let up = y / parts.round.y;
    (out * out + up * up).sqrt() - (1.0 + margin)
}

pub fn slack(parts: &MinkowskiParts, offset: DVec3) -> f64 {
    let around = offset.x.hypot(offset.z);
    (around / parts.round.x).hypot(offset.y / parts.round.y)
}

pub fn support(parts: &MinkowskiParts, direction: DVec3) -> f64 {
    let d = direction;
    parts.core.x * d.x.hypot(d.z) + (parts.round * d).length()
}

pub fn furthest(parts: &MinkowskiParts, direction: DVec3) -> DVec3 {
    parts.core * along_circle(direction) + parts.furthest_of_round(direction)
}
