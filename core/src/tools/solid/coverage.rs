//! Decides whether a placed solid covers all or none of the voxels of a box, without visiting them.
//!
//! From a placed solid and a box to a [`BoxCoverage`] that agrees with [`PlacedSolid::contains_voxel`] on every voxel of
//! the box. The value of a solid ([`super::sweep`]) at the centre of a box decides boxes far from the surface. Nearer
//! to it, a convex solid covers all voxels if it covers those at the corners, and none if a plane lies between it and
//! the box.

use glam::DVec3;

use super::placed::PlacedSolid;
use crate::sculpture::region::{BoxCoverage, VoxelBox};
use crate::tools::parallelepiped::Parallelepiped;

/// A share of the half extents, far above all rounding errors and far below a voxel.
const ROUNDING: f64 = 1e-9;

impl PlacedSolid {
    /// Returns how the solid covers the voxels of `bounds`.
    pub(super) fn coverage_by_values(&self, bounds: VoxelBox) -> BoxCoverage {
        let Some(centres) = Parallelepiped::of_voxels(bounds, |v| v - self.centre_vx) else {
            return BoxCoverage::None;
        };
        let (offset, half_vx) = (centres.middle.abs(), centres.extent());
        let slack = self.slack_of_box(half_vx, offset);
        let slack_at_corners = self.slack_of_box(DVec3::ZERO, offset + half_vx);
        let (Some(slack), Some(slack_at_corners)) = (slack, slack_at_corners) else {
            return BoxCoverage::Part;
        };
        let displacement = self.displacement.unwrap_or_default();
        let slack = slack + self.shape.finest(displacement) + ROUNDING;
        let slack_at_corners = 2.0 * slack_at_corners + ROUNDING;

        let points = centres.mapped(&self.tool_from_vx);
        let passes = |p: DVec3, margin: f64| self.shape.passes(p, displacement, margin);
        if !points.middle.is_finite() || !displacement.is_finite() {
            return BoxCoverage::Part;
        }
        if !passes(points.middle, slack) {
            return BoxCoverage::None;
        }
        if passes(points.middle, -slack) {
            return BoxCoverage::All;
        }
        if self.shape.solid().spec().is_convex {
            let inside = |corner: &DVec3| passes(*corner, -slack_at_corners);
            match points.corners().iter().filter(|corner| inside(corner)).count() {
                8 => return BoxCoverage::All,
                0 => {}
                _ => return BoxCoverage::Part,
            }
        }
        // Scaled so much, every solid contains the points whose value is up to the slack.
        let scale = 1.0 + 2.0 * slack_at_corners;
        let furthest = |direction: DVec3| self.shape.furthest(direction) * scale;
        match points.is_apart(furthest, displacement, 0.0) {
            true => BoxCoverage::None,
            false => BoxCoverage::Part,
        }
    }

    /// Returns the point in voxel coordinates that lies furthest along `direction`.
    #[cfg(test)]
    pub(crate) fn furthest_vx(&self, direction: DVec3) -> DVec3 {
        let vx_from_tool = self.tool_from_vx.inverse();
        let along = vx_from_tool.transpose() * direction;
        let moved = self.displacement.filter(|displacement| displacement.dot(along) > 0.0);
        let furthest = self.shape.furthest(along) + moved.unwrap_or_default();
        self.centre_vx + vx_from_tool * furthest
    }
}
