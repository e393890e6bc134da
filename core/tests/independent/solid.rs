//! The solids by their definitions: tool space, where each fills [-1, 1], and a rotation.

use std::fmt;

use super::matrix::{Matrix, Vector, apply, minus, times, transposed};
use super::statement::list;
use super::sweep::{least, least_of_convex};

#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Shape {
    Ellipsoid,
    Cuboid,
    Pyramid,
    Cylinder,
    Cone,
    Torus,
    Capsule,
    RoundedCuboid,
}

impl Shape {
    pub const ALL: [Shape; 8] = [
        Shape::Ellipsoid,
        Shape::Cuboid,
        Shape::Pyramid,
        Shape::Cylinder,
        Shape::Cone,
        Shape::Torus,
        Shape::Capsule,
        Shape::RoundedCuboid,
    ];
}

/// A rotation as given in a script.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Turn {
    /// Degrees about x, then y, then z.
    Angles([f64; 3]),
    /// x, y, z, w of any length.
    Quaternion([f64; 4]),
}

impl Turn {
    /// Maps directions of the tool to directions of the grid.
    fn matrix(&self) -> Matrix {
        match *self {
            Turn::Angles(degrees) => {
                let [x, y, z] = degrees.map(|d| d.to_radians().sin_cos());
                let about_x = [[1.0, 0.0, 0.0], [0.0, x.1, -x.0], [0.0, x.0, x.1]];
                let about_y = [[y.1, 0.0, y.0], [0.0, 1.0, 0.0], [-y.0, 0.0, y.1]];
                let about_z = [[z.1, -z.0, 0.0], [z.0, z.1, 0.0], [0.0, 0.0, 1.0]];
                times(&about_z, &times(&about_y, &about_x))
            }
            Turn::Quaternion(q) => {
                let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
                let [x, y, z, w] = q.map(|v| v / length);
                [
                    [w * w + x * x - y * y - z * z, 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
                    [2.0 * (x * y + z * w), w * w - x * x + y * y - z * z, 2.0 * (y * z - x * w)],
                    [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), w * w - x * x - y * y + z * z],
                ]
            }
        }
    }
}

/// A solid with its pose.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Placed {
    pub shape: Shape,
    /// Centre in voxels.
    pub at: [f64; 3],
    /// Half extents in units of the smallest voxel edge.
    pub half: [f64; 3],
    pub turn: Turn,
    /// The destination of its centre, straight and without rotation; `None` if it stays.
    pub to: Option<[f64; 3]>,
}

/// A solid in the voxels of one sculpture.
pub struct Ready<'a> {
    placed: &'a Placed,
    turn: Matrix,
    edges: [f64; 3],
    /// Its displacement, in tool space.
    displacement: Option<Vector>,
}

impl Placed {
    pub fn ready(&self, edges: [f64; 3]) -> Ready<'_> {
        let smallest = edges.iter().copied().fold(f64::INFINITY, f64::min);
        let edges = edges.map(|e| e / smallest);
        let mut ready = Ready { placed: self, turn: self.turn.matrix(), edges, displacement: None };
        ready.displacement = self.to.map(|to| ready.in_tool(minus(to, self.at)));
        ready
    }

    /// Returns the same solid, moved by `by` voxels.
    pub fn shifted(&self, by: [i64; 3]) -> Placed {
        let shift = |p: [f64; 3]| std::array::from_fn(|i| p[i] + by[i] as f64);
        Placed { at: shift(self.at), to: self.to.map(shift), ..*self }
    }
}

impl Ready<'_> {
    /// Maps a difference of points (voxels) to tool space: back by the transposed matrix, then by the half extents.
    fn in_tool(&self, offset: Vector) -> Vector {
        let offset = std::array::from_fn(|i| offset[i] * self.edges[i]);
        let turned = apply(&transposed(&self.turn), offset);
        std::array::from_fn(|i| turned[i] / self.placed.half[i])
    }

    /// Returns how far outside the solid, or its sweep, a point (voxels) is: less than 0 inside and 0 on its surface.
    /// The unit is that of tool space, and the value is not a true distance.
    pub fn beyond(&self, point: [f64; 3]) -> f64 {
        let p = self.in_tool(minus(point, self.placed.at));
        let Some(displacement) = self.displacement else { return self.beyond_at(p) };
        // Outside the box around the whole sweep.
        let beside = |i: usize| {
            let (a, b) = (p[i], p[i] - displacement[i]);
            a.min(b) > 1.2 || a.max(b) < -1.2
        };
        if (0..3).any(beside) {
            return 0.1;
        }
        let then = |t: f64| self.beyond_at(std::array::from_fn(|i| p[i] - t * displacement[i]));
        match self.placed.shape {
            Shape::Torus => least(&then),
            _ => least_of_convex(&then),
        }
    }

    /// Returns how far outside the solid a point of tool space is.
    fn beyond_at(&self, [x, y, z]: Vector) -> f64 {
        let Placed { shape, half, .. } = self.placed;
        match shape {
            Shape::Ellipsoid => (x * x + y * y + z * z).sqrt() - 1.0,
            Shape::Cuboid => x.abs().max(y.abs()).max(z.abs()) - 1.0,
            Shape::Pyramid => (y.abs() - 1.0).max(x.abs().max(z.abs()) - 0.5 * (1.0 - y)),
            Shape::Cylinder => (y.abs() - 1.0).max(x.hypot(z) - 1.0),
            Shape::Cone => (y.abs() - 1.0).max(x.hypot(z) - 0.5 * (1.0 - y)),
            Shape::Torus => {
                // Distances over the radius of the tube.
                let width = half[0].min(half[2]);
                let tube = half[1].min(width / 3.0);
                ((x.hypot(z) - 1.0) * width / tube + 1.0).hypot(y * half[1] / tube) - 1.0
            }
            Shape::Capsule => {
                let cap = half[0].min(half[2]).min(half[1]);
                let up = ((y.abs() - 1.0) * half[1] / cap + 1.0).max(0.0);
                x.hypot(z).hypot(up) - 1.0
            }
            Shape::RoundedCuboid => {
                let radius = half.iter().copied().fold(f64::INFINITY, f64::min) / 3.0;
                let over = |p: f64, half: f64| ((p.abs() - 1.0) * half / radius + 1.0).max(0.0);
                over(x, half[0]).hypot(over(y, half[1])).hypot(over(z, half[2])) - 1.0
            }
        }
    }

    /// Returns whether a point is nearer to the surface than rounding can resolve.
    pub fn doubtful(&self, point: [f64; 3]) -> bool {
        let Placed { shape, half, .. } = self.placed;
        let smallest = half.iter().copied().fold(f64::INFINITY, f64::min);
        let coarse = match (shape, self.displacement) {
            // The sweep of a torus is sampled in steps of a thousandth of the tube's radius, at most 2^14.
            (Shape::Torus, Some([x, y, z])) => {
                let width = half[0].min(half[2]);
                let tube = half[1].min(width / 3.0);
                let fastest = (x.hypot(z) * width / tube).hypot(y * half[1] / tube);
                f64::max(1.1e-3, fastest / 16000.0)
            }
            _ => 0.0,
        };
        self.beyond(point).abs() < f64::max(1e-4 / smallest.min(1.0), coarse)
    }
}

impl fmt::Display for Placed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.shape {
            Shape::RoundedCuboid => "rounded-cuboid".to_string(),
            other => format!("{other:?}").to_lowercase(),
        };
        write!(f, "{name} at={} half={} turn=", list(&self.at), list(&self.half))?;
        match self.turn {
            Turn::Angles(angles) => write!(f, "{}", list(&angles))?,
            Turn::Quaternion(q) => write!(f, "{}", list(&q))?,
        }
        self.to.map_or(Ok(()), |to| write!(f, " to={}", list(&to)))
    }
}
