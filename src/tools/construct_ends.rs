//! Owns the step from a convex solid's formula to the voxels of a row of bricks: real-valued
//! ends for eight rows of voxels at a time, rounded to voxels where rounding errors cannot
//! matter, and settled voxel by voxel with the exact test where they can.
//!
//! Takes a [`RowSolver`] and the exact test; gives [`Spans`] that equal the test on every voxel.

use std::ops::Range;

use glam::{DVec3, IVec3};
use wide::f64x4;

use super::construct_spans::{ROWS, Spans};

/// Half the distance between 1 and the next larger `f64`: the relative error of one operation.
pub const ROUNDING: f64 = f64::EPSILON / 2.0;

/// Real-valued ends along x, in voxel indices, of eight rows next to each other along y. A row
/// is empty where `from > to`.
#[derive(Clone, Copy)]
pub struct Ends {
    pub from: [f64x4; 2],
    pub to: [f64x4; 2],
    /// All bits set in the rows whose ends [`RowSolver::margin`] does not cover.
    pub doubtful: [f64x4; 2],
}

/// What is sure about one row: voxels outside of `outer` are out, those in `inner` are in.
#[derive(Clone, Copy, Debug)]
pub struct Bracket {
    /// Lowest and highest voxel index, as real numbers.
    pub outer: [f64; 2],
    /// None where `inner[0] > inner[1]`.
    pub inner: [f64; 2],
}

impl Bracket {
    /// Nothing is sure.
    pub const UNKNOWN: Bracket =
        Bracket { outer: [f64::NEG_INFINITY, f64::INFINITY], inner: Self::NONE };
    /// Every voxel is out.
    pub const OUTSIDE: Bracket = Bracket { outer: Self::NONE, inner: Self::NONE };
    /// No voxel.
    pub const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
}

/// A convex solid cut by rows along x. Rows are named by their voxel coordinates.
pub trait RowSolver {
    /// The ends of the rows at `y..y + 8` and `z`.
    fn ends(&self, y: f64, z: f64) -> Ends;

    /// How far, in voxels, the ends of a row that is not doubtful may be from where the exact
    /// test turns.
    fn margin(&self) -> f64;

    /// What is sure of the row at `y`, `z`, whatever the rounding errors.
    fn bracket(&self, y: f64, z: f64) -> Bracket;
}

/// Adding this to a number below 2^51 leaves its nearest integer in the low bits.
const INTEGER_IN_LOW_BITS: f64 = 1.5 * (1u64 << 52) as f64;

/// The voxels in `x` of the 8x8 rows at `y..y + 8`, `z..z + 8` that are in the solid, or `None`
/// if those of some row are not next to each other, which rounding errors of the exact test can
/// bring about where a surface runs along the row.
pub fn solve(
    solver: &impl RowSolver,
    x: &Range<i32>,
    y: u32,
    z: u32,
    exact: impl Fn(IVec3) -> bool,
) -> Option<Spans> {
    let mut spans = Spans::EMPTY;
    let (low, high) = (f64x4::splat(f64::from(x.start)), f64x4::splat(f64::from(x.end)));
    let magic = f64x4::splat(INTEGER_IN_LOW_BITS);
    // A voxel whose index is r is in if r is at or beyond the lower end, so the first one is
    // that end rounded up: half added, then rounded to the nearest. One past the last voxel is
    // the upper end rounded down plus one: the same. Near a tie the rounding is in doubt.
    let half = f64x4::splat(0.5);
    let sure = f64x4::splat(0.5 - solver.margin());
    let round = |end: f64x4| {
        let moved = (end + half).fast_max(low).fast_min(high);
        let bits = moved + magic;
        let doubtful = (moved - (bits - magic)).abs().simd_gt(sure);
        (bits.to_array().map(|v| v.to_bits() as i16), doubtful)
    };
    for row_z in 0..8 {
        let ends = solver.ends(f64::from(y), f64::from(z + row_z));
        let mut doubtful_rows = 0;
        for quad in 0..2 {
            let (from, doubt_from) = round(ends.from[quad]);
            let (to, doubt_to) = round(ends.to[quad]);
            let at = row_z as usize * 8 + quad * 4;
            spans.from[at..at + 4].copy_from_slice(&from);
            spans.to[at..at + 4].copy_from_slice(&to);
            let doubtful = doubt_from | doubt_to | ends.doubtful[quad];
            doubtful_rows |= doubtful.to_bitmask() << (4 * quad);
        }
        while doubtful_rows != 0 {
            let row_y = doubtful_rows.trailing_zeros();
            doubtful_rows &= doubtful_rows - 1;
            let span = settle(solver, x, y + row_y, z + row_z, &exact)?;
            let row = (row_z * 8 + row_y) as usize;
            debug_assert!(row < ROWS);
            (spans.from[row], spans.to[row]) = (span.start as i16, span.end as i16);
        }
    }
    Some(spans)
}

/// The voxels of one row, by the exact test wherever the bracket leaves it open.
fn settle(
    solver: &impl RowSolver,
    x: &Range<i32>,
    y: u32,
    z: u32,
    exact: impl Fn(IVec3) -> bool,
) -> Option<Range<i32>> {
    let bracket = solver.bracket(f64::from(y), f64::from(z));
    let (low, high) = (f64::from(x.start), f64::from(x.end));
    // Indices below 2^24, so the clamped values are exact; NaN cannot come from a bracket.
    let first = |v: f64| v.ceil().clamp(low, high) as i32;
    let past = |v: f64| (v.floor() + 1.0).clamp(low, high) as i32;
    let outer = first(bracket.outer[0])..past(bracket.outer[1]);
    let inner = first(bracket.inner[0])..past(bracket.inner[1]);
    let inner = if inner.is_empty() { outer.end..outer.end } else { inner };

    let inside = |x: i32| exact(IVec3::new(x, y as i32, z as i32));
    let mut span: Option<Range<i32>> = None;
    let mut add = |more: Range<i32>| match &mut span {
        None => {
            span = Some(more);
            true
        }
        Some(span) if span.end == more.start => {
            span.end = more.end;
            true
        }
        Some(_) => false,
    };
    let mut connected = true;
    for x in outer.start..inner.start.min(outer.end) {
        connected &= !inside(x) || add(x..x + 1);
    }
    connected &= inner.is_empty() || add(inner.clone());
    for x in inner.end..outer.end {
        connected &= !inside(x) || add(x..x + 1);
    }
    connected.then(|| span.unwrap_or(0..0))
}

/// Bounds on the numbers that the exact test meets within the voxels that are asked for: the
/// source of every margin.
#[derive(Clone, Copy, Debug)]
pub struct Magnitudes {
    /// Largest distance of a voxel centre from the solid's centre along each axis, in voxels,
    /// and at least 1.
    pub distance_vx: DVec3,
    /// Largest coordinate that those distances are taken of.
    pub coordinate_vx: f64,
    /// No component of a tool-space position, nor a partial sum of one, is larger.
    pub position: f64,
}

impl Magnitudes {
    /// Bound on the error of a tool-space position, of a sum of three of its components, and of
    /// the sum of their squares. A position takes six operations, each off by [`ROUNDING`] of
    /// at most `position`; the sum of squares five more on at most `position` squared. 128 is
    /// several times what these add up to.
    pub fn error(&self) -> f64 {
        self.linear_error() * (1.0 + self.position)
    }

    /// [`Magnitudes::error`] without the squares.
    pub fn linear_error(&self) -> f64 {
        128.0 * ROUNDING * (1.0 + self.position)
    }
}
