//! The lines that show where a solid of the tools is: its edges, or circles around what is round.
//!
//! From a primitive to lines in voxel coordinates.

use std::f32::consts::TAU;

use glam::{Mat3, Vec2, Vec3};

use crate::sculpture::grid::Grid;
use crate::tools::solid::{Primitive, Solid};

/// Segments of a circle.
pub const SEGMENTS: usize = 40;

/// A point by its parts, as [`Shape`](crate::tools::solid::Shape) adds them: of the core, and of the ellipsoid that
/// rounds it.
type Point = (Vec3, Vec3);

/// The edges of a solid in voxel coordinates.
pub fn outline_of(primitive: &Primitive, grid: &Grid) -> Vec<(Vec3, Vec3)> {
    let shrink = grid.voxel_size().min_element() / grid.voxel_size();
    let linear = Mat3::from_diagonal(shrink)
        * Mat3::from_quat(primitive.rotation)
        * Mat3::from_diagonal(primitive.half);
    let round = primitive.shape().round().as_vec3();
    let place = |(core, offset): Point| {
        primitive.centre_vx + linear * (core * (Vec3::ONE - round) + offset * round)
    };
    edges(primitive.solid).into_iter().map(|(a, b)| (place(a), place(b))).collect()
}

fn edges(solid: Solid) -> Vec<(Point, Point)> {
    let plain = |(a, b): (Vec3, Vec3)| ((Vec3::ZERO, a), (Vec3::ZERO, b));
    let rim = |y: f32| circle(move |turn| (Vec3::ZERO, Vec3::new(turn.x, y, turn.y)));
    // In the planes through the axis: four lines along the side.
    let sides = [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z];
    match solid {
        Solid::Cuboid => box_edges(Vec3::NEG_ONE, Vec3::ONE).map(plain).collect(),
        Solid::Pyramid => {
            let base = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
                .map(|(x, z)| Vec3::new(x, -1.0, z));
            let edges = |i: usize| [(base[i], base[(i + 1) % 4]), (base[i], Vec3::Y)];
            (0..4).flat_map(edges).map(plain).collect()
        }
        Solid::Ellipsoid => (0..3)
            .flat_map(|axis| {
                let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
                circle(move |turn| (Vec3::ZERO, u * turn.x + v * turn.y))
            })
            .collect(),
        Solid::Cylinder => {
            let along = sides.map(|side| plain((side + Vec3::Y, side - Vec3::Y)));
            rim(-1.0).chain(rim(1.0)).chain(along).collect()
        }
        Solid::Cone => {
            let along = sides.map(|side| plain((side - Vec3::Y, Vec3::Y)));
            rim(-1.0).chain(along).collect()
        }
        Solid::Torus => {
            // Outermost, innermost, top and bottom, and around the tube.
            let flat = |turn: Vec2| Vec3::new(turn.x, 0.0, turn.y);
            let rings = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
            let rings = rings.into_iter().flat_map(|(out, up)| {
                circle(move |turn| (flat(turn), flat(turn) * out + Vec3::Y * up))
            });
            let tubes = sides
                .into_iter()
                .flat_map(|side| circle(move |turn| (side, side * turn.x + Vec3::Y * turn.y)));
            rings.chain(tubes).collect()
        }
        Solid::Capsule => {
            let rims = [-1.0, 1.0]
                .into_iter()
                .flat_map(|y| circle(move |turn| (Vec3::Y * y, Vec3::new(turn.x, 0.0, turn.y))));
            let profiles = [Vec3::X, Vec3::Z].into_iter().flat_map(|side| {
                circle(move |turn| {
                    let end = if turn.y < 0.0 { Vec3::NEG_Y } else { Vec3::Y };
                    (end, side * turn.x + Vec3::Y * turn.y)
                })
            });
            rims.chain(profiles).collect()
        }
        // The flat part of each face.
        Solid::RoundedCuboid => (0..6)
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

/// The edges between the points that `at` gives for a circle's.
fn circle(at: impl Fn(Vec2) -> Point) -> impl Iterator<Item = (Point, Point)> {
    let point = move |i: usize| at(Vec2::from_angle(TAU * i as f32 / SEGMENTS as f32));
    (0..SEGMENTS).map(move |i| (point(i), point(i + 1)))
}

/// The twelve edges of a box.
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
                // Some way inwards and outwards: along all axes and diagonals one leads in.
                let near = |distance: f64| {
                    (0..27).any(|i| {
                        let way = glam::DVec3::from(
                            [i % 3, i / 3 % 3, i / 9].map(|v| f64::from(v) - 1.0),
                        );
                        shape.contains(at + way * distance)
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
