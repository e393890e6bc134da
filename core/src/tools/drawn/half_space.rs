//! Half space: all points on the side of a plane that its normal points to.

use glam::{DVec3, Vec3};

use super::fields::{Field, FieldValue};
use super::spec::{DrawnShape, DrawnSpec, EVERYWHERE, Surface, coverage_of_distance};
use crate::sculpture::region::BoxCoverage;
use crate::tools::parallelepiped::Parallelepiped;

/// All points on the side of a plane that its normal points to.
#[derive(Clone, PartialEq, Debug)]
pub struct HalfSpace {
    /// A point of the plane, in voxel coordinates.
    pub at_vx: Vec3,
    /// Perpendicular to it in the world, of any length.
    pub normal: Vec3,
}

impl DrawnShape for HalfSpace {
    const SPEC: DrawnSpec = DrawnSpec {
        name: "half-space",
        label: "half space",
        help: "everything on the side of a plane that its normal points to: `subtract` cuts it off",
        bench_row: "half space across",
        example: |pose, _| HalfSpace { at_vx: pose.at_vx, normal: Vec3::new(0.2, 1.0, 0.1) }.into(),
    };

    type Surface = PlaneSide;

    fn fields(&mut self) -> Vec<Field<'_>> {
        vec![
            Field::place(&mut self.at_vx),
            Field {
                key: "normal",
                usage: "X,Y,Z",
                rule: "the normal must have a direction",
                value: FieldValue::Direction(&mut self.normal),
            },
        ]
    }

    fn surface(&self, stretch: DVec3) -> PlaneSide {
        PlaneSide {
            at: self.at_vx.as_dvec3() * stretch,
            normal: self.normal.as_dvec3().normalize(),
        }
    }
}

/// The side of a plane that a normal points to.
#[derive(Clone, Debug)]
pub struct PlaneSide {
    at: DVec3,
    normal: DVec3,
}

impl Surface for PlaneSide {
    fn bounds(&self) -> [DVec3; 2] {
        EVERYWHERE
    }

    fn longest(&self) -> f64 {
        self.at.length()
    }

    #[inline]
    fn distance(&self, p: DVec3, _: &[u32]) -> f64 {
        (self.at - p).dot(self.normal)
    }

    fn is_plane(&self) -> bool {
        true
    }

    fn coverage(&self, points: &Parallelepiped, margin: f64) -> BoxCoverage {
        let reach: f64 = points.half_edges.iter().map(|edge| edge.dot(self.normal).abs()).sum();
        coverage_of_distance(self.distance(points.middle, &[]), reach + margin)
    }
}
