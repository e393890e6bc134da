//! Turned solids: half a profile is drawn beside an axis through the press.
//!
//! Takes pixels; gives a [`DrawnSolid::Lathe`].

use std::sync::Arc;

use glam::{Mat3, Quat, Vec2, Vec3};

use super::thin::thinned_flat;
use super::view::{DrawView, circle};
use crate::tools::drawn::{DrawnSolid, Lathe, SolidPose};

/// Largest deviation of the profile from the drawing, in units of the smallest edge.
const TOLERANCE: f32 = 0.25;
/// Most points of a profile.
const MOST_POINTS: usize = 256;

/// The axis, and the plane of the profile.
#[derive(Clone, Copy, Debug)]
pub struct LatheAxis {
    /// A point on it, in voxels.
    at_vx: Vec3,
    /// Orthogonal unit vectors: along it, across the picture to the right, and towards the viewer, in units of the
    /// smallest edge.
    up: Vec3,
    right: Vec3,
    near: Vec3,
}

impl LatheAxis {
    /// Places an axis through `at_vx`: the grid axis that points up in the picture, or else the vertical of the
    /// picture.
    pub fn new(view: &DrawView, at_vx: Vec3, along_grid: bool) -> Option<LatheAxis> {
        let [_, picture_up, near] = view.frame(view.sight.pixel_of(at_vx)?)?;
        let up = if along_grid { view.sight.screen_axes().up } else { picture_up };
        let right = up.cross(near).try_normalize()?;
        Some(LatheAxis { at_vx, up, right, near: right.cross(up) })
    }

    /// Returns the profile point at a pixel: the distance from the axis (negative on its left) and the height; `None`
    /// if the pixel does not show the plane.
    fn point(&self, view: &DrawView, at: Vec2) -> Option<Vec2> {
        let (eye, direction) = (view.eye(), view.direction(at));
        let origin = self.at_vx * view.edges;
        let t = (origin - eye).dot(self.near) / direction.dot(self.near);
        let offset = eye + direction * t - origin;
        let point = Vec2::new(offset.dot(self.right), offset.dot(self.up));
        // The plane's horizon would be far beyond every grid.
        (t > 0.0 && point.abs().max_element() < 1e5).then_some(point)
    }

    /// Returns the drawn profile: distances from the axis and heights. A part beyond the axis is folded back.
    pub fn profile(&self, view: &DrawView, drawn: &[Vec2]) -> Vec<Vec2> {
        let points = drawn.iter().filter_map(|at| self.point(view, *at));
        points.map(|p| Vec2::new(p.x.abs(), p.y)).collect()
    }

    /// Returns the solid; `None` if the profile is almost empty.
    pub fn turned(&self, view: &DrawView, drawn: &[Vec2]) -> Option<DrawnSolid> {
        let profile = thinned_flat(&self.profile(view, drawn), TOLERANCE, MOST_POINTS);
        let widest = profile.iter().map(|p| p.x).fold(0.0, f32::max);
        let heights = profile.iter().map(|p| p.y);
        let height = heights.clone().fold(f32::MIN, f32::max) - heights.fold(f32::MAX, f32::min);
        if profile.len() < 2 || widest < 0.5 || height < 0.5 {
            return None;
        }
        let rotation = Quat::from_mat3(&Mat3::from_cols(self.right, self.up, self.near));
        let pose = SolidPose { at_vx: self.at_vx, rotation: rotation.normalize() };
        Some(Lathe { pose, profile: Arc::from(profile) }.into())
    }

    /// Returns a profile point as a grid point, on the right or the left of the axis.
    fn place(&self, view: &DrawView, point: Vec2, side: f32) -> Vec3 {
        self.at_vx + (self.right * (point.x * side) + self.up * point.y) / view.edges
    }

    /// Returns the preview lines while the profile is drawn: the profile on both sides with some of its circles, and
    /// the axis.
    pub fn sketch(&self, view: &DrawView, drawn: &[Vec2]) -> (Vec<[Vec3; 2]>, Vec<[Vec3; 2]>) {
        let profile = self.profile(view, drawn);
        let mut lines = Vec::new();
        for side in [1.0, -1.0] {
            let places: Vec<Vec3> = profile.iter().map(|p| self.place(view, *p, side)).collect();
            lines.extend(super::view::chain(&places));
        }
        let reach = view.dims.as_vec3().max_element();
        let mut faint = vec![[-reach, reach].map(|y| self.place(view, Vec2::new(0.0, y), 1.0))];
        let by_height = |a: &&Vec2, b: &&Vec2| a.y.total_cmp(&b.y);
        let widest = profile.iter().max_by(|a, b| a.x.total_cmp(&b.x));
        let (low, high) = (profile.iter().min_by(by_height), profile.iter().max_by(by_height));
        for ring in [widest, low, high, profile.last()].into_iter().flatten() {
            let centre = self.place(view, Vec2::new(0.0, ring.y), 1.0);
            let [across, deep] = [self.right, self.near].map(|axis| axis * ring.x / view.edges);
            faint.extend(circle(centre, across, deep));
        }
        (lines, faint)
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::tests::views;
    use super::*;

    #[test]
    fn the_profile_is_seen_where_it_was_drawn_from_any_side() {
        let drawn: Vec<Vec2> =
            [[100.0, 55.0], [112.0, 54.0], [118.0, 45.0], [108.0, 40.0]].map(Vec2::from).to_vec();
        for view in views() {
            for along_grid in [false, true] {
                let axis = LatheAxis::new(
                    &view,
                    view.sight.at_depth(drawn[0], view.sight.depth(view.middle())),
                    along_grid,
                )
                .unwrap();
                let solid = axis.turned(&view, &drawn).unwrap();
                solid.check().unwrap();
                let DrawnSolid::Lathe(Lathe { pose, profile }) = solid else { panic!() };
                assert_eq!(profile.len(), drawn.len());
                assert!(profile[0].x < 1e-2, "it begins on the axis");
                for (point, pixel) in profile.iter().zip(&drawn) {
                    let place = pose.at_vx + pose.rotation * point.extend(0.0) / view.edges;
                    let seen = view.sight.pixel_of(place).unwrap();
                    assert!(seen.distance(*pixel) < 0.1, "{seen} {pixel}");
                }
                let up = pose.rotation * Vec3::Y;
                if along_grid {
                    assert!((up.abs().max_element() - 1.0).abs() < 1e-4, "{up}");
                }
            }
        }
    }

    #[test]
    fn a_profile_left_of_the_axis_or_across_it_makes_the_same_solid() {
        let view = &views()[0];
        let start = view.sight.pixel_of(view.middle()).unwrap();
        let axis = LatheAxis::new(view, view.middle(), true).unwrap();
        let path = [[0.0, 0.0], [15.0, 0.0], [15.0, -12.0], [4.0, -20.0]].map(Vec2::from);
        let [right, left] = [1.0, -1.0].map(|side| {
            let drawn = path.map(|p| start + p * Vec2::new(side, 1.0));
            let Some(DrawnSolid::Lathe(Lathe { profile, .. })) = axis.turned(view, &drawn) else {
                panic!()
            };
            profile
        });
        for (a, b) in right.iter().zip(&left[..]) {
            assert!(a.distance(*b) < 0.02, "{a} {b}");
        }
        let crossing = [Vec2::ZERO, Vec2::new(9.0, -5.0), Vec2::new(-9.0, -15.0)];
        axis.turned(view, &crossing.map(|p| start + p)).unwrap().check().unwrap();
    }

    #[test]
    fn a_click_and_a_line_along_the_axis_turn_nothing() {
        let view = &views()[0];
        let start = view.sight.pixel_of(view.middle()).unwrap();
        let axis = LatheAxis::new(view, view.middle(), true).unwrap();
        assert_eq!(axis.turned(view, &[start]), None);
        assert_eq!(axis.turned(view, &[start, start - Vec2::Y * 30.0]), None);
        assert_eq!(axis.turned(view, &[]), None);
    }
}
