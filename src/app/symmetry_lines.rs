//! Shows the symmetry as lines over the picture: mirror planes as frames with a cross, the axis of rotation with a
//! spoke for each image.
//!
//! Takes the symmetry and the grid; gives lines in voxel coordinates.

use glam::{Quat, UVec3, Vec3};

use crate::document::Document;
use crate::render::overlay::OverlayLine;
use crate::sculpture::Rgb;
use crate::tools::symmetry::{MirrorPlane, Radial};

/// Half the edge of the frame of a plane, and half the length of an axis, as a share of the grid's diagonal.
const REACH: f32 = 0.4;
/// Length of a spoke and of a plane's normal, also as a share.
const SPOKE: f32 = 0.12;

/// The colour of everything that symmetry shows.
pub const MIRROR: Rgb = Rgb::new(0xb0, 0x8c, 0xf0);

/// Returns the lines of all mirror planes and axes.
pub fn lines(document: &Document) -> Vec<OverlayLine> {
    let (grid, symmetry) = (document.grid(), document.symmetry().shifted(-document.origin()));
    let dims = grid.dims();
    let stretch = grid.voxel_size() / grid.voxel_size().min_element();
    let mut pairs = Vec::new();
    for (axis, plane) in document.mirror_planes().into_iter().enumerate() {
        pairs.extend(plane.into_iter().flat_map(|plane| plane_edges(axis, plane, dims)));
    }
    pairs.extend(symmetry.plane.iter().flat_map(|plane| of_plane(plane, dims, stretch)));
    pairs.extend(symmetry.radial.iter().flat_map(|radial| of_axis(radial, dims, stretch)));
    let line =
        |(from, to)| OverlayLine { from, to, colour: MIRROR, width_px: 1.2, opacity: [0.8, 0.3] };
    pairs.into_iter().map(line).collect()
}

/// Returns the rim of a mirror plane and a cross in it.
fn plane_edges(axis: usize, plane: f32, dims: UVec3) -> Vec<(Vec3, Vec3)> {
    let dims = dims.as_vec3();
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let at = |a: f32, b: f32| {
        let mut p = Vec3::ZERO;
        p[axis] = plane;
        p[u] = a * dims[u];
        p[v] = b * dims[v];
        p
    };
    let rim = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let cross = [(at(0.5, 0.0), at(0.5, 1.0)), (at(0.0, 0.5), at(1.0, 0.5))];
    (0..4).map(|i| (rim[i], rim[(i + 1) % 4])).chain(cross).collect()
}

/// Returns the frame of a plane around the point nearest to the grid's centre, its cross and its normal.
fn of_plane(plane: &MirrorPlane, dims: UVec3, stretch: Vec3) -> Vec<(Vec3, Vec3)> {
    let Some(normal) = plane.normal.try_normalize() else { return Vec::new() };
    let (middle, diagonal) = (dims.as_vec3() * 0.5 * stretch, (dims.as_vec3() * stretch).length());
    let foot = middle - normal * (middle - plane.at_vx * stretch).dot(normal);
    let (u, v) = normal.any_orthonormal_pair();
    let at = |a: f32, b: f32| (foot + (u * a + v * b) * REACH * diagonal) / stretch;
    let rim = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    let frame = (0..4).map(|i| (rim[i], rim[(i + 1) % 4]));
    let cross = [(at(-1.0, 0.0), at(1.0, 0.0)), (at(0.0, -1.0), at(0.0, 1.0))];
    let tip = (foot + normal * SPOKE * diagonal) / stretch;
    frame.chain(cross).chain([(foot / stretch, tip)]).collect()
}

/// Returns the axis, and a spoke for each image.
fn of_axis(radial: &Radial, dims: UVec3, stretch: Vec3) -> Vec<(Vec3, Vec3)> {
    let Some(axis) = radial.axis.try_normalize() else { return Vec::new() };
    let (middle, diagonal) = (dims.as_vec3() * 0.5 * stretch, (dims.as_vec3() * stretch).length());
    let at = radial.at_vx * stretch;
    let foot = at + axis * (middle - at).dot(axis);
    let along = axis * REACH * diagonal;
    let spoke = axis.any_orthonormal_vector() * SPOKE * diagonal;
    let turned = |k: u32| {
        let angle = std::f32::consts::TAU * k as f32 / radial.count as f32;
        foot + Quat::from_axis_angle(axis, angle) * spoke
    };
    let spokes = (0..radial.count).map(|k| (foot / stretch, turned(k) / stretch));
    spokes.chain([((foot - along) / stretch, (foot + along) / stretch)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIMS: UVec3 = UVec3::new(40, 20, 30);

    #[test]
    fn the_frame_of_a_plane_lies_in_it_whatever_the_voxels() {
        for stretch in [Vec3::ONE, Vec3::new(1.0, 2.0, 3.0)] {
            let plane =
                MirrorPlane { at_vx: Vec3::new(5.0, 6.0, 7.0), normal: Vec3::new(1.0, 2.0, -0.5) };
            let lines = of_plane(&plane, DIMS, stretch);
            assert_eq!(lines.len(), 4 + 2 + 1);
            for (from, to) in &lines[..6] {
                for p in [from, to] {
                    let away = ((*p - plane.at_vx) * stretch).dot(plane.normal.normalize());
                    assert!(away.abs() < 1e-3, "{away}");
                }
            }
        }
    }

    #[test]
    fn the_axis_has_a_spoke_for_each_image() {
        let radial = Radial { at_vx: Vec3::splat(9.0), axis: Vec3::Y, count: 5 };
        let lines = of_axis(&radial, DIMS, Vec3::ONE);
        assert_eq!(lines.len(), 5 + 1);
        let lengths: Vec<f32> = lines[..5].iter().map(|(from, to)| from.distance(*to)).collect();
        assert!(lengths.iter().all(|length| (length - lengths[0]).abs() < 1e-3));
        let none = Radial { axis: Vec3::ZERO, ..radial };
        assert!(of_axis(&none, DIMS, Vec3::ONE).is_empty());
    }
}
