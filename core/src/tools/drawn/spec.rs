//! Describes a drawn solid: its texts, an example, its fields and its surface, each written once in the file of the
//! solid.
//!
//! Text form, usage, checks, random tests and the rows of the benchmark follow from these descriptions. Knows no grid.

use glam::DVec3;

use super::DrawnSolid;
use super::fields::{Field, SolidPose};
use crate::sculpture::region::BoxCoverage;
use crate::tools::parallelepiped::Parallelepiped;

/// The description of a drawn solid.
#[derive(Clone, Copy, Debug)]
pub struct DrawnSpec {
    /// Its name in scripts and in labels of undo steps.
    pub name: &'static str,
    /// Its name in sentences.
    pub label: &'static str,
    /// Its explanation in the manual of scripts, after its usage.
    pub help: &'static str,
    /// Its row in the benchmark, which measures the example of size 64.
    pub bench_row: &'static str,
    /// An example at a pose, which reaches about as far as a ball of radius `size`: for tests and the benchmark.
    pub example: fn(pose: SolidPose, size: f32) -> DrawnSolid,
}

/// A drawn solid, in its own file.
pub trait DrawnShape {
    /// Its description.
    const SPEC: DrawnSpec;

    /// The solid, prepared for computing distances.
    type Surface: Surface;

    /// Returns its fields, in the order of the text form.
    fn fields(&mut self) -> Vec<Field<'_>>;

    /// Returns an error that says which rule is broken, if one is, besides the rules of single fields.
    fn check(&self) -> Result<(), &'static str> {
        Ok(())
    }

    /// Returns its surface. `stretch`: edges of a voxel in units of the smallest.
    fn surface(&self, stretch: DVec3) -> Self::Surface;
}

/// The surface of a drawn solid. Positions and lengths are in units of the smallest edge of a voxel.
pub trait Surface {
    /// Returns the lowest and the highest point of a box around it, at infinity if it has no end.
    fn bounds(&self) -> [DVec3; 2];

    /// Returns a bound on the numbers that distances are computed from.
    fn longest(&self) -> f64;

    /// Returns the distance of a point, below 0 inside: no nearer point is on the other side. For a solid in pieces:
    /// from the pieces in `pieces`.
    fn distance(&self, p: DVec3, pieces: &[u32]) -> f64;

    /// Returns how the solid covers the points of a box. `margin`: bound on the rounding error of points and distances.
    fn coverage(&self, points: &Parallelepiped, margin: f64) -> BoxCoverage;

    /// Returns whether it is a plane: distances are linear, but for rounding.
    fn is_plane(&self) -> bool {
        false
    }

    /// Returns the pieces that reach the box between two corners; none for a solid in one piece.
    fn pieces_near(&self, _low: DVec3, _high: DVec3) -> Vec<u32> {
        Vec::new()
    }
}

/// The box around solids without an end.
pub const EVERYWHERE: [DVec3; 2] = [DVec3::NEG_INFINITY, DVec3::INFINITY];

/// Returns how a solid covers points whose distances from its surface differ from `distance` by at most `reach`.
pub(super) fn coverage_of_distance(distance: f64, reach: f64) -> BoxCoverage {
    match () {
        _ if distance > reach => BoxCoverage::None,
        _ if distance < -reach => BoxCoverage::All,
        () => BoxCoverage::Part,
    }
}
