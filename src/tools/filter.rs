//! Owns the neighbourhood filters on blocks of bits: counting the 26 neighbours, erosion,
//! dilation, growth into concave corners, and smoothing by majority.
//!
//! Takes the block of existing voxels and the block of voxels that may change (same place and
//! size); gives the voxels to add or to remove. Voxels near the block's border miss neighbours,
//! so the block must reach further than the voxels that may change (by one voxel, or by the
//! radius of the majority).
//! Knows no tool and no document.
//!
//! Counting is done for 64 voxels at once in bit planes: 26 shifted rows are summed by ripple
//! carry adders of single-bit planes (Knuth, The Art of Computer Programming 4A, 7.1.3).

use crate::sculpture::bit_block::BitBlock;

/// Bit planes of a count from 0 to 31, for 64 voxels.
#[derive(Clone, Copy, Default)]
struct Count {
    planes: [u64; 5],
}

impl Count {
    #[inline(always)]
    fn add(&mut self, mut carry: u64) {
        for plane in &mut self.planes {
            let sum = *plane ^ carry;
            carry &= *plane;
            *plane = sum;
        }
    }

    /// The voxels whose count is at least `least` (0 to 31).
    #[inline(always)]
    fn at_least(&self, least: u32) -> u64 {
        // Compare from the highest plane down: greater, or equal so far.
        let (mut greater, mut equal) = (0u64, u64::MAX);
        for bit in (0..5).rev() {
            let plane = self.planes[bit];
            if least >> bit & 1 != 0 {
                equal &= plane;
            } else {
                greater |= equal & plane;
                equal &= !plane;
            }
        }
        greater | equal
    }
}

/// A row of the block moved by one voxel along x, 64 voxels of it.
#[inline(always)]
fn shifted(row: &[u64], word: usize) -> [u64; 3] {
    let here = row[word];
    let before = if word > 0 { row[word - 1] } else { 0 };
    let after = row.get(word + 1).copied().unwrap_or(0);
    [here << 1 | before >> 63, here, here >> 1 | after << 63]
}

/// The voxels of `block` (existing or not) that have at least `least` of their 26 neighbours.
pub fn with_neighbours(block: &BitBlock, least: u32) -> BitBlock {
    block.map_rows(|y, z, out| {
        for (word, bits) in out.iter_mut().enumerate() {
            let mut count = Count::default();
            for dz in -1..=1 {
                for dy in -1..=1 {
                    let Some(row) = block.row(y + dy, z + dz) else { continue };
                    let [left, here, right] = shifted(row, word);
                    count.add(left);
                    count.add(right);
                    if (dy, dz) != (0, 0) {
                        count.add(here);
                    }
                }
            }
            *bits = count.at_least(least);
        }
    })
}

/// Existing voxels of `may` with fewer than `threshold` of their 26 neighbours: to be removed.
///
/// A voxel of a plane has 17, of a straight edge 11, of a corner 7: thresholds from 12 to 17
/// leave planes alone and take edges; up to 7 take only what sticks out.
pub fn erosion(solid: &BitBlock, may: &BitBlock, threshold: u32) -> BitBlock {
    let keep = with_neighbours(solid, threshold);
    solid.zip(&keep, |s, k| s & !k).zip(may, |r, m| r & m)
}

/// Empty voxels of `may` with at least `threshold` of their 26 neighbours: to be added.
///
/// A voxel on a plane has 9, in a straight concave edge 15: thresholds of 10 and more leave
/// planes alone.
pub fn dilation(solid: &BitBlock, may: &BitBlock, threshold: u32) -> BitBlock {
    let touched = with_neighbours(solid, threshold);
    touched.zip(solid, |t, s| t & !s).zip(may, |r, m| r & m)
}

/// Dilation again and again, until nothing is added any more: fills concave corners up to a
/// closed surface. At most `rounds` times.
pub fn growth(solid: &BitBlock, may: &BitBlock, threshold: u32, rounds: u32) -> BitBlock {
    let mut grown = solid.clone();
    for _ in 0..rounds {
        let added = dilation(&grown, may, threshold);
        if added.count() == 0 {
            break;
        }
        grown = grown.zip(&added, |g, a| g | a);
    }
    grown.zip(solid, |g, s| g & !s)
}

/// What a majority filter changes: `(added, removed)`. A voxel takes the value that most voxels
/// of the cube reaching `radius_vx` around it have, itself included; so planes stay as they are.
pub fn majority(solid: &BitBlock, may: &BitBlock, radius_vx: u32) -> (BitBlock, BitBlock) {
    let size = solid.size().as_usizevec3();
    let reach = radius_vx as usize;
    // Box sums, one axis after the other, on a count a voxel.
    let mut counts = vec![0u16; size.element_product()];
    for z in 0..size.z {
        for y in 0..size.y {
            if let Some(row) = solid.row(y as i32, z as i32) {
                let line = &mut counts[(y + z * size.y) * size.x..][..size.x];
                for (x, count) in line.iter_mut().enumerate() {
                    *count = (row[x / 64] >> (x % 64) & 1) as u16;
                }
            }
        }
    }
    let mut line = Vec::new();
    for (length, stride) in [(size.x, 1), (size.y, size.x), (size.z, size.x * size.y)] {
        for start in (0..counts.len()).filter(|i| i / stride % length == 0) {
            box_sum(&mut counts[start..], length, stride, reach, &mut line);
        }
    }
    let half = ((2 * radius_vx + 1).pow(3) / 2) as u16;
    let most = solid.map_rows(|y, z, out| {
        let line = &counts[(y as usize + z as usize * size.y) * size.x..][..size.x];
        for (x, &count) in line.iter().enumerate() {
            out[x / 64] |= u64::from(count > half) << (x % 64);
        }
    });
    let added = most.zip(solid, |m, s| m & !s).zip(may, |r, m| r & m);
    let removed = solid.zip(&most, |s, m| s & !m).zip(may, |r, m| r & m);
    (added, removed)
}

/// Replaces `length` values, `stride` apart, by their sums over `reach` values on either side.
fn box_sum(values: &mut [u16], length: usize, stride: usize, reach: usize, line: &mut Vec<u16>) {
    line.clear();
    line.extend((0..length).map(|i| values[i * stride]));
    let mut sum: u16 = line.iter().take(reach).sum();
    for i in 0..length {
        sum += line.get(i + reach).copied().unwrap_or(0);
        if i > reach {
            sum -= line[i - reach - 1];
        }
        values[i * stride] = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::Grid;
    use glam::{IVec3, UVec3, Vec3};
    use proptest::prelude::*;

    const MIN: IVec3 = IVec3::ZERO;
    const MAX: IVec3 = IVec3::new(80, 24, 24);

    fn all() -> BitBlock {
        let mut block = BitBlock::empty(MIN, MAX);
        for z in MIN.z..MAX.z {
            for y in MIN.y..MAX.y {
                block.set_span(MIN.x, MAX.x, y, z);
            }
        }
        block
    }

    /// What may change without seeing the block's border.
    fn inner(margin: i32) -> BitBlock {
        let mut block = BitBlock::empty(MIN, MAX);
        for z in MIN.z + margin..MAX.z - margin {
            for y in MIN.y + margin..MAX.y - margin {
                block.set_span(MIN.x + margin, MAX.x - margin - 1, y, z);
            }
        }
        block
    }

    fn cuboid(min: IVec3, max: IVec3) -> BitBlock {
        let mut block = BitBlock::empty(MIN, MAX);
        for z in min.z..max.z {
            for y in min.y..max.y {
                block.set_span(min.x, max.x - 1, y, z);
            }
        }
        block
    }

    fn random(seed: u64, per_mille: u64) -> BitBlock {
        let mut grid = Grid::new(MAX.as_uvec3(), Vec3::ONE, 1 << 30).unwrap();
        let mut state = seed | 1;
        grid_fill(&mut grid, || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) % 1000 < per_mille
        });
        BitBlock::of_grid(&grid, MIN, MAX)
    }

    fn grid_fill(grid: &mut Grid, mut on: impl FnMut() -> bool) {
        for i in 0..grid.dims().element_product() {
            let v = grid.voxel_coords(i).as_ivec3();
            grid.set(v, on());
        }
    }

    fn naive_count(block: &BitBlock, v: IVec3, reach: i32) -> u32 {
        let mut count = 0;
        for z in -reach..=reach {
            for y in -reach..=reach {
                for x in -reach..=reach {
                    count += u32::from(block.get(v + IVec3::new(x, y, z)));
                }
            }
        }
        count
    }

    fn voxels() -> impl Iterator<Item = IVec3> {
        let size = MAX.as_uvec3();
        (0..size.element_product()).map(move |i| {
            UVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y).as_ivec3()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn counts_equal_a_naive_count(seed: u64, per_mille in 0u64..1000, least in 0u32..27) {
            let block = random(seed, per_mille);
            let counted = with_neighbours(&block, least);
            for v in voxels() {
                let count = naive_count(&block, v, 1) - u32::from(block.get(v));
                prop_assert_eq!(counted.get(v), count >= least, "{}: {}", v, count);
            }
        }

        #[test]
        fn majority_equals_a_naive_majority(seed: u64, per_mille in 300u64..700, radius in 1u32..4) {
            let block = random(seed, per_mille);
            let (added, removed) = majority(&block, &all(), radius);
            let volume = (2 * radius + 1).pow(3);
            for v in voxels() {
                let most = naive_count(&block, v, radius as i32) * 2 > volume;
                prop_assert_eq!(added.get(v), most && !block.get(v));
                prop_assert_eq!(removed.get(v), !most && block.get(v));
            }
        }

        #[test]
        fn growth_only_adds_and_ends_closed(seed: u64, per_mille in 100u64..800) {
            let block = random(seed, per_mille);
            let added = growth(&block, &all(), 12, 1000);
            prop_assert_eq!(added.zip(&block, |a, b| a & b).count(), 0);
            let grown = block.zip(&added, |b, a| b | a);
            prop_assert_eq!(dilation(&grown, &all(), 12).count(), 0);
        }

        #[test]
        fn dilation_then_erosion_keeps_a_box(
            min in prop::array::uniform3(3i32..10), size in prop::array::uniform3(1i32..9),
        ) {
            let min = IVec3::from(min);
            let solid = cuboid(min, min + IVec3::from(size));
            let wider = solid.zip(&dilation(&solid, &all(), 1), |a, b| a | b);
            let back = wider.zip(&erosion(&wider, &all(), 26), |a, b| a & !b);
            prop_assert_eq!(back, solid);
        }
    }

    #[test]
    fn every_filter_leaves_a_plane_alone() {
        let half = cuboid(MIN, IVec3::new(MAX.x, 12, MAX.z));
        for threshold in 12..=17 {
            assert_eq!(erosion(&half, &inner(1), threshold).count(), 0);
        }
        for threshold in 10..=26 {
            assert_eq!(dilation(&half, &inner(1), threshold).count(), 0);
            assert_eq!(growth(&half, &inner(1), threshold, 100).count(), 0);
        }
        for radius in 1..4 {
            let (added, removed) = majority(&half, &inner(radius as i32), radius);
            assert_eq!((added.count(), removed.count()), (0, 0));
        }
    }

    #[test]
    fn erosion_takes_single_voxels_and_edges() {
        let single = cuboid(IVec3::splat(8), IVec3::splat(9));
        assert_eq!(erosion(&single, &all(), 1).count(), 1);
        let solid = cuboid(IVec3::splat(6), IVec3::splat(16));
        // 12 edges of 8 voxels and 8 corners.
        assert_eq!(erosion(&solid, &all(), 12).count(), 12 * 8 + 8);
    }

    #[test]
    fn growth_fills_a_concave_edge_until_it_is_closed() {
        let floor = cuboid(MIN, IVec3::new(MAX.x, 8, MAX.z));
        let wall = cuboid(MIN, IVec3::new(MAX.x, MAX.y, 8));
        let corner = floor.zip(&wall, |a, b| a | b);
        let added = growth(&corner, &inner(2), 12, 1000);
        assert!(added.get(IVec3::new(40, 8, 8)), "the edge itself is filled");
        assert!(!added.get(IVec3::new(40, 12, 20)), "the open room is not");
        assert!(added.count() > 0);
    }
}
