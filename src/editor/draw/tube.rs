//! Lines and curves: tubes along what the pointer or a hand has drawn, or through points.
//!
//! Takes places of the grid in voxels; gives a [`DrawnSolid::Tube`] with few control points, since its command lists them, and the lines
//! that show it.

use std::sync::Arc;

use glam::Vec3;

use super::thin::{evened, length, thinned_to};
use super::view::{DrawView, chain};
use crate::tools::drawn::curve::tube_path;
use crate::tools::drawn::{ControlPoint, DrawnSolid, Tube};

/// Most control points of a curve.
const MOST_CONTROL_POINTS: usize = 256;
/// Length over which tremor of the hand is smoothed, as a share of the radius, and its range in units of the smallest edge.
/// It smooths the steps from voxel to voxel, too.
const EVEN_OVER: f32 = 0.6;
const EVEN_RANGE: std::ops::RangeInclusive<f32> = 0.7..=4.0;
/// How far the path may be from the control points, as a share of the radius.
const TOLERANCE: f32 = 0.06;
/// Least distance from one control point to the next, in units of the smallest edge.
const LEAST_STEP: f32 = 1e-2;

/// Returns a straight tube between two places; a ball if they are the same.
pub fn line(from_vx: Vec3, to_vx: Vec3, radii: [f32; 2]) -> DrawnSolid {
    let ends = [(from_vx, radii[0]), (to_vx, radii[1])]
        .map(|(at_vx, radius)| ControlPoint { at_vx, radius });
    let count = if from_vx == to_vx { 1 } else { 2 };
    Tube { control_points: ends.into_iter().take(count).collect() }.into()
}

/// Returns a tube along a path (voxels), its radius changing evenly from one end to the other. `edges`: of a voxel, in units of the
/// smallest.
pub fn curve(path_vx: &[Vec3], radii: [f32; 2], edges: Vec3) -> Option<DrawnSolid> {
    let (first, last) = (*path_vx.first()?, *path_vx.last()?);
    let thick = 0.5 * (radii[0] + radii[1]);
    let path: Vec<Vec3> = path_vx.iter().map(|p| *p * edges).collect();
    if length(&path) < 0.5 {
        return Some(line(first, last, radii));
    }
    let even = even(&path, thick);
    let mut thin = thinned_to(&even, (TOLERANCE * thick).max(0.2), MOST_CONTROL_POINTS);
    thin.dedup_by(|a, b| a.distance(*b) < LEAST_STEP);
    Some(Tube { control_points: control_points(&thin, radii, edges) }.into())
}

/// Returns a tube along a smooth curve through places (voxels), its radius changing evenly from the first to the last;
/// `None` without a place.
pub fn through(places_vx: &[Vec3], radii: [f32; 2], edges: Vec3) -> Option<DrawnSolid> {
    let mut places: Vec<Vec3> = places_vx.iter().map(|p| *p * edges).collect();
    places.dedup_by(|a, b| a.distance(*b) < LEAST_STEP);
    (!places.is_empty())
        .then(|| Tube { control_points: control_points(&places, radii, edges) }.into())
}

/// Returns control points at places (units of the smallest edge), the radii interpolated along the path.
fn control_points(places: &[Vec3], radii: [f32; 2], edges: Vec3) -> Arc<[ControlPoint]> {
    let total = length(places).max(f32::MIN_POSITIVE);
    let mut gone = 0.0;
    let mut before = places.first().copied().unwrap_or_default();
    let control_point = |p: &Vec3| {
        gone += p.distance(std::mem::replace(&mut before, *p));
        let radius = radii[0] + (radii[1] - radii[0]) * (gone / total).min(1.0);
        ControlPoint { at_vx: *p / edges, radius }
    };
    places.iter().map(control_point).collect()
}

/// Returns a path (units of the smallest edge) without the tremor of a hand, for a tube of that radius.
fn even(path: &[Vec3], radius: f32) -> Vec<Vec3> {
    let over = (EVEN_OVER * radius).clamp(*EVEN_RANGE.start(), *EVEN_RANGE.end());
    evened(path, 0.5 * over, over)
}

/// Returns the lines that show a tube while it is drawn along a path: its middle line and, beside it, its outline.
pub fn sketch(view: &DrawView, path_vx: &[Vec3], radii: [f32; 2]) -> Vec<[Vec3; 2]> {
    let path: Vec<Vec3> = path_vx.iter().map(|p| *p * view.edges).collect();
    let even = even(&path, 0.5 * (radii[0] + radii[1]));
    let count = even.len() as f32 - 1.0;
    let control_point = |(i, p): (usize, &Vec3)| ControlPoint {
        at_vx: *p / view.edges,
        radius: radii[0] + (radii[1] - radii[0]) * (i as f32 / count),
    };
    let control_points: Vec<ControlPoint> = even.iter().enumerate().map(control_point).collect();
    outline(view, &control_points)
}

/// Returns the lines that show a tube through places while they are chosen.
pub fn sketch_through(view: &DrawView, places_vx: &[Vec3], radii: [f32; 2]) -> Vec<[Vec3; 2]> {
    match through(places_vx, radii, view.edges) {
        Some(DrawnSolid::Tube(Tube { control_points })) => {
            outline(view, &tube_path(&control_points, view.edges))
        }
        _ => Vec::new(),
    }
}

/// Returns the middle line of a tube, its ends, and its outline as the viewer sees it.
fn outline(view: &DrawView, path: &[ControlPoint]) -> Vec<[Vec3; 2]> {
    let (Some(first), Some(last)) = (path.first(), path.last()) else { return Vec::new() };
    let middle: Vec<Vec3> = path.iter().map(|control_point| control_point.at_vx).collect();
    let mut lines: Vec<[Vec3; 2]> = chain(&middle).collect();
    lines.extend(view.circle(first.at_vx, first.radius));
    lines.extend(view.circle(last.at_vx, last.radius));
    let eye = view.eye();
    let rim = |side: f32| -> Vec<Vec3> {
        let at = |pair: &[ControlPoint]| {
            let (a, b) = (pair[0].at_vx * view.edges, pair[1].at_vx * view.edges);
            let out = (b - a).cross(a - eye).normalize_or_zero() * side;
            [(a, pair[0].radius), (b, pair[1].radius)]
                .map(|(p, radius)| (p + out * radius) / view.edges)
        };
        path.windows(2).flat_map(at).collect()
    };
    for side in [-1.0, 1.0] {
        lines.extend(chain(&rim(side)));
    }
    lines
}

#[cfg(test)]
mod tests {
    use glam::Vec2;
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_click_is_a_ball_and_a_drag_a_rod() {
        let at = Vec3::new(4.0, 5.0, 6.0);
        let DrawnSolid::Tube(Tube { control_points }) = line(at, at, [2.0, 3.0]) else { panic!() };
        assert_eq!(control_points[..], [ControlPoint { at_vx: at, radius: 2.0 }]);
        let DrawnSolid::Tube(Tube { control_points }) = line(at, at + 1.0, [2.0, 3.0]) else {
            panic!()
        };
        assert_eq!((control_points.len(), control_points[1].radius), (2, 3.0));
        for path in [vec![at], vec![at; 9], vec![at, at + 0.1]] {
            curve(&path, [1.0, 2.0], Vec3::ONE).unwrap().check().unwrap();
        }
        assert_eq!(curve(&[], [1.0, 1.0], Vec3::ONE), None);
    }

    #[test]
    fn a_curve_over_steps_of_voxels_is_smooth_and_short() {
        // A slope of one in four, as formed by the faces of voxels.
        let steps: Vec<Vec3> =
            (0..200).map(|i| Vec3::new(i as f32 * 0.5, (i / 8) as f32, 10.0)).collect();
        let Some(DrawnSolid::Tube(Tube { control_points })) = curve(&steps, [4.0, 2.0], Vec3::ONE)
        else {
            panic!()
        };
        assert!(control_points.len() < 16, "{}", control_points.len());
        assert_eq!(
            (control_points[0].at_vx, control_points[control_points.len() - 1].at_vx),
            (steps[0], steps[199])
        );
        assert_eq!(
            (control_points[0].radius, control_points[control_points.len() - 1].radius),
            (4.0, 2.0)
        );
        for control_point in &control_points[..] {
            assert!(
                (control_point.at_vx.y - control_point.at_vx.x * 0.25).abs() < 1.0,
                "{control_point:?}"
            );
        }
        // A half circle stays one.
        let round: Vec<Vec3> = (0..=300)
            .map(|i| (Vec2::from_angle(i as f32 * 0.0104719) * 30.0).extend(0.0))
            .collect();
        let Some(DrawnSolid::Tube(Tube { control_points })) = curve(&round, [3.0, 3.0], Vec3::ONE)
        else {
            panic!()
        };
        assert!((6..40).contains(&control_points.len()), "{}", control_points.len());
        assert!(
            control_points
                .iter()
                .all(|control_point| (control_point.at_vx.length() - 30.0).abs() < 0.4),
            "{control_points:?}"
        );
    }

    #[test]
    fn a_tube_goes_through_the_places_that_were_chosen() {
        let places = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 30.0, 0.0]];
        let places = places.map(Vec3::from);
        let Some(DrawnSolid::Tube(Tube { control_points })) =
            through(&places, [4.0, 2.0], Vec3::ONE)
        else {
            panic!()
        };
        let at: Vec<Vec3> =
            control_points.iter().map(|control_point| control_point.at_vx).collect();
        assert_eq!(at, places[1..], "what follows in the same place counts once");
        let radii: Vec<f32> =
            control_points.iter().map(|control_point| control_point.radius).collect();
        assert_eq!(radii, [4.0, 3.5, 2.0]);
        let Some(DrawnSolid::Tube(Tube { control_points })) =
            through(&places[..2], [4.0, 2.0], Vec3::ONE)
        else {
            panic!()
        };
        assert_eq!(control_points[..], [ControlPoint { at_vx: Vec3::ZERO, radius: 4.0 }]);
        assert_eq!(through(&[], [4.0, 2.0], Vec3::ONE), None);
    }

    #[test]
    fn the_sketch_of_a_tube_goes_through_its_points_and_is_as_wide() {
        for view in super::super::view::tests::views() {
            let middle = view.middle();
            let places = [middle, middle + Vec3::new(9.0, 0.0, 4.0), middle + Vec3::Y * 8.0];
            let lines = sketch_through(&view, &places, [3.0, 3.0]);
            for place in places {
                let to = |end: &[Vec3; 2]| end[0].distance(place).min(end[1].distance(place));
                assert!(lines.iter().map(to).fold(f32::MAX, f32::min) < 1e-3);
            }
            let off = |p: &Vec3| {
                let near = lines.iter().map(|line| (line[0] - *p) * view.edges);
                near.map(|offset| (offset.length() - 3.0).abs()).fold(f32::MAX, f32::min)
            };
            assert!(off(&places[1]) < 0.1, "{}", off(&places[1]));
            assert!(sketch_through(&view, &[], [3.0, 3.0]).is_empty());
            assert_eq!(sketch_through(&view, &places[..1], [3.0, 3.0]).len(), 64);
        }
    }

    proptest! {
        #[test]
        fn every_path_makes_a_valid_tube(
            path in prop::collection::vec(prop::array::uniform3(-100f32..100.0), 1..80),
            radii in prop::array::uniform2(0.5f32..200.0),
            edges in prop::array::uniform3(1f32..4.0),
        ) {
            let path: Vec<Vec3> = path.into_iter().map(Vec3::from).collect();
            let solid = curve(&path, radii, Vec3::from(edges)).unwrap();
            prop_assert_eq!(solid.check(), Ok(()));
        }
    }
}
