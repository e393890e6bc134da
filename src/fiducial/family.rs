//! Owns the patterns: which cells of which marker are white, and which marker a pattern is.
//!
//! A marker is 8 x 8 cells: a black rim around 6 x 6 cells of code, with white paper around it. The
//! family is tag36h11 (E. Olson: "AprilTag: A robust and flexible visual fiducial system", ICRA
//! 2011), whose codes differ in at least 11 cells however they are turned. Its first 30 markers are
//! known here; with fewer, less in a room is mistaken for one.

/// Cells along a side, rim included.
pub const CELLS: usize = 8;
/// Cells of code along a side.
pub const CODE_CELLS: usize = 6;
/// Wrong cells with which a pattern is still believed: far below half of the distance of 11.
pub const MAX_WRONG: u32 = 3;

/// Row by row from the upper left, the first cell in the highest of 36 bits, 1 is white. The numbers
/// are those of the family's publication (tag36h11, 2010).
const CODES: [u64; 30] = [
    0xd_5d62_8584,
    0xd_97f1_8b49,
    0xd_d280_910e,
    0xe_479e_9c98,
    0xe_bcbc_a822,
    0xf_31da_b3ac,
    0x0_56a5_d085,
    0x1_0652_e1d4,
    0x2_2b1d_fead,
    0x2_65ad_0472,
    0x3_4fe9_1b86,
    0x3_ff96_2cd5,
    0x4_3a25_329a,
    0x4_74b4_385f,
    0x4_e9d2_43e9,
    0x5_2461_49ae,
    0x5_997f_5538,
    0x6_83bb_6c4c,
    0x6_be4a_7211,
    0x7_e315_8eea,
    0x8_1da4_94af,
    0x8_5833_9a74,
    0x8_cd51_a5fe,
    0x9_f21c_c2d7,
    0xa_2cab_c89c,
    0xa_dc58_d9eb,
    0xb_16e7_dfb0,
    0xb_8c05_eb3a,
    0xd_25ef_139d,
    0xd_607e_1962,
];

/// Markers that there are: numbers 0 to this less one.
pub const COUNT: u32 = CODES.len() as u32;

/// Whether a cell of the whole marker is white; `x` to the right and `y` down from 0 to 7. None for
/// a number or a cell that there is not.
pub fn is_white(id: u32, x: usize, y: usize) -> Option<bool> {
    let code = *CODES.get(id as usize)?;
    if x >= CELLS || y >= CELLS {
        return None;
    }
    let inside = 1..=CODE_CELLS;
    let in_code = inside.contains(&x) && inside.contains(&y);
    Some(in_code && code >> (35 - ((y - 1) * CODE_CELLS + x - 1)) & 1 == 1)
}

/// Which marker a pattern is, as read from the picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Reading {
    pub id: u32,
    /// Quarter turns by which the pattern read is turned clockwise against the marker upright.
    pub quarter_turns: usize,
    /// Cells that had to be corrected.
    pub wrong: u32,
}

/// The marker nearest to a pattern of 6 x 6 cells, bits as in the family; None if none is near.
pub fn read(pattern: u64) -> Option<Reading> {
    let mut turned = pattern;
    let mut best: Option<Reading> = None;
    for quarter_turns in 0..4 {
        for (id, code) in (0..).zip(CODES) {
            let wrong = (code ^ turned).count_ones();
            if wrong <= MAX_WRONG && best.is_none_or(|best| wrong < best.wrong) {
                best = Some(Reading { id, quarter_turns, wrong });
            }
        }
        turned = turned_back(turned);
    }
    best
}

/// The pattern turned by a quarter counter-clockwise.
fn turned_back(pattern: u64) -> u64 {
    let mut out = 0;
    for y in 0..CODE_CELLS {
        for x in 0..CODE_CELLS {
            // What was at the right end of a row comes to the top of a column.
            let bit = pattern >> (35 - (x * CODE_CELLS + CODE_CELLS - 1 - y)) & 1;
            out |= bit << (35 - (y * CODE_CELLS + x));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slip in a digit would break these: the family was made by steps of one prime (modulo
    /// 2^36), taking codes at least 11 cells from all others.
    #[test]
    fn codes_are_those_of_the_family() {
        const PRIME: u64 = 982_451_653;
        let mut step = CODES[0];
        let mut next = 1;
        for _ in 0..200 {
            step = (step + PRIME) & ((1 << 36) - 1);
            if CODES.get(next) == Some(&step) {
                next += 1;
            }
        }
        assert_eq!(next, CODES.len());
        for (i, a) in CODES.into_iter().enumerate() {
            for (j, b) in CODES.into_iter().enumerate() {
                let mut turned = b;
                for turn in 0..4 {
                    let distance = (a ^ turned).count_ones();
                    assert!(distance >= 11 || (i == j && turn == 0), "{i} {j} {turn}: {distance}");
                    turned = turned_back(turned);
                }
                assert_eq!(turned, b, "four quarters are a whole turn");
            }
        }
    }

    #[test]
    fn turned_and_damaged_patterns_are_read() {
        for (id, code) in (0..).zip(CODES) {
            let damaged = code ^ (1 << (id % 36)) ^ (1 << ((id + 7) % 36));
            let mut clockwise = damaged;
            (0..3).for_each(|_| clockwise = turned_back(clockwise));
            let reading = Reading { id, quarter_turns: 0, wrong: 2 };
            assert_eq!(read(damaged), Some(reading));
            assert_eq!(read(clockwise), Some(Reading { quarter_turns: 1, ..reading }));
            let many = damaged ^ (1 << ((id + 11) % 36)) ^ (1 << ((id + 19) % 36));
            assert_eq!(read(many), None, "four wrong cells are too many");
        }
        assert_eq!(read(0), None);
        assert_eq!(read((1 << 36) - 1), None);
    }

    #[test]
    fn cells_have_a_black_rim() {
        assert_eq!(is_white(0, 0, 3), Some(false));
        // 0xd5d628584 begins 1101 01.
        let row: Vec<bool> = (1..7).map(|x| is_white(0, x, 1).unwrap()).collect();
        assert_eq!(row, [true, true, false, true, false, true]);
        assert_eq!(is_white(COUNT, 3, 3), None);
        assert_eq!(is_white(0, 8, 3), None);
    }
}
