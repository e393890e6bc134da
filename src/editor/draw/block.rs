//! A box by drag: its base on a face, in whole voxels.
//!
//! From a face and a pixel to the corners of the box and a cuboid.

use glam::{Quat, Vec2, Vec3};

use super::view::View;
use crate::picking::SurfacePoint;
use crate::tools::construct::{Primitive, Solid};

/// The lowest and the highest corner of the box whose base goes from the voxel at `base` to the one at a pixel, in the
/// plane of the face; `height` (in units of the smallest edge of a voxel) outwards, or inwards. None where the pixel does
/// not show the plane.
pub fn corners(
    view: &View,
    base: &SurfacePoint,
    at: Vec2,
    height: f32,
    outwards: bool,
) -> Option<[Vec3; 2]> {
    let SurfacePoint { point, face } = *base;
    let axis = face.abs().max_position();
    let rays = &view.sight.rays;
    let direction = rays.direction_at(at.x, at.y);
    let t = (point[axis] - rays.origin[axis]) / direction[axis];
    if !(t.is_finite() && t > 0.0) {
        return None;
    }
    let met = rays.origin + direction * t;
    let voxel = |p: Vec3| p.floor().clamp(Vec3::ZERO, view.dims.as_vec3() - 1.0);
    let (a, b) = (voxel(point), voxel(met));
    let (mut low, mut high) = (a.min(b), a.max(b) + 1.0);
    let plane = point[axis].round();
    let layers = (height / view.edges[axis]).round().max(1.0);
    let end = plane + face[axis].signum() * if outwards { layers } else { -layers };
    (low[axis], high[axis]) = (plane.min(end), plane.max(end));
    Some([low, high])
}

/// The cuboid between two corners.
pub fn cuboid(view: &View, [low, high]: [Vec3; 2]) -> Primitive {
    Primitive {
        solid: Solid::Cuboid,
        centre_vx: (low + high) * 0.5,
        half: (high - low) * 0.5 * view.edges,
        rotation: Quat::IDENTITY,
    }
}

/// The wall of the grid's box that is seen from inside at a pixel, and its side that faces the inside; none beside it.
pub fn far_wall(view: &View, at: Vec2) -> Option<SurfacePoint> {
    let rays = &view.sight.rays;
    let direction = rays.direction_at(at.x, at.y);
    let ends = [-rays.origin / direction, (view.dims.as_vec3() - rays.origin) / direction];
    let (enter, leave) = (ends[0].min(ends[1]).max_element(), ends[0].max(ends[1]));
    let axis = leave.min_position();
    let leave = leave[axis];
    (leave.is_finite() && leave > enter.max(0.0)).then(|| {
        let mut point = (rays.origin + direction * leave).clamp(Vec3::ZERO, view.dims.as_vec3());
        point[axis] = point[axis].round();
        SurfacePoint { point, face: Vec3::AXES[axis] * -direction[axis].signum() }
    })
}

#[cfg(test)]
mod tests {
    use super::super::view::tests::views;
    use super::*;

    #[test]
    fn the_base_is_what_is_dragged_over_and_the_height_goes_out_of_the_face() {
        for view in views() {
            let middle = view.sight.pixel_of(view.middle()).unwrap();
            let wall = far_wall(&view, middle).unwrap();
            let axis = wall.face.abs().max_position();
            let dims = view.dims.as_vec3();
            assert!(wall.point[axis] == 0.0 || wall.point[axis] == dims[axis]);
            let inside = wall.point + wall.face;
            assert!(inside.cmpge(Vec3::ZERO).all() && inside.cmple(dims).all(), "{inside}");

            // To a place in the same plane, three voxels on.
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut other = wall.point;
            other[u] = if other[u] > 0.5 * dims[u] { other[u] - 3.0 } else { other[u] + 3.0 };
            other[v] = if other[v] > 0.5 * dims[v] { other[v] - 2.0 } else { other[v] + 2.0 };
            let at = view.sight.pixel_of(other).unwrap();
            let height = 5.0 * view.edges[axis];
            let [low, high] = corners(&view, &wall, at, height, true).unwrap();
            let size = high - low;
            assert!((size[u] - 4.0).abs() <= 1.0 && (size[v] - 3.0).abs() <= 1.0, "{size}");
            assert_eq!(size[axis], 5.0);
            assert!(low.cmpge(Vec3::ZERO).all() && high.cmple(dims).all());
            let primitive = cuboid(&view, [low, high]);
            primitive.check().unwrap();
            assert_eq!(primitive.half * 2.0 / view.edges, size);
            // Inwards it lies behind the wall.
            let [low, high] = corners(&view, &wall, at, height, false).unwrap();
            assert!(low[axis] < 0.0 || high[axis] > dims[axis]);
        }
    }

    #[test]
    fn a_click_is_one_voxel_wide_and_the_base_ends_with_the_grid() {
        let view = &views()[0];
        let base = SurfacePoint { point: Vec3::new(30.5, 20.5, 50.0), face: Vec3::Z };
        let at = view.sight.pixel_of(base.point).unwrap();
        let [low, high] = corners(view, &base, at + 0.01, 0.0, true).unwrap();
        assert_eq!(high - low, Vec3::ONE);
        let [_, high] = corners(view, &base, Vec2::new(1e6, -1e6), 1.0, true).unwrap();
        assert_eq!(high.truncate(), view.dims.as_vec3().truncate());
        assert_eq!(far_wall(view, Vec2::new(-1e4, 0.0)), None);
    }
}
