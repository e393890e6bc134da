//! The outline of a convex object in a picture: its corners with sub-pixel precision.

use glam::{UVec2, Vec2};

/// Pixels that show the object.
pub struct Mask {
    pub size: UVec2,
    pub set: Vec<bool>,
}

impl Mask {
    fn at(&self, place: Vec2) -> bool {
        let pixel = place.floor();
        pixel.cmpge(Vec2::ZERO).all()
            && pixel.cmplt(self.size.as_vec2()).all()
            && self.set[(pixel.x as u32 + pixel.y as u32 * self.size.x) as usize]
    }

    pub fn count(&self) -> usize {
        self.set.iter().filter(|set| **set).count()
    }

    /// The middle of the pixels.
    pub fn middle(&self) -> Vec2 {
        let places = (0..self.size.y).flat_map(|y| (0..self.size.x).map(move |x| UVec2::new(x, y)));
        let set = places.zip(&self.set).filter(|(_, set)| **set).map(|(at, _)| at.as_vec2() + 0.5);
        set.sum::<Vec2>() / self.count() as f32
    }

    /// The corners of the object, each near its corner of `expected` (in order, counter-clockwise on axes x right, y
    /// down, as [`hull`] returns them): the intersections of lines fitted to the edges.
    pub fn corners(&self, expected: &[Vec2]) -> Vec<Vec2> {
        let next = |i: usize| (i + 1) % expected.len();
        let lines: Vec<(Vec2, Vec2)> =
            (0..expected.len()).map(|i| self.edge(expected[i], expected[next(i)])).collect();
        (0..expected.len())
            .map(|i| {
                let before = lines[(i + expected.len() - 1) % expected.len()];
                crossing(before, lines[i])
            })
            .collect()
    }

    /// Two points of the object's edge near the line from `a` to `b`.
    fn edge(&self, a: Vec2, b: Vec2) -> (Vec2, Vec2) {
        const REACH_PX: f32 = 8.0;
        const STEPS: usize = 128;
        let outwards = (b - a).normalize().perp() * -1.0;
        let samples: Vec<(f32, f32)> = (0..=60)
            .map(|i| 0.2 + 0.01 * i as f32)
            .map(|along| {
                let from = a.lerp(b, along) - outwards * REACH_PX;
                let step = 2.0 * REACH_PX / STEPS as f32;
                let inside =
                    (0..STEPS).filter(|i| self.at(from + outwards * (step * (*i as f32 + 0.5))));
                (along, inside.count() as f32 * step - REACH_PX)
            })
            .collect();
        // Least squares: how far outwards over how far along.
        let count = samples.len() as f32;
        let (mean_x, mean_y) = samples.iter().fold((0.0, 0.0), |sum, s| (sum.0 + s.0, sum.1 + s.1));
        let (mean_x, mean_y) = (mean_x / count, mean_y / count);
        let (xy, xx) = samples.iter().fold((0.0, 0.0), |sum, (x, y)| {
            (sum.0 + (x - mean_x) * (y - mean_y), sum.1 + (x - mean_x).powi(2))
        });
        let off = |along: f32| outwards * (mean_y + xy / xx * (along - mean_x));
        (a + off(0.0), b + off(1.0))
    }
}

fn crossing((a, b): (Vec2, Vec2), (c, d): (Vec2, Vec2)) -> Vec2 {
    let (u, v) = (b - a, d - c);
    a + u * ((c - a).perp_dot(v) / u.perp_dot(v))
}

/// The convex hull of points, in order (Andrew's monotone chain).
pub fn hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}
