//! How far voxels are from the nearest voxel of a block of bits, up to a reach.
//!
//! From bits to squared distances between middles of voxels, exactly: the minimum of parabolas one axis after the other
//! (P. Felzenszwalb, D. Huttenlocher, Distance Transforms of Sampled Functions, 2012), of which a short reach needs no
//! more than the few around each voxel. Knows no grid and no tool.

use fearless_simd::{Level, Simd, dispatch};
use glam::{IVec3, Vec3};
use rayon::prelude::*;

use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::region::VoxelBox;

/// Squared distances from the middles of the voxels of a box, x fastest, then y, then z.
pub struct Distances {
    bounds: VoxelBox,
    reach: f32,
    squared: Vec<f32>,
}

/// What is farther than the reach.
pub const FAR: f32 = 1e12;

impl Distances {
    /// To the nearest voxel of `block` that exists (`set`) or does not, along each axis at most `reach` away. A voxel
    /// is `edges` long. What lies outside the block does not exist.
    pub fn new(
        block: &BitBlock,
        set: bool,
        bounds: VoxelBox,
        reach: f32,
        edges: Vec3,
    ) -> Distances {
        let steps = (Vec3::splat(reach) / edges).ceil().as_ivec3();
        let size = bounds.size().as_ivec3();
        let level = Level::new();
        let row = size.x.max(0) as usize;
        // Along x, in all rows that are within reach.
        let wide = size + IVec3::new(0, 2 * steps.y, 2 * steps.z);
        let first = bounds.min - IVec3::new(0, steps.y, steps.z);
        let mut along = vec![FAR; row * (wide.y * wide.z).max(0) as usize];
        let layer = (row * wide.y as usize).max(1);
        along.par_chunks_mut(layer).enumerate().for_each(|(z, rows)| {
            for (y, out) in rows.chunks_exact_mut(row.max(1)).enumerate() {
                let at = first + IVec3::new(0, y as i32, z as i32);
                nearest_in_row(block, set, at, steps.x, edges.x, out);
            }
        });
        // Across y, then across z.
        let mut across = vec![FAR; row * (size.y * wide.z).max(0) as usize];
        across.par_chunks_mut((row * size.y as usize).max(1)).enumerate().for_each(|(z, rows)| {
            for (y, out) in rows.chunks_exact_mut(row.max(1)).enumerate() {
                let start = z * layer + y * row;
                dispatch!(level, simd => lowest(simd, &along, start, row, steps.y, edges.y, out));
            }
        });
        let layer = (row * size.y as usize).max(1);
        let mut squared = vec![FAR; layer * size.z.max(0) as usize];
        squared.par_chunks_mut(layer).enumerate().for_each(|(z, out)| {
            let start = z * layer;
            dispatch!(level, simd => lowest(simd, &across, start, layer, steps.z, edges.z, out));
        });
        Distances { bounds, reach, squared }
    }

    /// The squared distances of a row, which must lie in the box.
    pub fn row(&self, y: i32, z: i32) -> &[f32] {
        let size = self.bounds.size();
        let (y, z) = ((y - self.bounds.min.y) as usize, (z - self.bounds.min.z) as usize);
        let start = (y + z * size.y as usize) * size.x as usize;
        &self.squared[start..start + size.x as usize]
    }

    /// The same from a voxel on.
    pub fn row_from(&self, v: IVec3) -> &[f32] {
        &self.row(v.y, v.z)[(v.x - self.bounds.min.x) as usize..]
    }

    /// Of a voxel, or the nearest one in the box.
    pub fn near(&self, v: IVec3) -> f32 {
        let v = v.clamp(self.bounds.min, self.bounds.max - 1);
        self.row(v.y, v.z)[(v.x - self.bounds.min.x) as usize]
    }

    /// The distance less half of an edge, where the surface is, at `offset` (in voxels) from the middle of `v`,
    /// interpolated; what is beyond the reach counts as there. What is mirrored about `v` gives the same to the bit.
    pub fn at(&self, v: IVec3, offset: Vec3) -> f32 {
        let whole = offset.trunc();
        let share = (offset - whole).abs().to_array();
        let first = v + whole.as_ivec3();
        let step = offset.signum().as_ivec3();
        let mut sum = 0.0;
        for corner in 0..8 {
            let beside = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let mut weight = 1.0;
            for (axis, share) in share.into_iter().enumerate() {
                weight *= if beside[axis] == 1 { share } else { 1.0 - share };
            }
            if weight > 0.0 {
                let away = self.near(first + step * beside).sqrt().min(self.reach);
                sum += weight * (away - 0.5);
            }
        }
        sum
    }
}

/// Squared distances within a row, from the voxel `at` on: what lies between two runs of what is looked for is as far as
/// from the nearer one.
fn nearest_in_row(block: &BitBlock, set: bool, at: IVec3, steps: i32, edge: f32, out: &mut [f32]) {
    let local = at - block.origin();
    let row = block.row(local.y, local.z).unwrap_or(&[]);
    // Counted from the block's origin; what is outside does not exist.
    let width = if row.is_empty() { 0 } else { block.size().x as i32 };
    let (first, len) = (local.x, out.len() as i32);
    let (start, end) = (first - steps, first + len + steps);
    let mut last = None;
    let mut x = start;
    while x < end {
        let found = next(row, width, x, end, set);
        // The part of the row between the last run and this one.
        let (low, high) = (x.max(first), found.min(first + len));
        if low < high {
            let gap = &mut out[(low - first) as usize..(high - first) as usize];
            let before = last.map_or(f32::INFINITY, |last: i32| (low - last) as f32);
            let after = if found < end { (found - low) as f32 } else { f32::INFINITY };
            for (i, out) in gap.iter_mut().enumerate() {
                let nearest = (before + i as f32).min(after - i as f32);
                *out = square(nearest * edge).min(FAR);
            }
        }
        x = next(row, width, found, end, !set);
        let (low, high) = (found.max(first), x.min(first + len));
        if low < high {
            out[(low - first) as usize..(high - first) as usize].fill(0.0);
        }
        last = Some(x - 1);
    }
}

/// The first voxel of a row from `x` on that exists (`set`) or does not, or `end`. Only `width` voxels of it can exist.
fn next(row: &[u64], width: i32, mut x: i32, end: i32, set: bool) -> i32 {
    while x < end {
        if x < 0 || x >= width {
            if !set {
                return x;
            }
            x = if x < 0 { 0 } else { end };
            continue;
        }
        let word = row[x as usize / 64];
        let left = if set { word } else { !word } >> (x % 64);
        if left != 0 {
            // Bits behind the width do not exist.
            return (x + left.trailing_zeros() as i32).min(end);
        }
        x = (x / 64 + 1) * 64;
    }
    end
}

fn square(v: f32) -> f32 {
    v * v
}

/// The lowest of the parabolas that stand `stride` apart in `from`, the first of them at `start`.
#[inline(always)]
fn lowest<S: Simd>(
    _simd: S,
    from: &[f32],
    start: usize,
    stride: usize,
    steps: i32,
    edge: f32,
    out: &mut [f32],
) {
    for i in 0..=2 * steps {
        let rise = (i - steps) as f32 * edge;
        let rise = rise * rise;
        let from = &from[start + i as usize * stride..][..out.len()];
        for x in 0..out.len() {
            out[x] = out[x].min(from[x] + rise);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

        #[test]
        fn distances_equal_the_definition(
            seed in 0u32..10_000,
            set in any::<bool>(),
            reach in 1.0f32..5.0,
            edges in prop::array::uniform3(1.0f32..2.0),
            from in prop::array::uniform3(-3i32..4),
        ) {
            let edges = Vec3::from(edges);
            let mut block = BitBlock::empty(IVec3::splat(0), IVec3::splat(16));
            let exists = |v: IVec3| {
                let inside = v.cmpge(IVec3::ZERO).all() && v.cmplt(IVec3::splat(16)).all();
                let hash = ((v.x * 7 + v.y * 131 + v.z * 1741) as u32).wrapping_add(seed);
                inside && hash.wrapping_mul(2_654_435_761) >> 28 < 1 + seed % 15
            };
            let all = |size: i32| (0..size * size * size)
                .map(move |i| IVec3::new(i % size, i / size % size, i / size / size));
            for v in all(16).filter(|v| exists(*v)) {
                block.set_span(v.x, v.x, v.y, v.z);
            }
            prop_assert_eq!(block.count() as usize, all(16).filter(|v| exists(*v)).count());
            let bounds = VoxelBox { min: from.into(), max: IVec3::from(from) + 9 };
            let distances = Distances::new(&block, set, bounds, reach, edges);
            for v in all(9).map(|v| v + bounds.min) {
                let meant = all(13)
                    .map(|step| step - 6)
                    .filter(|step| exists(v + step) == set)
                    .map(|step| (step.as_vec3() * edges).length_squared())
                    .fold(FAR, f32::min);
                let found = distances.near(v);
                if meant <= reach * reach {
                    prop_assert!((found - meant).abs() < 1e-3, "{}: {} {}", v, found, meant);
                } else {
                    prop_assert!(found > reach * reach - 1e-3, "{}: {}", v, found);
                }
            }
        }
    }
}
