//! Tube: the volume that a ball sweeps along a curve through points, its radius changing from one to the next.

use std::sync::Arc;

use glam::{DVec3, DVec4, Vec3};

use super::curve::{CurvePiece, pieces};
use super::fields::{ControlPoint, Field, FieldValue, require};
use super::spec::{DrawnShape, DrawnSpec, EVERYWHERE, Surface};
use crate::sculpture::region::BoxCoverage;
use crate::tools::parallelepiped::Parallelepiped;

/// The volume that a ball sweeps along a curve through points, its radius changing from one to the next: a centripetal
/// Catmull-Rom spline (Yuksel, Schaefer, Keyser: Parameterization and Applications of Catmull-Rom Curves, 2011). Two
/// points make a line, one makes a ball.
#[derive(Clone, PartialEq, Debug)]
pub struct Tube {
    /// The points.
    pub control_points: Arc<[ControlPoint]>,
}

impl DrawnShape for Tube {
    const SPEC: DrawnSpec = DrawnSpec {
        name: "tube",
        label: "tube",
        help: "the sweep of a ball along a smooth curve through the points, growing and shrinking to their radii; two points make a line. `tube radius=R points=X,Y,Z;...` keeps one radius",
        bench_row: "tube of radius 12 along a curve of 9 points",
        example: |pose, size| Tube { control_points: coil(pose.at_vx, size) }.into(),
    };

    type Surface = TubeSweep;

    fn fields(&mut self) -> Vec<Field<'_>> {
        vec![Field {
            key: "points",
            usage: "X,Y,Z,R;X,Y,Z,R;...",
            rule: "more than 1024 points; use several tubes",
            value: FieldValue::Curve(&mut self.control_points),
        }]
    }

    fn check(&self) -> Result<(), &'static str> {
        require(
            self.control_points.windows(2).all(|pair| pair[0].at_vx != pair[1].at_vx),
            "two points that follow each other lie in the same place",
        )
    }

    fn surface(&self, stretch: DVec3) -> TubeSweep {
        let ball = |point: &ControlPoint| -> DVec4 {
            (point.at_vx.as_dvec3() * stretch).extend(f64::from(point.radius))
        };
        let balls: Vec<_> = self.control_points.iter().map(ball).collect();
        TubeSweep { pieces: pieces(&balls) }
    }
}

/// Returns a curve that winds upwards.
fn coil(centre_vx: Vec3, size: f32) -> Arc<[ControlPoint]> {
    let point = |i: u8| {
        let turn = f32::from(i) * 1.3;
        let height = f32::from(i) * (0.25 * size) - size;
        let at = Vec3::new(size * turn.cos(), height, size * turn.sin());
        ControlPoint { at_vx: centre_vx + at, radius: 0.1875 * size }
    };
    (0..9).map(point).collect()
}

/// The pieces that make a tube.
#[derive(Clone, Debug)]
pub struct TubeSweep {
    pieces: Vec<CurvePiece>,
}

impl Surface for TubeSweep {
    fn bounds(&self) -> [DVec3; 2] {
        let bounds = self.pieces.iter().map(CurvePiece::bounds);
        let bounds = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        bounds.unwrap_or(EVERYWHERE)
    }

    fn longest(&self) -> f64 {
        let furthest = |piece: &CurvePiece| piece.bounds().map(DVec3::length);
        self.pieces.iter().flat_map(furthest).fold(0.0, f64::max)
    }

    #[inline]
    fn distance(&self, p: DVec3, pieces: &[u32]) -> f64 {
        let distance = |i: &u32| self.pieces[*i as usize].distance(p);
        pieces.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    fn coverage(&self, points: &Parallelepiped, margin: f64) -> BoxCoverage {
        let reach = points.extent() + margin;
        let near = self.pieces_near(points.middle - reach, points.middle + reach);
        let of_pieces = near.iter().map(|i| self.pieces[*i as usize].coverage(points, margin));
        of_pieces.fold(BoxCoverage::None, BoxCoverage::or)
    }

    fn pieces_near(&self, low: DVec3, high: DVec3) -> Vec<u32> {
        let reaches = |piece: &CurvePiece| {
            let [lowest, highest] = piece.bounds();
            lowest.cmple(high).all() && highest.cmpge(low).all()
        };
        (0..).zip(&self.pieces).filter(|(_, piece)| reaches(piece)).map(|(i, _)| i).collect()
    }
}
