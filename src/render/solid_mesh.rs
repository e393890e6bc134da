//! The surfaces of the tool's solids as triangles, for its preview.
//!
//! A vertex of a solid whose shape depends on its proportions is kept in two parts, a point of the core and one of the
//! ellipsoid that rounds it ([`SolidShape`](crate::tools::solid::Shape)), so that one mesh serves all proportions. Knows
//! no Vulkan.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use crate::tools::solid::body::{Body, ProfilePoint, Stretch};

/// Segments around the axis of a round solid; half as many from pole to pole.
const SEGMENTS: usize = 96;
/// Segments along each half of an edge of a rounded cuboid, an eighth of a circle.
const EDGE_SEGMENTS: usize = SEGMENTS / 8;

/// A corner of a triangle. With half extents `round` of the rounding ellipsoid, it is at `core * (1 - round) + offset *
/// round`.
#[derive(Clone, Copy, PartialEq, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// The point of the core; 0 where there is none.
    pub core: [f32; 3],
    /// The point of the ellipsoid, on the unit ball; without a core, the vertex itself.
    pub offset: [f32; 3],
    /// The normal where `round` is 1; otherwise divide it by `round`, axis by axis.
    pub normal: [f32; 3],
}

impl Vertex {
    fn new(core: Vec3, offset: Vec3, normal: Vec3) -> Vertex {
        Vertex { core: core.to_array(), offset: offset.to_array(), normal: normal.to_array() }
    }

    /// Returns a vertex of a solid without a core, or of a ball around a point of one.
    fn on_ball(core: Vec3, offset: Vec3) -> Vertex {
        Vertex::new(core, offset, offset)
    }
}

/// Returns the surface of a solid: three vertices a triangle, counter-clockwise seen from outside.
pub fn triangles(body: &Body) -> Vec<[Vertex; 3]> {
    match body {
        Body::Faces { corners, faces } => faces
            .iter()
            .flat_map(|face| {
                let fan = face[1..].windows(2);
                fan.map(|next| flat([face[0], next[0], next[1]].map(|i| corners[i])))
            })
            .collect(),
        Body::Revolved { profile, .. } => revolved(&steps(profile)),
        Body::RoundedBox => rounded_cuboid(),
    }
}

/// Returns the largest depth of the triangles within the solid, in tool space.
pub fn sagitta(body: &Body) -> f32 {
    match body {
        Body::Faces { .. } => 0.0,
        // Round along and across.
        _ => 2.0 * (1.0 - (PI / SEGMENTS as f32).cos()),
    }
}

/// A point of a profile with its normal.
type ProfileStep = (ProfilePoint, Vec2);

/// Returns the steps of a profile. Joins arcs about different points.
fn steps(profile: &[Stretch]) -> Vec<[ProfileStep; 2]> {
    let mut out: Vec<[ProfileStep; 2]> = Vec::new();
    for stretch in profile {
        let count = match stretch {
            Stretch::Line(_) => 1,
            Stretch::Arc { core, turns: [from, to] } => {
                // A tube off the axis is at most a third as wide as the solid, and needs half as many.
                let of_circle = if core.x == 0.0 { SEGMENTS } else { SEGMENTS / 2 };
                ((to - from) * of_circle as f32).round() as usize
            }
        };
        let at = |step: usize| stretch.at(step as f32 / count as f32);
        if let Some([_, last]) = out.last()
            && last.0.core != at(0).0.core
        {
            out.push([*last, at(0)]);
        }
        out.extend((0..count).map(|step| [at(step), at(step + 1)]));
    }
    out
}

/// Returns the triangles that a profile (from the top down along the outside) sweeps around the y axis.
fn revolved(profile: &[[ProfileStep; 2]]) -> Vec<[Vertex; 3]> {
    let at = |(p, normal): ProfileStep, segment: usize| {
        let (sin, cos) = (TAU * segment as f32 / SEGMENTS as f32).sin_cos();
        let turn = |v: Vec2| Vec3::new(v.x * sin, v.y, v.x * cos);
        Vertex::new(turn(p.core), turn(p.offset), turn(normal))
    };
    let on_axis = |(p, _): ProfileStep| p.core.x == 0.0 && p.offset.x.abs() < 1e-6;
    let mut out = Vec::new();
    for [upper, lower] in profile {
        for segment in 0..SEGMENTS {
            let [a, b] = [at(*upper, segment), at(*lower, segment)];
            let [c, d] = [at(*lower, segment + 1), at(*upper, segment + 1)];
            // On the axis one of the two has no area.
            if !on_axis(*lower) {
                out.push([a, b, c]);
            }
            if !on_axis(*upper) {
                out.push([a, c, d]);
            }
        }
    }
    out
}

/// Returns the axes of the six faces of a cube: outwards, and two along the face that make a right-handed frame with
/// it.
fn faces() -> impl Iterator<Item = [Vec3; 3]> {
    (0..3).flat_map(|axis| {
        [-1.0, 1.0].map(|sign| {
            [Vec3::AXES[axis] * sign, Vec3::AXES[(axis + 1) % 3] * sign, Vec3::AXES[(axis + 2) % 3]]
        })
    })
}

/// Returns the faces of a cube, each bent over its edges up to its neighbours, a corner of the core at a time.
fn rounded_cuboid() -> Vec<[Vertex; 3]> {
    // Tangents of the angles from the face's middle, and the side of the core that they belong to.
    let stops: Vec<(f32, f32)> = [-1.0, 1.0]
        .into_iter()
        .flat_map(|side: f32| {
            (0..=EDGE_SEGMENTS).map(move |i| {
                let share = i as f32 / EDGE_SEGMENTS as f32;
                let along = if side < 0.0 { 1.0 - share } else { share };
                (side * (along * PI / 4.0).tan(), side)
            })
        })
        .collect();
    let mut out = Vec::new();
    for [normal, u, v] in faces() {
        let at = |(along_u, side_u): (f32, f32), (along_v, side_v): (f32, f32)| {
            let offset = (normal + u * along_u + v * along_v).normalize();
            Vertex::on_ball(normal + u * side_u + v * side_v, offset)
        };
        for columns in stops.windows(2) {
            for rows in stops.windows(2) {
                let [a, b] = [at(columns[0], rows[0]), at(columns[1], rows[0])];
                let [c, d] = [at(columns[1], rows[1]), at(columns[0], rows[1])];
                out.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    out
}

fn flat(corners: [Vec3; 3]) -> [Vertex; 3] {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize();
    corners.map(|corner| Vertex::new(Vec3::ZERO, corner, normal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::solid::{Solid, SolidShape};

    fn place(vertex: &Vertex, round: Vec3, offset_scale: f32) -> Vec3 {
        Vec3::from(vertex.core) * (1.0 - round) + Vec3::from(vertex.offset) * round * offset_scale
    }

    /// Checks that every mesh lies on the surface of the solid that the tool computes with, is closed, and faces
    /// outwards.
    #[test]
    fn meshes_are_the_surfaces_of_the_solids() {
        let third = 1.0 / 3.0;
        let cases = [
            (Solid::Ellipsoid, Vec3::ONE, 4.0 / 3.0 * PI),
            (Solid::Cuboid, Vec3::ONE, 8.0),
            (Solid::Pyramid, Vec3::ONE, 8.0 / 3.0),
            (Solid::Cylinder, Vec3::ONE, TAU),
            (Solid::Cone, Vec3::ONE, TAU / 3.0),
            // In tool space the tube is stretched by the flatness of the solid.
            (Solid::Torus, Vec3::ONE, 2.0 * PI * PI * (2.0 * third) * third * third),
            (Solid::Torus, Vec3::new(4.0, 0.4, 4.0), 2.0 * PI * PI * 0.9 * 0.1),
            (Solid::Capsule, Vec3::new(1.0, 2.0, 1.0), PI + 2.0 / 3.0 * PI),
            (Solid::Capsule, Vec3::new(2.0, 1.0, 2.0), 4.0 / 3.0 * PI),
            (
                Solid::RoundedCuboid,
                Vec3::ONE,
                (64.0 + 6.0 * 16.0 + 3.0 * PI * 4.0 + 4.0 / 3.0 * PI) / 27.0,
            ),
            // Box, faces, edges and corners by Steiner's formula, over 5 * 1 * 2.
            (Solid::RoundedCuboid, Vec3::new(5.0, 1.0, 2.0), 7.852),
        ];
        for (solid, half, volume) in cases {
            let shape = SolidShape::new(solid, half.as_dvec3());
            let round = shape.round().as_vec3();
            let mut enclosed = 0.0;
            for triangle in triangles(&solid.spec().body) {
                let corners = triangle.map(|vertex| place(&vertex, round, 1.0));
                for vertex in triangle {
                    let [inside, outside] = [0.999, 1.001]
                        .map(|scale| shape.contains(place(&vertex, round, scale).as_dvec3()));
                    assert!(inside && !outside, "{solid:?} {half} {vertex:?}");
                }
                let [a, b, c] = corners;
                let normal = (b - a).cross(c - a);
                let outwards = |v: &Vertex| (Vec3::from(v.normal) / round).dot(normal) > 0.0;
                // Faces without an area have no side.
                assert!(
                    normal.length() < 1e-9 || triangle.iter().all(outwards),
                    "{solid:?} {half} {triangle:?}"
                );
                enclosed += a.dot(b.cross(c)) / 6.0;
            }
            assert!((enclosed - volume).abs() < 0.02 * volume, "{solid:?} {half} {enclosed}");
        }
    }
}
