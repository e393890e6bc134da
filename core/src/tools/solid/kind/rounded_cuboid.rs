//! Rounded cuboid: a cuboid whose edges are rounded by a third of its smallest half extent.

use glam::DVec3;

use super::super::body::Body;
use super::super::parts::MinkowskiParts;
pub use super::super::parts::{furthest, passes, slack, support};
use super::super::simd_real::SimdReal;
use super::super::spec::{RowMethod, SolidSpec};
use crate::tools::texture;

pub static SPEC: SolidSpec = SolidSpec {
    name: "rounded-cuboid",
    label: "Rounded",
    help: "Rounded cuboid tool: a box with soft edges",
    synonyms: "rounded box soft cushion pillow",
    parts,
    rows: RowMethod::Bricks,
    fills_its_box: false,
    is_convex: true,
    image_point: texture::on_faces,
    body: Body::RoundedBox,
};

/// Radius of the edges, as a fraction of the smallest half extent.
const EDGE_RADIUS: f64 = 1.0 / 3.0;

fn parts(half: DVec3) -> MinkowskiParts {
    let core = 1.0 - half.min_element() * EDGE_RADIUS / half;
    MinkowskiParts { core, round: 1.0 - core }
}

#[inline(always)]
pub fn holds<N: SimdReal>(parts: &MinkowskiParts, p: [N; 3]) -> N::Mask {
    let [x, y, z] = parts.beyond_core(p);
    (x * x + y * y + z * z).at_most(x.all(1.0))
}
