//! Distance transform: the distance of voxels from the nearest voxel of a block of bits, up to a reach.
//!
//! From bits to exact squared distances between voxel centres: the lower envelope of parabolas, one axis after the
//! other (P. Felzenszwalb, D. Huttenlocher, Distance Transforms of Sampled Functions, 2012). A short reach needs only
//! the few parabolas around each voxel. Knows no grid and no tool.

use fearless_simd::{Level, Simd, dispatch};
use glam::{IVec3, Vec3};
use rayon::prelude::*;

use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::region::VoxelBox;

/// Squared distances from the centres of the voxels of a box, x fastest, then z, then y.
pub struct Distances {
    bounds: VoxelBox,
    reach: f32,
    /// Length of a row; numbers beyond the box are meaningless.
    row: usize,
    squared: Vec<f32>,
}

/// Row lengths are multiples of this, so that no voxel is computed alone.
const LANES: usize = 16;

/// The squared distance that represents all distances beyond the reach.
pub const FAR: f32 = 1e12;

impl Distances {
    /// Returns the distances to the nearest voxel of `block` that exists (`set`) or does not, at most `reach` away
    /// along each axis. A voxel is `edges` long. Nothing exists outside the block.
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
        let width = size.x.max(0) as usize;
        let row = width.next_multiple_of(LANES);
        let wide = size + IVec3::new(0, 2 * steps.y, 2 * steps.z);
        let first = bounds.min - IVec3::new(0, steps.y, steps.z);
        let rises = |steps: i32, edge: f32| (0..=steps).map(|i| square(i as f32 * edge)).collect();
        let (rises_y, rises_z): (Vec<f32>, Vec<f32>) =
            (rises(steps.y, edges.y), rises(steps.z, edges.z));
        let layer = row * size.y.max(0) as usize;
        // Along x and across y, in all layers within reach; then across z, for all layers of one y.
        let mut layers = vec![0.0; layer * wide.z.max(0) as usize];
        let of_z = layers.par_chunks_mut(layer.max(1)).enumerate();
        of_z.for_each_init(Vec::new, |along, (z, out)| {
            along.resize(row * wide.y as usize, FAR);
            for (y, out) in along.chunks_exact_mut(row.max(1)).enumerate() {
                let at = first + IVec3::new(0, y as i32, z as i32);
                nearest_in_row(block, set, at, steps.x, edges.x, &mut out[..width]);
            }
            dispatch!(level, simd => lowest(simd, along, row, &rises_y, out));
        });
        let column = row * size.z.max(0) as usize;
        let mut squared = vec![0.0; column * size.y.max(0) as usize];
        let of_y = squared.par_chunks_mut(column.max(1)).enumerate();
        of_y.for_each_init(Vec::new, |across, (y, out)| {
            across.clear();
            for layer in layers.chunks_exact(layer.max(1)) {
                across.extend_from_slice(&layer[y * row..][..row]);
            }
            dispatch!(level, simd => lowest(simd, across, row, &rises_z, out));
        });
        Distances { bounds, reach, row, squared }
    }

    /// Returns the squared distances of a row, which must lie in the box.
    pub fn row(&self, y: i32, z: i32) -> &[f32] {
        let size = self.bounds.size();
        let (y, z) = ((y - self.bounds.min.y) as usize, (z - self.bounds.min.z) as usize);
        let start = (z + y * size.z as usize) * self.row;
        &self.squared[start..start + size.x as usize]
    }

    /// Returns the squared distances of a row from a voxel on.
    pub(crate) fn row_from(&self, v: IVec3) -> &[f32] {
        &self.row(v.y, v.z)[(v.x - self.bounds.min.x) as usize..]
    }

    /// Returns the squared distance of a voxel, or of the nearest one in the box.
    pub fn near(&self, v: IVec3) -> f32 {
        let v = v.clamp(self.bounds.min, self.bounds.max - 1);
        self.row(v.y, v.z)[(v.x - self.bounds.min.x) as usize]
    }

    /// Returns the distance less half an edge, where the surface is, at `offset` (in voxels) from the centre of `v`,
    /// interpolated. Distances beyond the reach count as the reach. Positions that mirror each other about `v` give
    /// bitwise equal results.
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

/// Computes squared distances within a row, from the voxel `at` on. A voxel between two runs of target voxels takes the
/// distance to the nearer run.
fn nearest_in_row(block: &BitBlock, set: bool, at: IVec3, steps: i32, edge: f32, out: &mut [f32]) {
    let local = at - block.origin();
    let row = block.row(local.y, local.z).unwrap_or(&[]);
    // Relative to the block's origin; nothing exists outside.
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
                let nearest = lesser(before + i as f32, after - i as f32);
                *out = lesser(square(nearest * edge), FAR);
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

/// Returns the first voxel of a row from `x` on that exists (`set`) or does not, or `end`. Only `width` voxels of it
/// can exist.
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
            // Bits beyond the width do not exist.
            return (x + left.trailing_zeros() as i32).min(end);
        }
        x = (x / 64 + 1) * 64;
    }
    end
}

fn square(v: f32) -> f32 {
    v * v
}

/// Computes the lower envelope of the parabolas on rows of `row` numbers (a multiple of [`LANES`]), at each row of
/// `out`. `rises`: the rise of a parabola at each distance in rows. `from` has as many rows before the first of `out`,
/// and after the last, as there are `rises` after the first.
#[inline(always)]
fn lowest<S: Simd>(_simd: S, from: &[f32], row: usize, rises: &[f32], out: &mut [f32]) {
    let (from, _) = from.as_chunks::<LANES>();
    let (out, _) = out.as_chunks_mut::<LANES>();
    let row = row / LANES;
    let middle = (rises.len() - 1) * row;
    for (at, out) in (middle..).zip(out) {
        let mut least = from[at];
        let mut away = 0;
        for rises in rises[1..].chunks(4) {
            // From here on no parabola is low enough.
            if !least.iter().fold(false, |lower, v| lower | (*v > rises[0])) {
                break;
            }
            for rise in rises {
                away += row;
                let (before, behind) = (&from[at - away], &from[at + away]);
                for x in 0..LANES {
                    least[x] = lesser(least[x], lesser(before[x], behind[x]) + rise);
                }
            }
        }
        *out = least;
    }
}

/// Returns the lesser number, as `f32::min` does, in one instruction.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn long_rows_and_reaches_are_as_far_as_the_nearest_of_a_few_voxels() {
        let voxels =
            [[2, 3, 4], [37, 20, 9], [18, 31, 30], [19, 31, 30], [39, 0, 39]].map(IVec3::from);
        let mut block = BitBlock::empty(IVec3::ZERO, IVec3::splat(40));
        voxels.iter().for_each(|v| block.set_span(v.x, v.x, v.y, v.z));
        let edges = Vec3::new(1.0, 1.25, 1.5);
        for (width, reach) in [(1, 9.0), (15, 6.0), (16, 14.5), (17, 14.5), (40, 21.0)] {
            let bounds = VoxelBox { min: IVec3::new(-2, 7, 3), max: IVec3::new(width - 2, 33, 36) };
            let distances = Distances::new(&block, true, bounds, reach, edges);
            let size = bounds.size().as_ivec3();
            let mut near = 0;
            for i in 0..size.element_product() {
                let at = IVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y);
                let v = bounds.min + at;
                let away = |to: &IVec3| ((to - v).as_vec3() * edges).length_squared();
                let meant = voxels.iter().map(away).fold(FAR, f32::min);
                let found = distances.near(v);
                if meant <= reach * reach {
                    near += 1;
                    assert!((found - meant).abs() < 1e-3, "{v}: {found} {meant}");
                } else {
                    assert!(found > reach * reach - 1e-3, "{v}: {found}");
                }
            }
            assert!(near > 0, "{width}");
        }
    }

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
