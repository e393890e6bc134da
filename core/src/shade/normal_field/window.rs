//! First estimate of normals: the gradient of smoothed existence at the surface voxels of a brick, how planar the
//! surface is around each of them, and the depth of each.
//!
//! Existence is smoothed with a Gaussian of 1.3 voxels, in whole numbers and separably: nine voxels along each axis. So
//! a brick depends on the cube of 16^3 voxels around it, which is 4^3 words. In a half space the smoothed value of a
//! voxel determines its depth below the surface, and the depth determines the length of the gradient. The planarity is
//! the measured length over the expected one: 1 on planes, small on edges and in noise.
//!
//! Takes the bits around a brick, returns one sample for each of its surface voxels. Sums are whole numbers: along one
//! axis or two they fit in 16 bits, along three they are below 2^24, so they do not depend on the vector instructions.

use std::sync::LazyLock;

use fearless_simd::{Simd, f32x16, i16x32, prelude::*, u16x32};
use glam::{IVec3, Vec3};

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick};
use crate::shade::occlusion::{self, BrickFilling, WordsAround};

/// Reach of the smoothing along each axis.
pub const WINDOW_REACH_VX: usize = 4;

/// Edge of the cube of voxels that the samples of a brick depend on.
const CUBE: usize = 16;
/// Edge of a brick.
const EDGE: usize = BRICK_EDGE_VX as usize;
const TAPS: usize = 2 * WINDOW_REACH_VX + 1;

/// The Gaussian, of 1.3 voxels.
const WEIGHTS: [u16; TAPS] = [1, 5, 24, 58, 78, 58, 24, 5, 1];
/// Its sum, its second moment, and the standard deviation of these whole numbers.
const SUM: f64 = 254.0;
const SECOND_MOMENT: f64 = 430.0;
/// Number of intervals of the table of half spaces.
const INTERVALS: usize = 1024;

/// Weights of offsets times the offsets: a derivative.
const SLOPES: [i16; TAPS] = {
    let mut slopes = [0; TAPS];
    let mut i = 0;
    while i < TAPS {
        slopes[i] = WEIGHTS[i] as i16 * (i as i16 - WINDOW_REACH_VX as i16);
        i += 1;
    }
    slopes
};

/// The contributions of a row of sixteen voxels to the smoothed values and to the derivatives of the eight in its
/// middle, for each value of its lower and of its upper half.
struct RowTable {
    sums: [[[u16; EDGE]; 256]; 2],
    slopes: [[[i16; EDGE]; 256]; 2],
}

static ROWS: LazyLock<Box<RowTable>> = LazyLock::new(|| {
    let mut table =
        Box::new(RowTable { sums: [[[0; EDGE]; 256]; 2], slopes: [[[0; EDGE]; 256]; 2] });
    for half in 0..2 {
        for bits in 0..256 {
            for x in 0..EDGE {
                let set = (0..EDGE).filter(|i| bits >> i & 1 != 0).map(|i| i + EDGE * half);
                let taps =
                    || set.clone().filter_map(|i| i.checked_sub(x).filter(|tap| *tap < TAPS));
                table.sums[half][bits][x] = taps().map(|tap| WEIGHTS[tap]).sum();
                table.slopes[half][bits][x] = taps().map(|tap| SLOPES[tap]).sum();
            }
        }
    }
    table
});

/// The properties of a half space for each interval of its smoothed value: the depth of the voxel in voxels, and the
/// factor from the length of the gradient to the planarity.
static HALF_SPACE: LazyLock<[[f32; 2]; INTERVALS + 1]> = LazyLock::new(half_space);

/// Computes the table with basic operations only, so that all machines get the same numbers: the normal distribution is
/// summed in small steps.
fn half_space() -> [[f32; 2]; INTERVALS + 1] {
    const STEP: f64 = 1.0 / 4096.0;
    let deviation = (SECOND_MOMENT / SUM).sqrt();
    // From -5 to 5 standard deviations. exp(-x^2/2) is a product whose factor itself decreases by a constant factor.
    let mut table = [[0.0; 2]; INTERVALS + 1];
    let (mut x, mut share, mut next) = (-5.0f64, 0.0f64, 0);
    while next <= INTERVALS {
        let density = bell(x) / (std::f64::consts::TAU.sqrt() * deviation);
        if share * INTERVALS as f64 >= next as f64 || x >= 5.0 {
            // A surface voxel is at most a diagonal deep, and its centre is not outside.
            let depth = (x * deviation).clamp(0.0, 1.0);
            let scale = SECOND_MOMENT * SUM * SUM;
            table[next] = [depth as f32, (1.0 / (density * scale)) as f32];
            next += 1;
        } else {
            share += density * deviation * STEP;
            x += STEP;
        }
    }
    table
}

/// Returns `exp(-x^2 / 2)` by its series, with the argument reduced until it converges fast.
fn bell(x: f64) -> f64 {
    let y = x * x / 2.0 / 1024.0;
    let once = 1.0 - y * (1.0 - y / 2.0 * (1.0 - y / 3.0 * (1.0 - y / 4.0)));
    (0..10).fold(once, |v, _| v * v)
}

/// The surface voxels of a brick: existing ones that have an empty neighbour across a face. Voxels outside the grid are
/// empty.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct SurfaceMask {
    /// A word per z; bit `x + 8 y`.
    pub layers: [u64; EDGE],
}

impl SurfaceMask {
    /// Returns the number of voxels.
    pub fn count(&self) -> usize {
        self.layers.iter().map(|layer| layer.count_ones() as usize).sum()
    }
}

/// First estimates of a brick, in the order of the bits of its [`SurfaceMask`].
#[derive(Debug, Default)]
pub struct BrickSamples {
    pub mask: SurfaceMask,
    /// Points on the surface, in voxels from the lower corner of the brick: centres of voxels, moved outwards by their
    /// depth.
    pub positions: [Vec<f32>; 3],
    /// Point out of the solid; of unit length, or 0.
    pub normals: [Vec<f32>; 3],
    /// Planarity, 0 to 1.
    pub planarity: Vec<f32>,
    /// The filled part around all voxels of a brick with surface, if requested: `x + 8 y + 64 z`.
    pub filling: BrickFilling,
}

impl BrickSamples {
    pub fn normal(&self, i: usize) -> Vec3 {
        Vec3::new(self.normals[0][i], self.normals[1][i], self.normals[2][i])
    }

    pub fn position(&self, i: usize) -> Vec3 {
        Vec3::new(self.positions[0][i], self.positions[1][i], self.positions[2][i])
    }

    fn clear(&mut self) {
        self.positions.iter_mut().chain(&mut self.normals).for_each(Vec::clear);
        self.planarity.clear();
    }
}

/// Sums over the cube, smoothed or differentiated along x, then y: memory for [`sample`].
#[derive(Debug)]
pub struct WindowSums {
    /// Along x: `[z][y][x]` over the cube's y and z and the brick's x.
    row: [[[u16; EDGE]; CUBE]; CUBE],
    row_slope: [[[i16; EDGE]; CUBE]; CUBE],
    /// Along x and y, over the cube's z.
    layer: [[[f32; EDGE]; EDGE]; CUBE],
    layer_slope_x: [[[f32; EDGE]; EDGE]; CUBE],
    layer_slope_y: [[[f32; EDGE]; EDGE]; CUBE],
}

impl Default for WindowSums {
    fn default() -> WindowSums {
        let layers = [[[0.0; EDGE]; EDGE]; CUBE];
        WindowSums {
            row: [[[0; EDGE]; CUBE]; CUBE],
            row_slope: [[[0; EDGE]; CUBE]; CUBE],
            layer: layers,
            layer_slope_x: layers,
            layer_slope_y: layers,
        }
    }
}

/// The requested results for a brick.
#[derive(Clone, Copy)]
pub struct Wanted {
    /// The words with samples: a bit each.
    pub words: u8,
    /// Whether to compute the filled part around its voxels.
    pub filling: bool,
}

/// Replaces `samples` by those of the brick at brick coordinates `brick`. Their mask is that of the requested words.
#[inline(always)]
pub fn sample<S: Simd>(
    simd: S,
    grid: &Grid,
    brick: IVec3,
    wanted: Wanted,
    sums: &mut WindowSums,
    samples: &mut BrickSamples,
) {
    samples.clear();
    let words = words_around(grid, brick);
    let rows = rows_of(&words);
    samples.mask = surface_mask(&rows, wanted.words);
    if samples.mask == SurfaceMask::default() {
        return;
    }
    if wanted.filling {
        samples.filling.fill(&occlusion::table_of(&words));
    }
    // The rows and layers of voxels that have samples, and those of the cube that these depend on.
    let (mut all, mut layers) = (0, 0);
    for (z, layer) in samples.mask.layers.iter().enumerate() {
        all |= layer;
        layers |= u32::from(*layer != 0) << z;
    }
    let lines = (0..EDGE).fold(0, |lines, y| lines | u32::from(all >> (EDGE * y) & 0xFF != 0) << y);
    let [cube_lines, cube_layers] = [reached(lines), reached(layers)];
    sum_rows(&rows, [cube_lines, cube_layers], sums);
    sum_layers(simd, [lines, cube_layers], sums);
    for (z, layer) in (0..).zip(samples.mask.layers) {
        for pair in 0..EDGE / 2 {
            let bits = layer >> (16 * pair) & 0xFFFF;
            if bits != 0 {
                sum_columns(simd, sums, [2 * pair, z], bits as u32, samples);
            }
        }
    }
}

/// Returns the positions along an axis of the cube that the windows of these positions of the brick reach: a bit each.
fn reached(places: u32) -> u32 {
    (0..TAPS).fold(0, |reached, tap| reached | places << tap)
}

/// Returns the words around a brick, of which the middle two along each axis are the brick's.
#[inline(always)]
fn words_around(grid: &Grid, brick: IVec3) -> WordsAround {
    // For each word along an axis: the index of its brick among three, and its half of that brick.
    const FROM: [(usize, usize); 4] = [(0, 1), (1, 0), (1, 1), (2, 0)];
    let dims = grid.brick_dims().as_ivec3();
    let mut bricks = [&Brick::EMPTY; 27];
    for (i, found) in (0..).zip(&mut bricks) {
        let b = brick + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
        if b.cmpge(IVec3::ZERO).all() && b.cmplt(dims).all() {
            *found = grid.brick(b.as_uvec3());
        }
    }
    let mut words = WordsAround::default();
    for (plane, (z, half_z)) in words.iter_mut().zip(FROM) {
        for (row, (y, half_y)) in plane.iter_mut().zip(FROM) {
            for (word, (x, half_x)) in row.iter_mut().zip(FROM) {
                *word = bricks[x + 3 * y + 9 * z].words[half_x + 2 * half_y + 4 * half_z];
            }
        }
    }
    words
}

/// Returns the bits of the 16^3 voxels around a brick: a row along x for each y and z.
#[inline(always)]
fn rows_of(words: &WordsAround) -> [[u16; CUBE]; CUBE] {
    let mut rows = [[0; CUBE]; CUBE];
    for (wz, plane) in words.iter().enumerate() {
        for (wy, words) in plane.iter().enumerate() {
            for z in 0..4 {
                let mut four = 0u64;
                for (i, word) in words.iter().enumerate() {
                    four |= spread_nibbles(word >> (16 * z) & 0xFFFF) << (4 * i);
                }
                for y in 0..4 {
                    rows[4 * wz + z][4 * wy + y] = (four >> (16 * y)) as u16;
                }
            }
        }
    }
    rows
}

/// Returns the four nibbles of 16 bits, each in the lowest bits of 16.
#[inline(always)]
fn spread_nibbles(bits: u64) -> u64 {
    let pairs = (bits | bits << 24) & 0x0000_00FF_0000_00FF;
    (pairs | pairs << 12) & 0x000F_000F_000F_000F
}

#[inline(always)]
fn surface_mask(rows: &[[u16; CUBE]; CUBE], words: u8) -> SurfaceMask {
    let mut mask = SurfaceMask::default();
    for z in 0..EDGE {
        for y in 0..EDGE {
            let (z_in, y_in) = (z + WINDOW_REACH_VX, y + WINDOW_REACH_VX);
            let row = rows[z_in][y_in];
            let buried = row << 1
                & row >> 1
                & rows[z_in][y_in - 1]
                & rows[z_in][y_in + 1]
                & rows[z_in - 1][y_in]
                & rows[z_in + 1][y_in];
            let halves = words >> (2 * (y / 4) + 4 * (z / 4)) & 3;
            let wanted = [0, 0x0F, 0xF0, 0xFF][usize::from(halves)];
            let surface = (row & !buried) >> WINDOW_REACH_VX & wanted;
            mask.layers[z] |= u64::from(surface) << (EDGE * y);
        }
    }
    mask
}

/// Sums the selected lines and layers along x.
#[inline(always)]
fn sum_rows(rows: &[[u16; CUBE]; CUBE], [lines, layers]: [u32; 2], sums: &mut WindowSums) {
    let table = &**ROWS;
    let sums_of_layers = sums.row.iter_mut().zip(&mut sums.row_slope);
    for (z, (rows, (sums, slopes))) in rows.iter().zip(sums_of_layers).enumerate() {
        if layers >> z & 1 == 0 {
            continue;
        }
        for (y, (row, (sums, slopes))) in rows.iter().zip(sums.iter_mut().zip(slopes)).enumerate() {
            if lines >> y & 1 == 0 {
                continue;
            }
            let [lower, upper] = [usize::from(row & 255), usize::from(row >> 8)];
            for x in 0..EDGE {
                sums[x] = table.sums[0][lower][x] + table.sums[1][upper][x];
                slopes[x] = table.slopes[0][lower][x] + table.slopes[1][upper][x];
            }
        }
    }
}

/// Sums the selected lines and layers along y, four rows at a time; rows that are not selected are unspecified.
#[inline(always)]
fn sum_layers<S: Simd>(simd: S, [lines, layers]: [u32; 2], sums: &mut WindowSums) {
    for z in 0..CUBE {
        if layers >> z & 1 == 0 {
            continue;
        }
        let row = sums.row[z].as_flattened();
        let row_slope = sums.row_slope[z].as_flattened();
        for y in (0..EDGE).step_by(4) {
            if lines >> y & 0xF == 0 {
                continue;
            }
            let mut sum = u16x32::splat(simd, 0);
            let (mut slope_x, mut slope_y) = (i16x32::splat(simd, 0), i16x32::splat(simd, 0));
            for tap in 0..TAPS {
                let at = EDGE * (y + tap);
                let values = u16x32::from_slice(simd, &row[at..at + 32]);
                let slopes = i16x32::from_slice(simd, &row_slope[at..at + 32]);
                sum += values * WEIGHTS[tap];
                slope_y += values.bitcast::<i16x32<S>>() * SLOPES[tap];
                slope_x += slopes * (WEIGHTS[tap] as i16);
            }
            let (lower, upper) = sum.widen();
            let (lower_x, upper_x) = slope_x.widen();
            let (lower_y, upper_y) = slope_y.widen();
            let at = EDGE * y;
            for (at, sum, [slope_x, slope_y]) in
                [(at, lower, [lower_x, lower_y]), (at + 16, upper, [upper_x, upper_y])]
            {
                store(sum.to_float(), &mut sums.layer[z], at);
                store(slope_x.to_float(), &mut sums.layer_slope_x[z], at);
                store(slope_y.to_float(), &mut sums.layer_slope_y[z], at);
            }
        }
    }
}

#[inline(always)]
fn store<S: Simd>(values: f32x16<S>, layer: &mut [[f32; EDGE]; EDGE], first: usize) {
    values.store_slice(&mut layer.as_flattened_mut()[first..first + 16]);
}

#[inline(always)]
fn load<S: Simd>(simd: S, layer: &[[f32; EDGE]; EDGE], first: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &layer.as_flattened()[first..first + 16])
}

/// Sums two rows of voxels along z, starting at `y`, and appends the samples of those whose bits are set.
#[inline(always)]
fn sum_columns<S: Simd>(
    simd: S,
    sums: &WindowSums,
    [y, z]: [usize; 2],
    bits: u32,
    samples: &mut BrickSamples,
) {
    let zero = f32x16::splat(simd, 0.0);
    let (mut sum, mut slopes) = (zero, [zero; 3]);
    for tap in 0..TAPS {
        let layer = z + tap;
        let values = load(simd, &sums.layer[layer], EDGE * y);
        let [weight, slope] = [f32::from(WEIGHTS[tap]), f32::from(SLOPES[tap])];
        sum += values * weight;
        slopes[0] += load(simd, &sums.layer_slope_x[layer], EDGE * y) * weight;
        slopes[1] += load(simd, &sums.layer_slope_y[layer], EDGE * y) * weight;
        slopes[2] += values * slope;
    }
    let length = (slopes[0] * slopes[0] + slopes[1] * slopes[1] + slopes[2] * slopes[2]).sqrt();
    // Whole numbers: a gradient that is not zero has a length of at least 1.
    let outwards = f32x16::splat(simd, -1.0) / length.max(1.0);
    let interval = (sum * (INTERVALS as f64 / (SUM * SUM * SUM)) as f32).to_array();
    let length = length.to_array();
    let normals = [
        (slopes[0] * outwards).to_array(),
        (slopes[1] * outwards).to_array(),
        (slopes[2] * outwards).to_array(),
    ];
    let table = &*HALF_SPACE;
    let mut rest = bits;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize & 15;
        rest &= rest - 1;
        let [depth, factor] = table[(interval[lane] as usize).min(INTERVALS)];
        let voxel = [lane % EDGE, y + lane / EDGE, z];
        for axis in 0..3 {
            let normal = normals[axis][lane];
            samples.normals[axis].push(normal);
            samples.positions[axis].push(voxel[axis] as f32 + 0.5 + normal * depth);
        }
        samples.planarity.push((length[lane] * factor).min(1.0));
    }
}
