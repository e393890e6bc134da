//! Converts the crossings of a ray to the voxels inside along it.

use rayon::prelude::*;

use super::crossings::{MeshCrossing, Rays};

/// Calls `emit` with the first voxel of each span inside, and one past its last. If the surface is crossed equally
/// often in both directions, everything that it winds around is inside, however often. Otherwise points after an even
/// number of crossings are outside, whichever direction the triangles face. Returns false, without a span, for a ray
/// through a hole.
pub fn inside(ray: &[MeshCrossing], mut emit: impl FnMut(u32, u32)) -> bool {
    let is_wound = ray.iter().map(|c| c.step()).sum::<i32>() == 0;
    if !is_wound && ray.len() % 2 == 1 {
        return false;
    }
    let (mut depth, mut start) = (0, 0);
    for crossing in ray {
        let before = depth;
        depth = if is_wound { depth + crossing.step() } else { 1 - depth };
        if before == 0 {
            start = crossing.before();
        } else if depth == 0 && crossing.before() > start {
            emit(start, crossing.before());
        }
    }
    true
}

/// Returns the share of rays through holes among all rays with crossings.
pub(crate) fn open_share(rays: &[Rays]) -> f64 {
    let count = |rays: &Rays| {
        let all: Vec<&[MeshCrossing]> =
            rays.crossings.chunk_by(|a, b| a.ray() == b.ray()).collect();
        let open = all.par_iter().filter(|ray| !inside(ray, |_, _| {})).count();
        (open, all.len())
    };
    let (open, all) = rays.iter().map(count).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    open as f64 / all.max(1) as f64
}
