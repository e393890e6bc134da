//! Converts the crossings of a ray to the voxels inside along it.

use super::crossings::MeshCrossing;

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
