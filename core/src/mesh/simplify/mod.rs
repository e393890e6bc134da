//! Reduces triangles: collapses edges, the least error first, until the requested number is left.
//!
//! The error is that of [`Quadric`](quadric::Quadric)s, and larger where colours differ. An edge is only collapsed if
//! the surface remains a manifold (the link condition: Dey, Edelsbrunner, Guha and Nekhayev, "Topology preserving edge
//! contraction", 1999) and no triangle is flipped. So the result is as closed as the mesh was and has its topology; if
//! no further edge may be collapsed, more triangles are left than requested. Uses one thread; the result is
//! deterministic.

mod quadric;
mod surface;

use glam::Vec3;

use self::surface::SimplifiedSurface;
use super::{Budget, Mesh, MeshError, MeshPart};
use crate::progress::Progress;
use crate::sculpture::Limits;

/// Collapses between two checks for cancellation.
const PORTION: u64 = 1 << 14;

/// Low bits of an error (a positive float, so ordered as its bits) that do not distinguish buckets: buckets are a fifth
/// wide.
const BUCKET_SHIFT: u32 = 21;
/// Buckets of all positive floats.
const BUCKETS: usize = 1 << (31 - BUCKET_SHIFT);

/// An edge that may be collapsed, and the sum of its vertices' versions, which identifies an edge that has changed.
type EdgeCandidate = ([u32; 2], u32);

/// The edges by their errors, to the precision of the buckets: unlike a heap, this costs no more for many edges.
struct EdgeQueue {
    buckets: Vec<Vec<EdgeCandidate>>,
    /// All buckets below this one are empty.
    lowest: usize,
}

impl EdgeQueue {
    fn new() -> EdgeQueue {
        EdgeQueue { buckets: vec![Vec::new(); BUCKETS], lowest: 0 }
    }

    fn push(&mut self, error: f32, candidate: EdgeCandidate) {
        let bucket = (error.to_bits() >> BUCKET_SHIFT) as usize % BUCKETS;
        self.buckets[bucket].push(candidate);
        self.lowest = self.lowest.min(bucket);
    }

    /// Returns all edges of the lowest bucket that has any.
    fn pop(&mut self) -> Option<Vec<EdgeCandidate>> {
        let next = self.buckets[self.lowest..].iter().position(|bucket| !bucket.is_empty())?;
        self.lowest += next;
        Some(std::mem::take(&mut self.buckets[self.lowest]))
    }
}

/// Returns the most bytes that simplifying takes, `mesh` included. Its own vectors are freed before the queue is
/// filled, whose buckets may have twice the capacity that they use.
fn needed_bytes(mesh: &Mesh) -> u64 {
    let (vertices, triangles) = (mesh.vertex_count(), mesh.triangle_count());
    let (copied, whole) = SimplifiedSurface::needed_bytes(vertices, triangles, mesh.is_coloured());
    let edges = triangles + triangles / 2;
    let queue = 2 * edges * size_of::<EdgeCandidate>() as u64;
    (mesh.heap_bytes() + copied).max(whole + queue)
}

/// Returns the mesh with at most `triangles`, as far as its topology allows. Refuses, before allocating, if that needs
/// more than the limits for the grid and the colours together.
pub fn simplified(
    mesh: Mesh,
    triangles: u64,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Mesh, MeshError> {
    let all = mesh.triangle_count();
    if all <= triangles {
        return Ok(mesh);
    }
    let what = format!("simplifying {all} triangles needs");
    let checked = Budget::new(limits).check_work(what, needed_bytes(&mesh));
    checked.map_err(|over| over.advise("export without a limit of triangles"))?;
    progress.begin("simplifying");
    let base = mesh.base;
    let mut surface = SimplifiedSurface::new(mesh);
    let mut queue = EdgeQueue::new();
    for edge in surface.edges() {
        queue.push(surface.collapse_of(edge).error, (edge, surface.version(edge)));
    }
    let (mut left, mut count) = (all, 0u64);
    let mut neighbours = Vec::new();
    'until_few: while let Some(candidates) = queue.pop() {
        for (edge, version) in candidates {
            if left <= triangles {
                break 'until_few;
            }
            if !surface.is_alive(edge) || surface.version(edge) != version {
                continue;
            }
            let collapse = surface.collapse_of(edge);
            if !surface.try_collapse(edge, &collapse) {
                continue;
            }
            left -= 2;
            surface.neighbours(edge[0], &mut neighbours);
            for &other in &neighbours {
                let edge = [edge[0].min(other), edge[0].max(other)];
                queue.push(surface.collapse_of(edge).error, (edge, surface.version(edge)));
            }
            count += 1;
            if count.is_multiple_of(PORTION) {
                progress.advance((all - left) as f32 / (all - triangles) as f32);
                if progress.is_cancelled() {
                    return Err(MeshError::Cancelled);
                }
            }
        }
    }
    progress.end();
    let part: MeshPart = surface.into_part();
    Mesh::joined(vec![part], base)
}

/// Returns the normal of a triangle, as long as twice its area.
fn cross([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}
