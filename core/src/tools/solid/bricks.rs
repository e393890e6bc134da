//! Computes the voxels of solids that have no row solver. Each brick near the surface is tested by itself, and in it
//! each word, by the value at its centre ([`super::sweep`]); voxels that this leaves open are tested eight at a time.
//!
//! From a placed solid to the bricks that it touches in a row, and the voxels in one.

use fearless_simd::{Simd, f64x8, prelude::*};
use glam::{DMat3, DVec3, UVec3};

use super::ends::STEPS;
use super::placed::PlacedSolid;
use crate::sculpture::Brick;
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_VOXELS, WORD_EDGE_VX, local_coords};
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::region::{RowReach, VoxelBox};

impl PlacedSolid {
    /// Returns [`PlacedSolid::slack_of_box`] of a cube.
    fn slack_of_cube(&self, edge_vx: u32, furthest: DVec3) -> Option<f64> {
        self.slack_of_box(DVec3::splat(0.5 * f64::from(edge_vx - 1)), furthest)
    }

    /// Returns the greatest difference between the value at the centre of a box and those of its voxel centres, with
    /// all rounding, where no box centre is further from the solid's centre than `furthest` along each axis. `half_vx`:
    /// half the distance between the first and the last voxel centre. `None` where positions may be NaN, or where
    /// extreme proportions leave no thickness in floating point.
    pub(super) fn slack_of_box(&self, half_vx: DVec3, furthest: DVec3) -> Option<f64> {
        // Bound on the relative error of a voxel's offset from the centre and of its product with the matrix.
        let rounding = f64::EPSILON * 4.0;
        let reach = half_vx
            + rounding * (self.centre_vx.abs() + f64::from(MAX_AXIS_VX))
            + rounding * furthest;
        let m = self.tool_from_vx;
        let abs = DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
        let extent = abs * reach;
        // The test rounds positions by less than this, too.
        let largest =
            1.0 + self.displacement.unwrap_or_default().abs() + extent + abs * furthest * 2.0;
        let slack = self.shape.slack(extent + 16.0 * rounding * largest);
        slack.is_finite().then_some(slack * (1.0 + 1e-9) + 1e-12)
    }

    /// Maps eight points, given relative to the centre, to tool space, by the operations of the definition.
    #[inline(always)]
    fn in_tool_space<S: Simd>(&self, [x, y, z]: [f64x8<S>; 3]) -> [f64x8<S>; 3] {
        let DMat3 { x_axis, y_axis, z_axis } = self.tool_from_vx;
        [
            x * x_axis.x + y * y_axis.x + z * z_axis.x,
            x * x_axis.y + y * y_axis.y + z * z_axis.y,
            x * x_axis.z + y * y_axis.z + z * z_axis.z,
        ]
    }

    /// Tests eight points in tool space, with a margin.
    ///
    /// Kept as a function of its own, compiled once for each set of instructions, because it is large.
    #[inline(always)]
    fn holds<S: Simd>(&self, simd: S, p: [f64x8<S>; 3], margin: f64) -> u64 {
        simd.vectorize(
            #[inline(always)]
            || {
                let inside = match self.displacement {
                    None if margin == 0.0 => self.shape.holds(p),
                    displacement => {
                        self.shape.passes_over(p, displacement.unwrap_or_default(), margin)
                    }
                };
                inside.to_bitmask()
            },
        )
    }

    /// Returns the bricks of a row that the solid touches and fills, computed eight at a time from the values at their
    /// centres. `None` where those are not known.
    #[inline(always)]
    pub(super) fn reach_of_row<S: Simd>(&self, simd: S, y_vx: u32, z_vx: u32) -> Option<RowReach> {
        let edge = f64::from(BRICK_EDGE_VX);
        let VoxelBox { min, max } = self.reachable;
        let bricks = min.x as u32 / BRICK_EDGE_VX..(max.x as u32).div_ceil(BRICK_EDGE_VX);
        let middle = |brick: u32| {
            DVec3::new(f64::from(brick) * edge, f64::from(y_vx), f64::from(z_vx)) + 0.5 * edge
                - self.centre_vx
        };
        let (first, last) = (middle(bricks.start), middle(bricks.end + 8));
        let slack = self.slack_of_cube(BRICK_EDGE_VX, first.abs().max(last.abs()))?;
        let mut reach = RowReach::NONE;
        let mut run = bricks.start..bricks.start;
        for brick in bricks.clone().step_by(8) {
            let x = f64x8::load_array(simd, STEPS.map(f64::from)) * edge + middle(brick).x;
            let [y, z] = [first.y, first.z].map(|v| f64x8::splat(simd, v));
            let p = self.in_tool_space([x, y, z]);
            let touched = self.holds(simd, p, slack);
            if touched == 0 {
                continue;
            }
            let whole = self.holds(simd, p, -slack);
            for (i, x) in (brick..bricks.end.min(brick + 8)).enumerate() {
                if touched >> i & 1 != 0 {
                    let first = if reach.touched.is_empty() { x } else { reach.touched.start };
                    reach.touched = first..x + 1;
                }
                // Only the longest run of whole bricks is reported as whole.
                if whole >> i & 1 != 0 {
                    run = if run.end == x { run.start..x + 1 } else { x..x + 1 };
                    if run.len() > reach.whole.len() {
                        reach.whole = run.clone();
                    }
                }
            }
        }
        Some(reach)
    }

    /// Returns the voxels inside the solid of the brick at `origin_vx`.
    #[inline(always)]
    pub(super) fn test_brick<S: Simd>(&self, simd: S, origin_vx: UVec3) -> Brick {
        let mut mask = Brick::EMPTY;
        let origin = origin_vx.as_dvec3() - self.centre_vx;
        let furthest = origin.abs() + f64::from(BRICK_EDGE_VX);
        let Some(slack) = self.slack_of_cube(WORD_EDGE_VX, furthest) else {
            for local in (0..BRICK_VOXELS).map(local_coords) {
                let v = origin_vx + UVec3::from(local);
                mask.set(local[0], local[1], local[2], self.contains_voxel(v.as_ivec3()));
            }
            return mask;
        };
        // The centres of the words.
        let p = self.in_tool_space([
            f64x8::load_array(simd, [2.0, 6.0, 2.0, 6.0, 2.0, 6.0, 2.0, 6.0]) + origin.x,
            f64x8::load_array(simd, [2.0, 2.0, 6.0, 6.0, 2.0, 2.0, 6.0, 6.0]) + origin.y,
            f64x8::load_array(simd, [2.0, 2.0, 2.0, 2.0, 6.0, 6.0, 6.0, 6.0]) + origin.z,
        ]);
        let (touched, whole) = (self.holds(simd, p, slack), self.holds(simd, p, -slack));
        for (i, word) in mask.words.iter_mut().enumerate() {
            let corner = UVec3::new(i as u32 & 1, i as u32 >> 1 & 1, i as u32 >> 2);
            *word = match () {
                _ if touched >> i & 1 == 0 => 0,
                _ if whole >> i & 1 != 0 => !0,
                () => self.test_word(simd, origin_vx + corner * WORD_EDGE_VX),
            };
        }
        mask
    }

    /// Tests the voxels of a word as [`PlacedSolid::contains_voxel`] does, by the same operations: eight at a time,
    /// four along x for each of two along y.
    #[inline(always)]
    fn test_word<S: Simd>(&self, simd: S, corner_vx: UVec3) -> u64 {
        const X: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0];
        const Y: [f64; 8] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        let (corner, centre) = (corner_vx.as_dvec3(), self.centre_vx);
        let x = f64x8::load_array(simd, X) + corner.x + 0.5 - centre.x;
        let mut word = 0;
        for step_z in 0..WORD_EDGE_VX {
            let z = corner.z + f64::from(step_z) + 0.5 - centre.z;
            for pair in 0..WORD_EDGE_VX / 2 {
                let y = f64x8::load_array(simd, Y) + (corner.y + f64::from(2 * pair)) + 0.5;
                let p = self.in_tool_space([x, y - centre.y, f64x8::splat(simd, z)]);
                word |= self.holds(simd, p, 0.0) << (16 * step_z + 8 * pair);
            }
        }
        word
    }
}
