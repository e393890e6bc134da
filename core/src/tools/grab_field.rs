//! The smoothed existence bits that pulls at clay look up.
//!
//! From the bits of a box of a grid to values between voxels, and the voxel that a place belongs to. Knows no tool.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, BrickKind};
use crate::sculpture::region::VoxelBox;

/// Existence bits smoothed by (9 B - 5 B^2) / 4, where B is the binomial filter 1-4-6-4-1 along each axis. Its second
/// moment makes up for that of the interpolation, so that curved surfaces stay where they are. 0 to 4096 and a little beyond, above [`HALF`] exactly where a voxel
/// exists, so that what does not move does not change.
pub struct Field {
    min: IVec3,
    size: UVec3,
    values: Vec<i16>,
}

/// Places to a voxel that sources are told apart by.
pub const FINE: i32 = 1 << 10;
/// What the filter reaches, and a voxel for the interpolation.
pub const MARGIN_VX: i32 = 5;
/// Half of the filter's sum.
const HALF: i16 = 2048;
/// Least difference of a voxel's value from [`HALF`].
const CLEAR: i16 = 128;
/// The same for walls and gaps of a single voxel, which else would close or open where they move by a part of one.
const THIN: i16 = 1024;

impl Field {
    /// Of a box that may reach beyond the grid, where nothing exists.
    pub fn new(grid: &Grid, bounds: VoxelBox) -> Field {
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
        values.par_chunks_mut(layer.max(1)).enumerate().for_each(|(z, values)| {
            let bits_at = |i: isize| usize::try_from(i).ok().and_then(|i| bits.get(i)).copied();
            for (i, value) in values.iter_mut().enumerate() {
                let here = z * layer + i;
                let bit = bits[here];
                let other = |stride: isize| bits_at(here as isize + stride) == Some(1 - bit);
                let thin =
                    [1, row as isize, layer as isize].into_iter().any(|s| other(s) && other(-s));
                let clear = if thin { THIN } else { CLEAR };
                *value = match bit {
                    1 => (*value).max(HALF + clear),
                    _ => (*value).min(HALF - clear),
                };
            }
        });
        Field { min: bounds.min, size, values }
    }

    /// Whether something exists at `offset`, in units of 1 / [`FINE`] voxel, from the middle of `v`; and the voxel
    /// nearest to there that does, of equally near ones that on the side of `v`.
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
        let from_above = offset.cmplt(IVec3::ZERO).bitmask() as usize;
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

/// Replaces `values` by their means with weights 1-4-6-4-1 along each axis; nothing lies beyond the ends.
fn smooth(values: &mut Vec<i16>, spare: &mut Vec<i16>, size: UVec3) {
    let (row, layer) = (size.x as usize, (size.x * size.y) as usize);
    // 1-2-1 twice along each axis.
    for (axis, stride) in [(0, 1), (0, 1), (1, row), (1, row), (2, layer), (2, layer)] {
        let from = &*values;
        spare.par_chunks_mut(layer.max(1)).enumerate().for_each(|(z, out)| {
            for (y, out) in out.chunks_mut(row).enumerate() {
                let start = z * layer + y * row;
                let here = &from[start..start + row];
                if axis == 0 {
                    for (x, out) in out.iter_mut().enumerate() {
                        let before = if x == 0 { 0 } else { here[x - 1] };
                        *out = (before + 2 * here[x] + here.get(x + 1).unwrap_or(&0) + 2) >> 2;
                    }
                    continue;
                }
                out.iter_mut().zip(here).for_each(|(out, here)| *out = 2 * here);
                let (place, end) = if axis == 1 { (y, size.y) } else { (z, size.z) };
                let mut add = |at: usize| {
                    out.iter_mut().zip(&from[at..at + row]).for_each(|(out, other)| *out += other);
                };
                if place > 0 {
                    add(start - stride);
                }
                if place + 1 < end as usize {
                    add(start + stride);
                }
                out.iter_mut().for_each(|out| *out = (*out + 2) >> 2);
            }
        });
        std::mem::swap(values, spare);
    }
}
