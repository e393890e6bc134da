//! Divides the path of a solid through the grid into straight segments that it sweeps exactly ([`SweepSegment`]). The
//! segments do not depend on how often the device reports.
//!
//! Takes positions and rotations of the tool; gives segments. Knows no voxels and no document.

use glam::{Quat, Vec3};

use crate::tools::solid::{Primitive, Solid};

/// Largest distance of the tool from a straight segment, in lengths of the smallest voxel edge.
const BESIDE: f32 = 0.15;
/// How far the tool may lag behind the hand, as a share of its smallest half extent. Only turns and bends make segments
/// shorter.
const LAG: f32 = 0.2;
/// How far the outermost points of a turning tool move from one use to the next, in lengths of the smallest voxel edge.
const TURN: f32 = 0.6;
/// Most uses for one turn: a larger turn is a jump.
const MOST_TURNS: f32 = 16.0;
/// Longest distance that a tool sweeps at once, in lengths of the smallest voxel edge. A larger one is a jump: the tool is
/// lifted.
const FURTHEST: f32 = 4096.0;

/// A straight segment of the path, or a single position.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SweepSegment {
    /// Where the tool starts, in voxels.
    pub from: Vec3,
    /// Where it ends; `None` if it stays.
    pub to: Option<Vec3>,
    /// Rotation of the tool.
    pub rotation: Quat,
}

impl SweepSegment {
    /// Returns the segment of a tool that stays.
    pub fn place(tool: &Primitive) -> SweepSegment {
        SweepSegment { from: tool.centre_vx, to: None, rotation: tool.rotation }
    }

    /// Moves the segment.
    pub fn shift(&mut self, by_vx: Vec3) {
        self.from += by_vx;
        self.to = self.to.map(|to| to + by_vx);
    }

    /// Returns where it ends.
    pub fn end(&self) -> Vec3 {
        self.to.unwrap_or(self.from)
    }
}

/// The path of a tool that is in use.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sweep {
    /// Where the last segment ended, and the rotation there.
    used: Vec3,
    rotation: Quat,
    /// Where the tool is.
    at: Vec3,
    /// Direction since the last segment, in edges; `None` while the tool stays.
    heading: Option<Vec3>,
    /// Length of a voxel edge on each axis, in edges of the smallest.
    edges: Vec3,
}

impl Sweep {
    /// Begins a path at `tool`, which has been used there. `edges`: length of a voxel edge on each axis.
    pub fn new(tool: &Primitive, edges: Vec3) -> Sweep {
        let (at, rotation) = (tool.centre_vx, tool.rotation);
        Sweep { used: at, rotation, at, heading: None, edges }
    }

    /// Moves straight to `tool` and gives the segments that are due. Jumps if it is too far away for a movement, and
    /// ignores a position that is not finite.
    pub fn lead(&mut self, tool: &Primitive, mut segment: impl FnMut(SweepSegment)) {
        let to = tool.centre_vx;
        if !to.is_finite() {
            return;
        }
        if self.distance(to) > FURTHEST {
            self.finish(tool, &mut segment);
            self.jump(tool, segment);
            return;
        }
        let displacement = (to - self.used) * self.edges;
        match self.heading {
            Some(heading)
                if !is_straight_on(heading, (self.at - self.used) * self.edges, displacement) =>
            {
                self.finish(tool, &mut segment);
                self.heading = ((to - self.at) * self.edges).try_normalize();
            }
            Some(_) => {}
            None => self.heading = displacement.try_normalize(),
        }
        self.at = to;
        let length = ((to - self.used) * self.edges).length();
        if length >= LAG * tool.half.min_element() || self.turns(tool) >= 1.0 {
            self.finish(tool, segment);
        }
    }

    /// Gives the segments up to the position of the tool, without waiting for more.
    pub fn finish(&mut self, tool: &Primitive, mut segment: impl FnMut(SweepSegment)) {
        let (from, to) = (self.used, self.at);
        let (before, after) = (self.rotation, tool.rotation);
        let turns = self.turns(tool);
        if from == to && turns < 1.0 {
            return;
        }
        let count = turns.ceil().clamp(1.0, MOST_TURNS);
        let mut last = from;
        for i in 1..=count as u32 {
            let share = i as f32 / count;
            // Exactly the last one.
            let (next, rotation) = match share < 1.0 {
                true => (from.lerp(to, share), before.slerp(after, share).normalize()),
                false => (to, after),
            };
            segment(SweepSegment { from: last, to: (next != last).then_some(next), rotation });
            last = next;
        }
        (self.used, self.rotation, self.heading) = (to, after, None);
    }

    /// Continues at `tool` without sweeping there, and uses it there.
    pub fn jump(&mut self, tool: &Primitive, mut segment: impl FnMut(SweepSegment)) {
        *self = Sweep::new(tool, self.edges);
        segment(SweepSegment::place(tool));
    }

    /// Moves the path.
    pub fn shift(&mut self, by_vx: Vec3) {
        self.used += by_vx;
        self.at += by_vx;
    }

    /// Returns the distance from the position of the tool, in lengths of the smallest voxel edge.
    pub fn distance(&self, to: Vec3) -> f32 {
        ((to - self.at) * self.edges).length()
    }

    /// Returns how many uses the turn of `tool` since the last segment needs.
    fn turns(&self, tool: &Primitive) -> f32 {
        let ball = tool.solid == Solid::Ellipsoid && tool.half == Vec3::splat(tool.half.x);
        match ball || tool.rotation == self.rotation {
            true => 0.0,
            false => self.rotation.angle_between(tool.rotation) * tool.half.length() / TURN,
        }
    }
}

/// Returns whether a path that began along `heading` and was at `at` goes straight on to `to`, both relative to its
/// start.
fn is_straight_on(heading: Vec3, at: Vec3, to: Vec3) -> bool {
    let ahead = to.dot(heading);
    ahead >= at.dot(heading) && (to - heading * ahead).length() <= BESIDE
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn tool(half: f32) -> Primitive {
        Primitive {
            solid: Solid::Cuboid,
            centre_vx: Vec3::ZERO,
            half: Vec3::splat(half),
            rotation: Quat::IDENTITY,
        }
    }

    /// Returns the segments of a path through points, up to its end.
    fn segments(points: &[Vec3], half: f32, edges: Vec3) -> Vec<SweepSegment> {
        let at = |centre_vx| Primitive { centre_vx, ..tool(half) };
        let mut sweep = Sweep::new(&at(points[0]), edges);
        let mut out = Vec::new();
        for &point in &points[1..] {
            sweep.lead(&at(point), |segment| out.push(segment));
        }
        sweep.finish(&at(sweep.at), |segment| out.push(segment));
        out
    }

    #[test]
    fn a_straight_path_is_a_segment_for_each_lag() {
        let points: Vec<Vec3> = (0..=100).map(|i| Vec3::X * i as f32 * 0.5).collect();
        let out = segments(&points, 10.0, Vec3::ONE);
        assert_eq!(out.len(), 25);
        assert!(
            out.iter().all(|segment| segment.to == Some(segment.from + Vec3::X * 2.0)),
            "{out:?}"
        );
        let once = segments(&[Vec3::ZERO, Vec3::X * 50.0], 10.0, Vec3::ONE);
        let whole =
            SweepSegment { from: Vec3::ZERO, to: Some(Vec3::X * 50.0), rotation: Quat::IDENTITY };
        assert_eq!(once, [whole]);
        // The end is reached, however little is left.
        let short = segments(&[Vec3::ZERO, Vec3::X * 0.1], 10.0, Vec3::ONE);
        assert_eq!(short.last().map(SweepSegment::end), Some(Vec3::X * 0.1));
    }

    #[test]
    fn a_sweep_jumps_to_far_points_and_ignores_invalid_ones() {
        for far in [1e5, 1e7, 1e30, f32::MAX] {
            let out = segments(&[Vec3::ZERO, Vec3::X * far, Vec3::ZERO], 1.0, Vec3::ONE);
            let ends: Vec<_> = out.iter().map(|segment| (segment.from, segment.to)).collect();
            assert_eq!(ends, [(Vec3::X * far, None), (Vec3::ZERO, None)], "{far}");
        }
        let points = [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::X * 3.0];
        let out = segments(&points, 1.0, Vec3::ONE);
        assert_eq!(out.iter().map(SweepSegment::end).collect::<Vec<_>>(), [Vec3::X * 3.0]);
    }

    #[test]
    fn a_tool_that_turns_is_used_as_often_as_its_corners_need() {
        let mut sweep = Sweep::new(&tool(20.0), Vec3::ONE);
        let turned = |degrees: f32, solid| Primitive {
            solid,
            rotation: Quat::from_rotation_y(degrees.to_radians()),
            ..tool(20.0)
        };
        let mut out = Vec::new();
        sweep.lead(&turned(0.5, Solid::Cuboid), |segment| out.push(segment));
        assert_eq!(out, [], "that little is nothing yet");
        sweep.lead(&turned(4.0, Solid::Cuboid), |segment| out.push(segment));
        // A corner 34.6 voxels from the middle goes 2.4 voxels.
        assert_eq!(out.len(), 5);
        assert!(out.iter().all(|segment| segment.from == Vec3::ZERO && segment.to.is_none()));
        assert_eq!(out[4].rotation, turned(4.0, Solid::Cuboid).rotation);
        // Turning a ball changes nothing.
        let mut ball = Sweep::new(&turned(0.0, Solid::Ellipsoid), Vec3::ONE);
        ball.lead(&turned(90.0, Solid::Ellipsoid), |segment| panic!("{segment:?}"));
        // Turns are spread evenly over a movement.
        let moved = Primitive { centre_vx: Vec3::X * 10.0, ..turned(0.0, Solid::Cuboid) };
        out.clear();
        sweep.lead(&moved, |segment| out.push(segment));
        assert_eq!(out.len(), 5);
        assert!((out[0].end().x - 2.0).abs() < 1e-5 && out[4].to == Some(Vec3::X * 10.0));
    }

    proptest! {
        /// Segments join without a gap, stay within twice the tolerance of every point of the path, and end where it
        /// does.
        #[test]
        fn segments_follow_the_path(
            steps in prop::collection::vec(prop::array::uniform3(prop_oneof![-6f32..6.0, -0.2f32..0.2, Just(0.0)]), 1..40),
            half in prop_oneof![Just(1.0f32), 2f32..80.0],
            long in 1f32..3.0,
        ) {
            let edges = Vec3::new(1.0, long, 1.0);
            let mut points = vec![Vec3::splat(5.0)];
            for step in steps {
                points.push(points[points.len() - 1] + Vec3::from(step));
            }
            let out = segments(&points, half, edges);
            let mut at = points[0];
            for segment in &out {
                prop_assert_eq!(segment.from, at);
                at = segment.end();
            }
            prop_assert_eq!(at, points[points.len() - 1]);
            prop_assert!(out.len() <= points.len());
            for point in &points {
                let beside = out.iter().map(|segment| {
                    let (segment_edges, p) = ((segment.end() - segment.from) * edges, (*point - segment.from) * edges);
                    let share = (p.dot(segment_edges) / segment_edges.length_squared().max(1e-12)).clamp(0.0, 1.0);
                    (p - segment_edges * share).length()
                });
                let nearest = beside.fold(f32::INFINITY, f32::min);
                prop_assert!(out.is_empty() || nearest <= 2.0 * BESIDE + 1e-4, "{} beside", nearest);
            }
        }

        /// Any input gives few segments, and all their ends are finite.
        #[test]
        fn a_path_ends_wherever_it_goes(
            places in prop::collection::vec(prop::array::uniform3(prop::num::f32::ANY), 1..20),
            half in prop::num::f32::POSITIVE,
        ) {
            let mut sweep = Sweep::new(&tool(half), Vec3::ONE);
            let mut count = 0;
            for place in places {
                sweep.lead(&Primitive { centre_vx: place.into(), ..tool(half) }, |segment| {
                    assert!(segment.from.is_finite() && segment.end().is_finite(), "{segment:?}");
                    count += 1;
                });
                prop_assert!(sweep.at.is_finite());
            }
            prop_assert!(count <= 40);
        }
    }
}
