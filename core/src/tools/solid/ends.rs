//! Converts a convex solid's formula to the voxels of a row of bricks. Real-valued ends of eight rows at a time are
//! rounded to voxels where errors cannot matter, and decided voxel by voxel with the exact test where they can.
//!
//! Ends are computed in `f32`, eight at a time in a vector. About one row in a hundred is too close to call and is
//! computed again in `f64`; of those about one in a million is decided by the exact test itself. From a [`RowSolver`]
//! and the exact test to spans that equal the test on every voxel.

use std::ops::Range;

use fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};
use glam::{DVec3, IVec3};

use super::spans::RowSpans;

/// Relative error of one operation in `f64`.
pub const ROUNDING: f64 = f64::EPSILON / 2.0;
/// Relative error of one operation in `f32`.
pub const ROUNDING_32: f64 = f32::EPSILON as f64 / 2.0;
/// 0, 1, .. 7: the offsets of eight adjacent rows.
pub const STEPS: [f32; 8] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// Ends along x, as voxel indices relative to an origin, of eight rows adjacent along y. A row is empty where `from >=
/// to`.
pub struct Ends<S: Simd> {
    pub from: f32x8<S>,
    pub to: f32x8<S>,
    /// The rows whose ends are not within the margin.
    pub doubtful: mask32x8<S>,
}

/// The certain part of one row: voxels outside `outer` are out, those in `inner` are in.
#[derive(Clone, Copy, Debug)]
pub struct Bracket {
    /// Lowest and highest voxel index, as real numbers.
    pub outer: [f64; 2],
    /// Contains no voxel if `inner[0] > inner[1]`.
    pub inner: [f64; 2],
}

impl Bracket {
    /// No voxel.
    pub const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
    /// Every voxel is out.
    pub const OUTSIDE: Bracket = Bracket { outer: Self::NONE, inner: Self::NONE };
    /// Nothing is certain.
    pub const UNKNOWN: Bracket =
        Bracket { outer: [f64::NEG_INFINITY, f64::INFINITY], inner: Self::NONE };
}

/// A convex solid that can be intersected with rows along x. Rows are given by their voxel coordinates.
pub trait RowSolver {
    /// Values for one row of bricks.
    type Local;

    /// Prepares the 8x8 rows from `y`, `z` on; `None` if they are all empty. Ends will be relative to `origin`. The
    /// second value is the margin in voxels: the greatest distance between the ends of a row that is not doubtful and
    /// the position where the exact test turns. From a half on, all rows are doubtful.
    fn local(&self, origin: f64, y: f64, z: f64) -> Option<(Self::Local, f32)>;

    /// Returns the ends of the eight rows at `step_z` voxels along z.
    fn ends<S: Simd>(&self, simd: S, local: &Self::Local, step_z: usize) -> Ends<S>;

    /// Returns the certain part of the row at `y`, `z`, with all rounding errors allowed for.
    fn bracket(&self, y: f64, z: f64) -> Bracket;
}

/// Adding this to an `f32` below 2^22 leaves its nearest integer in the low bits.
const INTEGER_IN_LOW_BITS: f32 = 1.5 * (1u32 << 23) as f32;

/// The voxels in `x` of the 8x8 rows from `y`, `z` on.
#[derive(Clone, Debug)]
pub struct RowBlock {
    pub x: Range<i32>,
    pub y: u32,
    pub z: u32,
}

/// Fills `spans` with the voxels of `rows` that are in the solid. Returns false if those of some row are not
/// contiguous, which can happen by rounding errors of the exact test where a surface runs along the row.
#[inline(always)]
pub fn solve<S: Simd>(
    simd: S,
    solver: &impl RowSolver,
    rows: &RowBlock,
    exact: impl Fn(IVec3) -> bool,
    spans: &mut RowSpans,
) -> bool {
    let &RowBlock { ref x, y, z } = rows;
    let origin = (x.start + x.end) / 2;
    // A voxel of index r is inside if r is at or beyond the lower end, so the first one is that end rounded up: half
    // added, then rounded to the nearest. One past the last voxel is the upper end rounded down plus one, which is the
    // same. Near a tie the rounding is in doubt.
    let at = (f64::from(origin) - 0.5, f64::from(y), f64::from(z));
    let Some((local, margin)) = solver.local(at.0, at.1, at.2) else {
        spans.clear();
        return true;
    };
    let rounding = Rounding::new(simd, x, origin, margin);
    let mut doubtful = 0;
    for pair in 0..4 {
        let (first, second) = (2 * pair, 2 * pair + 1);
        let (from, to, doubts) = rounding.rows(solver.ends(simd, &local, first));
        doubtful |= doubts << (8 * first);
        let (next_from, next_to, doubts) = rounding.rows(solver.ends(simd, &local, second));
        doubtful |= doubts << (8 * second);
        spans.set(simd, pair, [from, next_from], [to, next_to]);
    }
    doubtful == 0 || settle_rows(solver, rows, doubtful, &exact, spans)
}

/// The conversion of ends to voxels.
struct Rounding<S: Simd> {
    low: f32x8<S>,
    high: f32x8<S>,
    /// [`INTEGER_IN_LOW_BITS`] plus the origin of the ends.
    magic: f32x8<S>,
    /// Ends rounded by less than this are certain.
    sure: f32x8<S>,
}

impl<S: Simd> Rounding<S> {
    #[inline(always)]
    fn new(simd: S, x: &Range<i32>, origin: i32, margin: f32) -> Rounding<S> {
        Rounding {
            low: f32x8::splat(simd, (x.start - origin) as f32),
            high: f32x8::splat(simd, (x.end - origin) as f32),
            magic: f32x8::splat(simd, INTEGER_IN_LOW_BITS + origin as f32),
            sure: f32x8::splat(simd, 0.5 - margin),
        }
    }

    /// Returns the first voxels of eight rows, one past the last ones, and a bit for each doubtful row.
    #[inline(always)]
    fn rows(&self, ends: Ends<S>) -> (i32x8<S>, i32x8<S>, u64) {
        let (from, off_from) = self.round(ends.from);
        let (to, off_to) = self.round(ends.to);
        // A row whose ends are NaN is doubtful.
        let doubtful = !off_from.max(off_to).simd_lt(self.sure) | ends.doubtful;
        (from, to, doubtful.to_bitmask())
    }

    /// Returns the ends clamped to the requested voxels and rounded, and the amounts of rounding.
    #[inline(always)]
    fn round(&self, end: f32x8<S>) -> (i32x8<S>, f32x8<S>) {
        let moved = end.max(self.low).min(self.high);
        let rounded = moved + self.magic;
        let off = (moved - (rounded - self.magic)).abs();
        (rounded.bitcast::<i32x8<S>>() - INTEGER_IN_LOW_BITS.to_bits() as i32, off)
    }
}

/// Decides the rows of a block that are set in `doubtful`, y fastest. Returns false if one is not contiguous.
#[cold]
#[inline(never)]
fn settle_rows(
    solver: &impl RowSolver,
    rows: &RowBlock,
    mut doubtful: u64,
    exact: &impl Fn(IVec3) -> bool,
    spans: &mut RowSpans,
) -> bool {
    let (y, z) = (rows.y as i32, rows.z as i32);
    while doubtful != 0 {
        let row = doubtful.trailing_zeros();
        doubtful &= doubtful - 1;
        let (step_y, step_z) = (row % 8, row / 8);
        let at = (y + step_y as i32, z + step_z as i32);
        let Some(span) = settle(solver, &rows.x, at.0, at.1, exact) else { return false };
        spans.set_row(step_y as usize, step_z as usize, span);
    }
    true
}

/// Returns the voxels of one row, using the exact test wherever the bracket leaves it open.
fn settle(
    solver: &impl RowSolver,
    x: &Range<i32>,
    y: i32,
    z: i32,
    exact: impl Fn(IVec3) -> bool,
) -> Option<Range<i32>> {
    let bracket = solver.bracket(f64::from(y), f64::from(z));
    let (low, high) = (f64::from(x.start), f64::from(x.end));
    // Clamped to non-negative indices, so that a cast rounds down.
    let first = |v: f64| {
        let v = v.clamp(low, high);
        v as i32 + i32::from(v > f64::from(v as i32))
    };
    let past = |v: f64| (v + 1.0).clamp(low, high) as i32;
    let outer = first(bracket.outer[0])..past(bracket.outer[1]);
    let inner = first(bracket.inner[0])..past(bracket.inner[1]);
    let inner = if inner.is_empty() { outer.end..outer.end } else { inner };

    let inside = |x: i32| exact(IVec3::new(x, y, z));
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

/// Bounds on the numbers that the exact test meets within the requested voxels: the source of every margin.
#[derive(Clone, Copy, Debug)]
pub struct Magnitudes {
    /// Largest distance of a voxel centre from the solid's centre along each axis, in voxels, and at least 1.
    pub distance_vx: DVec3,
    /// Largest coordinate from which those distances are computed.
    pub coordinate_vx: f64,
    /// Number of voxels along x that can be inside.
    pub width_vx: f64,
    /// Bound on the components of a tool-space position, and on their partial sums.
    pub position: f64,
}

impl Magnitudes {
    /// Returns a bound on the error of a tool-space position, of a sum of three of its components, and of the sum of
    /// their squares. A position takes six operations, each with an error of [`ROUNDING`] times at most `position`; the
    /// sum of squares takes five more on at most `position` squared. 128 is several times their total.
    pub fn error(&self) -> f64 {
        self.linear_error() * (1.0 + self.position)
    }

    /// Returns [`Magnitudes::error`] without the squares.
    pub(crate) fn linear_error(&self) -> f64 {
        128.0 * ROUNDING * (1.0 + self.position)
    }
}
