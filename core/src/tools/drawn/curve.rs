//! Curves with a round cross-section. Divides a curve into pieces that a ball sweeps in a straight line while its
//! radius changes linearly, and computes the distance from such a piece.
//!
//! Pure geometry in units of the smallest edge of a voxel.

use glam::{DVec3, DVec4, Vec3};

use super::fields::ControlPoint;
use super::spec::coverage_of_distance;
use crate::sculpture::region::BoxCoverage;
use crate::tools::parallelepiped::Parallelepiped;

/// Maximum distance of the pieces from the curve.
const TOLERANCE: f64 = 0.02;
/// Maximum number of pieces between two control points.
const MAX_PIECES: f64 = 32.0;

/// The volume that a ball sweeps in straight motion while its radius changes linearly: the convex hull of its two ends.
#[derive(Clone, Copy, Debug)]
pub struct CurvePiece {
    from: DVec3,
    /// Of length 1, or 0.
    along: DVec3,
    length: f64,
    radius: f64,
    /// Growth of the radius per unit of length along the piece.
    slope: f64,
}

impl CurvePiece {
    /// Creates a piece from one ball to another. Each ball is its centre, with the radius as the fourth number.
    fn new(a: DVec4, b: DVec4) -> CurvePiece {
        let (from, displacement) = (a.truncate(), (b - a).truncate());
        let length = displacement.length();
        let along = displacement.normalize_or_zero();
        let slope = if length > 0.0 { (b.w - a.w) / length } else { 0.0 };
        CurvePiece { from, along, length, radius: a.w, slope }
    }

    /// Returns the least distance of `p` from the surfaces of all balls on the path, below 0 inside. It changes by at
    /// most the distance that `p` moves.
    #[inline(always)]
    pub fn distance(&self, p: DVec3) -> f64 {
        let offset = p - self.from;
        let height = offset.dot(self.along);
        let aside = (offset - self.along * height).length();
        // Minimises hypot(aside, s - height) - radius - slope s, which is convex in s.
        let s = match 1.0 - self.slope * self.slope {
            steep if steep > 0.0 => height + aside * self.slope / steep.sqrt(),
            // One end contains the other.
            _ if self.slope > 0.0 => self.length,
            _ => 0.0,
        };
        let s = s.clamp(0.0, self.length);
        aside.hypot(s - height) - self.radius - self.slope * s
    }

    /// Returns how the piece covers the points of a box. `margin`: bound on rounding errors.
    pub fn coverage(&self, points: &Parallelepiped, margin: f64) -> BoxCoverage {
        let far = coverage_of_distance(self.distance(points.middle), points.radius() + margin);
        if far != BoxCoverage::Part {
            return far;
        }
        let inside = |corner: &DVec3| self.distance(*corner) < -margin;
        match points.corners().iter().filter(|corner| inside(corner)).count() {
            8 => BoxCoverage::All,
            0 if points.relative_to(self.from).is_apart(
                |direction| self.furthest(direction),
                DVec3::ZERO,
                margin,
            ) =>
            {
                BoxCoverage::None
            }
            _ => BoxCoverage::Part,
        }
    }

    /// Returns the point that lies furthest along a direction of length 1, relative to the start.
    fn furthest(&self, direction: DVec3) -> DVec3 {
        let (end, radius) = (self.along * self.length, self.radius + self.slope * self.length);
        match end.dot(direction) + radius > self.radius {
            true => end + direction * radius,
            false => direction * self.radius,
        }
    }

    /// Returns the lowest and the highest point.
    pub fn bounds(&self) -> [DVec3; 2] {
        let to = self.from + self.along * self.length;
        let end = self.radius + self.slope * self.length;
        let (low, high) = (self.from - self.radius, self.from + self.radius);
        [low.min(to - end), high.max(to + end)]
    }
}

/// Returns the pieces of a centripetal Catmull-Rom spline through balls whose neighbours differ in position.
pub fn pieces(balls: &[DVec4]) -> Vec<CurvePiece> {
    match path(balls)[..] {
        [ball] => vec![CurvePiece::new(ball, ball)],
        ref path => path.windows(2).map(|pair| CurvePiece::new(pair[0], pair[1])).collect(),
    }
}

/// Returns the path of the ball that sweeps a tube, for display: straight lines between control points, as close to the
/// curve as those of its voxels. `edges`: of a voxel, in units of the smallest. Neighbours must differ in position.
pub fn tube_path(control_points: &[ControlPoint], edges: Vec3) -> Vec<ControlPoint> {
    let ball = |control_point: &ControlPoint| {
        (control_point.at_vx * edges).as_dvec3().extend(f64::from(control_point.radius))
    };
    let balls: Vec<DVec4> = control_points.iter().map(ball).collect();
    let control_point = |ball: DVec4| ControlPoint {
        at_vx: ball.truncate().as_vec3() / edges,
        radius: ball.w as f32,
    };
    path(&balls).into_iter().map(control_point).collect()
}

/// Returns the balls at the ends of the pieces, in order.
fn path(balls: &[DVec4]) -> Vec<DVec4> {
    let mut path: Vec<DVec4> = balls.first().copied().into_iter().collect();
    for i in 1..balls.len() {
        let (a, b) = (balls[i - 1], balls[i]);
        // The curve continues straight beyond its ends.
        let before = if i > 1 { balls[i - 2] } else { a + (a - b) };
        let after = balls.get(i + 1).copied().unwrap_or(b + (b - a));
        let span = SplineSpan::new([before, a, b, after]);
        let bend = (1..8).map(|part| {
            let t = f64::from(part) / 8.0;
            (span.at(t) - a.lerp(b, t)).length()
        });
        // A chord of 1/n of the path is n^2 times as close to the curve.
        let count = (bend.fold(0.0, f64::max) / TOLERANCE).sqrt().ceil().clamp(1.0, MAX_PIECES);
        let inner = (1..count as u32).map(|part| span.at(f64::from(part) / count));
        path.extend(inner.chain([b]));
    }
    path
}

/// The part of the spline between the middle two of four balls.
struct SplineSpan {
    balls: [DVec4; 4],
    knots: [f64; 4],
}

impl SplineSpan {
    fn new(balls: [DVec4; 4]) -> SplineSpan {
        let mut knots = [0.0; 4];
        for i in 1..4 {
            let displacement = (balls[i] - balls[i - 1]).truncate();
            knots[i] = knots[i - 1] + displacement.length().sqrt();
        }
        SplineSpan { balls, knots }
    }

    /// Returns the ball at a share of the path, by the pyramid of Barry and Goldman (1988).
    fn at(&self, share: f64) -> DVec4 {
        let k = &self.knots;
        let t = k[1] + (k[2] - k[1]) * share;
        let mut level = self.balls;
        for step in 1..4 {
            for i in 0..4 - step {
                // The last step is between the middle knots, the others as wide as they reach.
                let (low, high) = if step == 3 { (k[1], k[2]) } else { (k[i], k[i + step]) };
                level[i] = level[i].lerp(level[i + 1], (t - low) / (high - low));
            }
        }
        let mut ball = level[0];
        // Where radii change fast, the curve through them may fall below zero.
        ball.w = ball.w.max(0.0);
        ball
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ball() -> impl Strategy<Value = DVec4> {
        (prop::array::uniform3(-20.0..20.0f64), 0.1..8.0f64)
            .prop_map(|(at, radius)| DVec3::from(at).extend(radius))
    }

    #[test]
    fn the_way_of_a_tube_goes_through_its_beads_and_bends_between_them() {
        let control_point =
            |x: f32, y: f32, radius| ControlPoint { at_vx: Vec3::new(x, y, 1.0), radius };
        let control_points = [
            control_point(0.0, 0.0, 3.0),
            control_point(20.0, 10.0, 2.0),
            control_point(40.0, 0.0, 1.0),
        ];
        let way = tube_path(&control_points, Vec3::new(1.0, 2.0, 1.0));
        assert!(
            way.len() > 10
                && control_points.iter().all(|control_point| way.contains(control_point)),
            "{way:?}"
        );
        let straight = |p: &ControlPoint| p.at_vx.y == 10.0 - (p.at_vx.x - 20.0).abs() * 0.5;
        assert!(!way.iter().all(straight));
        assert_eq!(tube_path(&control_points[..2], Vec3::ONE), control_points[..2]);
        assert_eq!(tube_path(&control_points[..1], Vec3::ONE), control_points[..1]);
        assert_eq!(tube_path(&[], Vec3::ONE), []);
    }

    proptest! {
        /// The distance is the least of those from many balls on the path.
        #[test]
        fn the_distance_is_that_of_the_nearest_ball(a in ball(), b in ball(), p in ball()) {
            let (piece, p) = (CurvePiece::new(a, b), p.truncate());
            let tried = (0..=2000).map(|i| {
                let ball = a.lerp(b, f64::from(i) / 2000.0);
                p.distance(ball.truncate()) - ball.w
            });
            let least = tried.fold(f64::INFINITY, f64::min);
            let found = piece.distance(p);
            prop_assert!(found <= least + 1e-9 && found >= least - 0.02, "{} {}", found, least);
            let [low, high] = piece.bounds();
            if found <= 0.0 {
                prop_assert!(p.cmpge(low - 1e-9).all() && p.cmple(high + 1e-9).all());
            }
        }

        #[test]
        fn a_curve_goes_through_its_balls_without_gaps(
            balls in prop::collection::vec(ball(), 2..6),
        ) {
            let pieces = pieces(&balls);
            for pair in pieces.windows(2) {
                let end = pair[0].from + pair[0].along * pair[0].length;
                prop_assert!(end.distance(pair[1].from) < 1e-9);
            }
            for ball in balls {
                let nearest = pieces.iter().map(|p| p.distance(ball.truncate()));
                prop_assert!(nearest.fold(f64::INFINITY, f64::min) <= 1e-9 - ball.w);
            }
        }
    }

    #[test]
    fn a_straight_way_is_one_piece_and_a_bend_as_many_as_it_needs() {
        let at = |x: f64, y: f64| DVec4::new(x, y, 0.0, 2.0);
        assert_eq!(pieces(&[at(0.0, 0.0)]).len(), 1);
        assert_eq!(pieces(&[at(0.0, 0.0), at(9.0, 3.0)]).len(), 1);
        let bend = pieces(&[at(0.0, 0.0), at(20.0, 0.0), at(20.0, 20.0)]).len();
        assert!((8..=64).contains(&bend), "{bend}");
    }
}
