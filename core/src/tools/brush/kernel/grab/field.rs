//! The smoothed existence bits that pulls at clay sample.
//!
//! From the bits of a box of a grid to values between voxels, and the voxel nearest to a point. Knows no tool.

use fearless_simd::{Level, Simd, dispatch};
use glam::{IVec3, UVec3};
use rayon::prelude::*;

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, BrickKind};
use crate::sculpture::region::VoxelBox;

/// Existence bits smoothed by (9 B - 5 B^2) / 4, where B is the binomial filter 1-4-6-4-1 along each axis. Its second
/// moment cancels that of the interpolation, so that curved surfaces keep their position. Values range from 0 to 4096
/// and a little beyond, above [`HALF`] exactly where a voxel exists, so that points that do not move do not change.
pub struct SmoothedBits {
    min: IVec3,
    size: UVec3,
    values: Vec<i16>,
}

/// Subdivisions of a voxel by which sources are told apart.
pub const FINE: i32 = 1 << 10;
/// The reach of the filter, plus a voxel for the interpolation.
pub const MARGIN_VX: i32 = 5;
/// Half of the filter's sum.
const HALF: i16 = 2048;
/// Minimum difference of a voxel's value from [`HALF`].
const CLEAR: i16 = 128;
/// The minimum difference for walls and gaps of a single voxel, which would otherwise close or open when they move by a
/// fraction of one.
const THIN: i16 = 1024;

impl SmoothedBits {
    /// Smooths the bits of a box that may extend beyond the grid, where nothing exists.
    pub fn new(grid: &Grid, bounds: VoxelBox) -> SmoothedBits {
        let size = bounds.size();
        let (row, layer) = (size.x as usize, (size.x * size.y) as usize);
        let mut bits = vec![0u8; layer * size.z as usize];
        let edge = BRICK_EDGE_VX as i32;
        let inside = bounds.intersect(VoxelBox::of_grid(grid));
        bits.par_chunks_mut(layer.max(1)).enumerate().for_each(|(z, bits)| {
            let z = bounds.min.z + z as i32;
            if !(inside.min.z..inside.max.z).contains(&z) {
                return;
            }
            for y in inside.min.y..inside.max.y {
                let mut x = inside.min.x;
                while x < inside.max.x {
                    let end = (x / edge * edge + edge).min(inside.max.x);
                    let b = IVec3::new(x, y, z).as_uvec3() / BRICK_EDGE_VX;
                    let at = ((y - bounds.min.y) as usize) * row + (x - bounds.min.x) as usize;
                    match grid.brick_kind(grid.brick_index(b)) {
                        BrickKind::Empty => {}
                        BrickKind::Full => bits[at..at + (end - x) as usize].fill(1),
                        BrickKind::Mixed => {
                            let brick = grid.brick(b);
                            for (place, bit) in
                                bits[at..at + (end - x) as usize].iter_mut().enumerate()
                            {
                                let local = (x + place as i32) % edge;
                                *bit = u8::from(brick.get(
                                    local as u32,
                                    (y % edge) as u32,
                                    (z % edge) as u32,
                                ));
                            }
                        }
                    }
                    x = end;
                }
            }
        });
        let mut once: Vec<i16> = bits.par_iter().map(|bit| 2 * HALF * i16::from(*bit)).collect();
        let mut spare = vec![0; once.len()];
        smooth(&mut once, &mut spare, size);
        let mut values = once.clone();
        smooth(&mut values, &mut spare, size);
        values.par_iter_mut().zip(&once).for_each(|(twice, once)| {
            *twice = ((9 * i32::from(*once) - 5 * i32::from(*twice)) / 4) as i16;
        });
        let level = Level::new();
        values.par_chunks_mut(layer.max(1)).enumerate().for_each(|(z, values)| {
            let mut thin = vec![0; row];
            for (y, values) in values.chunks_exact_mut(row.max(1)).enumerate() {
                let at = z * layer + y * row;
                dispatch!(level, simd => clear(simd, &bits, at, [row, layer], &mut thin, values));
            }
        });
        SmoothedBits { min: bounds.min, size, values }
    }

    /// Returns whether clay exists at `offset`, in units of 1 / [`FINE`] voxel, from the centre of `v`, and the nearest
    /// existing voxel to that point; of equally near ones the one on the side of `v`.
    pub fn sample(&self, v: UVec3, offset: IVec3) -> (bool, UVec3) {
        let whole = offset.div_euclid(IVec3::splat(FINE));
        let share = offset - whole * FINE;
        let first = v.as_ivec3() + whole;
        let local = first - self.min;
        if local.cmplt(IVec3::ZERO).any() || (local + 1).cmpge(self.size.as_ivec3()).any() {
            return (false, v);
        }
        let (row, layer) = (self.size.x as usize, (self.size.x * self.size.y) as usize);
        let [x, y, z] = local.to_array().map(|v| v as usize);
        let at = x + y * row + z * layer;
        let mut inside = 0;
        for corner in 0..8usize {
            let [cx, cy, cz] = [corner & 1, corner >> 1 & 1, corner >> 2];
            inside += usize::from(self.values[at + cx + cy * row + cz * layer] > HALF);
        }
        if inside == 0 {
            return (false, v);
        }
        let from_above = offset.cmplt(IVec3::ZERO).bitmask() as usize;
        if inside == 8 {
            let mut nearest = first;
            for axis in 0..3 {
                let above = 2 * share[axis] + i32::from(offset[axis] < 0) > FINE;
                nearest[axis] += i32::from(above);
            }
            return (true, nearest.as_uvec3());
        }
        let (mut sum, mut largest, mut nearest) = (0i64, 0, None);
        for corner in (0..8usize).map(|corner| corner ^ from_above) {
            let [cx, cy, cz] = [corner & 1, corner >> 1 & 1, corner >> 2];
            let along = |c: usize, share: i32| i64::from(if c == 1 { share } else { FINE - share });
            let weight = along(cx, share.x) * along(cy, share.y) * along(cz, share.z);
            let value = self.values[at + cx + cy * row + cz * layer];
            sum += weight * i64::from(value);
            if value > HALF && weight > largest {
                largest = weight;
                nearest = Some(first + IVec3::new(cx as i32, cy as i32, cz as i32));
            }
        }
        let half = i64::from(FINE).pow(3) * i64::from(HALF);
        match nearest {
            Some(nearest) if sum > half => (true, nearest.as_uvec3()),
            _ => (false, v),
        }
    }
}

/// Moves the values of the row of voxels from `at` on away from [`HALF`], to the side of their bits. `thin` is scratch
/// memory for a row.
#[inline(always)]
fn clear<S: Simd>(
    _simd: S,
    bits: &[u8],
    at: usize,
    [row, layer]: [usize; 2],
    thin: &mut [u8],
    values: &mut [i16],
) {
    let here = &bits[at..at + row];
    thin.fill(0);
    for (i, pair) in here.windows(3).enumerate() {
        thin[i + 1] = (pair[0] ^ pair[1]) & (pair[2] ^ pair[1]);
    }
    for stride in [row, layer] {
        if at < stride || at + stride + row > bits.len() {
            continue;
        }
        let (before, after) = (&bits[at - stride..][..row], &bits[at + stride..][..row]);
        for i in 0..row {
            thin[i] |= (before[i] ^ here[i]) & (after[i] ^ here[i]);
        }
    }
    for i in 0..row {
        let clear = CLEAR + (THIN - CLEAR) * i16::from(thin[i]);
        let value = values[i];
        values[i] = if here[i] != 0 { value.max(HALF + clear) } else { value.min(HALF - clear) };
    }
}

/// Replaces `values` by their means with weights 1-4-6-4-1 along each axis; values beyond the ends are 0.
fn smooth(values: &mut Vec<i16>, spare: &mut Vec<i16>, size: UVec3) {
    let (row, layer) = (size.x as usize, (size.x * size.y) as usize);
    let level = Level::new();
    // 1-2-1 twice along each axis.
    for (axis, stride) in [(0, 1), (0, 1), (1, row), (1, row), (2, layer), (2, layer)] {
        let from = &*values;
        spare.par_chunks_mut(layer.max(1)).enumerate().for_each(|(z, out)| {
            for (y, out) in out.chunks_exact_mut(row).enumerate() {
                let start = z * layer + y * row;
                let (place, end) = if axis == 1 { (y, size.y) } else { (z, size.z) };
                let ends = [place == 0, place + 1 == end as usize];
                dispatch!(level, simd => match axis {
                    0 => smooth_along(simd, &from[start..start + row], out),
                    _ => smooth_across(simd, from, start, stride, ends, out),
                });
            }
        });
        std::mem::swap(values, spare);
    }
}

/// Computes the means of a row with weights 1-2-1 along it.
#[inline(always)]
fn smooth_along<S: Simd>(_simd: S, here: &[i16], out: &mut [i16]) {
    let last = here.len() - 1;
    for (out, three) in out[1.min(last)..].iter_mut().zip(here.windows(3)) {
        *out = (three[0] + 2 * three[1] + three[2] + 2) >> 2;
    }
    let at = |i: usize| here.get(i).copied().unwrap_or(0);
    out[0] = (2 * at(0) + at(1) + 2) >> 2;
    if last > 0 {
        out[last] = (at(last - 1) + 2 * at(last) + 2) >> 2;
    }
}

/// Computes the means across rows: of the row from `start` on and those `stride` before and after it, except at `ends`.
#[inline(always)]
fn smooth_across<S: Simd>(
    _simd: S,
    from: &[i16],
    start: usize,
    stride: usize,
    ends: [bool; 2],
    out: &mut [i16],
) {
    let row = out.len();
    let here = &from[start..start + row];
    // Values that do not count are multiplied by 0.
    let before = if ends[0] { here } else { &from[start - stride..][..row] };
    let after = if ends[1] { here } else { &from[start + stride..][..row] };
    let [low, high] = ends.map(|end| i16::from(!end));
    for i in 0..row {
        out[i] = (before[i] * low + 2 * here[i] + after[i] * high + 2) >> 2;
    }
}
