//! The lines that outline a solid of the tools: its edges, or circles around round parts.
//!
//! Takes a primitive; gives lines in voxel coordinates.

use std::f32::consts::TAU;

use glam::{Mat3, Vec2, Vec3};

use crate::sculpture::grid::Grid;
use crate::tools::solid::Primitive;
use crate::tools::solid::body::{Body, ProfilePoint, Stretch};

/// Segments of a circle.
pub const SEGMENTS: usize = 40;

/// A point in two parts, whose sum [`Shape`](crate::tools::solid::Shape) uses: of the core, and of the ellipsoid that
/// rounds it.
type Point = (Vec3, Vec3);

/// Returns the edges of a solid in voxel coordinates.
pub fn outline_of(primitive: &Primitive, grid: &Grid) -> Vec<(Vec3, Vec3)> {
    let shrink = grid.voxel_size().min_element() / grid.voxel_size();
    let linear = Mat3::from_diagonal(shrink)
        * Mat3::from_quat(primitive.rotation)
        * Mat3::from_diagonal(primitive.half);
    let round = primitive.shape().round().as_vec3();
    let place = |(core, offset): Point| {
        primitive.centre_vx + linear * (core * (Vec3::ONE - round) + offset * round)
    };
    edges(&primitive.solid.spec().body).into_iter().map(|(a, b)| (place(a), place(b))).collect()
}

fn edges(body: &Body) -> Vec<(Point, Point)> {
    match body {
        Body::Faces { corners, faces } => face_edges(corners, faces),
        Body::Revolved { profile, rims } => {
            let rims = rims.iter().flat_map(|rim| {
                circle(move |turn| {
                    let about = |p: Vec2| Vec3::new(p.x * turn.x, p.y, p.x * turn.y);
                    (about(rim.core), about(rim.offset))
                })
            });
            // In the planes through the axis.
            let sides = [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z];
            rims.chain(sides.into_iter().flat_map(|side| meridian(profile, side))).collect()
        }
        // The flat part of each face.
        Body::RoundedBox => (0..6)
            .flat_map(|face| {
                let axis = face / 2;
                let out = Vec3::AXES[axis] * if face % 2 == 0 { 1.0 } else { -1.0 };
                let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
                let corners = [-u - v, u - v, u + v, v - u];
                (0..4).map(move |i| ((out + corners[i], out), (out + corners[(i + 1) % 4], out)))
            })
            .collect(),
    }
}

/// Returns the edges of flat faces, each once.
fn face_edges(corners: &[Vec3], faces: &[&[usize]]) -> Vec<(Point, Point)> {
    let around = |face: &&[usize]| -> Vec<[usize; 2]> {
        let ends = face.iter().zip(face.iter().cycle().skip(1));
        ends.map(|(from, to)| [*from, *to]).collect()
    };
    // Only one of the two faces at an edge runs along it upwards.
    let edges = faces.iter().flat_map(around).filter(|[from, to]| from < to);
    edges.map(|ends| ends.map(|i| (Vec3::ZERO, corners[i])).into()).collect()
}

/// Returns the lines of a profile in the half plane of a side, without the caps.
fn meridian(profile: &'static [Stretch], side: Vec3) -> Vec<(Point, Point)> {
    let place = move |p: ProfilePoint| {
        let at = |p: Vec2| side * p.x + Vec3::Y * p.y;
        (at(p.core), at(p.offset))
    };
    let mut points: Vec<Vec<Point>> = Vec::new();
    for stretch in profile.iter().filter(|stretch| !stretch.is_cap()) {
        let steps = match stretch {
            Stretch::Line(_) => 1,
            Stretch::Arc { turns: [from, to], .. } => {
                ((to - from) * SEGMENTS as f32).round() as usize
            }
        };
        let at = |step: usize| place(stretch.at(step as f32 / steps as f32).0);
        points.push((0..=steps).map(at).collect());
    }
    // Arcs about different points are connected by a straight line.
    let chain = points.concat();
    chain.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

/// Returns the edges between the points that `at` gives for a circle.
fn circle(at: impl Fn(Vec2) -> Point) -> impl Iterator<Item = (Point, Point)> {
    let point = move |i: usize| at(Vec2::from_angle(TAU * i as f32 / SEGMENTS as f32));
    (0..SEGMENTS).map(move |i| (point(i), point(i + 1)))
}

/// Returns the twelve edges of a box.
pub fn box_edges(min: Vec3, max: Vec3) -> impl Iterator<Item = (Vec3, Vec3)> {
    (0..3).flat_map(move |axis| {
        (0..4).map(move |corner| {
            let mut from = min;
            from[(axis + 1) % 3] = if corner & 1 == 0 { min } else { max }[(axis + 1) % 3];
            from[(axis + 2) % 3] = if corner & 2 == 0 { min } else { max }[(axis + 2) % 3];
            let mut to = from;
            to[axis] = max[axis];
            (from, to)
        })
    })
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::sculpture::grid::Grid;
    use crate::tools::solid::Solid;

    #[test]
    fn a_box_has_twelve_different_edges() {
        let edges: Vec<_> = box_edges(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)).collect();
        assert_eq!(edges.len(), 12);
        let total: f32 = edges.iter().map(|(a, b)| a.distance(*b)).sum();
        assert_eq!(total, 24.0);
        for (i, a) in edges.iter().enumerate() {
            assert!(edges[..i].iter().all(|b| a != b));
        }
    }

    #[test]
    fn outlines_lie_on_the_solids() {
        let grid = Grid::new(glam::UVec3::splat(64), Vec3::ONE, 1 << 20).unwrap();
        let halves = [Vec3::splat(9.0), Vec3::new(8.0, 2.0, 8.0), Vec3::new(4.0, 11.0, 5.0)];
        for (solid, half) in Solid::ALL.into_iter().flat_map(|s| halves.map(|half| (s, half))) {
            let rotation = Quat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.4);
            let primitive = Primitive { solid, centre_vx: Vec3::splat(30.0), half, rotation };
            let placed = primitive.in_grid(Vec3::ONE);
            let shape = primitive.shape();
            let lines = outline_of(&primitive, &grid);
            assert!(lines.len() >= 8, "{solid:?}");
            for end in lines.iter().flat_map(|(a, b)| [*a, *b]) {
                let at = placed.tool_point(end).as_dvec3();
                // One of the axes and diagonals leads inwards, another outwards.
                let near = |distance: f64| {
                    (0..27).any(|i| {
                        let direction = glam::DVec3::from(
                            [i % 3, i / 3 % 3, i / 9].map(|v| f64::from(v) - 1.0),
                        );
                        shape.contains(at + direction * distance)
                    })
                };
                let out = at + at.normalize() * 0.02;
                assert!(near(0.01), "{solid:?} {half} {at}");
                let inner = solid == Solid::Torus;
                assert!(inner || !shape.contains(out), "{solid:?} {half} {at}");
            }
        }
    }
}
