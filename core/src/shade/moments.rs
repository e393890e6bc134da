//! The first moments of existence around voxels, which give the gradients.
//!
//! Five voxels along an axis always lie in two words of 4^3, so that eight words hold all neighbours.
//! Folded to one word, with a bit for each residue modulo 4, only neighbours two voxels to either side
//! would collide. Two folded words therefore hold all neighbours, and counts of their planes give the
//! moments exactly.
//!
//! From the eight words around a voxel to whole numbers. Knows no grid.

use glam::IVec3;

/// Squared distance within which a voxel counts as a neighbour.
const REACH_SQUARED: i32 = 6;

/// The neighbours of a voxel in the eight words around it.
#[derive(Clone, Copy)]
struct NeighbourMasks {
    /// The neighbours two voxels up on some axis.
    upper: [u64; 8],
    /// The other neighbours.
    lower: [u64; 8],
}

/// The masks for voxel `2 + (x, y, z)` of a cube of 8^3, at index `x + 4y + 16z`.
static NEIGHBOURS: [NeighbourMasks; 64] = neighbours();

/// The voxels of a word whose x, y, z is 0. Shifted by `1 << 2 * axis`, they are those of 1.
const PLANES: [u64; 3] = [0x1111_1111_1111_1111, 0x000F_000F_000F_000F, 0xFFFF];

const fn neighbours() -> [NeighbourMasks; 64] {
    let mut masks = [NeighbourMasks { upper: [0; 8], lower: [0; 8] }; 64];
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

/// Returns the existing neighbours of voxel `2 + (x, y, z)` of a cube of eight words, folded to two; `at` is `x + 4y +
/// 16z`.
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

/// Returns minus the sum of the offsets of folded neighbours.
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
