//! The faces of voxels, merged to rectangles.
//!
//! Rectangles alone would have T-junctions: corners of one in the middle of another's side. So a corner of any
//! rectangle is a vertex of all that touch it, as are corners with several fans; all others vanish. Rectangles become
//! triangles between the vertices on their sides ([`polygon`]), none without area. Where colours change, faces are
//! not merged, since colours are those of vertices.
//!
//! Takes contents; gives one part.

mod numbers;
mod polygon;
mod rectangles;

use glam::Vec3;
use rayon::prelude::*;

use self::numbers::Numbers;
use self::polygon::put_rectangle;
use self::rectangles::{Rectangle, rectangles};
use super::{Budget, Mesh, MeshError, Part, VertexColours};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::Contents;

/// Rectangles that are triangulated by a thread at a time.
const PORTION: usize = 1 << 13;

/// Memory that each rectangle takes at least.
const LEAST_BYTES: u64 =
    (size_of::<Rectangle>() + size_of::<[u32; 4]>() + size_of::<Vec3>()) as u64;

/// The mesh of merged faces.
pub fn mesh(
    contents: &Contents,
    colours: VertexColours,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Mesh, MeshError> {
    progress.begin("merging faces");
    let is_coloured = colours.are_in(contents);
    let go_on = || if progress.is_cancelled() { Err(MeshError::Cancelled) } else { Ok(()) };
    let mut all: Vec<Rectangle> = Vec::new();
    let budget = Budget::new(limits);
    for axis in 0..3 {
        let found = rectangles(contents, axis, is_coloured);
        // With the vertex and the face of each that follow.
        budget.take(found.len() as u64 * LEAST_BYTES);
        budget.check()?;
        all.extend(found);
        progress.advance(0.2 * (axis + 1) as f32);
        go_on()?;
    }
    let numbers = Numbers::new(contents, &all);
    go_on()?;
    let portions: Vec<Part> = all
        .par_chunks(PORTION)
        .map(|portion| {
            let mut part = Part::default();
            portion.iter().for_each(|rectangle| put_rectangle(&numbers, rectangle, &mut part));
            part
        })
        .collect();
    drop(all);
    let mut part = Part::default();
    numbers.put_vertices(contents, is_coloured, &mut part);
    for mut portion in portions {
        part.quads.append(&mut portion.quads);
        part.triangles.append(&mut portion.triangles);
    }
    progress.end();
    go_on()?;
    Mesh::joined(vec![part], contents.material.base())
}
