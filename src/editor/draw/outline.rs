//! Outlines and lines over the picture: the part of the grid behind an outline, or on one side of a line.
//!
//! Takes pixels; gives solids that scripts can write, too: a [`DrawnSolid::Extrusion`] along the line of sight through
//! the middle of the outline, or a [`DrawnSolid::HalfSpace`] whose plane contains the eye.

use std::sync::Arc;

use glam::{Mat3, Quat, Vec2, Vec3};

use super::thin::thinned_flat;
use super::view::DrawView;
use crate::tools::drawn::{DrawnSolid, Extrusion, HalfSpace, SolidPose};

/// Smallest intentional outline, in square pixels.
const LEAST_AREA_PX: f32 = 30.0;
/// Shortest intentional line, in pixels.
const LEAST_LINE_PX: f32 = 6.0;
/// Largest deviation of the outline from the drawing, in pixels.
const TOLERANCE_PX: f32 = 0.5;
/// Most points of an outline.
const MOST_POINTS: usize = 512;
/// Spacing and length of the hatching lines of a side, in pixels.
const HATCH_PX: [f32; 2] = [14.0, 12.0];

/// Returns the rectangle between two corners.
pub fn rectangle(a: Vec2, b: Vec2) -> [Vec2; 4] {
    [a, Vec2::new(b.x, a.y), b, Vec2::new(a.x, b.y)]
}

/// Returns whether an outline has an inside. All loops of a self-crossing outline count.
pub fn is_meant(outline: &[Vec2]) -> bool {
    let [Some(low), Some(high)] = [Vec2::min, Vec2::max].map(|f| outline.iter().copied().reduce(f))
    else {
        return false;
    };
    let size = high - low;
    size.min_element() >= 2.0 && size.element_product() >= LEAST_AREA_PX
}

/// Returns the prism behind an outline (pixels), whose drawn size applies at `target_vx`. The prism extends along the
/// line of sight through the outline's middle, by `depth` (in units of the smallest edge of a voxel) about the target,
/// or through the whole grid.
pub fn prism(
    view: &DrawView,
    outline: &[Vec2],
    target_vx: Vec3,
    depth: Option<f32>,
) -> Option<DrawnSolid> {
    let closed: Vec<Vec2> = outline.iter().chain(outline.first()).copied().collect();
    let mut outline = thinned_flat(&closed, TOLERANCE_PX, MOST_POINTS);
    outline.pop();
    // In the space of solids, where voxels have their true shape.
    let (origin, target) = (view.eye(), target_vx * view.edges);
    let middle = outline.iter().sum::<Vec2>() / outline.len().max(1) as f32;
    let [right, up, near] = view.frame(middle)?;
    let ahead = -near;
    let distance = (target - origin).dot(ahead);
    let centre = origin + ahead * distance;
    let outline: Option<Arc<[Vec2]>> = outline
        .iter()
        .map(|&at| {
            let direction = view.direction(at);
            let along = direction.dot(ahead);
            let point = direction * (distance / along) + origin - centre;
            (along > 1e-3).then(|| Vec2::new(point.dot(right), point.dot(up)))
        })
        .collect();
    let size = view.dims.as_vec3() * view.edges;
    let through = || {
        let corner =
            |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * size;
        let furthest = (0..8).map(|i| (corner(i) - centre).dot(ahead).abs()).fold(0.0, f32::max);
        2.0 * furthest + 2.0
    };
    let rotation = Quat::from_mat3(&Mat3::from_cols(right, up, near)).normalize();
    let prism = Extrusion {
        pose: SolidPose { at_vx: centre / view.edges, rotation },
        outlines: Arc::new([outline?]),
        depth: depth.unwrap_or_else(through),
    };
    Some(prism.into())
}

/// Returns the half space seen on one side of a line through two pixels: to the right of the direction of travel, or
/// with `other` to the left.
pub fn half_space(view: &DrawView, from: Vec2, to: Vec2, other: bool) -> Option<DrawnSolid> {
    if from.distance(to) < LEAST_LINE_PX {
        return None;
    }
    let (a, b) = (view.direction(from), view.direction(to));
    let normal = a.cross(b).try_normalize()?;
    let aside = side(from, to, other);
    let there = view.direction(from.lerp(to, 0.5) + aside * 8.0).dot(normal);
    let normal = if there < 0.0 { -normal } else { normal };
    // A point of the plane near the grid, where numbers are precise.
    let (eye, middle) = (view.eye(), view.middle() * view.edges);
    let at = middle - normal * (middle - eye).dot(normal);
    Some(HalfSpace { at_vx: at / view.edges, normal }.into())
}

/// Returns a unit vector to the right of a line in the picture, or with `other` to its left.
fn side(from: Vec2, to: Vec2, other: bool) -> Vec2 {
    let along = (to - from).normalize_or_zero();
    // The y axis of pixels points down.
    let right = Vec2::new(-along.y, along.x);
    if other { -right } else { right }
}

/// Returns hatching on one side of a line, as pairs of pixels.
pub fn hatching(from: Vec2, to: Vec2, other: bool) -> Vec<[Vec2; 2]> {
    let along = (to - from).normalize_or_zero();
    let slanted = (side(from, to, other) - along * 0.6).normalize_or_zero() * HATCH_PX[1];
    let count = (from.distance(to) / HATCH_PX[0]).min(400.0) as u32;
    (0..=count)
        .map(|i| from + along * (i as f32 * HATCH_PX[0]))
        .map(|at| [at, at + slanted])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::view::tests::{view, views};
    use super::*;
    use glam::UVec3;

    #[test]
    fn the_prism_is_seen_as_the_outline_from_any_side() {
        let outline =
            [[90.0, 40.0], [120.0, 45.0], [110.0, 65.0], [95.0, 60.0]].map(Vec2::from).to_vec();
        for view in views() {
            let solid = prism(&view, &outline, view.middle(), None).unwrap();
            solid.check().unwrap();
            let DrawnSolid::Extrusion(Extrusion { pose, outlines, depth }) = solid else {
                panic!()
            };
            for (point, pixel) in outlines[0].iter().zip(&outline) {
                let place = pose.at_vx + pose.rotation * point.extend(0.0) / view.edges;
                let seen = view.sight.pixel_of(place).unwrap();
                assert!(seen.distance(*pixel) < 0.05, "{seen} {pixel}");
            }
            let across = (view.dims.as_vec3() * view.edges).length();
            assert!(depth > 0.5 * across && depth < 2.5 * across, "{depth}");
            let slab = prism(&view, &outline, view.middle(), Some(6.0)).unwrap();
            assert!(matches!(slab, DrawnSolid::Extrusion(Extrusion { depth: 6.0, .. })));
        }
    }

    #[test]
    fn a_half_space_is_what_is_seen_on_its_side() {
        let (from, to) = (Vec2::new(40.0, 30.0), Vec2::new(150.0, 70.0));
        for view in views() {
            for other in [false, true] {
                let solid = half_space(&view, from, to, other).unwrap();
                solid.check().unwrap();
                let DrawnSolid::HalfSpace(HalfSpace { at_vx, normal }) = solid else { panic!() };
                for i in 0..60 {
                    let at = Vec2::new((i * 37 % 200) as f32, (i * 61 % 100) as f32);
                    let place = view.sight.at_depth(at, view.sight.depth(view.middle()));
                    let inside = ((place - at_vx) * view.edges).dot(normal);
                    let right = (to - from).perp_dot(at - from) > 0.0;
                    if (to - from).perp_dot(at - from).abs() > 200.0 {
                        assert_eq!(inside > 0.0, right != other, "{at} {inside}");
                    }
                }
                let [start, end] = hatching(from, to, other)[3];
                assert_eq!((to - from).perp_dot(end - start) > 0.0, !other);
            }
        }
    }

    #[test]
    fn a_drag_without_area_or_length_draws_nothing() {
        let view = view(Quat::IDENTITY, UVec3::splat(8), Vec3::ONE);
        let at = Vec2::new(50.0, 50.0);
        assert!(!is_meant(&[]) && !is_meant(&[at]) && !is_meant(&[at, at + 0.5]));
        assert!(!is_meant(&[at, at + Vec2::X * 90.0]), "a line has no inside");
        assert!(half_space(&view, at, at, false).is_none());
        // A figure of eight has two loops whose areas cancel.
        let eight = [at, at + Vec2::new(40.0, 30.0), at + Vec2::X * 40.0, at + Vec2::Y * 30.0];
        assert!(is_meant(&eight));
        prism(&view, &eight, view.middle(), None).unwrap().check().unwrap();
        assert!(is_meant(&rectangle(at, at + 20.0)) && !is_meant(&rectangle(at, at)));
    }

    #[test]
    fn outlines_keep_their_shape_with_few_points() {
        let view = view(Quat::IDENTITY, UVec3::splat(60), Vec3::ONE);
        let round: Vec<Vec2> = (0..5000)
            .map(|i| Vec2::new(100.0, 50.0) + Vec2::from_angle(i as f32 * 0.00125664) * 30.0)
            .collect();
        let Some(DrawnSolid::Extrusion(Extrusion { outlines, .. })) =
            prism(&view, &round, view.middle(), None)
        else {
            panic!()
        };
        assert!((12..80).contains(&outlines[0].len()), "{}", outlines[0].len());
    }
}
