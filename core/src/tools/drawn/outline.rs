//! Flat outlines: the distance from closed polygons, below 0 inside.
//!
//! Pure plane geometry. A point is inside if a ray from it crosses an odd number of edges.

use std::sync::Arc;

use glam::{DVec2, Vec2};

use crate::sculpture::region::BoxCoverage;

/// Edges, each from one point to another.
#[derive(Clone, Debug, Default)]
pub struct Outlines {
    edges: Vec<[DVec2; 2]>,
}

impl Outlines {
    /// Adds a closed outline.
    pub fn close(&mut self, points: &[DVec2]) {
        self.join(points);
        if let [first, .., last] = points {
            self.join(&[*last, *first]);
        }
    }

    /// Adds the edges from each point to the next.
    pub fn join(&mut self, points: &[DVec2]) {
        self.edges.extend(points.windows(2).map(|pair| [pair[0], pair[1]]));
    }

    /// Returns the lowest and the highest point.
    pub fn bounds(&self) -> [DVec2; 2] {
        let points = self.edges.iter().flatten();
        points.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], p| {
            [low.min(*p), high.max(*p)]
        })
    }

    /// Returns the distance of `p` from the nearest edge, below 0 inside: no nearer point is on the other side.
    pub fn distance(&self, p: DVec2) -> f64 {
        let mut nearest = f64::INFINITY;
        let mut inside = false;
        for [a, b] in &self.edges {
            let (edge, offset) = (*b - *a, p - *a);
            let length_squared = edge.length_squared();
            let share = if length_squared > 0.0 { offset.dot(edge) / length_squared } else { 0.0 };
            nearest = nearest.min((offset - edge * share.clamp(0.0, 1.0)).length_squared());
            // The ray points along x, outwards from the axis of a profile.
            if (a.y > p.y) != (b.y > p.y) {
                let left = (p.x - a.x) * edge.y < edge.x * offset.y;
                inside ^= left == (edge.y > 0.0);
            }
        }
        if inside { -nearest.sqrt() } else { nearest.sqrt() }
    }

    /// Returns how the outlines cover all points `middle` plus a share from -1 to 1 of each of `half_edges`. `margin`:
    /// bound on rounding errors.
    pub fn coverage(&self, middle: DVec2, half_edges: &[DVec2], margin: f64) -> BoxCoverage {
        let distance = self.distance(middle);
        let reach: f64 = half_edges.iter().map(|edge| edge.length()).sum();
        let meets = |outline: &[DVec2; 2]| meets(outline, middle, half_edges, margin);
        match distance.abs() <= reach + margin && self.edges.iter().any(meets) {
            true => BoxCoverage::Part,
            false if distance < 0.0 => BoxCoverage::All,
            false => BoxCoverage::None,
        }
    }
}

/// Returns whether an edge of an outline meets the points of [`Outlines::coverage`]: whether neither its own normal nor
/// that of one of `half_edges` is the normal of a line between them.
fn meets([a, b]: &[DVec2; 2], middle: DVec2, half_edges: &[DVec2], margin: f64) -> bool {
    let half = (*b - *a) * 0.5;
    let offset = middle - (*a + half);
    let separates = |side: &DVec2| {
        let normal = side.perp();
        let reach: f64 = half_edges.iter().map(|edge| edge.dot(normal).abs()).sum();
        offset.dot(normal).abs() > reach + half.dot(normal).abs() + margin * normal.length()
    };
    !separates(&half) && !half_edges.iter().any(separates)
}

/// Converts points to double precision.
pub fn exact(points: &[Vec2]) -> Vec<DVec2> {
    points.iter().map(|point| point.as_dvec2()).collect()
}

/// Returns a wavy line of 33 points for examples, about `size` from the y axis and from `-size` to `size` along it.
pub fn wavy(size: f32) -> Arc<[Vec2]> {
    let point = |i: u8| {
        let share = f32::from(i) / 32.0;
        let out = 0.875 * size + 0.125 * size * (share * 12.0).sin();
        Vec2::new(out, 2.0 * size * share - size)
    };
    (0..=32).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_from_a_frame_are_those_of_its_sides() {
        let square = |half: f64| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|p| DVec2::from(p) * half)
        };
        let mut frame = Outlines::default();
        frame.close(&square(8.0));
        frame.close(&square(4.0));
        for (p, distance) in [
            ([0.0, 0.0], 4.0),
            ([5.0, 1.0], -1.0),
            ([-6.5, 0.0], -1.5),
            ([11.0, 12.0], 5.0),
            ([-8.0, 3.0], 0.0),
        ] {
            assert!((frame.distance(p.into()) - distance).abs() < 1e-12, "{p:?}");
        }
        assert_eq!(frame.bounds(), [DVec2::splat(-8.0), DVec2::splat(8.0)]);
    }
}
