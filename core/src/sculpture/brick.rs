//! The brick: 8x8x8 existence bits in one 64-byte cache line.
//!
//! A brick is eight 64-bit words, each a cube of 4x4x4 voxels. A word is the next level of the
//! hierarchy: a ray or an edit that finds it 0 or all ones skips 64 voxels at once. It is also one
//! `R32G32_UINT` texel of the bit image.
//!
//! - word of local voxel (x, y, z): `x/4 + 2*(y/4) + 4*(z/4)`
//! - bit in the word: `x%4 + 4*(y%4) + 16*(z%4)`
//!
//! Knows nothing of grids, colours or files.

use bytemuck::{Pod, Zeroable};
use glam::UVec3;

/// Voxels along one edge of a brick.
pub const BRICK_EDGE_VX: u32 = 8;
/// Voxels in a brick.
pub const BRICK_VOXELS: u32 = 512;
/// Voxels along one edge of a word.
pub const WORD_EDGE_VX: u32 = 4;
/// Words in a brick.
pub const BRICK_WORDS: usize = 8;

/// 8x8x8 existence bits; see the module text for the order of the bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Brick {
    /// Words of 4^3 voxels, x fastest, then y, then z.
    pub words: [u64; BRICK_WORDS],
}

/// How full a brick is, as its voxel count tells.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum BrickKind {
    /// No voxel.
    Empty,
    /// Some voxels, but not all 512.
    Mixed,
    /// All 512 voxels.
    Full,
}

/// Returns the index in 0..512 of a voxel in its brick, from brick-local coordinates 0..8: `word * 64 + bit`. Colour
/// pages use the same order.
#[inline(always)]
pub const fn local_index(x: u32, y: u32, z: u32) -> u32 {
    let word = (x >> 2) | ((y >> 2) << 1) | ((z >> 2) << 2);
    let bit = (x & 3) | ((y & 3) << 2) | ((z & 3) << 4);
    (word << 6) | bit
}

/// Returns the brick-local coordinates 0..8 of a voxel from its index 0..512 in the brick.
#[inline(always)]
pub const fn local_coords(index: u32) -> [u32; 3] {
    let (word, bit) = (index >> 6, index & 63);
    [
        ((word & 1) << 2) | (bit & 3),
        ((word >> 1 & 1) << 2) | (bit >> 2 & 3),
        ((word >> 2 & 1) << 2) | (bit >> 4 & 3),
    ]
}

impl Brick {
    /// No voxel exists.
    pub const EMPTY: Brick = Brick { words: [0; BRICK_WORDS] };
    /// All 512 voxels exist.
    pub const FULL: Brick = Brick { words: [u64::MAX; BRICK_WORDS] };

    /// Returns whether the voxel at brick-local coordinates (each 0..8) exists.
    #[inline(always)]
    pub fn get(&self, x: u32, y: u32, z: u32) -> bool {
        let i = local_index(x, y, z);
        self.words[(i >> 6) as usize] >> (i & 63) & 1 != 0
    }

    /// Sets or clears the voxel at brick-local coordinates (each 0..8).
    #[inline(always)]
    pub fn set(&mut self, x: u32, y: u32, z: u32, exists: bool) {
        let i = local_index(x, y, z);
        let mask = 1u64 << (i & 63);
        if exists {
            self.words[(i >> 6) as usize] |= mask;
        } else {
            self.words[(i >> 6) as usize] &= !mask;
        }
    }

    /// Returns the number of existing voxels, 0..=512.
    #[inline(always)]
    pub fn count(&self) -> u16 {
        let mut count = 0;
        for word in self.words {
            count += word.count_ones();
        }
        count as u16
    }

    /// Returns whether no voxel exists.
    #[inline]
    pub fn is_empty(&self) -> bool {
        *self == Self::EMPTY
    }

    /// Returns whether all 512 voxels exist.
    #[inline]
    pub fn is_full(&self) -> bool {
        *self == Self::FULL
    }

    /// Combines two bricks word by word.
    #[inline(always)]
    pub fn zip(&self, other: &Brick, f: impl Fn(u64, u64) -> u64) -> Brick {
        let mut words = [0; BRICK_WORDS];
        for (i, word) in words.iter_mut().enumerate() {
            *word = f(self.words[i], other.words[i]);
        }
        Brick { words }
    }

    /// Returns the voxels that are in both.
    #[inline(always)]
    pub fn and(&self, other: &Brick) -> Brick {
        self.zip(
            other,
            #[inline(always)]
            |a, b| a & b,
        )
    }

    /// Returns the voxels that are in either.
    #[inline(always)]
    pub fn or(&self, other: &Brick) -> Brick {
        self.zip(
            other,
            #[inline(always)]
            |a, b| a | b,
        )
    }

    /// Returns the voxels of `self` that are not in `other`.
    #[inline(always)]
    pub(crate) fn and_not(&self, other: &Brick) -> Brick {
        self.zip(
            other,
            #[inline(always)]
            |a, b| a & !b,
        )
    }

    /// Builds a brick from its 64 rows: `rows[z]` holds 8 bytes, byte `y` the row of
    /// eight voxels along x (bit 0 is x = 0).
    #[inline]
    pub fn from_rows(rows: &[u64; 8]) -> Brick {
        let mut words = [0u64; BRICK_WORDS];
        for (z, &slice) in rows.iter().enumerate() {
            let shift = (z & 3) * 16;
            let base = (z >> 2) * 4;
            let low = pack_nibbles(slice & 0x0F0F_0F0F_0F0F_0F0F);
            let high = pack_nibbles(slice >> 4 & 0x0F0F_0F0F_0F0F_0F0F);
            words[base] |= (low & 0xFFFF) << shift;
            words[base + 1] |= (high & 0xFFFF) << shift;
            words[base + 2] |= (low >> 32 & 0xFFFF) << shift;
            words[base + 3] |= (high >> 32 & 0xFFFF) << shift;
        }
        Brick { words }
    }

    /// Performs the inverse of [`Brick::from_rows`].
    #[inline]
    pub fn to_rows(&self) -> [u64; 8] {
        std::array::from_fn(|z| {
            let shift = (z & 3) * 16;
            let base = (z >> 2) * 4;
            let piece = |i: usize| self.words[base + i] >> shift & 0xFFFF;
            let low = piece(0) | piece(2) << 32;
            let high = piece(1) | piece(3) << 32;
            unpack_nibbles(low) | unpack_nibbles(high) << 4
        })
    }

    /// Returns the voxels whose brick-local coordinates are below `limit` on every axis (each limit is clamped to 8):
    /// those that a brick at the upper border may hold.
    pub fn below(limit: [u32; 3]) -> Brick {
        let row = low_bits(limit[0].min(8)) as u64;
        let mut rows = [0u64; 8];
        for slice in rows.iter_mut().take(limit[2].min(8) as usize) {
            for y in 0..limit[1].min(8) {
                *slice |= row << (8 * y);
            }
        }
        Brick::from_rows(&rows)
    }

    /// Calls `f` with the index 0..512 of every existing voxel, in ascending order.
    #[inline]
    pub fn for_each(&self, mut f: impl FnMut(u32)) {
        for (word, &bits) in self.words.iter().enumerate() {
            let mut rest = bits;
            while rest != 0 {
                f((word as u32) << 6 | rest.trailing_zeros());
                rest &= rest - 1;
            }
        }
    }
}

/// Returns the lowest set voxel of a word, and one past the highest, on each axis. The word must not be 0.
#[inline]
pub(crate) fn word_bounds(word: u64) -> (UVec3, UVec3) {
    // Folded to the four bits of each axis.
    let z = (0..4).fold(0, |z, i| z | u32::from(word >> (16 * i) & 0xFFFF != 0) << i);
    let layer = word | word >> 16 | word >> 32 | word >> 48;
    let y = (0..4).fold(0, |y, i| y | u32::from(layer >> (4 * i) & 0xF != 0) << i);
    let x = ((layer | layer >> 4 | layer >> 8 | layer >> 12) & 0xF) as u32;
    let axes = [x, y, z];
    let low = axes.map(u32::trailing_zeros);
    (UVec3::from(low), UVec3::from(axes.map(|bits| 32 - bits.leading_zeros())))
}

/// Returns a number whose lowest `n` bits (0..=8) are set.
#[inline]
fn low_bits(n: u32) -> u32 {
    (1u32 << n) - 1
}

/// Packs four bytes holding a nibble each into 16 contiguous bits, in both halves of a u64 at once.
#[inline]
fn pack_nibbles(v: u64) -> u64 {
    let v = (v | v >> 4) & 0x00FF_00FF_00FF_00FF;
    (v | v >> 8) & 0x0000_FFFF_0000_FFFF
}

/// Performs the inverse of [`pack_nibbles`].
#[inline]
fn unpack_nibbles(v: u64) -> u64 {
    let v = (v | v << 8) & 0x00FF_00FF_00FF_00FF;
    (v | v << 4) & 0x0F0F_0F0F_0F0F_0F0F
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn local_index_and_coords_are_inverse_and_cover_the_brick() {
        let mut seen = [false; BRICK_VOXELS as usize];
        for z in 0..8 {
            for y in 0..8 {
                for x in 0..8 {
                    let i = local_index(x, y, z);
                    assert_eq!(local_coords(i), [x, y, z]);
                    assert!(!std::mem::replace(&mut seen[i as usize], true));
                }
            }
        }
    }

    proptest! {
        #[test]
        fn rows_round_trip(words: [u64; 8]) {
            let brick = Brick { words };
            prop_assert_eq!(Brick::from_rows(&brick.to_rows()), brick);
        }

        #[test]
        fn rows_agree_with_get(rows: [u64; 8]) {
            let brick = Brick::from_rows(&rows);
            for z in 0..8u32 { for y in 0..8u32 { for x in 0..8u32 {
                prop_assert_eq!(brick.get(x, y, z), rows[z as usize] >> (8 * y + x) & 1 != 0);
            } } }
        }

        #[test]
        fn below_is_the_box(limit: [u8; 3]) {
            let limit = limit.map(|v| v as u32 % 12);
            let brick = Brick::below(limit);
            for z in 0..8u32 { for y in 0..8u32 { for x in 0..8u32 {
                prop_assert_eq!(brick.get(x, y, z), x < limit[0] && y < limit[1] && z < limit[2]);
            } } }
        }

        #[test]
        fn for_each_visits_every_bit_once(words: [u64; 8]) {
            let brick = Brick { words };
            let mut copy = Brick::EMPTY;
            let mut visits = 0;
            brick.for_each(|i| { let [x, y, z] = local_coords(i); copy.set(x, y, z, true); visits += 1; });
            prop_assert_eq!(copy, brick);
            prop_assert_eq!(visits, brick.count());
        }
    }
}
