//! Rows of bits: the inside of a mesh from its spans, and its shell.
//!
//! A row holds the voxels along x; rows follow one another along y, then z, so that most work is done for 64 voxels at
//! once. Spans along y and z mark their ends, which a running exclusive or fills.

use glam::UVec3;
use rayon::prelude::*;

use super::crossings::Rays;
use super::spans::inside;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::{Brick, Grid};

fn words(dims: UVec3) -> usize {
    dims.x.div_ceil(64) as usize
}

/// Returns the bytes of the bits of a grid.
pub fn bytes(dims: UVec3) -> u64 {
    words(dims) as u64 * 8 * u64::from(dims.y) * u64::from(dims.z)
}

/// Returns the voxels inside. With `has_holes` the three directions vote; rays through holes are ignored.
pub fn fill(rays: &[Rays], dims: UVec3, has_holes: bool) -> Vec<u64> {
    let (mut bits, unsure) = along_x(&rays[0], dims);
    if !has_holes {
        return bits;
    }
    let (width, height, depth) = (words(dims), dims.y as usize, dims.z as usize);
    let along_y = along(&rays[1], dims.x, height, depth);
    let along_z = along(&rays[2], dims.x, depth, height);
    bits.par_chunks_mut(width * height).enumerate().for_each(|(z, slice)| {
        for (at, word) in slice.iter_mut().enumerate() {
            let (w, y) = (at % width, at / width);
            let known_x = if unsure[y + height * z] { 0 } else { u64::MAX };
            let known_y = !along_y.unsure[w + width * z];
            let known_z = !along_z.unsure[w + width * y];
            let (in_x, in_y, in_z) = (
                *word & known_x,
                along_y.bits[w + width * (y + height * z)] & known_y,
                along_z.bits[w + width * (z + depth * y)] & known_z,
            );
            let out = known_x & !in_x | known_y & !in_y | known_z & !in_z;
            *word = in_x & in_y | in_y & in_z | in_z & in_x | (in_x | in_y | in_z) & !out;
        }
    });
    bits
}

/// Returns the inside by rays along x, and the rows that lie on rays through holes.
fn along_x(rays: &Rays, dims: UVec3) -> (Vec<u64>, Vec<bool>) {
    let (width, height) = (words(dims), dims.y as usize);
    let rows = height * dims.z as usize;
    let (mut bits, mut unsure) = (vec![0u64; width * rows], vec![false; rows]);
    let slices = bits.par_chunks_mut(width * height).zip(unsure.par_chunks_mut(height));
    slices.enumerate().for_each(|(z, (slice, unsure))| {
        let first = height * z;
        for ray in rays.of(first, first + height).chunk_by(|a, b| a.ray() == b.ray()) {
            let y = ray[0].ray() - first;
            let row = &mut slice[width * y..width * (y + 1)];
            unsure[y] = !inside(ray, |start, end| set_span(row, start, end));
        }
    });
    (bits, unsure)
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

/// The inside by rays along y or z.
struct CrossRays {
    /// Rows along the rays' axis within each slice.
    bits: Vec<u64>,
    /// Rays through holes: a row of bits for each slice.
    unsure: Vec<u64>,
}

/// Returns the inside by rays that run from row to row, in `slices` of `rows` rows of `size_x` voxels.
fn along(rays: &Rays, size_x: u32, rows: usize, slices: usize) -> CrossRays {
    let width = size_x.div_ceil(64) as usize;
    let size_x = size_x as usize;
    let mut bits = vec![0u64; width * rows * slices];
    let mut unsure = vec![0u64; width * slices];
    let each = bits.par_chunks_mut(width * rows).zip(unsure.par_chunks_mut(width));
    each.enumerate().for_each(|(slice, (bits, unsure))| {
        let first = size_x * slice;
        for ray in rays.of(first, first + size_x).chunk_by(|a, b| a.ray() == b.ray()) {
            let x = ray[0].ray() - first;
            let (word, bit) = (x / 64, 1 << (x % 64));
            let is_sure = inside(ray, |start, end| {
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
    CrossRays { bits, unsure }
}

/// Returns the voxels on both sides of the surface. Those of one side alone would touch only at edges on the steps of a
/// slope, and leave gaps.
pub fn shell(rays: &[Rays], dims: UVec3) -> Vec<u64> {
    let (width, height) = (words(dims), dims.y as usize);
    let mut bits = vec![0u64; width * height * dims.z as usize];
    for rays in rays {
        for crossing in &rays.crossings {
            for along in crossing.sides(dims[rays.axis]) {
                let v = voxel(dims, rays.axis, crossing.ray(), along);
                let row = v.y as usize + height * v.z as usize;
                bits[width * row + v.x as usize / 64] |= 1 << (v.x % 64);
            }
        }
    }
    bits
}

/// Returns the voxel at a position along a ray.
pub fn voxel(dims: UVec3, axis: usize, ray: usize, along: u32) -> UVec3 {
    let (a, b) = super::crossings::ACROSS[axis];
    let mut v = UVec3::ZERO;
    v[a] = ray as u32 % dims[a];
    v[b] = ray as u32 / dims[a];
    v[axis] = along;
    v
}

/// Writes the bits to a grid of their size.
pub(crate) fn pour(bits: &[u64], grid: &mut Grid) {
    let dims = grid.dims();
    let (width, height) = (words(dims), dims.y as usize);
    grid.fill_bricks(|b| {
        let corner = b * BRICK_EDGE_VX;
        let room = (dims - corner).min(UVec3::splat(BRICK_EDGE_VX));
        let mut rows = [0u64; 8];
        for z in 0..room.z {
            for y in 0..room.y {
                let row = (corner.y + y) as usize + height * (corner.z + z) as usize;
                let word = bits[width * row + corner.x as usize / 64];
                rows[z as usize] |= (word >> (corner.x % 64) & 0xFF) << (8 * y);
            }
        }
        Brick::from_rows(&rows)
    });
}
