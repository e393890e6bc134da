//! The first moments of existence around voxels, which are their gradients.
//!
//! Five voxels along an axis always lie in two words of 4^3, so that eight words hold all neighbours.
//! Folded to one word, with a bit for each residue modulo 4, only neighbours two voxels to either side
//! would collide. Two folded words therefore hold all neighbours, and counts of their planes give the
//! moments exactly.
//!
//! From the eight words around a voxel to whole numbers. Knows no grid.

use fearless_simd::{Level, Simd, i16x32, i32x16, prelude::*, u8x64, u32x16, u64x8};
use glam::IVec3;

/// Squared distance within which a voxel counts as a neighbour.
const REACH_SQUARED: i32 = 6;

/// The neighbours of a voxel in the eight words around it.
#[derive(Clone, Copy)]
struct Masks {
    /// Those two voxels up on some axis.
    upper: [u64; 8],
    /// The others.
    lower: [u64; 8],
}

/// For a voxel `2 + (x, y, z)` of a cube of 8^3, `x + 4y + 16z` the index.
static NEIGHBOURS: [Masks; 64] = neighbours();

/// The voxels of a word whose x, y, z is 0. Shifted by `1 << 2 * axis` they are those of 1.
const PLANES: [u64; 3] = [0x1111_1111_1111_1111, 0x000F_000F_000F_000F, 0xFFFF];

const fn neighbours() -> [Masks; 64] {
    let mut masks = [Masks { upper: [0; 8], lower: [0; 8] }; 64];
    let mut voxel = 0;
    while voxel < 64 {
        let mut other = 0;
        while other < 512 {
            let dx = (other & 7) - ((voxel & 3) + 2);
            let dy = (other >> 3 & 7) - ((voxel >> 2 & 3) + 2);
            let dz = (other >> 6) - ((voxel >> 4) + 2);
            if dx * dx + dy * dy + dz * dz <= REACH_SQUARED {
                let word = (other >> 2 & 1) | (other >> 5 & 1) << 1 | (other >> 8 & 1) << 2;
                let bit = (other & 3) | (other >> 3 & 3) << 2 | (other >> 6 & 3) << 4;
                let masks = &mut masks[voxel as usize];
                if dx == 2 || dy == 2 || dz == 2 {
                    masks.upper[word as usize] |= 1 << bit;
                } else {
                    masks.lower[word as usize] |= 1 << bit;
                }
            }
            other += 1;
        }
        voxel += 1;
    }
    masks
}

/// Folded neighbours of sixteen voxels.
#[derive(Default)]
pub(super) struct FoldedLanes {
    pub upper: [[u64; 8]; 2],
    pub lower: [[u64; 8]; 2],
}

/// The existing neighbours of voxel `2 + (x, y, z)` of a cube of eight words, folded to two;
/// `at` is `x + 4y + 16z`.
#[inline(always)]
pub(super) fn fold(at: usize, bits: &[u64; 8]) -> (u64, u64) {
    let masks = &NEIGHBOURS[at & 63];
    let (mut upper, mut lower) = (0, 0);
    for (word, (mask_upper, mask_lower)) in bits.iter().zip(masks.upper.iter().zip(&masks.lower)) {
        upper |= word & mask_upper;
        lower |= word & mask_lower;
    }
    (upper, lower)
}

/// Minus the sum of the offsets of folded neighbours.
#[inline(always)]
pub(super) fn moments(at: usize, upper: u64, lower: u64) -> IVec3 {
    let moment = |axis: usize| {
        // The voxel itself has residue `at + 2` on the axis.
        let plane = |residue: usize| PLANES[axis] << ((residue & 3) << (2 * axis));
        let at = at >> (2 * axis);
        let (two, down, up) = (plane(at), plane(at + 1), plane(at + 3));
        let count = |bits: u64| bits.count_ones() as i32;
        2 * (count(lower & two) - count(upper & two))
            + (count(lower & down) - count(lower & up))
            + (count(upper & down) - count(upper & up))
    };
    IVec3::new(moment(0), moment(1), moment(2))
}

/// [`moments`] of sixteen voxels.
#[inline(always)]
pub(super) fn moments_of_many<S: Simd>(
    simd: S,
    at: u32x16<S>,
    folded: &FoldedLanes,
) -> [i32x16<S>; 3] {
    if can_look_up(simd) {
        let (at_0, at_1) = at.widen();
        let ([upper_0, upper_1], [lower_0, lower_1]) = (&folded.upper, &folded.lower);
        let first = moments_of_eight(simd, at_0, upper_0, lower_0);
        let second = moments_of_eight(simd, at_1, upper_1, lower_1);
        // The sums are the lowest 16 bits.
        let both =
            |axis: usize| (first[axis].narrow(second[axis]).bitcast::<i32x16<S>>() << 16) >> 16;
        return [both(0), both(1), both(2)];
    }
    // Without vector table lookups, one at a time is faster.
    let at = at.to_array();
    let mut moments_of = [[0; 16]; 3];
    for lane in 0..16 {
        let (upper, lower) = (folded.upper[lane / 8][lane % 8], folded.lower[lane / 8][lane % 8]);
        let moments = moments(at[lane] as usize, upper, lower);
        for axis in 0..3 {
            moments_of[axis][lane] = moments[axis];
        }
    }
    moments_of.map(|v| i32x16::load_array(simd, v))
}

/// Whether vectors look up bytes in a table of sixteen with one instruction.
#[inline(always)]
fn can_look_up<S: Simd>(simd: S) -> bool {
    match simd.level() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(_) | Level::Avx512(_) => true,
        #[cfg(target_arch = "aarch64")]
        Level::Neon(_) => true,
        _ => false,
    }
}

/// [`moments`] of eight voxels, in the lowest 16 bits of each.
///
/// Words are turned until the residue two voxels away is 0 on every axis, the one before the voxel
/// 1, the voxel's 2 and the next one's 3. Their nibbles, rows along x, are then looked up: how much
/// each weighs along x, and how many voxels it has, which weigh by their place along y and z.
#[inline(always)]
fn moments_of_eight<S: Simd>(
    simd: S,
    at: u64x8<S>,
    upper: &[u64; 8],
    lower: &[u64; 8],
) -> [u64x8<S>; 3] {
    let (upper, lower) = (turned(simd, at, upper), turned(simd, at, lower));
    // Rows at y 0 and 2, and at y 1 and 3.
    let (upper_even, upper_odd) = (low_nibbles(simd, upper), low_nibbles(simd, upper >> 4));
    let (lower_even, lower_odd) = (low_nibbles(simd, lower), low_nibbles(simd, lower >> 4));

    let along_x = look_up(simd, &LOWER_ALONG_X, lower_even)
        + look_up(simd, &LOWER_ALONG_X, lower_odd)
        + look_up(simd, &UPPER_ALONG_X, upper_even)
        + look_up(simd, &UPPER_ALONG_X, upper_odd);
    let x = even(simd, along_x) + odd(along_x);

    let (upper_even, upper_odd) =
        (look_up(simd, &COUNT, upper_even), look_up(simd, &COUNT, upper_odd));
    let (lower_even, lower_odd) =
        (look_up(simd, &COUNT, lower_even), look_up(simd, &COUNT, lower_odd));
    let two = even(simd, lower_even) - even(simd, upper_even);
    let one = lower_odd + upper_odd;
    let y = two + two + even(simd, one) - odd(one);

    let (upper, lower) = (upper_even + upper_odd, lower_even + lower_odd);
    let z = (even(simd, lower) + odd(lower)) * i16x32::load_array_ref(simd, &LOWER_ALONG_Z)
        + (even(simd, upper) + odd(upper)) * i16x32::load_array_ref(simd, &UPPER_ALONG_Z);
    [sum_of_four(x - BIAS_OF_PAIR), sum_of_four(y), sum_of_four(z)]
}

// Functions, not closures: code that is not inlined is not compiled for the instructions that the
// dispatch chose.

#[inline(always)]
fn low_nibbles<S: Simd>(simd: S, v: u64x8<S>) -> u8x64<S> {
    v.bitcast::<u8x64<S>>() & u8x64::splat(simd, 0xF)
}

#[inline(always)]
fn look_up<S: Simd>(simd: S, table: &[u8; 64], of: u8x64<S>) -> u8x64<S> {
    u8x64::load_array_ref(simd, table).swizzle_dyn_within_blocks(of)
}

/// The lower of each two bytes.
#[inline(always)]
fn even<S: Simd>(simd: S, v: u8x64<S>) -> i16x32<S> {
    v.bitcast::<i16x32<S>>() & i16x32::splat(simd, 0xFF)
}

/// The upper of each two bytes, none of which is so large that a sign comes into this.
#[inline(always)]
fn odd<S: Simd>(v: u8x64<S>) -> i16x32<S> {
    v.bitcast::<i16x32<S>>() >> 8
}

/// The sum of each four numbers, in the lowest 16 bits.
#[inline(always)]
fn sum_of_four<S: Simd>(v: i16x32<S>) -> u64x8<S> {
    let halves = v + (v.bitcast::<u64x8<S>>() >> 32).bitcast::<i16x32<S>>();
    (halves + (halves.bitcast::<u64x8<S>>() >> 16).bitcast::<i16x32<S>>()).bitcast()
}

/// Folded words rotated down by the residue of `at` along each axis.
#[inline(always)]
fn turned<S: Simd>(simd: S, at: u64x8<S>, words: &[u64; 8]) -> u64x8<S> {
    let word = u64x8::load_array_ref(simd, words);
    let word = turned_in(simd, word, at & 3, 4, PLANES[0]);
    let word = turned_in(simd, word, (at >> 2 & 3) << 2, 16, PLANES[0] & PLANES[1]);
    let by = (at >> 4 & 3) << 4;
    let back = (u64x8::splat(simd, 64) - by) & 63;
    word >> by | word << back
}

/// Bits rotated down by `by`, within groups of `span` bits that start at the bits of `firsts`.
#[inline(always)]
fn turned_in<S: Simd>(simd: S, word: u64x8<S>, by: u64x8<S>, span: u64, firsts: u64) -> u64x8<S> {
    let back = u64x8::splat(simd, span) - by;
    let firsts = u64x8::splat(simd, firsts);
    let not_round = (firsts << back) - firsts;
    (word >> by & not_round) | (word << back & !not_round)
}

/// What a row of four voxels, two voxels before the centre, one before, at it, and one behind, adds
/// to the moment along it, and that no number is negative.
const fn along_x(weights: [i8; 4], bias: i8) -> [u8; 64] {
    let mut table = [0; 64];
    let mut i = 0;
    while i < 64 {
        let mut sum = bias;
        let mut x = 0;
        while x < 4 {
            sum += weights[x] * (i >> x & 1) as i8;
            x += 1;
        }
        table[i] = sum as u8;
        i += 1;
    }
    // For each block of sixteen bytes that a vector looks up in.
    let mut i = 16;
    while i < 64 {
        table[i] = table[i - 16];
        i += 1;
    }
    table
}

static LOWER_ALONG_X: [u8; 64] = along_x([2, 1, 0, -1], 1);
static UPPER_ALONG_X: [u8; 64] = along_x([-2, 1, 0, -1], 3);
static COUNT: [u8; 64] = along_x([1, 1, 1, 1], 0);
/// Of two bytes, each with two rows of either kind.
const BIAS_OF_PAIR: i16 = 2 * 2 * (1 + 3);

/// The weights of four layers, for eight words.
const fn along_z(weights: [i16; 4]) -> [i16; 32] {
    let mut all = [0; 32];
    let mut i = 0;
    while i < 32 {
        all[i] = weights[i % 4];
        i += 1;
    }
    all
}

static LOWER_ALONG_Z: [i16; 32] = along_z([2, 1, 0, -1]);
static UPPER_ALONG_Z: [i16; 32] = along_z([-2, 1, 0, -1]);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::raycast::tests::levels;
    use fearless_simd::dispatch;
    use proptest::prelude::*;

    proptest! {
        /// With every set of instructions.
        #[test]
        fn sixteen_at_once_are_as_one_by_one(
            at in prop::array::uniform16(0u32..64),
            words in prop::array::uniform32(any::<u64>()),
            thin in any::<bool>(),
        ) {
            let mut folded = FoldedLanes::default();
            for (i, word) in words.into_iter().enumerate() {
                let part = if i < 16 { &mut folded.upper } else { &mut folded.lower };
                part[i / 8 % 2][i % 8] = if thin { word & word >> 7 & word >> 13 } else { word };
            }
            for level in levels() {
                let found: [[i32; 16]; 3] = dispatch!(level, simd => {
                    let at = u32x16::load_array(simd, at);
                    moments_of_many(simd, at, &folded).map(|v| v.to_array())
                });
                for lane in 0..16 {
                    let [upper, lower] = [folded.upper, folded.lower].map(|f| f[lane / 8][lane % 8]);
                    let expected = moments(at[lane] as usize, upper, lower);
                    prop_assert_eq!(IVec3::from(found.map(|axis| axis[lane])), expected);
                }
            }
        }
    }
}
