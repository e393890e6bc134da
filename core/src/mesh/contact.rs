//! The fans of surface faces around a corner of the voxel lattice, for each of the 256 ways to fill the eight voxels
//! around it.
//!
//! Twelve faces meet at a corner, one between each two of its voxels that touch. Those between an existing and an empty
//! voxel belong to the surface; they form closed fans, and each fan gets a vertex of its own. Around an edge in which
//! only two voxels exist and touch, four faces of the surface meet: those of the same voxel belong together. So voxels
//! that touch only in an edge or a corner are **separated**, and every fan is a disc.
//!
//! Octant `i` of a corner is the voxel at `corner - 1 + (i & 1, i >> 1 & 1, i >> 2)`. Along axis `a` a face has the
//! axes `u = a + 1` and `v = a + 2` (modulo 3); face `4 a + u + 2 v` lies on the side of the octants with these bits.
//! Pure tables; knows no grid.

use std::sync::LazyLock;

use glam::{IVec3, Vec3};

/// The most fans of a corner: four voxels that touch only in it, or in edges.
pub const MOST_FANS: usize = 4;

/// Marks a face that does not belong to the surface.
const NO_FAN: u8 = u8::MAX;

/// One fan of faces around a corner.
#[derive(Clone, Copy, Default, Debug)]
pub struct Fan {
    /// Its faces, a bit each.
    pub faces: u16,
    /// The existing voxels beside the faces, a bit per octant.
    pub solid: u8,
    /// Direction away from the other fans of the corner; 0 if there are none.
    pub apart: Vec3,
}

/// The properties of a corner that follow from its eight voxels.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Number of fans.
    pub count: u8,
    /// The fan of each face.
    pub fan_of: [u8; 12],
    /// The fans, by their lowest face.
    pub fans: [Fan; MOST_FANS],
    /// For each axis, whether the edge below (bit 0) and above (bit 1) is shared by four faces of the same fan.
    pub pinched: [u8; 3],
}

/// The corners, indexed by the octants that exist.
pub static CORNERS: LazyLock<[Corner; 256]> =
    LazyLock::new(|| std::array::from_fn(|octants| Corner::new(octants as u8)));

/// Returns the corners among 64 that have several fans or an edge that may be pinched. Bit `x` of word `i` is octant
/// `i` of corner `x`.
///
/// Such a corner has an edge around which the voxels alternate, or just two voxels, either existing or empty, that lie
/// opposite each other.
#[inline(always)]
pub(crate) fn odd_corners(words: &[u64; 8]) -> u64 {
    let mut odd = 0;
    for axis in 0..3 {
        for side in 0..2 {
            let [a, b] = [octant(axis, side, 0, 0), octant(axis, side, 1, 1)];
            let [c, d] = [octant(axis, side, 1, 0), octant(axis, side, 0, 1)];
            let [a, b, c, d] = [words[a], words[b], words[c], words[d]];
            odd |= (a ^ c) & !(a ^ b) & !(c ^ d);
        }
    }
    for i in 0..4 {
        let (mut any, mut all) = (0, u64::MAX);
        for j in (0..4).filter(|&j| j != i) {
            any |= words[j] | words[7 - j];
            all &= words[j] & words[7 - j];
        }
        let [a, b] = [words[i], words[7 - i]];
        odd |= a & b & !any | all & !(a | b);
    }
    odd
}

/// Returns the octant with bit `at` along `axis`, `u` and `v` along the next two axes.
const fn octant(axis: usize, at: usize, u: usize, v: usize) -> usize {
    at << axis | u << ((axis + 1) % 3) | v << ((axis + 2) % 3)
}

/// Returns the two octants beside a face: below and above along its axis.
pub const fn beside(face: usize) -> [usize; 2] {
    let (axis, u, v) = (face / 4, face & 1, face >> 1 & 1);
    [octant(axis, 0, u, v), octant(axis, 1, u, v)]
}

/// Returns the face between two octants that differ along one axis.
fn between(a: usize, b: usize) -> usize {
    let axis = (a ^ b).trailing_zeros() as usize;
    4 * axis + (a >> ((axis + 1) % 3) & 1) + 2 * (a >> ((axis + 2) % 3) & 1)
}

impl Corner {
    fn new(octants: u8) -> Corner {
        let exists = |i: usize| octants >> i & 1 != 0;
        let is_face = |face: usize| {
            let [low, high] = beside(face);
            exists(low) != exists(high)
        };
        // A fan is identified by its lowest face until all are known.
        let mut fan_of: [u8; 12] =
            std::array::from_fn(|face| if is_face(face) { face as u8 } else { NO_FAN });
        let mut join = |a: usize, b: usize| {
            let (low, high) = (fan_of[a].min(fan_of[b]), fan_of[a].max(fan_of[b]));
            fan_of.iter_mut().filter(|fan| **fan == high).for_each(|fan| *fan = low);
        };
        for (axis, side) in (0..6).map(|i| (i / 2, i % 2)) {
            // The octants around the edge, in order.
            let ring = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[u, v]| octant(axis, side, u, v));
            let around: [usize; 4] = std::array::from_fn(|i| between(ring[i], ring[(i + 1) % 4]));
            if around.iter().all(|&face| is_face(face)) {
                // Face i lies between octants i and i + 1: the faces beside an existing octant belong together.
                let first = usize::from(!exists(ring[0]));
                join(around[(first + 3) % 4], around[first]);
                join(around[(first + 1) % 4], around[(first + 2) % 4]);
            } else {
                let faces: Vec<usize> = around.into_iter().filter(|&face| is_face(face)).collect();
                if let [a, b] = faces[..] {
                    join(a, b);
                }
            }
        }
        let mut corner = Corner {
            count: 0,
            fan_of: [NO_FAN; 12],
            fans: [Fan::default(); MOST_FANS],
            pinched: [0; 3],
        };
        for face in (0..12).filter(|&face| fan_of[face] != NO_FAN) {
            if fan_of[face] as usize == face {
                corner.count += 1;
            }
            let number = match fan_of[face] as usize == face {
                true => corner.count - 1,
                false => corner.fan_of[fan_of[face] as usize],
            };
            corner.fan_of[face] = number;
            let fan = &mut corner.fans[number as usize];
            fan.faces |= 1 << face;
            let [low, high] = beside(face);
            fan.solid |= 1 << if exists(low) { low } else { high };
        }
        corner.part(octants);
        for (axis, side) in (0..6).map(|i| (i / 2, i % 2)) {
            let ring = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[u, v]| octant(axis, side, u, v));
            let fan = |i: usize| corner.fan_of[between(ring[i], ring[(i + 1) % 4])];
            let is_crossed = (0..4).all(|i| exists(ring[i]) != exists(ring[(i + 1) % 4]));
            if is_crossed && (1..4).all(|i| fan(i) == fan(0)) {
                corner.pinched[axis] |= 1 << side;
            }
        }
        corner
    }

    /// Computes the directions in which the fans are moved apart: each towards its side that no other fan bounds.
    fn part(&mut self, octants: u8) {
        if self.count < 2 {
            return;
        }
        for i in 0..self.count as usize {
            let fan = self.fans[i];
            let mut out = Vec3::ZERO;
            for face in (0..12).filter(|face| fan.faces >> face & 1 != 0) {
                let [low, _] = beside(face);
                let side = if fan.solid >> low & 1 != 0 { 1.0 } else { -1.0 };
                out[face / 4] += side;
            }
            let shares_solid = self.fans[..self.count as usize]
                .iter()
                .enumerate()
                .any(|(j, other)| j != i && connected(octants, other.solid, fan.solid));
            let apart = if shares_solid { out } else { -out };
            self.fans[i].apart = apart.normalize_or_zero();
        }
    }
}

/// Returns whether octants `a` and `b` are connected through faces of `all`.
fn connected(all: u8, a: u8, b: u8) -> bool {
    let mut reached = a;
    loop {
        let x = (reached & 0x55) << 1 | (reached & 0xAA) >> 1;
        let y = (reached & 0x33) << 2 | (reached & 0xCC) >> 2;
        let z = reached.rotate_left(4);
        let next = (reached | x | y | z) & all;
        if next == reached {
            return reached & b != 0;
        }
        reached = next;
    }
}

/// Returns the offset of an octant's voxel from the corner.
pub(crate) fn voxel_of(octant: usize) -> IVec3 {
    IVec3::new(octant as i32 & 1, octant as i32 >> 1 & 1, octant as i32 >> 2) - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_corners_are_those_with_several_fans_or_a_pinched_edge() {
        for (octants, corner) in CORNERS.iter().enumerate() {
            let words = std::array::from_fn(|i| (octants as u64 >> i & 1) << 5);
            let is_odd = corner.count > 1 || corner.pinched != [0; 3];
            assert_eq!(odd_corners(&words) >> 5 & 1 != 0, is_odd, "{octants:08b}");
        }
    }

    #[test]
    fn fans_hold_every_face_of_the_surface_once_and_are_closed() {
        for (octants, corner) in CORNERS.iter().enumerate() {
            let exists = |i: usize| octants >> i & 1 != 0;
            let mut seen = 0u16;
            for fan in &corner.fans[..corner.count as usize] {
                assert_eq!(seen & fan.faces, 0, "{octants:08b}");
                assert!((3..=12).contains(&fan.faces.count_ones()), "{octants:08b}");
                seen |= fan.faces;
                // Each edge of the corner has an even number of the fan's faces.
                for axis in 0..3 {
                    for side in 0..2 {
                        let count = (0..12)
                            .filter(|face| fan.faces >> face & 1 != 0 && face / 4 != axis)
                            .filter(|&face| beside(face).iter().all(|o| o >> axis & 1 == side))
                            .count();
                        assert!(count % 2 == 0, "{octants:08b}");
                    }
                }
                assert_eq!(fan.apart != Vec3::ZERO, corner.count > 1, "{octants:08b}");
            }
            for face in 0..12 {
                let [low, high] = beside(face);
                assert_eq!(seen >> face & 1 != 0, exists(low) != exists(high));
            }
        }
    }

    #[test]
    fn voxels_that_touch_in_a_corner_or_an_edge_alone_are_separated() {
        assert_eq!(CORNERS[0b0000_0001].count, 1);
        assert_eq!(CORNERS[0b1000_0001].count, 2, "opposite corners");
        assert_eq!(CORNERS[0b0000_1001].count, 2, "across an edge");
        assert_eq!(CORNERS[0b0110_1001].count, 4, "checkerboard");
        assert_eq!(CORNERS[0b0111_1110].count, 2, "opposite holes");
        assert_eq!(CORNERS[0b0000_1111].count, 1);
        // Two holes beside each other across an edge are joined there.
        assert_eq!(CORNERS[0b1111_0110].count, 1);
        assert_eq!(CORNERS[0b1111_0110].pinched, [0, 0, 1]);
    }

    #[test]
    fn fans_are_moved_to_their_own_sides() {
        let corner = &CORNERS[0b1000_0001];
        let middles = [Vec3::splat(-1.0), Vec3::ONE];
        assert!(corner.fans[0].apart.dot(middles[0]) * corner.fans[1].apart.dot(middles[1]) > 0.9);
        for (fan, octant) in corner.fans.iter().take(2).zip([0usize, 7]) {
            let towards = voxel_of(octant).as_vec3() + 0.5;
            assert!(fan.apart.dot(towards.normalize()) > 0.99, "{fan:?}");
        }
        // Opposite holes: each fan moves into its own hole.
        for fan in CORNERS[0b0111_1110].fans.iter().take(2) {
            let hole = [0usize, 7].into_iter().find(|hole| {
                let faces = (0..12).filter(|face| fan.faces >> face & 1 != 0);
                faces.clone().all(|face| beside(face).contains(hole))
            });
            let towards = voxel_of(hole.unwrap()).as_vec3() + 0.5;
            assert!(fan.apart.dot(towards.normalize()) > 0.99, "{fan:?}");
        }
    }
}
