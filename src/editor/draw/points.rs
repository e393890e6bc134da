//! A curve by points: its clicked points, and the next one under the pointer.
//!
//! A value: takes pixels, the present view and the surface under the pointer; gives grid points in voxels.

use glam::{Vec2, Vec3};

use super::tube;
use super::view::DrawView;
use crate::tools::drawn::MAX_POINTS;

/// Largest distance in pixels at which a press hits the last point: a second click on it ends the curve.
pub const CLICK_PX: f32 = 4.0;
/// Radius of the mark of a point, in pixels.
const MARK_PX: f32 = 4.0;

/// The effect of a press.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Pressed {
    /// Another point was added.
    Added,
    /// The press hit the last point, which finishes the tube.
    Finished,
    /// The tube can have no more points.
    Full,
}

/// The points of an unfinished curve; there is at least one.
#[derive(Clone, PartialEq, Debug)]
pub struct CurvePoints {
    first: Vec3,
    /// The points after the first.
    others: Vec<Vec3>,
    /// Position of the next point under the pointer.
    next: Option<Vec3>,
    /// The button is down, and the last point follows the pointer.
    held: bool,
}

impl CurvePoints {
    pub fn new(first: Vec3) -> CurvePoints {
        CurvePoints { first, others: Vec::new(), next: None, held: false }
    }

    pub fn count(&self) -> usize {
        1 + self.others.len()
    }

    /// Returns whether the button is down.
    pub fn is_held(&self) -> bool {
        self.held
    }

    fn last(&self) -> Vec3 {
        self.others.last().copied().unwrap_or(self.first)
    }

    /// Returns the position of a pixel: on the surface `seen` there, else as far from the eye as the last point.
    fn place(&self, view: &DrawView, at: Vec2, seen: Option<Vec3>) -> Vec3 {
        seen.unwrap_or_else(|| view.sight.at_depth(at, view.sight.depth(self.last())))
    }

    /// Handles a press at a pixel.
    pub fn press(&mut self, view: &DrawView, at: Vec2, seen: Option<Vec3>) -> Pressed {
        let on_last = |last: Vec2| last.distance(at) <= CLICK_PX;
        if view.sight.pixel_of(self.last()).is_some_and(on_last) {
            return Pressed::Finished;
        }
        if self.count() >= MAX_POINTS {
            return Pressed::Full;
        }
        let place = self.place(view, at, seen);
        self.others.push(place);
        (self.next, self.held) = (None, true);
        Pressed::Added
    }

    /// Moves the pointer to a pixel.
    pub fn lead(&mut self, view: &DrawView, at: Vec2, seen: Option<Vec3>) {
        let place = self.place(view, at, seen);
        match self.others.last_mut() {
            Some(last) if self.held => *last = place,
            _ => self.next = Some(place),
        }
    }

    /// Releases the button: the last point stays in place.
    pub fn release(&mut self) {
        self.held = false;
    }

    /// Removes the last point. Returns false for the first one, without which there is no curve.
    pub fn take_back(&mut self) -> bool {
        self.held = false;
        self.others.pop().is_some()
    }

    /// Returns the points, in order.
    pub fn places(&self) -> Vec<Vec3> {
        [self.first].into_iter().chain(self.others.iter().copied()).collect()
    }

    /// Returns the tube through the points and, if the pointer is `there`, on to it, with marks on the points.
    pub fn sketch(
        &self,
        view: &DrawView,
        radii: [f32; 2],
        there: bool,
    ) -> (Vec<[Vec3; 2]>, Vec<[Vec3; 2]>) {
        let mut places = self.places();
        let mark = |place: &Vec3| {
            let radius = view.sight.along(Vec3::X, MARK_PX, *place) * view.edges.x;
            view.circle(*place, radius)
        };
        let marks = places.iter().flat_map(mark).collect();
        places.extend(self.next.filter(|_| there));
        (tube::sketch_through(view, &places, radii), marks)
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::tests::views;
    use super::*;

    #[test]
    fn points_lie_on_the_surface_and_beside_it_as_deep_as_the_last() {
        for view in views() {
            let depth = |place: Vec3| view.sight.depth(place);
            let mut points = CurvePoints::new(view.middle() + 5.0);
            let at = Vec2::new(120.0, 40.0);
            points.lead(&view, at, None);
            assert_eq!(points.count(), 1, "the pointer alone puts no point");
            assert_eq!(points.press(&view, at, None), Pressed::Added);
            let there = points.places()[1];
            assert!((depth(there) - depth(points.first)).abs() < 1e-2);
            assert!(view.sight.pixel_of(there).unwrap().distance(at) < 0.1);
            // With the button down it follows the pointer, also on the surface.
            points.lead(&view, at + 20.0, Some(Vec3::ONE));
            points.release();
            points.lead(&view, at, None);
            assert_eq!(points.places(), [points.first, Vec3::ONE]);
            let at = Vec2::new(60.0, 70.0);
            assert_eq!(points.press(&view, at, None), Pressed::Added);
            assert!((depth(points.places()[2]) - depth(Vec3::ONE)).abs() < 1e-2);
        }
    }

    #[test]
    fn a_press_on_the_last_point_ends_the_curve_and_points_are_taken_back() {
        let view = &views()[0];
        let mut points = CurvePoints::new(view.middle());
        let first = view.sight.pixel_of(view.middle()).unwrap();
        assert_eq!(points.press(view, first + 1.0, None), Pressed::Finished);
        assert_eq!(points.press(view, first + 30.0, None), Pressed::Added);
        assert_eq!(points.press(view, first, None), Pressed::Added, "the first is not the last");
        assert!(points.is_held());
        assert!(points.take_back() && points.take_back() && !points.take_back());
        assert!(!points.is_held());
        assert_eq!(points.places(), [view.middle()]);
    }

    #[test]
    fn there_are_at_most_as_many_points_as_a_tube_may_have() {
        let view = &views()[0];
        let mut points = CurvePoints::new(view.middle());
        let at = |i: usize| Vec2::new(20.0 + (i % 2) as f32 * 90.0, 20.0);
        let all = (0..2 * MAX_POINTS).map(|i| points.press(view, at(i), None));
        assert_eq!(all.filter(|pressed| *pressed == Pressed::Added).count(), MAX_POINTS - 1);
        assert_eq!(points.press(view, Vec2::ZERO, None), Pressed::Full);
        let solid = tube::through(&points.places(), [2.0, 2.0], view.edges).unwrap();
        assert_eq!(solid.check(), Ok(()));
    }

    #[test]
    fn the_sketch_goes_on_to_the_pointer_while_it_is_there() {
        let view = &views()[0];
        let mut points = CurvePoints::new(view.middle());
        points.lead(view, Vec2::new(150.0, 50.0), None);
        let [with, without] = [true, false].map(|there| points.sketch(view, [2.0, 2.0], there));
        assert_eq!(with.1, without.1, "one point is marked");
        assert!(with.0.len() > without.0.len() && !without.0.is_empty());
    }
}
