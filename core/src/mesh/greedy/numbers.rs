//! The corners of the lattice that are vertices of merged faces, and their indices.
//!
//! Layer by layer: first the corners of rectangles and those with several fans, row by row; then the further vertices
//! of the layer ([`VertexLayer`]). Layers without odd corners are not kept.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::rectangles::Rectangle;
use crate::mesh::MeshPart;
use crate::mesh::layer::{Further, VertexLayer};
use crate::mesh::place::{
    AtCorners, VertexPlacement, colour, octant_of_edge, octants_around, solid_of,
};
use crate::mesh::rows::{VoxelRows, for_each_bit, row_words};
use crate::sculpture::history::Contents;

/// Layers that a thread processes together.
pub const LAYERS: u32 = 16;

/// The vertices and their indices.
pub struct VertexNumbers {
    width: usize,
    /// Rows of a layer.
    height: usize,
    /// The corners that are vertices, a bit each.
    kept: Vec<u64>,
    /// The index of the first vertex of each row of corners.
    row_starts: Vec<u32>,
    /// Layers with odd corners, with the index of their first further vertex.
    odd: Vec<Option<(VertexLayer, u32)>>,
    count: u64,
}

impl VertexNumbers {
    /// Returns the bytes of the bits and rows of all corners.
    pub(crate) fn bytes_of_bits(dims: UVec3) -> u64 {
        let rows = (u64::from(dims.y) + 1) * (u64::from(dims.z) + 1);
        rows * (8 * row_words(dims) as u64 + 4)
    }

    /// Returns the vertices for the corners of `rectangles`, and all others that must be kept. `goes_on` gets the bytes
    /// of the layers of a portion; once it returns false, the indices are unspecified.
    pub fn new(
        contents: &Contents,
        rectangles: &[Rectangle],
        goes_on: impl Fn(u64) -> bool + Sync,
    ) -> VertexNumbers {
        let grid = &contents.grid;
        let dims = grid.dims();
        let (width, height) = (row_words(dims), dims.y as usize + 1);
        let layers = dims.z + 1;
        let starts: Vec<u32> = (0..layers).step_by(LAYERS as usize).collect();
        let stopped = AtomicBool::new(false);
        let odd: Vec<Vec<Option<VertexLayer>>> = starts
            .par_iter()
            .map(|&start| {
                if stopped.load(Ordering::Relaxed) {
                    return Vec::new();
                }
                let end = (start + LAYERS).min(layers);
                let rows = VoxelRows::of(grid, i64::from(start) - 1..i64::from(end) + 1);
                let layer = |z: u32| VertexLayer::new(&rows, z.into());
                let mut next = layer(start);
                let made = (start..end).map(|z| {
                    let above = layer(z + 1);
                    next.find_edges_to(&above);
                    let own = std::mem::replace(&mut next, above);
                    (!own.is_plain()).then_some(own)
                });
                let made: Vec<Option<VertexLayer>> = made.collect();
                if !goes_on(made.iter().flatten().map(VertexLayer::heap_bytes).sum()) {
                    stopped.store(true, Ordering::Relaxed);
                }
                made
            })
            .collect();
        let mut kept = vec![0; width * height * layers as usize];
        let odd: Vec<Option<VertexLayer>> = odd.into_iter().flatten().collect();
        let mut keep = |x: usize, y: usize, z: usize| {
            kept[(z * height + y) * width + x / 64] |= 1 << (x % 64);
        };
        for Rectangle { axis, low, high, .. } in rectangles {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(usize::from);
            for corner in 0..4 {
                let mut at = *low;
                at[u] = if corner & 1 != 0 { high[u] } else { low[u] };
                at[v] = if corner & 2 != 0 { high[v] } else { low[v] };
                let [x, y, z] = at.map(usize::from);
                keep(x, y, z);
            }
        }
        for (layer, kept) in odd.iter().zip(kept.chunks_mut(width * height)) {
            for (kept, odd) in kept.iter_mut().zip(layer.iter().flat_map(|layer| &layer.ambiguous))
            {
                *kept |= odd;
            }
        }
        let (mut row_starts, mut numbered) = (Vec::new(), Vec::new());
        let mut count = 0u64;
        for (layer, kept) in odd.into_iter().zip(kept.chunks(width * height)) {
            for row in kept.chunks(width) {
                row_starts.push(count as u32);
                count += row.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
            }
            let further = layer.as_ref().map_or(0, |layer| layer.further().count());
            numbered.push(layer.map(|layer| (layer, count as u32)));
            count += further as u64;
        }
        VertexNumbers { width, height, kept, row_starts, odd: numbered, count }
    }

    /// Returns whether the corner is a vertex.
    #[inline(always)]
    pub(crate) fn is_kept(&self, [x, y, z]: [usize; 3]) -> bool {
        self.kept[(z * self.height + y) * self.width + x / 64] >> (x % 64) & 1 != 0
    }

    /// Returns the vertex of the fan with `face` at a corner that is a vertex.
    pub fn vertex(&self, [x, y, z]: [usize; 3], face: usize) -> u32 {
        if let Some((layer, further)) = &self.odd[z] {
            let fan = layer.corner(x, y).map_or(0, |corner| corner.fan_of[face] as usize);
            if fan > 0 {
                return further + (layer.fan(x, y, fan) - layer.corner_count()) as u32;
            }
        }
        let row = z * self.height + y;
        let words = &self.kept[row * self.width..(row + 1) * self.width];
        let before: u32 = words[..x / 64].iter().map(|word| word.count_ones()).sum();
        self.row_starts[row] + before + (words[x / 64] & ((1 << (x % 64)) - 1)).count_ones()
    }

    /// Returns the vertex in the middle of an edge, as [`VertexLayer::middle`].
    pub fn middle(&self, [x, y, z]: [usize; 3], axis: usize, side: usize) -> Option<u32> {
        let (layer, further) = self.odd[z].as_ref()?;
        let at = layer.middle(x, y, axis, side)?;
        Some(further + (at - layer.corner_count()) as u32)
    }

    /// Adds all vertices.
    pub(crate) fn put_vertices(&self, contents: &Contents, is_coloured: bool, part: &mut MeshPart) {
        let per_layer = self.width * self.height;
        part.positions.reserve_exact(self.count as usize);
        let mut put = |corner: IVec3, octants: u8, position, solid| {
            part.positions.push(position);
            debug_assert!(octants != 0 && octants != u8::MAX, "{corner}");
            if is_coloured {
                part.colours.push(colour(contents, corner, solid));
            }
        };
        for (z, kept) in self.kept.chunks(per_layer).enumerate() {
            for (i, &word) in kept.iter().enumerate() {
                for_each_bit(word, |bit| {
                    let (x, y) = (64 * (i % self.width) + bit, i / self.width);
                    let corner = IVec3::new(x as i32, y as i32, z as i32);
                    let octants = octants_around(&contents.grid, corner);
                    put(
                        corner,
                        octants,
                        AtCorners.fan(&(), corner, octants, 0),
                        solid_of(octants, 0),
                    );
                });
            }
            let Some((layer, _)) = &self.odd[z] else { continue };
            for ([x, y], further) in layer.further() {
                let corner = IVec3::new(x as i32, y as i32, z as i32);
                let octants = layer.octants_at(x, y);
                let (position, solid) = match further {
                    Further::Fan(fan) => {
                        (AtCorners.fan(&(), corner, octants, fan), solid_of(octants, fan))
                    }
                    Further::Middle { axis, side } => {
                        let octant = octant_of_edge(octants, axis, side);
                        (AtCorners.middle(&(), corner, axis, octant), 1 << octant)
                    }
                };
                put(corner, octants, position, solid);
            }
        }
    }
}
