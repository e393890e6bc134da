//! Owns the step from a convex solid's formula to the voxels of a row of bricks: real-valued
//! ends for eight rows of voxels at a time, rounded to voxels where errors cannot matter, and
//! settled voxel by voxel with the exact test where they can.
//!
//! The ends are worked out in `f32`, of which eight at a time are cheap; about one row in a
//! hundred is too close to call and is looked at again in `f64`, and of those about one in a
//! million is decided by the exact test itself. Takes a [`RowSolver`] and the exact test; gives
//! spans that equal the test on every voxel.

use std::ops::Range;

use glam::{DVec3, IVec3};
use wide::{f32x8, i16x8, i32x8};

use super::construct_spans::RowSpans;

/// Relative error of one operation in `f64`.
pub const ROUNDING: f64 = f64::EPSILON / 2.0;
/// Relative error of one operation in `f32`.
pub const ROUNDING_32: f64 = f32::EPSILON as f64 / 2.0;
/// 0, 1, .. 7: the steps from one row to the next.
pub const STEPS: f32x8 = f32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);

/// Ends along x, as voxel indices less an origin, of eight rows next to each other along y. A
/// row is empty where `from >= to`.
#[derive(Clone, Copy)]
pub struct Ends {
    pub from: f32x8,
    pub to: f32x8,
    /// All bits set in the rows whose ends the margin does not cover.
    pub doubtful: f32x8,
}

/// What is sure about one row: voxels outside of `outer` are out, those in `inner` are in.
#[derive(Clone, Copy, Debug)]
pub struct Bracket {
    /// Lowest and highest voxel index, as real numbers.
    pub outer: [f64; 2],
    /// No voxel if `inner[0] > inner[1]`.
    pub inner: [f64; 2],
}

impl Bracket {
    /// No voxel.
    pub const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
    /// Every voxel is out.
    pub const OUTSIDE: Bracket = Bracket { outer: Self::NONE, inner: Self::NONE };
    /// Nothing is sure.
    pub const UNKNOWN: Bracket =
        Bracket { outer: [f64::NEG_INFINITY, f64::INFINITY], inner: Self::NONE };
}

/// A convex solid cut by rows along x. Rows are named by their voxel coordinates.
pub trait RowSolver {
    /// What holds for one row of bricks.
    type Local;

    /// Prepares for the 8x8 rows from `y`, `z` on; none if they are all empty. Ends will be less
    /// `origin`. The second value is how far, in voxels, the ends of a row that is not doubtful may be from where the
    /// exact test turns; at a half or more all rows are doubtful.
    fn local(&self, origin: f64, y: f64, z: f64) -> Option<(Self::Local, f32)>;

    /// The ends of the eight rows `step_z` voxels on along z.
    fn ends(&self, local: &Self::Local, step_z: f64) -> Ends;

    /// What is sure of the row at `y`, `z`, whatever the rounding errors.
    fn bracket(&self, y: f64, z: f64) -> Bracket;
}

/// Adding this to an `f32` below 2^22 leaves its nearest integer in the low bits.
const INTEGER_IN_LOW_BITS: f32 = 1.5 * (1u32 << 23) as f32;

/// Fills `spans` with the voxels in `x` of the 8x8 rows from `y`, `z` on that are in the solid.
/// False if those of some row are not next to each other, which rounding errors of the exact
/// test can bring about where a surface runs along the row.
#[inline(always)]
pub fn solve(
    solver: &impl RowSolver,
    x: &Range<i32>,
    y: u32,
    z: u32,
    exact: impl Fn(IVec3) -> bool,
    spans: &mut RowSpans,
) -> bool {
    let origin = (x.start + x.end) / 2;
    let (low, high) = ((x.start - origin) as f32, (x.end - origin) as f32);
    let (low, high, magic) =
        (f32x8::splat(low), f32x8::splat(high), f32x8::splat(INTEGER_IN_LOW_BITS));
    let magic_bits = i32x8::splat(INTEGER_IN_LOW_BITS.to_bits() as i32);
    let origin16 = i16x8::splat(origin as i16);
    // A voxel whose index is r is in if r is at or beyond the lower end, so the first one is
    // that end rounded up: half added, then rounded to the nearest. One past the last voxel is
    // the upper end rounded down plus one: the same. Near a tie the rounding is in doubt.
    let at = (f64::from(origin) - 0.5, f64::from(y), f64::from(z));
    let Some((local, margin)) = solver.local(at.0, at.1, at.2) else {
        spans.clear();
        return true;
    };
    let sure = f32x8::splat(0.5 - margin);
    for step_z in 0..8 {
        let ends = solver.ends(&local, f64::from(step_z));
        let round = |end: f32x8| {
            let moved = end.fast_max(low).fast_min(high);
            let rounded = moved + magic;
            let off = (moved - (rounded - magic)).abs();
            let steps: i32x8 = bytemuck::cast::<f32x8, i32x8>(rounded) - magic_bits;
            (i16x8::from_i32x8_saturate(steps) + origin16, off)
        };
        let ((mut from, off_from), (mut to, off_to)) = (round(ends.from), round(ends.to));
        let doubtful = !off_from.fast_max(off_to).simd_lt(sure) | ends.doubtful;
        if doubtful.to_bitmask() != 0 {
            let at = (y as i32, z as i32 + step_z);
            if !settle_rows(solver, x, at, doubtful.to_bitmask(), &exact, &mut from, &mut to) {
                return false;
            }
        }
        spans.set(step_z as usize, from, to);
    }
    true
}

/// Settles the rows of the bits in `rows` among eight. False if one is torn.
#[cold]
#[inline(never)]
fn settle_rows(
    solver: &impl RowSolver,
    x: &Range<i32>,
    (y, z): (i32, i32),
    mut rows: u32,
    exact: &impl Fn(IVec3) -> bool,
    from: &mut i16x8,
    to: &mut i16x8,
) -> bool {
    let (mut starts, mut ends) = (from.to_array(), to.to_array());
    while rows != 0 {
        let row = rows.trailing_zeros();
        rows &= rows - 1;
        let Some(span) = settle(solver, x, y + row as i32, z, exact) else { return false };
        (starts[row as usize], ends[row as usize]) = (span.start as i16, span.end as i16);
    }
    (*from, *to) = (i16x8::new(starts), i16x8::new(ends));
    true
}

/// The voxels of one row, by the exact test wherever the bracket leaves it open.
fn settle(
    solver: &impl RowSolver,
    x: &Range<i32>,
    y: i32,
    z: i32,
    exact: impl Fn(IVec3) -> bool,
) -> Option<Range<i32>> {
    let bracket = solver.bracket(f64::from(y), f64::from(z));
    let (low, high) = (f64::from(x.start), f64::from(x.end));
    // Clamped to indices that are not negative, so that a cast rounds down.
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

/// Bounds on the numbers that the exact test meets within the voxels that are asked for: the
/// source of every margin.
#[derive(Clone, Copy, Debug)]
pub struct Magnitudes {
    /// Largest distance of a voxel centre from the solid's centre along each axis, in voxels,
    /// and at least 1.
    pub distance_vx: DVec3,
    /// Largest coordinate that those distances are taken of.
    pub coordinate_vx: f64,
    /// Number of voxels along x that can be inside.
    pub width_vx: f64,
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
