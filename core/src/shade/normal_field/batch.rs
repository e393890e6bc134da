//! Computes the normals of bricks that lie close together, on all cores.
//!
//! Three stages, each for all bricks before the next: samples of the bricks and of those within two around them,
//! filtered cells of the bricks and those next to them, normals of the bricks. Keeps its memory.

use std::cell::RefCell;

use fearless_simd::{Level, dispatch};
use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use super::cells::{
    CellNormals, MergedSamples, Neighbourhood, bits, cells_towards, filter_cells, filter_voxels,
    words_towards,
};
use super::packed::{PackedDepth, PackedNormal};
use super::pages::SurfaceRecord;
use super::window::{BrickSamples, SurfaceMask, Wanted, WindowSums, sample};
use crate::sculpture::Grid;
use crate::sculpture::brick::BrickKind;
use crate::shade::occlusion::Filled;

/// The distance in bricks around the targets within which samples count.
const MARGIN_BRICKS: i32 = 2;
/// The most bricks in the box around a part, margins included: its index takes 4 bytes for each.
const MOST_BRICKS: u64 = 40 * 40 * 40;
/// Edge of the blocks into which larger parts are divided.
const PART_EDGE_LOG2: u32 = 4;

/// No index in the lists.
const NONE: u32 = u32::MAX;

/// The precision of computed normals.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Precision {
    /// First estimates of the bricks themselves: about a fifth of the work after an edit; edges are rounded.
    Estimated,
    /// As [`super::NormalField`] describes them.
    Refined,
}

/// The last stage that a brick needs.
const SAMPLED: u8 = 1;
const FILTERED: u8 = 2;
const TARGET: u8 = 3;

/// The bricks of a part, and the box around them.
#[derive(Debug, Default)]
pub struct Batch {
    /// Lower corner and size of the box, in bricks.
    low: IVec3,
    size: IVec3,
    /// For each brick of the box, its stage; then its index in `bricks`.
    stages: Vec<u8>,
    places: Vec<u32>,
    bricks: Vec<BrickTask>,
    samples: Vec<Sampled>,
    filtered: Vec<CellNormals>,
    records: Vec<Vec<SurfaceRecord>>,
    /// Targets without any surface.
    bare: Vec<u32>,
}

/// A brick to compute.
#[derive(Clone, Copy, Debug)]
struct BrickTask {
    brick: IVec3,
    index: u32,
    stage: u8,
    /// The words of the brick in which samples are needed: a bit each.
    words: u8,
    /// The cells to filter: a bit each.
    cells: u64,
}

#[derive(Debug, Default)]
struct Sampled {
    samples: BrickSamples,
    cells: MergedSamples,
}

impl Sampled {
    /// Takes the samples of a brick and merges them into cells.
    fn take_samples(&mut self, level: Level, grid: &Grid, place: &BrickTask) {
        SCRATCH.with_borrow_mut(|scratch| {
            dispatch!(level, simd => {
                let wanted = Wanted { words: place.words, filling: place.stage == TARGET };
                sample(simd, grid, place.brick, wanted, &mut scratch.sums, &mut self.samples);
                self.cells.merge(&self.samples);
            })
        });
    }
}

/// Adds the refined records of the samples of a brick to `records`, which is empty. `around` gives the cells of a brick
/// with their filtered normals by its offset from this one.
fn refine<'a>(
    level: Level,
    samples: &BrickSamples,
    around: &impl Fn(IVec3) -> Option<(&'a MergedSamples, &'a CellNormals)>,
    records: &mut Vec<SurfaceRecord>,
) {
    SCRATCH.with_borrow_mut(|scratch| {
        let BrickScratch { neighbourhood, filled, .. } = &mut **scratch;
        filled.clear();
        for (z, layer) in samples.mask.layers.into_iter().enumerate() {
            filled.extend(bits(layer).map(|bit| samples.filling[64 * z + bit]));
        }
        records.resize(filled.len(), SurfaceRecord::NONE);
        dispatch!(level, simd => filter_voxels(
            simd,
            samples,
            around,
            neighbourhood,
            #[inline(always)]
            |i, normal, depth_vx| {
                let (normal, depth) = (PackedNormal::pack(normal), PackedDepth::pack(depth_vx));
                records[i] = SurfaceRecord::new(normal, depth, filled[i].openness_at(depth.vx()));
            },
        ));
    });
}

/// Computes records of the first estimates.
fn estimates(samples: &BrickSamples, records: &mut Vec<SurfaceRecord>) {
    records.clear();
    for (z, layer) in samples.mask.layers.into_iter().enumerate() {
        for bit in bits(layer) {
            let voxel = Vec3::new((bit & 7) as f32, (bit >> 3) as f32, z as f32) + 0.5;
            let normal = samples.normal(records.len());
            let depth_vx = (samples.position(records.len()) - voxel).dot(normal);
            let depth = PackedDepth::pack(depth_vx);
            let open = samples.filling[64 * z + bit].openness_at(depth.vx());
            records.push(SurfaceRecord::new(PackedNormal::pack(normal), depth, open));
        }
    }
}

/// The surface found in a brick.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceOf<'a> {
    pub mask: &'a SurfaceMask,
    /// The records in the order of the mask.
    pub records: &'a [SurfaceRecord],
}

impl SurfaceOf<'_> {
    /// No surface.
    const NONE: SurfaceOf<'static> =
        SurfaceOf { mask: &SurfaceMask { layers: [0; 8] }, records: &[] };
}

/// The buffers that a thread needs for one brick.
#[derive(Default)]
struct BrickScratch {
    sums: WindowSums,
    neighbourhood: Neighbourhood,
    /// The filled part around each surface voxel.
    filled: Vec<Filled>,
}

thread_local! {
    static SCRATCH: RefCell<Box<BrickScratch>> = RefCell::default();
}

impl Batch {
    /// Calls `compute` with all of `targets` (linear indices, ascending), or with parts of them that lie close
    /// together.
    pub(crate) fn for_each_part(
        &mut self,
        grid: &Grid,
        targets: &[u32],
        compute: &mut dyn FnMut(&mut Batch, &[u32]),
    ) {
        if targets.is_empty() {
            return;
        }
        let (low, high) = bounds(grid, targets);
        let size = (high - low + 2 * MARGIN_BRICKS).as_u64vec3();
        if size.element_product() <= MOST_BRICKS {
            return compute(self, targets);
        }
        let block = |&index: &u32| {
            let UVec3 { x, y, z } = grid.brick_coords(index as usize) >> PART_EDGE_LOG2;
            [z, y, x]
        };
        let mut sorted = targets.to_vec();
        sorted.sort_by_key(block);
        sorted.chunk_by(|a, b| block(a) == block(b)).for_each(|part| compute(self, part));
    }

    /// Computes the normals of `targets`.
    pub fn compute(&mut self, level: Level, grid: &Grid, targets: &[u32], precision: Precision) {
        self.plan(grid, targets, precision);
        let count = self.bricks.len();
        let last = self.bricks.partition_point(|place| place.stage == TARGET);
        let middle = self.bricks.partition_point(|place| place.stage >= FILTERED);
        grow(&mut self.samples, count);
        grow(&mut self.records, last);
        if self.filtered.len() < middle {
            self.filtered.resize(middle, [[0.0; 64]; 3]);
        }
        let Batch { low, size, places, bricks, samples, filtered, records, .. } = self;
        for_each(&bricks[..count], &mut samples[..count], &|place, out| {
            out.take_samples(level, grid, place);
        });

        let place_of = |brick: IVec3| {
            let at = brick - *low;
            let inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(*size).all();
            let place = if inside { places[linear(at, *size)] } else { NONE };
            (place != NONE).then_some(place as usize)
        };
        let samples = &samples[..count];
        if precision == Precision::Estimated {
            for_each(&bricks[..last], &mut records[..last], &|place, out| {
                if let Some(own) = place_of(place.brick) {
                    estimates(&samples[own].samples, out);
                }
            });
            return;
        }
        let filter = |place: &BrickTask, out: &mut CellNormals| {
            let around = |offset| Some(&samples[place_of(place.brick + offset)?].cells);
            SCRATCH.with_borrow_mut(|scratch| {
                let neighbourhood = &mut scratch.neighbourhood;
                dispatch!(level, simd => filter_cells(simd, place.cells, &around, neighbourhood, out));
            });
        };
        for_each(&bricks[..middle], &mut filtered[..middle], &filter);

        let filtered = &filtered[..middle];
        let finish = |place: &BrickTask, out: &mut Vec<SurfaceRecord>| {
            out.clear();
            let Some(own) = place_of(place.brick) else { return };
            let own = &samples[own].samples;
            let around = |offset| {
                let place = place_of(place.brick + offset)?;
                Some((&samples[place].cells, filtered.get(place)?))
            };
            refine(level, own, &around, out);
        };
        for_each(&bricks[..last], &mut records[..last], &finish);
    }

    /// Returns the targets of the last [`Batch::compute`]: brick and surface.
    pub fn results(&self) -> impl Iterator<Item = (u32, SurfaceOf<'_>)> {
        let last = self.bricks.partition_point(|place| place.stage == TARGET);
        let all = self.bricks[..last].iter().zip(&self.samples).zip(&self.records);
        let with_surface = all.map(|((place, Sampled { samples, .. }), records)| {
            (place.index, SurfaceOf { mask: &samples.mask, records })
        });
        with_surface.chain(self.bare.iter().map(|index| (*index, SurfaceOf::NONE)))
    }

    /// Returns the words and the cells of a brick whose samples and filtered normals bricks around it depend on. Bricks
    /// of a later stage need all.
    fn parts_for_others(&self, at: IVec3, stage: u8) -> (u8, u64) {
        let mut words = if stage == SAMPLED { 0 } else { u8::MAX };
        let mut cells = if stage == TARGET { u64::MAX } else { 0 };
        if stage == TARGET {
            return (words, cells);
        }
        let (low, high) = ((at - 1).max(IVec3::ZERO), (at + 1).min(self.size - 1));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let other = IVec3::new(x, y, z);
                    let further = self.stages[linear(other, self.size)];
                    if further > stage && stage == SAMPLED {
                        words |= words_towards(other - at);
                    } else if further > stage {
                        cells |= cells_towards(other - at);
                    }
                }
            }
        }
        (words, cells)
    }

    /// Lists the bricks to compute for `targets`: targets first, then those to filter, then the rest.
    fn plan(&mut self, grid: &Grid, targets: &[u32], precision: Precision) {
        let (low, high) = bounds(grid, targets);
        self.low = low - MARGIN_BRICKS;
        self.size = high - low + 2 * MARGIN_BRICKS;
        let (corner, size) = (self.low, self.size);
        let bricks = size.element_product() as usize;
        self.stages.clear();
        self.stages.resize(bricks, 0);
        self.places.clear();
        self.places.resize(bricks, NONE);
        self.bricks.clear();
        self.bare.clear();
        for &index in targets {
            let at = grid.brick_coords(index as usize).as_ivec3() - corner;
            if !may_have_surface(grid, at + corner) {
                self.bare.push(index);
                continue;
            }
            if precision == Precision::Estimated {
                self.stages[linear(at, size)] = TARGET;
                continue;
            }
            for z in -2i32..=2 {
                for y in -2i32..=2 {
                    let row = linear(at + IVec3::new(-2, y, z), size);
                    let far = y.abs().max(z.abs()) as u8;
                    for (x, stage) in (-2i32..).zip(&mut self.stages[row..row + 5]) {
                        *stage = (*stage).max(TARGET - far.max(x.unsigned_abs() as u8));
                    }
                }
            }
        }
        let dims = grid.brick_dims().as_ivec3();
        let (from, to) = (corner.max(IVec3::ZERO), (corner + size).min(dims));
        for wanted in [TARGET, FILTERED, SAMPLED] {
            for z in from.z..to.z {
                for y in from.y..to.y {
                    for x in from.x..to.x {
                        let brick = IVec3::new(x, y, z);
                        let at = linear(brick - corner, size);
                        if self.stages[at] == wanted && may_have_surface(grid, brick) {
                            self.places[at] = self.bricks.len() as u32;
                            let index = grid.brick_index(brick.as_uvec3()) as u32;
                            let (words, cells) = self.parts_for_others(brick - corner, wanted);
                            self.bricks.push(BrickTask {
                                brick,
                                index,
                                stage: wanted,
                                words,
                                cells,
                            });
                        }
                    }
                }
            }
        }
    }
}

/// Calls `compute` for each pair, on all cores. The closure is a trait object, so that the loop is compiled once.
fn for_each<T: Send>(
    places: &[BrickTask],
    out: &mut [T],
    compute: &(dyn Fn(&BrickTask, &mut T) + Sync),
) {
    places.par_iter().zip(out).with_min_len(4).for_each(|(place, out)| compute(place, out));
}

fn grow<T: Default>(list: &mut Vec<T>, count: usize) {
    if list.len() < count {
        list.resize_with(count, T::default);
    }
}

fn linear(at: IVec3, size: IVec3) -> usize {
    (at.x + size.x * (at.y + size.y * at.z)) as usize
}

/// Returns the box around bricks: its lower corner and one past its highest.
fn bounds(grid: &Grid, bricks: &[u32]) -> (IVec3, IVec3) {
    bricks.iter().fold((IVec3::MAX, IVec3::MIN), |(low, high), &index| {
        let b = grid.brick_coords(index as usize).as_ivec3();
        (low.min(b), high.max(b + 1))
    })
}

/// Returns whether the brick at `b`, which must be inside, may have a surface voxel: it is neither empty nor full among
/// full neighbours.
fn may_have_surface(grid: &Grid, b: IVec3) -> bool {
    let kind = |b: IVec3| grid.brick_kind(grid.brick_index(b.as_uvec3()));
    match kind(b) {
        BrickKind::Empty => false,
        BrickKind::Mixed => true,
        BrickKind::Full => {
            let dims = grid.brick_dims().as_ivec3();
            let at_border = b.cmpeq(IVec3::ZERO).any() || b.cmpeq(dims - 1).any();
            let axes = [IVec3::X, IVec3::Y, IVec3::Z];
            at_border
                || axes.iter().any(|&axis| {
                    kind(b - axis) != BrickKind::Full || kind(b + axis) != BrickKind::Full
                })
        }
    }
}
