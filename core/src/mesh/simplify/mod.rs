//! Fewer triangles: edges are collapsed, the least error first, until so many are left as are wanted.
//!
//! The error is that of [`Quadric`]s, and larger where colours differ. An edge is only collapsed if that leaves a
//! manifold (the link condition: Dey, Edelsbrunner, Guha and Nekhayev, "Topology preserving edge contraction", 1999)
//! and turns no triangle over. So the result is as closed as the mesh was and has its topology; where nothing more may
//! be collapsed, more triangles are left than wanted. One thread does it; the result is always the same.

mod quadric;
mod surface;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::Vec3;

use self::surface::{Collapse, Surface};
use super::{Mesh, MeshError, Part};
use crate::progress::Progress;

/// Collapses between two looks at whether the work is cancelled.
const PORTION: u64 = 1 << 14;

/// An edge that may be collapsed: its error, its vertices, and the sum of their versions, by which an edge is known
/// that has changed since. Positive floats are ordered as their bits.
type Candidate = Reverse<(u32, [u32; 2], u32)>;

/// The mesh with at most `triangles`, as far as its topology allows.
pub fn simplified(mesh: Mesh, triangles: u64, progress: &dyn Progress) -> Result<Mesh, MeshError> {
    let all = mesh.triangle_count();
    if all <= triangles {
        return Ok(mesh);
    }
    progress.begin("simplifying");
    let base = mesh.base;
    let mut surface = Surface::new(mesh);
    let candidate = |surface: &Surface, edge: [u32; 2]| -> Candidate {
        let Collapse { error, .. } = surface.collapse_of(edge);
        Reverse((error.to_bits(), edge, surface.version(edge)))
    };
    let edges: Vec<Candidate> = surface.edges().map(|edge| candidate(&surface, edge)).collect();
    let mut heap = BinaryHeap::from(edges);
    let (mut left, mut count) = (all, 0u64);
    let mut neighbours = Vec::new();
    while left > triangles
        && let Some(Reverse((_, edge, version))) = heap.pop()
    {
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
            heap.push(candidate(&surface, edge));
        }
        count += 1;
        if count.is_multiple_of(PORTION) {
            progress.advance((all - left) as f32 / (all - triangles) as f32);
            if progress.is_cancelled() {
                return Err(MeshError::Cancelled);
            }
        }
    }
    progress.end();
    let part: Part = surface.into_part();
    Mesh::joined(vec![part], base)
}

/// The normal of a triangle, as long as twice its area.
fn cross([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}
