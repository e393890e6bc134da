//! The faces of voxels, merged to rectangles.
//!
//! Rectangles alone would have T-junctions: corners of one in the middle of another's side. So a corner of any
//! rectangle is a vertex of all that touch it, as are corners with several fans; all others are removed. Rectangles
//! become triangles between the vertices on their sides ([`polygon`]), none without area. Where colours change, faces
//! are not merged, since colours belong to vertices.
//!
//! Takes contents; returns one part.

mod numbers;
mod polygon;
mod rectangles;

use glam::Vec3;
use rayon::prelude::*;

use self::numbers::{LAYERS, VertexNumbers};
use self::polygon::put_rectangle;
use self::rectangles::{PLANES, Rectangle, rectangles};
use super::budget::StagePieces;
use super::{Budget, Mesh, MeshError, MeshPart, VertexColours};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::Contents;

/// The number of rectangles that a thread triangulates at a time.
const PORTION: usize = 1 << 13;

/// The least memory per rectangle: itself, copied once, a face and a vertex.
const LEAST_BYTES: u64 =
    (2 * size_of::<Rectangle>() + size_of::<[u32; 4]>() + size_of::<Vec3>()) as u64;

/// Returns the mesh of merged faces.
pub fn mesh(
    contents: &Contents,
    colours: VertexColours,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Mesh, MeshError> {
    progress.begin("merging faces");
    let made = merged(contents, colours.are_in(contents), &Budget::new(limits), progress);
    progress.end();
    Mesh::joined(vec![made?], contents.material.base())
}

fn merged(
    contents: &Contents,
    is_coloured: bool,
    budget: &Budget,
    progress: &dyn Progress,
) -> Result<MeshPart, MeshError> {
    let go_on = || if progress.is_cancelled() { Err(MeshError::Cancelled) } else { budget.check() };
    let room = || !progress.is_cancelled() && budget.take(0);
    let dims = contents.grid.dims();
    let planes: u32 = dims.to_array().map(|axis| axis / PLANES + 1).iter().sum();
    let pieces = StagePieces::new(progress, [0.0, 0.4], planes as usize);
    let mut all: Vec<Rectangle> = Vec::new();
    for axis in 0..3 {
        let found = rectangles(contents, axis, is_coloured, |count| {
            pieces.one();
            budget.take(count as u64 * LEAST_BYTES) && room()
        });
        go_on()?;
        found.into_iter().for_each(|found| all.extend(found));
    }
    budget.take(VertexNumbers::bytes_of_bits(dims));
    go_on()?;
    let pieces = StagePieces::new(progress, [0.4, 0.7], (dims.z / LAYERS + 1) as usize);
    let numbers = VertexNumbers::new(contents, &all, |layer| {
        pieces.one();
        budget.take(layer) && room()
    });
    go_on()?;
    let pieces = StagePieces::new(progress, [0.7, 1.0], all.len() / PORTION + 1);
    let portion = |portion: &[Rectangle]| {
        let mut part = MeshPart::default();
        if room() {
            portion.iter().for_each(|rectangle| put_rectangle(&numbers, rectangle, &mut part));
            // Once more for joining the parts.
            budget.take(2 * part.heap_bytes());
        }
        pieces.one();
        part
    };
    let portions: Vec<MeshPart> = all.par_chunks(PORTION).map(portion).collect();
    drop(all);
    go_on()?;
    let mut part = MeshPart::default();
    numbers.put_vertices(contents, is_coloured, &mut part);
    part.quads.reserve_exact(portions.iter().map(|portion| portion.quads.len()).sum());
    part.triangles.reserve_exact(portions.iter().map(|portion| portion.triangles.len()).sum());
    for mut portion in portions {
        part.quads.append(&mut portion.quads);
        part.triangles.append(&mut portion.triangles);
    }
    go_on()?;
    Ok(part)
}
