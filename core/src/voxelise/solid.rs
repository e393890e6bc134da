//! Fills a grid layer by layer: the inside of a mesh from its spans, or its shell.
//!
//! Rays along x and y are cut for one layer of 64 voxels at a time. Rays along z run through all layers: what they
//! contribute is listed by layers first ([`Marks`]). Most work is done for 64 voxels of a row along x at once.

use std::sync::{Mutex, PoisonError};

use glam::UVec3;
use rayon::prelude::*;

use super::crossings::RaySlab;
use super::spans::inside;
use super::{CutMesh, VoxeliseError};
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::Grid;
use crate::sculpture::grid::{GridLayers, LEAF_EDGE_VX, LeafRow};

/// Voxels of a layer, in order: y (13 bits), z in the layer (6 bits) and x (13 bits).
struct Marks(Vec<u32>);

impl Marks {
    /// Returns the bits of a voxel.
    fn of(v: UVec3) -> u32 {
        v.y << 19 | (v.z % LEAF_EDGE_VX) << 13 | v.x
    }

    fn sort(&mut self) {
        self.0.par_sort_unstable();
    }

    /// Calls `f` with y, z and x in a row of leaves of each of its voxels.
    fn in_row(&self, y: u32, mut f: impl FnMut(u32, u32, u32)) {
        let at = |y: u32| self.0.partition_point(|mark| u64::from(*mark) < u64::from(y) << 19);
        for mark in &self.0[at(y)..at(y + LEAF_EDGE_VX)] {
            f((mark >> 19) - y, mark >> 13 & 63, mark & 0x1FFF);
        }
    }
}

/// Returns an upper bound of the bytes for a mesh of `dims` voxels: with `has_holes` those of [`fill`], else of [`shell`].
pub(super) fn bytes(cut: &CutMesh, has_holes: bool) -> u64 {
    let marks = cut.slabs[2].all_crossings * 2 * size_of::<u32>() as u64;
    let UVec3 { x, y, .. } = cut.placed.dims;
    let plane = u64::from(x.div_ceil(64)) * 8 * u64::from(y);
    let along_y = cut.slabs[1].bytes();
    marks + along_y + if has_holes { plane * u64::from(LEAF_EDGE_VX + 2) } else { 0 }
}

/// Returns a grid of the voxels inside. With `has_holes` the three directions vote; rays through holes are ignored.
pub(super) fn fill(cut: &CutMesh, empty: Grid, has_holes: bool) -> Result<Grid, VoxeliseError> {
    let votes = if has_holes { Some(ZVotes::new(cut)?) } else { None };
    build(cut, empty, |layer, layers| {
        let along_x = cut.placed.cross(&cut.slabs[0], layer);
        let Some(along_z) = &votes else {
            return Ok(layers.add(&|row| {
                fill_along_x(&along_x, row);
            }));
        };
        let along_y = YVotes::new(cut, layer);
        Ok(layers.add(&|row| {
            let unsure = fill_along_x(&along_x, row);
            let in_z = along_z.row(layer, row);
            for (z, y) in (0..LEAF_EDGE_VX).flat_map(|z| (0..LEAF_EDGE_VX).map(move |y| (z, y))) {
                let known_x = if unsure[z as usize] >> y & 1 != 0 { 0 } else { u64::MAX };
                let row_y = row.y + y;
                if row_y >= cut.placed.dims.y {
                    continue;
                }
                let first = (y + LEAF_EDGE_VX * z) as usize * row.width;
                for (w, word) in row.row(y, z).iter_mut().enumerate() {
                    let (in_y, known_y) = along_y.word(w, row_y, z);
                    let known_z = along_z.known(w, row_y);
                    let (in_x, in_y, in_z) =
                        (*word & known_x, in_y & known_y, in_z[first + w] & known_z);
                    let out = known_x & !in_x | known_y & !in_y | known_z & !in_z;
                    *word = in_x & in_y | in_y & in_z | in_z & in_x | (in_x | in_y | in_z) & !out;
                }
            }
        }))
    })
}

/// Returns a grid of the voxels on both sides of the surface. Those of one side alone would touch only at edges on the
/// steps of a slope, and leave gaps.
pub(super) fn shell(cut: &CutMesh, empty: Grid) -> Result<Grid, VoxeliseError> {
    let dims = cut.placed.dims;
    let sides = |rays: &RaySlab, f: &mut dyn FnMut(UVec3)| {
        for ray in rays.rays() {
            for crossing in ray.crossings {
                crossing.sides(dims[rays.axis]).for_each(|along| f(rays.voxel(&ray, along)));
            }
        }
    };
    let mut of_layers = listed_along_z(cut, |rays, put| sides(rays, put))?;
    build(cut, empty, |layer, layers| {
        let mut marks = Marks(std::mem::take(&mut of_layers[layer as usize]));
        for axis in [0, 1] {
            sides(&cut.placed.cross(&cut.slabs[axis], layer), &mut |v| marks.0.push(Marks::of(v)));
        }
        marks.sort();
        Ok(layers.add(&|row| {
            marks.in_row(row.y, |y, z, x| row.row(y, z)[x as usize / 64] |= 1 << (x % 64));
        }))
    })
}

/// Builds a grid of all layers, each of which `add` adds.
fn build(
    cut: &CutMesh,
    empty: Grid,
    mut add: impl FnMut(u32, &mut GridLayers) -> Result<u64, VoxeliseError>,
) -> Result<Grid, VoxeliseError> {
    let mut layers = GridLayers::new(empty);
    let count = layers.count();
    for layer in 0..count {
        cut.go_on()?;
        cut.progress.advance(layer as f32 / count as f32);
        let bytes = add(layer, &mut layers)?;
        if bytes > cut.grid_bytes {
            // As the others may turn out.
            let all = bytes / u64::from(layer + 1) * u64::from(count);
            let what = "the voxels of the mesh at this size need about";
            let over = OverBudget::new(what, all.max(bytes), MemoryBudget::Grids, cut.grid_bytes);
            return Err(over.advise("choose fewer voxels").into());
        }
    }
    Ok(layers.finish())
}

/// Calls `of` with the slabs of rays along z, and returns the voxels that it puts, by their layers.
fn listed_along_z(
    cut: &CutMesh,
    of: impl Fn(&RaySlab, &mut dyn FnMut(UVec3)),
) -> Result<Vec<Vec<u32>>, VoxeliseError> {
    let mut of_layers = vec![Vec::new(); cut.placed.dims.z.div_ceil(LEAF_EDGE_VX) as usize];
    for slab in 0..cut.slabs[2].count() {
        cut.go_on()?;
        of(&cut.placed.cross(&cut.slabs[2], slab), &mut |v| {
            of_layers[(v.z / LEAF_EDGE_VX) as usize].push(Marks::of(v));
        });
    }
    Ok(of_layers)
}

/// Sets the voxels inside by rays along x in a row of leaves. Returns the rows of voxels that lie on rays through holes:
/// a word for each z, a bit for each y.
fn fill_along_x(rays: &RaySlab, row: &mut LeafRow) -> [u64; LEAF_EDGE_VX as usize] {
    let mut unsure = [0; LEAF_EDGE_VX as usize];
    let first = row.y;
    for (z, unsure) in (0..).zip(&mut unsure) {
        for ray in rays.rays_of(first..first + LEAF_EDGE_VX, z) {
            let y = ray.a - first;
            let voxels = row.row(y, z);
            let is_sure = inside(ray.crossings, |start, end| set_span(voxels, start, end));
            *unsure |= u64::from(!is_sure) << y;
        }
    }
    unsure
}

/// Sets the bits from `start` to before `end`, which is greater.
fn set_span(row: &mut [u64], start: u32, end: u32) {
    let (first, last) = (start as usize / 64, (end - 1) as usize / 64);
    let from = u64::MAX << (start % 64);
    let to = u64::MAX >> (63 - (end - 1) % 64);
    if first == last {
        row[first] |= from & to;
        return;
    }
    row[first] |= from;
    row[first + 1..last].fill(u64::MAX);
    row[last] |= to;
}

/// The inside of a layer by rays along y.
struct YVotes {
    width: usize,
    height: usize,
    /// Rows along x; they follow along y, then along z.
    bits: Vec<u64>,
    /// Rays through holes: a row of bits for each z.
    unsure: Vec<u64>,
}

impl YVotes {
    fn new(cut: &CutMesh, layer: u32) -> YVotes {
        let UVec3 { x, y, z } = cut.placed.dims;
        let (width, height) = (x.div_ceil(64) as usize, y as usize);
        let planes = (z - layer * LEAF_EDGE_VX).min(LEAF_EDGE_VX) as usize;
        let rays = cut.placed.cross(&cut.slabs[1], layer);
        let mut bits = vec![0u64; width * height * planes];
        let mut unsure = vec![0u64; width * planes];
        let each = bits.par_chunks_mut(width * height).zip(unsure.par_chunks_mut(width));
        each.enumerate().for_each(|(plane, (bits, unsure))| {
            for ray in rays.rays_of(0..x, plane as u32) {
                let (word, bit) = (ray.a as usize / 64, 1 << (ray.a % 64));
                let is_sure = inside(ray.crossings, |start, end| {
                    bits[word + width * start as usize] ^= bit;
                    if let Some(after) = bits.get_mut(word + width * end as usize) {
                        *after ^= bit;
                    }
                });
                if !is_sure {
                    unsure[word] |= bit;
                }
            }
            for at in width..bits.len() {
                bits[at] ^= bits[at - width];
            }
        });
        YVotes { width, height, bits, unsure }
    }

    /// Returns the voxels inside of a word of a row, and those on rays without holes; none beyond the grid.
    fn word(&self, w: usize, y: u32, z: u32) -> (u64, u64) {
        let at = w + self.width * (y as usize + self.height * z as usize);
        let unsure = self.unsure.get(w + self.width * z as usize).map_or(0, |unsure| !unsure);
        (self.bits.get(at).copied().unwrap_or(0), unsure)
    }
}

/// The inside by rays along z.
struct ZVotes {
    width: usize,
    /// The ends of spans, by layers.
    ends: Vec<Marks>,
    /// Rays through holes: rows along x, which follow along y.
    unsure: Vec<u64>,
    /// The voxels inside before the next layer: those of each row of leaves.
    before: Vec<Mutex<Vec<u64>>>,
}

impl ZVotes {
    fn new(cut: &CutMesh) -> Result<ZVotes, VoxeliseError> {
        let UVec3 { x, y, z } = cut.placed.dims;
        let width = x.div_ceil(64) as usize;
        let unsure = Mutex::new(vec![0u64; width * y as usize]);
        let ends = listed_along_z(cut, |rays, put| {
            let mut unsure = unsure.lock().unwrap_or_else(PoisonError::into_inner);
            for ray in rays.rays() {
                let is_sure = inside(ray.crossings, |start, end| {
                    put(rays.voxel(&ray, start));
                    // Nothing follows the last layer.
                    if end < z {
                        put(rays.voxel(&ray, end));
                    }
                });
                if !is_sure {
                    unsure[ray.a as usize / 64 + width * ray.b as usize] |= 1 << (ray.a % 64);
                }
            }
        })?;
        let mut ends: Vec<Marks> = ends.into_iter().map(Marks).collect();
        ends.iter_mut().for_each(Marks::sort);
        let rows = y.div_ceil(LEAF_EDGE_VX);
        let empty = || Mutex::new(vec![0; width * LEAF_EDGE_VX as usize]);
        let unsure = unsure.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(ZVotes { width, ends, unsure, before: (0..rows).map(|_| empty()).collect() })
    }

    /// Returns the voxels inside of a row of leaves, in the order of its words. Layers must be asked for in order.
    fn row(&self, layer: u32, row: &LeafRow) -> Vec<u64> {
        let plane = self.width * LEAF_EDGE_VX as usize;
        let mut bits = vec![0u64; plane * LEAF_EDGE_VX as usize];
        self.ends[layer as usize].in_row(row.y, |y, z, x| {
            let word = x as usize / 64 + self.width * (y + LEAF_EDGE_VX * z) as usize;
            bits[word] ^= 1 << (x % 64);
        });
        let before = &self.before[(row.y / LEAF_EDGE_VX) as usize];
        let mut before = before.lock().unwrap_or_else(PoisonError::into_inner);
        for plane in bits.chunks_exact_mut(plane) {
            for (word, before) in plane.iter_mut().zip(before.iter_mut()) {
                *word ^= *before;
                *before = *word;
            }
        }
        bits
    }

    /// Returns which voxels of a word lie on rays without holes.
    fn known(&self, w: usize, y: u32) -> u64 {
        !self.unsure[w + self.width * y as usize]
    }
}
