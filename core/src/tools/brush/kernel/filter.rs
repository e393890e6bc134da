//! Neighbourhood filters on blocks of bits: counts of the 26 neighbours, erosion, dilation, growth into concave
//! corners, and smoothing by a majority filter.
//!
//! From the block of existing voxels and the block of voxels that may change (same position and size) to the voxels to
//! add or remove. Voxels near the block's border lack neighbours, so the block must extend beyond the voxels that may
//! change, by one voxel or by the radius of the majority filter. Knows no tool and no document.
//!
//! Counts are computed for 64 voxels at once in bit planes: 26 shifted rows are summed by ripple-carry adders of
//! single-bit planes (Knuth, The Art of Computer Programming 4A, 7.1.3).

use crate::sculpture::bit_block::BitBlock;

/// Number of planes of the largest count: the 17^3 voxels of the widest majority filter.
const MOST_PLANES: usize = 13;

/// Bit planes of a count for 64 voxels.
#[derive(Clone, Copy)]
struct Count<const PLANES: usize> {
    planes: [u64; PLANES],
}

impl<const PLANES: usize> Default for Count<PLANES> {
    fn default() -> Self {
        Count { planes: [0; PLANES] }
    }
}

impl<const PLANES: usize> Count<PLANES> {
    /// Increments the count of the voxels that are set.
    #[inline(always)]
    fn add(&mut self, mut carry: u64) {
        for plane in &mut self.planes {
            let sum = *plane ^ carry;
            carry &= *plane;
            *plane = sum;
        }
    }

    /// Adds counts. Only the lowest `planes` of the sum are kept.
    #[inline(always)]
    fn add_counts<const N: usize>(&mut self, other: &Count<N>, planes: usize) {
        let mut carry = 0;
        for (i, plane) in self.planes.iter_mut().enumerate().take(planes) {
            let (a, b) = (*plane, other.planes.get(i).copied().unwrap_or(0));
            *plane = a ^ b ^ carry;
            carry = a & b | carry & (a ^ b);
        }
    }

    /// Returns the voxels whose count is at least `least`. The planes must be able to hold `least`.
    #[inline(always)]
    fn at_least(&self, least: u32) -> u64 {
        // Compares from the highest plane down: greater, or equal so far.
        let (mut greater, mut equal) = (0u64, u64::MAX);
        for bit in (0..PLANES).rev() {
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

/// Returns 64 voxels of a row, read `by` voxels (less than 64) further along x; 0 beyond its ends.
#[inline(always)]
pub(super) fn shifted(row: &[u64], word: usize, by: i32) -> u64 {
    let here = row[word];
    match by {
        0 => here,
        1.. => here >> by | row.get(word + 1).copied().unwrap_or(0) << (64 - by),
        _ => here << -by | if word > 0 { row[word - 1] >> (64 + by) } else { 0 },
    }
}

/// Returns those of 64 voxels (existing or not) that have at least `least` of their 26 neighbours.
#[inline(always)]
fn word_with_neighbours(block: &BitBlock, y: i32, z: i32, word: usize, least: u32) -> u64 {
    let mut count = Count::<5>::default();
    for dz in -1..=1 {
        for dy in -1..=1 {
            let Some(row) = block.row(y + dy, z + dz) else { continue };
            count.add(shifted(row, word, -1));
            count.add(shifted(row, word, 1));
            if (dy, dz) != (0, 0) {
                count.add(row[word]);
            }
        }
    }
    count.at_least(least)
}

/// Calls `f` for each word that has voxels in `may`, in a block like `may`. Nothing is computed for the others.
fn map_words(may: &BitBlock, mut f: impl FnMut(i32, i32, usize, u64) -> u64) -> BitBlock {
    may.map_rows(|y, z, out| {
        let Some(row) = may.row(y, z) else { return };
        for (word, (bits, &may)) in out.iter_mut().zip(row).enumerate() {
            if may != 0 {
                *bits = f(y, z, word, may) & may;
            }
        }
    })
}

/// Returns a word of `block`.
#[inline(always)]
fn word_of(block: &BitBlock, y: i32, z: i32, word: usize) -> u64 {
    block.row(y, z).map_or(0, |row| row[word])
}

/// Returns the voxels to remove: existing voxels of `may` with fewer than `threshold` of their 26 neighbours.
///
/// A voxel of a plane has 17 neighbours, of a straight edge 11, of a corner 7. Thresholds from 12 to 17 preserve planes
/// and remove edges; thresholds up to 7 remove only protruding voxels.
pub fn erosion(solid: &BitBlock, may: &BitBlock, threshold: u32) -> BitBlock {
    map_words(may, |y, z, word, _| {
        word_of(solid, y, z, word) & !word_with_neighbours(solid, y, z, word, threshold)
    })
}

/// Returns the voxels to add: empty voxels of `may` with at least `threshold` of their 26 neighbours.
///
/// A voxel on a plane has 9 neighbours, in a straight concave edge 15. Thresholds of 10 and more preserve planes.
pub fn dilation(solid: &BitBlock, may: &BitBlock, threshold: u32) -> BitBlock {
    map_words(may, |y, z, word, _| {
        word_with_neighbours(solid, y, z, word, threshold) & !word_of(solid, y, z, word)
    })
}

/// Repeats dilation, at most `rounds` times, until it adds nothing. Fills concave corners up to a closed surface.
pub fn growth(solid: &BitBlock, may: &BitBlock, threshold: u32, rounds: u32) -> BitBlock {
    let rows_y = solid.size().y as usize;
    let row_count = rows_y * solid.size().z as usize;
    let mut grown = solid.clone();
    // Rows that the last round has added to. Only around them can more be added.
    let mut changed = vec![true; row_count];
    for _ in 0..rounds {
        let near = |y: i32, z: i32| {
            let (y, z) = (y as usize, z as usize);
            (z.saturating_sub(1)..=z + 1).any(|z| {
                (y.saturating_sub(1)..=y + 1)
                    .any(|y| y < rows_y && changed.get(y + z * rows_y).is_some_and(|c| *c))
            })
        };
        let mut next = vec![false; row_count];
        let added = map_words(may, |y, z, word, may| {
            let empty = may & !word_of(&grown, y, z, word);
            if empty == 0 || !near(y, z) {
                return 0;
            }
            let added = empty & word_with_neighbours(&grown, y, z, word, threshold);
            next[y as usize + z as usize * rows_y] |= added != 0;
            added
        });
        if !next.contains(&true) {
            break;
        }
        grown = grown.zip(&added, |g, a| g | a);
        changed = next;
    }
    grown.zip(solid, |g, s| g & !s)
}

/// Returns the changes of a majority filter: `(added, removed)`. At full `strength` (1) a voxel takes the value of most
/// voxels in the cube that reaches `radius_vx` (1 to 8) around it, itself included; planes therefore stay unchanged. At
/// less strength, that share of half of the cube is enough for a voxel to stay.
pub fn majority(
    solid: &BitBlock,
    may: &BitBlock,
    radius_vx: u32,
    strength: f32,
) -> (BitBlock, BitBlock) {
    let reach = radius_vx as i32;
    let volume = (2 * radius_vx + 1).pow(3);
    let minority = ((volume / 2) as f32 * strength.clamp(0.0, 1.0)) as u32;
    let (stays_from, added_from) = (minority + 1, volume - minority);
    let planes = (volume.ilog2() + 1) as usize;
    // Along x first, once for every word: the counts of rows are summed many times.
    let size = solid.size();
    let width = size.x.div_ceil(64) as usize;
    let mut along_x = vec![Count::<5>::default(); width * (size.y * size.z) as usize];
    let place = |y: i32, z: i32| (y as usize + z as usize * size.y as usize) * width;
    for z in 0..size.z as i32 {
        for y in 0..size.y as i32 {
            let Some(row) = solid.row(y, z).filter(|row| row.iter().any(|w| *w != 0)) else {
                continue;
            };
            for word in 0..width {
                let count = &mut along_x[place(y, z) + word];
                (-reach..=reach).for_each(|by| count.add(shifted(row, word, by)));
            }
        }
    }
    let most = map_words(may, |y, z, word, _| {
        let mut count = Count::<MOST_PLANES>::default();
        for z in (z - reach).max(0)..=(z + reach).min(size.z as i32 - 1) {
            for y in (y - reach).max(0)..=(y + reach).min(size.y as i32 - 1) {
                count.add_counts(&along_x[place(y, z) + word], planes);
            }
        }
        let added = count.at_least(added_from);
        if stays_from == added_from {
            return added;
        }
        added | count.at_least(stays_from) & word_of(solid, y, z, word)
    });
    let added = most.zip(solid, |m, s| m & !s);
    let removed = solid.zip(&most, |s, m| s & !m).zip(may, |r, m| r & m);
    (added, removed)
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

    /// Returns the voxels at least `margin` from the block's border, whose changes do not depend on it.
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

    /// A summed volume table of the existing voxels of a block.
    struct Sums(Vec<i32>);

    impl Sums {
        const SIZE: UVec3 = UVec3::new(MAX.x as u32 + 1, MAX.y as u32 + 1, MAX.z as u32 + 1);

        fn of(block: &BitBlock) -> Sums {
            let mut sums = Sums(vec![0; Sums::SIZE.element_product() as usize]);
            for v in voxels() {
                let mut sum = i32::from(block.get(v));
                for corner in 0..7 {
                    let back = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
                    let part = sums.before(v + back);
                    // Inclusion and exclusion, by the number of axes on which the part is shorter.
                    sum += if back.element_sum() % 2 == 0 { part } else { -part };
                }
                sums.0[Sums::index(v + 1)] = sum;
            }
            sums
        }

        fn index(v: IVec3) -> usize {
            let (v, size) = (v.as_uvec3(), Sums::SIZE);
            (v.x + size.x * (v.y + size.y * v.z)) as usize
        }

        /// Returns the number of voxels below `v` on all axes.
        fn before(&self, v: IVec3) -> i32 {
            self.0[Sums::index(v.clamp(MIN, MAX))]
        }

        /// Returns the number of voxels within `reach` of `v` on all axes.
        fn around(&self, v: IVec3, reach: i32) -> u32 {
            let (min, max) = (v - reach, v + reach + 1);
            let mut count = 0;
            for corner in 0..8 {
                let high = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
                let sign = if high.element_sum() % 2 == 1 { 1 } else { -1 };
                count += sign * self.before(high * max + (1 - high) * min);
            }
            count as u32
        }
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
            let (added, removed) =
                (dilation(&block, &all(), least), erosion(&block, &all(), least));
            for v in voxels() {
                let count = naive_count(&block, v, 1) - u32::from(block.get(v));
                let (many, exists) = (count >= least, block.get(v));
                prop_assert_eq!(added.get(v), many && !exists, "{}: {}", v, count);
                prop_assert_eq!(removed.get(v), !many && exists, "{}: {}", v, count);
            }
        }

        #[test]
        fn majority_equals_a_naive_majority(seed: u64, per_mille in 300u64..700, radius in prop::sample::select(vec![1u32, 2, 3, 5, 8]), strength in prop::sample::select(vec![0.0f32, 0.25, 0.5, 0.9, 1.0])) {
            let block = random(seed, per_mille);
            let (added, removed) = majority(&block, &all(), radius, strength);
            let volume = (2 * radius + 1).pow(3);
            let sums = Sums::of(&block);
            for v in voxels() {
                let exists = block.get(v);
                let clay = sums.around(v, radius as i32);
                let alike = if exists { clay } else { volume - clay };
                // The voxel itself does not count towards the half of the cube that it needs.
                let changes = (alike as f32) <= strength * ((volume - 1) / 2) as f32;
                prop_assert_eq!(added.get(v), changes && !exists);
                prop_assert_eq!(removed.get(v), changes && exists);
            }
        }

        #[test]
        fn growth_is_dilation_until_nothing_is_added(seed: u64, per_mille in 100u64..800) {
            let block = random(seed, per_mille);
            for rounds in [0, 1, 3, 1000] {
                let mut naive = block.clone();
                for _ in 0..rounds {
                    let added = dilation(&naive, &inner(2), 12);
                    if added.count() == 0 {
                        break;
                    }
                    naive = naive.zip(&added, |n, a| n | a);
                }
                let grown = growth(&block, &inner(2), 12, rounds);
                prop_assert_eq!(grown, naive.zip(&block, |n, b| n & !b));
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
            let (added, removed) = majority(&half, &inner(radius as i32), radius, 1.0);
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
