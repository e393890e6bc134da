//! Refined normals: means of first estimates over points of one surface, which preserve edges.
//!
//! A cell is a cube of 2^3 voxels. Its samples are merged into one: point and normal are means, weighted by planarity
//! to the power of 24, so that samples on an edge have no influence beside those on a face. The normal of a point is
//! then a weighted mean over the cells around it. A cell's weight falls with its distance, with the distance of the
//! point from the cell's plane, and with the angle between the normals: a bilateral filter (Fleishman, Drori and
//! Cohen-Or, "Bilateral mesh denoising", 2003; Jones, Durand and Desbrun, "Non-iterative, feature-preserving mesh
//! smoothing", 2003). It is applied to the cells, and with their new normals to the voxels.
//!
//! Takes the samples of bricks and of their neighbours, returns normals. Sums have a fixed order, so all vector
//! instructions give the same normals.

use fearless_simd::{Simd, f32x4, f32x16, prelude::*};
use glam::{IVec3, Vec3};

use super::window::{BrickSamples, SurfaceMask};
use crate::sculpture::vectors::for_axes;

/// Edge of a cell.
const CELL_EDGE_VX: f32 = 2.0;
/// Cells along the edge of a brick.
const CELLS: i32 = 4;
/// Cells in a brick.
const BRICK_CELLS: usize = 64;

/// Distance from a cell's plane at which its weight is 0.
const PLANE_REACH_VX: f32 = 2.5;
/// Distance of cells from cells, and of cells from voxels, at which the weight is 0.
const CELL_REACH_VX: f32 = 4.0;
const VOXEL_REACH_VX: f32 = 5.0;
/// Cosine of the angle between normals at which the weight is 0.
const LEAST_COSINE: f32 = 0.4;
/// Weight of a sample without planarity: a voxel with no plane nearby keeps its estimate.
const LEAST_WEIGHT: f32 = 1e-9;
/// Weight of the estimate of the voxel itself.
const OWN_WEIGHT: f32 = 1e-4;

/// The displacement of a curved surface inwards by smoothing the bits, over the difference of the two mean heights of
/// the cells around a point (see [`depth`]). A Gaussian of variance s^2 moves a ball of radius r by s^2 / r. The
/// heights of cells at distance d differ by d^2 / r, with a mean d^2 of a third of the squared reach.
const CURVATURE_SHIFT: f32 = 1.69 / (VOXEL_REACH_VX * VOXEL_REACH_VX / 3.0);

/// Edge of the cube of cells in which a [`Neighbourhood`] is collected.
const COLLECTED: i32 = 8;
/// The most cells of a neighbourhood.
const MOST: usize = (COLLECTED * COLLECTED * COLLECTED) as usize;
const LANES: usize = 16;

/// The merged samples of a brick. Cell (x, y, z) has index `x + 4 y + 16 z`.
#[derive(Clone, Debug)]
pub struct MergedSamples {
    /// The cells that have samples: a bit each.
    pub used: u64,
    /// In voxels from the lower corner of the brick.
    positions: [[f32; BRICK_CELLS]; 3],
    weights: [f32; BRICK_CELLS],
    /// Of unit length, or 0.
    normals: [[f32; BRICK_CELLS]; 3],
}

impl Default for MergedSamples {
    fn default() -> MergedSamples {
        MergedSamples {
            used: 0,
            positions: [[0.0; BRICK_CELLS]; 3],
            weights: [0.0; BRICK_CELLS],
            normals: [[0.0; BRICK_CELLS]; 3],
        }
    }
}

/// Weighted sums over the cells around a point.
struct CellSums {
    weight: f32,
    normal: Vec3,
    /// Sum of the offsets of the cells from the point.
    offset: Vec3,
    /// Sum of the heights of the cells above the point, each along its own normal.
    height: f32,
}

/// New normals of the cells of a brick.
pub type CellNormals = [[f32; BRICK_CELLS]; 3];

impl MergedSamples {
    /// Merges the samples of a brick.
    #[inline(always)]
    pub fn merge(&mut self, samples: &BrickSamples) {
        let mut sums = [[0.0f32; 7]; BRICK_CELLS];
        self.used = 0;
        for (i, voxel) in voxels(&samples.mask).enumerate() {
            let cell = voxel.dot(IVec3::new(1, 4, 16)) as usize;
            self.used |= 1 << cell;
            let squared = samples.planarity[i] * samples.planarity[i];
            let to_8 = squared * squared * squared * squared;
            let weight = to_8 * to_8 * to_8 + LEAST_WEIGHT;
            let (at, normal) = (samples.position(i), samples.normal(i));
            let values = [at.x, at.y, at.z, normal.x, normal.y, normal.z, 1.0];
            for (sum, value) in sums[cell].iter_mut().zip(values) {
                *sum += weight * value;
            }
        }
        for cell in bits(self.used) {
            let [x, y, z, normal_x, normal_y, normal_z, weight] = sums[cell];
            let at = Vec3::new(x, y, z) / weight;
            let normal = Vec3::new(normal_x, normal_y, normal_z) / weight;
            set(&mut self.positions, cell, at);
            set(&mut self.normals, cell, normal.normalize_or_zero());
            self.weights[cell] = weight;
        }
    }
}

/// Returns the cells of the voxels of a mask, in order.
#[inline(always)]
fn voxels(mask: &SurfaceMask) -> impl Iterator<Item = IVec3> {
    (0..).zip(mask.layers).flat_map(|(z, layer)| {
        bits(layer).map(move |bit| IVec3::new((bit & 7) as i32, (bit >> 3) as i32, z) >> 1)
    })
}

#[inline(always)]
pub fn bits(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = word.trailing_zeros() as usize;
        (word != 0).then(|| {
            word &= word - 1;
            bit & 63
        })
    })
}

#[inline(always)]
fn set(vectors: &mut [[f32; BRICK_CELLS]; 3], cell: usize, v: Vec3) {
    for (axis, value) in v.to_array().into_iter().enumerate() {
        vectors[axis][cell] = value;
    }
}

#[inline(always)]
fn get(vectors: &[[f32; BRICK_CELLS]; 3], cell: usize) -> Vec3 {
    Vec3::new(vectors[0][cell], vectors[1][cell], vectors[2][cell])
}

/// The cells around some point of a brick, as lists for vectors.
pub struct Neighbourhood {
    positions: [[f32; MOST]; 3],
    normals: [[f32; MOST]; 3],
    weights: [f32; MOST],
    count: usize,
}

/// Some cells of a brick, with the normals to use.
struct CellPart<'a> {
    cells: &'a MergedSamples,
    normals: &'a CellNormals,
    /// The cells to use: a bit each.
    used: u64,
    /// Lower corner of the brick, relative to that of the brick in the middle.
    corner_vx: Vec3,
}

/// The points for which weighted means are computed: a box in voxels from the lower corner of a brick, and the distance
/// at which weights become 0.
struct Places {
    low: Vec3,
    high: Vec3,
    reach_vx: f32,
}

impl Places {
    /// Returns the surface points of all voxels of a cube: at most 1 outside their centres.
    fn of_cube(corner_vx: IVec3, edge_vx: f32, reach_vx: f32) -> Places {
        let low = corner_vx.as_vec3() - 0.5;
        Places { low, high: low + (edge_vx + 1.0), reach_vx }
    }
}

impl Default for Neighbourhood {
    fn default() -> Neighbourhood {
        let vectors = [[0.0; MOST]; 3];
        Neighbourhood { positions: vectors, normals: vectors, weights: [0.0; MOST], count: 0 }
    }
}

impl Neighbourhood {
    /// Collects the cells of the cube of 8^3 cells, starting at `low` in cells from the lower corner of a brick, that
    /// have weight for any point in `places`. `around` gives the cells of a brick by its offset from that one, with the
    /// normals to use.
    #[inline(always)]
    fn collect<'a, S: Simd>(
        &mut self,
        simd: S,
        low: IVec3,
        places: &Places,
        around: &impl Fn(IVec3) -> Option<(&'a MergedSamples, &'a CellNormals)>,
    ) {
        self.count = 0;
        for z in -1..=1 {
            let part_z = part(low.z, z);
            for y in -1..=1 {
                let part_y = part(low.y, y);
                for x in -1..=1 {
                    let parts = mask(part(low.x, x), part_y, part_z);
                    if parts == 0 {
                        continue;
                    }
                    let offset = IVec3::new(x, y, z);
                    let Some((cells, normals)) = around(offset) else { continue };
                    let corner_vx = offset.as_vec3() * (CELLS as f32 * CELL_EDGE_VX);
                    let used = cells.used & parts;
                    self.append(simd, CellPart { cells, normals, used, corner_vx }, places);
                }
            }
        }
        // The lanes that pad the last vector have no weight.
        let end = self.count.next_multiple_of(LANES).min(MOST);
        self.weights[self.count..end].fill(0.0);
    }

    #[inline(always)]
    fn append<S: Simd>(&mut self, simd: S, part: CellPart, places: &Places) {
        let CellPart { cells, normals, used, corner_vx: corner } = part;
        for first in (0..BRICK_CELLS).step_by(LANES) {
            let used = used >> first & 0xFFFF;
            if used == 0 {
                continue;
            }
            let at = for_axes(
                #[inline(always)]
                |axis| {
                    f32x16::from_slice(simd, &cells.positions[axis][first..][..LANES])
                        + corner[axis]
                },
            );
            let [x, y, z] = for_axes(
                #[inline(always)]
                |axis| at[axis] - at[axis].max(places.low[axis]).min(places.high[axis]),
            );
            let near = (x * x + y * y + z * z).simd_lt(places.reach_vx * places.reach_vx);
            let at = for_axes(
                #[inline(always)]
                |axis| at[axis].to_array(),
            );
            for lane in bits(used & near.to_bitmask()) {
                let (i, cell) = (self.count, first + lane);
                for axis in 0..3 {
                    self.positions[axis][i] = at[axis][lane & 15];
                    self.normals[axis][i] = normals[axis][cell & 63];
                }
                self.weights[i] = cells.weights[cell & 63];
                self.count = i + 1;
            }
        }
    }

    /// Returns the weighted sums for a point with an estimate of its normal.
    #[inline(always)]
    fn sum<S: Simd>(&self, simd: S, at: Vec3, estimate: Vec3, reach_vx: f32) -> CellSums {
        let zero = f32x16::splat(simd, 0.0);
        let (mut normals, mut offsets) = ([zero; 3], [zero; 3]);
        let (mut weights, mut heights) = (zero, zero);
        for i in (0..self.count).step_by(LANES) {
            let offset = for_axes(
                #[inline(always)]
                |axis| load(simd, &self.positions[axis], i) - at[axis],
            );
            let normal = for_axes(
                #[inline(always)]
                |axis| load(simd, &self.normals[axis], i),
            );
            let height = offset[0] * normal[0] + offset[1] * normal[1] + offset[2] * normal[2];
            let distance = offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2];
            let cosine = normal[0] * estimate.x + normal[1] * estimate.y + normal[2] * estimate.z;
            let near = (distance * (-1.0 / (reach_vx * reach_vx)) + 1.0).max(0.0);
            let flat =
                (height * height * (-1.0 / (PLANE_REACH_VX * PLANE_REACH_VX)) + 1.0).max(0.0);
            let alike = (cosine - LEAST_COSINE).max(0.0) * (1.0 / (1.0 - LEAST_COSINE));
            let both = flat * alike;
            let weight = load(simd, &self.weights, i) * near * (both * both);
            weights += weight;
            heights += weight * height;
            for axis in 0..3 {
                normals[axis] += weight * normal[axis];
                offsets[axis] += weight * offset[axis];
            }
        }
        let [x, y, z] = normals;
        let [weight, normal_x, normal_y, normal_z] = sums_of(simd, [weights, x, y, z]);
        let [x, y, z] = offsets;
        let [height, offset_x, offset_y, offset_z] = sums_of(simd, [heights, x, y, z]);
        CellSums {
            weight,
            normal: Vec3::new(normal_x, normal_y, normal_z),
            offset: Vec3::new(offset_x, offset_y, offset_z),
            height,
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, values: &[f32; MOST], first: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &values[first..first + LANES])
}

/// Returns the sums of all lanes, in an order independent of the vector instructions: halves are added to each other.
#[inline(always)]
fn sums_of<S: Simd>(simd: S, [a, b, c, d]: [f32x16<S>; 4]) -> [f32; 4] {
    let (a, b, c, d) = (quarter(simd, a), quarter(simd, b), quarter(simd, c), quarter(simd, d));
    let ab = (simd.zip_low_f32x4(a, b) + simd.zip_high_f32x4(a, b)).to_array();
    let cd = (simd.zip_low_f32x4(c, d) + simd.zip_high_f32x4(c, d)).to_array();
    [ab[0] + ab[2], ab[1] + ab[3], cd[0] + cd[2], cd[1] + cd[3]]
}

#[inline(always)]
fn quarter<S: Simd>(simd: S, values: f32x16<S>) -> f32x4<S> {
    let (low, high) = simd.split_f32x16(values);
    let (low, high) = simd.split_f32x8(low + high);
    low + high
}

/// Returns the cells of a brick at `offset` bricks on an axis that lie in the cube starting at `low`: four bits.
#[inline(always)]
fn part(low: i32, offset: i32) -> u32 {
    let first = (low - offset * CELLS).clamp(0, CELLS);
    let end = (low + COLLECTED - offset * CELLS).clamp(0, CELLS);
    ((1 << end) - 1) & !((1 << first) - 1)
}

/// Returns the cells of a brick that lie in the given ones along each axis.
#[inline(always)]
fn mask(x: u32, y: u32, z: u32) -> u64 {
    let row = u64::from(x);
    let layer = (0..4).filter(|i| y >> i & 1 != 0).fold(0, |layer, i| layer | row << (4 * i));
    (0..4).filter(|i| z >> i & 1 != 0).fold(0, |all, i| all | layer << (16 * i))
}

/// Returns the words of a brick whose cells [`filter_cells`] collects for the neighbouring brick in this direction: a
/// bit each. It reaches two cells beyond a brick, which is the edge of a word.
pub(crate) fn words_towards(direction: IVec3) -> u8 {
    let halves = |d: i32| match d {
        0 => 0b11,
        1 => 0b10,
        _ => 0b01,
    };
    let [x, y, z] = direction.to_array().map(halves);
    (0..8).fold(0, |words, word| {
        let is_near = x >> (word & 1) & y >> (word >> 1 & 1) & z >> (word >> 2) & 1;
        words | (is_near as u8) << word
    })
}

/// Returns the cells of a brick that [`filter_voxels`] collects for the neighbouring brick in this direction: three
/// along each axis.
pub(crate) fn cells_towards(direction: IVec3) -> u64 {
    let near = |d: i32| match d {
        0 => 0b1111,
        1 => 0b1110,
        _ => 0b0111,
    };
    let [x, y, z] = direction.to_array().map(near);
    mask(x, y, z)
}

/// Filters the normals of the `wanted` cells of a brick. `around` gives the cells of a brick by its offset from this
/// one.
#[inline(always)]
pub fn filter_cells<'a, S: Simd>(
    simd: S,
    wanted: u64,
    around: &impl Fn(IVec3) -> Option<&'a MergedSamples>,
    neighbourhood: &mut Neighbourhood,
    out: &mut CellNormals,
) {
    let Some(cells) = around(IVec3::ZERO) else { return };
    let estimates = |offset| around(offset).map(|cells| (cells, &cells.normals));
    let places = Places::of_cube(IVec3::ZERO, 8.0, CELL_REACH_VX);
    neighbourhood.collect(simd, IVec3::splat(-2), &places, &estimates);
    for cell in bits(cells.used & wanted) {
        let (at, estimate) = (get(&cells.positions, cell), get(&cells.normals, cell));
        let sums = neighbourhood.sum(simd, at, estimate, CELL_REACH_VX);
        set(out, cell, sums.normal.try_normalize().unwrap_or(estimate));
    }
}

/// Computes the normals and depths of the surface voxels of a brick, and calls `out` with each, in the order of the
/// samples. The normal is of any length, and 0 if there is none. The depth of a voxel's centre below the surface is
/// along its normal, in voxels. `around` gives cells and filtered normals of a brick by its offset from this one.
#[inline(always)]
pub fn filter_voxels<'a, S: Simd>(
    simd: S,
    samples: &BrickSamples,
    around: &impl Fn(IVec3) -> Option<(&'a MergedSamples, &'a CellNormals)>,
    neighbourhood: &mut Neighbourhood,
    mut out: impl FnMut(usize, Vec3, f32),
) {
    // In cubes of 4^3 voxels, so that the lists are short.
    for word in 0..8 {
        let corner = IVec3::new(word & 1, word >> 1 & 1, word >> 2);
        let square = 0x0F0F_0F0Fu64 << (4 * corner.x + 32 * corner.y);
        let layers = 4 * corner.z as usize..4 * corner.z as usize + 4;
        if samples.mask.layers[layers.clone()].iter().all(|layer| layer & square == 0) {
            continue;
        }
        let places = Places::of_cube(4 * corner, 4.0, VOXEL_REACH_VX);
        neighbourhood.collect(simd, 2 * corner - 3, &places, around);
        let mut first = samples.mask.layers[..layers.start].iter().map(count).sum::<usize>();
        for (z, layer) in layers.clone().zip(&samples.mask.layers[layers]) {
            for bit in bits(layer & square) {
                let i = first + count(&(layer & ((1 << bit) - 1)));
                let (at, estimate) = (samples.position(i), samples.normal(i));
                let sums = neighbourhood.sum(simd, at, estimate, VOXEL_REACH_VX);
                let normal = sums.normal + estimate * OWN_WEIGHT;
                let voxel = Vec3::new((bit & 7) as f32, (bit >> 3) as f32, z as f32) + 0.5;
                out(i, normal, depth(voxel, at, normal, &sums));
            }
            first += count(layer);
        }
    }
}

/// Returns the depth of `voxel` below the surface around `at`, along `normal`, which has any length.
///
/// The mean of two heights of the cells above `at`: along this normal, and along theirs. On a curved surface, cells lie
/// below the one plane by as much as `at` lies below the other, so the mean has no bias. Their difference gives the
/// curvature, and with it the displacement of the surface by smoothing the bits.
#[inline(always)]
fn depth(voxel: Vec3, at: Vec3, normal: Vec3, sums: &CellSums) -> f32 {
    let normal = normal.normalize_or_zero();
    if sums.weight <= LEAST_WEIGHT {
        return (at - voxel).dot(normal);
    }
    let (along_theirs, along_this) = (sums.height, normal.dot(sums.offset));
    let height = 0.5 * (along_theirs + along_this) + CURVATURE_SHIFT * (along_theirs - along_this);
    (at - voxel).dot(normal) + height / sums.weight
}

#[inline(always)]
fn count(layer: &u64) -> usize {
    layer.count_ones() as usize
}
