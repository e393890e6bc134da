//! Erodes and dilates blocks of bits by a ball of any diameter. The opening, the part of a solid that a ball can reach,
//! measures the thickness of its walls.
//!
//! From a block to a block of the same position and size; beyond its border nothing exists. The ball is a list of runs
//! along x. For each run length the block is first reduced along x by doubling; then rows are combined, 64 voxels at a
//! time, in slabs of layers on all cores. (The separation of a structuring element is the idea of van Herk and of Gil,
//! applied to rows of bits.) Knows no document.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use crate::progress::Progress;
use crate::sculpture::bit_block::BitBlock;

/// Largest extent of a ball on an axis, in voxels: a shift by half of it stays within a word.
pub const MAX_BALL_VX: u32 = 64;
/// Number of layers computed together; the runs of the layers around them are computed twice.
const SLAB: usize = 24;

/// A run of the ball along x, as offsets from the ball's origin voxel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Run {
    y: i32,
    z: i32,
    /// First and last offset along x.
    low: i32,
    high: i32,
}

/// A digital ball: it fits exactly between two faces that are its diameter apart, on every axis.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DigitalBall {
    runs: Vec<Run>,
    extent_vx: [u32; 3],
}

impl DigitalBall {
    /// Creates the ball of `diameter` among voxels with edges `voxel` (in the same unit). On each axis it spans the
    /// fewest voxels that are together at least as long. Its centre is a voxel centre where that number is odd, and
    /// lies between two voxels where it is even. A voxel belongs to the ball if its centre does. Returns `None` if the
    /// ball spans more than [`MAX_BALL_VX`] voxels on an axis, or a number is not finite or not positive.
    pub fn new(diameter: f32, voxel: Vec3) -> Option<DigitalBall> {
        if !(diameter.is_finite()
            && diameter > 0.0
            && voxel.is_finite()
            && voxel.min_element() > 0.0)
        {
            return None;
        }
        // Less than a thousandth of a voxel is a rounding error.
        let edges = (diameter / voxel - 1e-3).ceil().max(Vec3::ONE);
        if edges.max_element() > MAX_BALL_VX as f32 {
            return None;
        }
        let extent_vx = edges.to_array().map(|edge| edge as u32);
        // Offset of the centre from that of the origin voxel.
        let middle = Vec3::from(extent_vx.map(|edge| if edge % 2 == 0 { 0.5 } else { 0.0 }));
        let first = extent_vx.map(|edge| -((edge as i32 - 1) / 2));
        let last = extent_vx.map(|edge| edge as i32 / 2);
        let square = |x: i32, y: i32, z: i32| {
            ((Vec3::new(x as f32, y as f32, z as f32) - middle) * voxel).length_squared()
        };
        // Wide enough to include the voxels at the ends of its axes.
        let near = middle.to_array().map(|m| m as i32);
        let ends = [
            square(last[0], near[1], near[2]),
            square(near[0], last[1], near[2]),
            square(near[0], near[1], last[2]),
        ];
        let widest = ends.into_iter().fold(0.25 * diameter * diameter, f32::max) * (1.0 + 1e-5);
        let mut runs = Vec::new();
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                let mut inside = (first[0]..=last[0]).filter(|&x| square(x, y, z) <= widest);
                if let Some(low) = inside.next() {
                    runs.push(Run { y, z, low, high: inside.next_back().unwrap_or(low) });
                }
            }
        }
        Some(DigitalBall { runs, extent_vx })
    }

    /// Returns the number of voxels along each axis.
    pub(crate) fn extent_vx(&self) -> [u32; 3] {
        self.extent_vx
    }

    /// Returns the positions in `solid` at which the ball fits inside it. `None` if cancelled.
    pub(crate) fn erode(&self, solid: &BitBlock, progress: &dyn Progress) -> Option<BitBlock> {
        self.combine::<true>(solid, progress)
    }

    /// Returns all voxels that the ball covers at `places`, within the block. `None` if cancelled.
    pub(crate) fn dilate(&self, places: &BitBlock, progress: &dyn Progress) -> Option<BitBlock> {
        self.combine::<false>(places, progress)
    }

    /// Erodes (`ALL`: the rows of all runs must have a voxel) or dilates (any of them, with the ball reflected).
    fn combine<const ALL: bool>(
        &self,
        block: &BitBlock,
        progress: &dyn Progress,
    ) -> Option<BitBlock> {
        let size = block.size();
        let mut out = block.emptied();
        if size.x == 0 || size.y == 0 {
            return Some(out);
        }
        let combination = Combination::<ALL>::new(self, block);
        let done = std::sync::atomic::AtomicUsize::new(0);
        let slabs = out.layers_mut(SLAB).enumerate();
        slabs.for_each(|(slab, words)| {
            if progress.is_cancelled() {
                return;
            }
            combination.compute_slab((slab * SLAB) as i32, words);
            let done = done.fetch_add(SLAB, std::sync::atomic::Ordering::Relaxed) + SLAB;
            progress.advance((done as f32 / size.z as f32).min(1.0));
        });
        // Clears the bits of each row's last word that lie beyond the size of the block.
        let beyond = match size.x % 64 {
            0 => u64::MAX,
            inside => (1 << inside) - 1,
        };
        let width = combination.width;
        (!progress.is_cancelled()).then(|| {
            out.layers_mut(SLAB).for_each(|words| {
                words.iter_mut().skip(width - 1).step_by(width).for_each(|word| *word &= beyond);
            });
            out
        })
    }
}

/// An erosion (`ALL`) or dilation of a block by a ball.
struct Combination<'a, const ALL: bool> {
    block: &'a BitBlock,
    /// Words in a row; rows in a layer.
    width: usize,
    rows: usize,
    layers: i32,
    /// The runs of the ball, reflected for a dilation.
    runs: Vec<Run>,
    /// The distinct first and last offsets of the runs, ascending.
    lengths: Vec<(i32, i32)>,
    /// Number of layers that the ball reaches beyond its origin voxel.
    reach: i32,
}

/// The rows of some layers, reduced along x by each run length.
struct ReducedRows {
    /// The layers.
    layers: Range<i32>,
    /// Whether a row holds any voxels; empty rows are not reduced.
    occupied: Vec<bool>,
    /// The reduced rows for each run length.
    along_x: Vec<Vec<u64>>,
}

impl<'a, const ALL: bool> Combination<'a, ALL> {
    fn new(ball: &DigitalBall, block: &'a BitBlock) -> Self {
        let size = block.size();
        let reversed = |run: &Run| Run { y: -run.y, z: -run.z, low: -run.high, high: -run.low };
        let runs: Vec<Run> = match ALL {
            true => ball.runs.clone(),
            false => ball.runs.iter().map(reversed).collect(),
        };
        let mut lengths: Vec<(i32, i32)> = runs.iter().map(|run| (run.low, run.high)).collect();
        lengths.sort_unstable();
        lengths.dedup();
        Combination {
            block,
            width: size.x.div_ceil(64) as usize,
            rows: size.y as usize,
            layers: size.z as i32,
            runs,
            lengths,
            reach: ball.extent_vx[2] as i32 / 2,
        }
    }

    fn row(&self, y: i32, z: i32) -> &'a [u64] {
        self.block.row(y, z).unwrap_or_default()
    }

    /// Reduces the rows of `layers` along x.
    fn reduce(&self, layers: Range<i32>) -> ReducedRows {
        let (width, rows) = (self.width, self.rows);
        let count = layers.len() * rows;
        let places = || layers.clone().flat_map(|z| (0..rows as i32).map(move |y| (y, z)));
        let occupied: Vec<bool> =
            places().map(|(y, z)| self.row(y, z).iter().any(|word| *word != 0)).collect();
        let mut along_x = vec![vec![0; count * width]; self.lengths.len()];
        for (reduced, &(low, high)) in along_x.iter_mut().zip(&self.lengths) {
            let mut scratch = vec![0; width];
            let targets = reduced.chunks_exact_mut(width).zip(places()).zip(&occupied);
            for ((target, (y, z)), _) in targets.filter(|(_, occupied)| **occupied) {
                target.copy_from_slice(self.row(y, z));
                reduce_along_x::<ALL>(target, &mut scratch, low, high);
            }
        }
        ReducedRows { layers, occupied, along_x }
    }

    /// Computes the layers from `first` on that fit into `words`.
    fn compute_slab(&self, first: i32, words: &mut [u64]) {
        let (width, rows) = (self.width, self.rows);
        let end = first + (words.len() / (width * rows)) as i32;
        // The rows of this slab and of the layers that the ball reaches around it.
        let reduced = self.reduce((first - self.reach).max(0)..(end + self.reach).min(self.layers));
        let runs: Vec<(Run, &[u64])> = self
            .runs
            .iter()
            .filter_map(|run| {
                let at = self.lengths.binary_search(&(run.low, run.high)).ok()?;
                Some((*run, &reduced.along_x[at][..]))
            })
            .collect();
        for (row, target) in words.chunks_exact_mut(width).enumerate() {
            let (y, z) = ((row % rows) as i32, first + (row / rows) as i32);
            if ALL {
                // A ball contains its origin voxel.
                target.copy_from_slice(self.row(y, z));
            }
            for (run, along_x) in &runs {
                let (y, z) = (y + run.y, z + run.z);
                let inside = y >= 0 && (y as usize) < rows && reduced.layers.contains(&z);
                let place = match inside {
                    true => (z - reduced.layers.start) as usize * rows + y as usize,
                    false => 0,
                };
                let exists = inside && reduced.occupied[place];
                let any = if exists {
                    merge::<ALL>(target, &along_x[place * width..(place + 1) * width])
                } else if ALL {
                    target.fill(0);
                    0
                } else {
                    1
                };
                if ALL && any == 0 {
                    break;
                }
            }
        }
    }
}

/// Intersects (`ALL`) or unites `target` with `other`; returns whether anything is left, as a word.
fn merge<const ALL: bool>(target: &mut [u64], other: &[u64]) -> u64 {
    let mut any = 0;
    for (bits, &other) in target.iter_mut().zip(other) {
        *bits = if ALL { *bits & other } else { *bits | other };
        any |= *bits;
    }
    any
}

/// Replaces each voxel of a row by whether all, or any, of the voxels at offsets `low` (at most 0) to `high` (at least
/// 0) exist. Beyond the row there are none.
fn reduce_along_x<const ALL: bool>(row: &mut [u64], scratch: &mut [u64], low: i32, high: i32) {
    scratch.copy_from_slice(row);
    // The length doubles with each step. The words that are read have not been written yet.
    let (length, mut have) = (high as u32 + 1, 1);
    while have < length {
        let by = have.min(length - have);
        for i in 0..row.len() {
            let next = row.get(i + 1).copied().unwrap_or(0);
            let moved = row[i] >> by | next << (64 - by);
            row[i] = if ALL { row[i] & moved } else { row[i] | moved };
        }
        have += by;
    }
    let (length, mut have) = (low.unsigned_abs() + 1, 1);
    while have < length {
        let by = have.min(length - have);
        for i in (0..scratch.len()).rev() {
            let before = if i > 0 { scratch[i - 1] } else { 0 };
            let moved = scratch[i] << by | before >> (64 - by);
            scratch[i] = if ALL { scratch[i] & moved } else { scratch[i] | moved };
        }
        have += by;
    }
    merge::<ALL>(row, scratch);
}

#[cfg(test)]
mod tests {
    use glam::IVec3;
    use proptest::prelude::*;

    use super::*;

    const MAX: IVec3 = IVec3::new(88, 16, 40);

    fn random(seed: u64, per_mille: u64) -> BitBlock {
        let mut block = BitBlock::empty(IVec3::ZERO, MAX);
        let mut state = seed | 1;
        for v in voxels() {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            if (state >> 33) % 1000 < per_mille {
                block.set_span(v.x, v.x, v.y, v.z);
            }
        }
        block
    }

    fn voxels() -> impl Iterator<Item = IVec3> {
        let row = |y, z| (0..MAX.x).map(move |x| IVec3::new(x, y, z));
        (0..MAX.z).flat_map(move |z| (0..MAX.y).flat_map(move |y| row(y, z)))
    }

    fn offsets(ball: &DigitalBall) -> Vec<IVec3> {
        let run = |run: &Run| (run.low..=run.high).map(|x| IVec3::new(x, run.y, run.z)).collect();
        ball.runs.iter().flat_map(|r| -> Vec<IVec3> { run(r) }).collect()
    }

    #[test]
    fn a_ball_is_as_long_as_its_diameter_on_every_axis() {
        for tenths in 1..200u32 {
            let diameter = tenths as f32 * 0.1;
            let ball = DigitalBall::new(diameter, Vec3::ONE).unwrap();
            let edge = tenths.div_ceil(10);
            assert_eq!(ball.extent_vx(), [edge; 3], "{diameter}");
            let offsets = offsets(&ball);
            let low = offsets.iter().copied().reduce(IVec3::min).unwrap();
            let high = offsets.iter().copied().reduce(IVec3::max).unwrap();
            assert_eq!(high - low + 1, IVec3::splat(edge as i32), "{diameter}");
            assert!(offsets.contains(&IVec3::ZERO));
            let volume = std::f32::consts::PI / 6.0 * diameter.powi(3);
            if diameter > 12.0 {
                assert!((offsets.len() as f32 / volume - 1.0).abs() < 0.07, "{diameter}");
            }
        }
        // Voxels that are flat along an axis: the ball spans more of them there.
        let ball = DigitalBall::new(2.0, Vec3::new(1.0, 0.25, 0.5)).unwrap();
        assert_eq!(ball.extent_vx(), [2, 8, 4]);
    }

    #[test]
    fn an_invalid_diameter_makes_no_ball() {
        for diameter in [0.0, -1.0, f32::NAN, f32::INFINITY, 64.1, 1e30] {
            assert_eq!(DigitalBall::new(diameter, Vec3::ONE), None, "{diameter}");
        }
        for voxel in [0.0, f32::NAN, 1e-30] {
            assert_eq!(DigitalBall::new(1.0, Vec3::new(1.0, voxel, 1.0)), None, "{voxel}");
        }
        assert!(DigitalBall::new(64.0, Vec3::ONE).is_some());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn erosion_and_dilation_equal_the_definition(
            seed: u64, diameter in 0.5f32..5.5, flat in prop::sample::select(vec![1.0f32, 0.5]),
        ) {
            let ball = DigitalBall::new(diameter, Vec3::new(1.0, flat, 1.0)).unwrap();
            let offsets = offsets(&ball);
            let dense = random(seed, 980);
            let eroded = ball.erode(&dense, &()).unwrap();
            let sparse = random(seed, 12);
            let dilated = ball.dilate(&sparse, &()).unwrap();
            for v in voxels() {
                prop_assert_eq!(eroded.get(v), offsets.iter().all(|o| dense.get(v + *o)), "{}", v);
                prop_assert_eq!(dilated.get(v), offsets.iter().any(|o| sparse.get(v - *o)), "{}", v);
            }
            let count = voxels().filter(|v| dilated.get(*v)).count() as u64;
            prop_assert_eq!(dilated.count(), count, "nothing beyond the block");
        }
    }

    #[test]
    fn cancelled_work_gives_nothing() {
        let report = crate::progress::ProgressReport::default();
        report.cancel();
        let ball = DigitalBall::new(3.0, Vec3::ONE).unwrap();
        assert_eq!(ball.erode(&random(1, 500), &report), None);
    }
}
