//! The voxels on one side of a plane, in rows along x: each row has one span, whose end is computed from distances that
//! are linear in the coordinates, and decided by the exact test where rounding may matter.
//!
//! Takes the distance of a voxel, gives spans. Knows no solid.

use std::ops::Range;

use fearless_simd::Simd;
use glam::{DVec3, IVec3};

use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::region::{BoxCoverage, RowReach, VoxelBox};
use crate::tools::solid::spans::RowSpans;

/// Rows of a brick along y, and along z.
const EDGE: usize = BRICK_EDGE_VX as usize;

/// The distances of voxel centres from a plane, at most 0 on the side that is covered.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinearDistance {
    /// Of the centre of the voxel at the origin, and its change by voxel along each axis.
    at_origin: f64,
    by_voxel: DVec3,
    /// Bound on the error of computed distances, in and around the grid.
    error: f64,
    /// The size of the grid in voxels, at least that of a brick.
    size: IVec3,
}

/// The part of a row of bricks on one side of a plane.
pub(super) enum PlaneRow {
    /// All its voxels, or none.
    Uniform(bool),
    Spans(RowReach),
    /// Rounding leaves a row of voxels in pieces.
    Unknown,
}

impl LinearDistance {
    /// Returns the distances that `distance` computes for voxel centres, with an error of at most `error` for those of a
    /// grid of `dims` voxels.
    pub fn new(distance: impl Fn(DVec3) -> f64, dims: IVec3, error: f64) -> LinearDistance {
        let (origin, size) = (DVec3::splat(0.5), dims.max(IVec3::splat(EDGE as i32)));
        let at_origin = distance(origin);
        // From the far ends of the grid, so that errors do not grow with the coordinates.
        let by_voxel = DVec3::from(DVec3::AXES.map(|axis| {
            let length = axis.dot(size.as_dvec3());
            (distance(origin + axis * length) - at_origin) / length
        }));
        LinearDistance { at_origin, by_voxel, error: 16.0 * error, size }
    }

    /// Returns how a box of voxels is covered; `None` if it lies too far from the grid.
    #[inline]
    pub fn coverage(&self, bounds: VoxelBox) -> Option<BoxCoverage> {
        let Self { at_origin, by_voxel, error, size } = *self;
        let is_near = bounds.min.cmpge(-size).all() && bounds.max.cmple(size * 2).all();
        if !is_near || bounds.is_empty() {
            return None;
        }
        let at_low = at_origin + by_voxel.dot(bounds.min.as_dvec3());
        let reach = by_voxel * (bounds.max - bounds.min - 1).as_dvec3();
        let least = at_low + reach.min(DVec3::ZERO).element_sum();
        let most = at_low + reach.max(DVec3::ZERO).element_sum();
        Some(match () {
            () if least > error => BoxCoverage::None,
            () if most < -error => BoxCoverage::All,
            () => BoxCoverage::Part,
        })
    }

    /// Sets the spans of the 64 rows of voxels of a row of bricks, from its lower edge at `low` (x = 0) to `end_x`.
    /// `is_covered` is the exact test of a voxel.
    #[inline(always)]
    pub fn cut_row<S: Simd>(
        &self,
        simd: S,
        low: IVec3,
        end_x: i32,
        spans: &mut RowSpans,
        is_covered: &dyn Fn(IVec3) -> bool,
    ) -> PlaneRow {
        let Self { at_origin, by_voxel, error, .. } = *self;
        let at_low = at_origin + by_voxel.dot(low.as_dvec3());
        let end = f64::from(end_x);
        // The least and the greatest distance among the rows.
        let reach = by_voxel * DVec3::new(end, EDGE as f64, EDGE as f64);
        let (least, most) = (
            at_low + reach.min(DVec3::ZERO).element_sum(),
            at_low + reach.max(DVec3::ZERO).element_sum(),
        );
        if least > error {
            return PlaneRow::Uniform(false);
        }
        if most < -error {
            let rows = (0..EDGE * EDGE).map(|row| (row % EDGE, row / EDGE));
            rows.for_each(|(y, z)| spans.set_row(y, z, 0..end_x));
            return PlaneRow::Uniform(true);
        }
        let row = VoxelRow::new(by_voxel.x, error, end_x);
        for (z, y) in (0..EDGE).flat_map(|z| (0..EDGE).map(move |y| (z, y))) {
            let distance = at_low + by_voxel.y * y as f64 + by_voxel.z * z as f64;
            let is_covered = |x: i32| is_covered(low + IVec3::new(x, y as i32, z as i32));
            match row.span(distance, &is_covered) {
                Some(span) => spans.set_row(y, z, span),
                None => return PlaneRow::Unknown,
            }
        }
        PlaneRow::Spans(spans.reach(simd))
    }
}

/// A row of voxels along x whose distances are known but for an error.
struct VoxelRow {
    end_x: i32,
    error: f64,
    /// Whether the distance hardly changes along the row: no more than the error.
    is_flat: bool,
    /// Whether the distance grows along x.
    covers_low: bool,
    /// 1 over the change of the distance by voxel, and the voxels by which that changes by the error.
    inverse: f64,
    slack: f64,
}

impl VoxelRow {
    #[inline(always)]
    fn new(by_voxel: f64, error: f64, end_x: i32) -> VoxelRow {
        VoxelRow {
            end_x,
            error,
            is_flat: by_voxel.abs() * f64::from(end_x) <= error,
            covers_low: by_voxel > 0.0,
            inverse: 1.0 / by_voxel,
            slack: (error / by_voxel).abs(),
        }
    }

    /// Returns the covered voxels of a row that begins at a distance; `None` if they do not follow each other.
    #[inline(always)]
    fn span(&self, distance: f64, is_covered: &dyn Fn(i32) -> bool) -> Option<Range<i32>> {
        let (end_x, end) = (self.end_x, f64::from(self.end_x));
        if self.is_flat {
            return match distance {
                _ if distance > 2.0 * self.error => Some(0..0),
                _ if distance < -2.0 * self.error => Some(0..end_x),
                _ => exact(0, end_x - 1, is_covered),
            };
        }
        // The voxels from the first to the last are too close to call. Rounded by way of positive numbers.
        let at = -distance * self.inverse;
        let first = ((at - self.slack).clamp(-1.0, end) + 2.0) as i32 - 1;
        let last = ((at + self.slack).clamp(-1.0, end) + 1.0) as i32 - 1;
        if first > last {
            let cut = first.clamp(0, end_x);
            return Some(if self.covers_low { 0..cut } else { cut..end_x });
        }
        let (from, to) = (first.max(0), last.min(end_x - 1));
        let span = exact(from, to, is_covered)?;
        match (self.covers_low, span.is_empty()) {
            (true, true) => Some(0..from),
            (false, true) => Some(to + 1..end_x),
            (true, false) => (span.start == from).then_some(0..span.end),
            (false, false) => (span.end == to + 1).then_some(span.start..end_x),
        }
    }
}

/// Returns the voxels of a row from `from` to `to` that are covered, if they follow each other without a gap.
fn exact(from: i32, to: i32, is_covered: &dyn Fn(i32) -> bool) -> Option<Range<i32>> {
    let mut covered = (from..=to).filter(|x| is_covered(*x));
    let Some(first) = covered.next() else { return Some(from..from) };
    let mut end = first + 1;
    for x in covered {
        if x != end {
            return None;
        }
        end = x + 1;
    }
    Some(first..end)
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use glam::{UVec3, Vec3};
    use proptest::prelude::*;

    use crate::sculpture::Grid;
    use crate::sculpture::region::Region;
    use crate::tools::drawn::region::PlacedDrawnSolid;
    use crate::tools::drawn::{DrawnSolid, HalfSpace};
    use crate::tools::symmetry::SymmetryTransform;

    /// Axes, directions close to them, and others.
    fn normal() -> impl Strategy<Value = Vec3> {
        let part = prop_oneof![
            Just(0.0f32),
            Just(1.0),
            Just(-1.0),
            -1.0f32..1.0,
            -1e-6f32..1e-6,
            -1e-12f32..1e-12
        ];
        let parts = prop::array::uniform3(part).prop_map(Vec3::from);
        parts.prop_filter("has a direction", |normal| normal.length() > 1e-3)
    }

    fn place() -> impl Strategy<Value = Vec3> {
        let coordinate = prop_oneof![
            (-5i32..180).prop_map(|v| v as f32),
            (-5i32..180).prop_map(|v| v as f32 + 0.5),
            -5f32..180.0
        ];
        prop::array::uniform3(coordinate).prop_map(Vec3::from)
    }

    proptest! {
        #[test]
        fn rows_of_a_half_space_are_its_voxels(
            at_vx in place(),
            normal in normal(),
            dims in prop::array::uniform3(prop_oneof![1u32..9, 1u32..40, 150u32..180]),
            stretched: bool,
            mirror in prop::option::of(0f32..60.0),
        ) {
            let dims = UVec3::from(dims).min(UVec3::new(180, 24, 24));
            let size = if stretched { Vec3::new(1.0, 0.4, 2.3) } else { Vec3::ONE };
            let grid = Grid::new(dims, size, 1 << 30).unwrap();
            let image = SymmetryTransform::of_planes([mirror, None, mirror]);
            let space: DrawnSolid = HalfSpace { at_vx, normal }.into();
            let placed = PlacedDrawnSolid::new(&space, &grid, image);
            let bricks = grid.brick_dims();
            dispatch!(Level::new(), simd => {
                let mut row = Default::default();
                for (z, y) in (0..bricks.z).flat_map(|z| (0..bricks.y).map(move |y| (z, y))) {
                    let reach = placed.cut_row(simd, y * 8, z * 8, &mut row);
                    for x in 0..bricks.x {
                        let b = UVec3::new(x, y, z);
                        let valid = grid.valid_mask(b);
                        let found = match reach.touched.contains(&x) {
                            true => placed.mask(simd, &row, &reach, x).and(&valid),
                            false => crate::sculpture::Brick::EMPTY,
                        };
                        if reach.whole.contains(&x) {
                            prop_assert_eq!(found, valid);
                        }
                        let mut mismatch = None;
                        valid.for_each(|local| {
                            let at = UVec3::from(crate::sculpture::brick::local_coords(local));
                            let v = (b * 8 + at).as_ivec3();
                            if placed.contains_voxel(v) != found.get(at.x, at.y, at.z) {
                                mismatch = Some(v);
                            }
                        });
                        prop_assert_eq!(mismatch, None);
                    }
                }
                Ok(())
            })?;
        }
    }
}
