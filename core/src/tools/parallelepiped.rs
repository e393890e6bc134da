//! The centres of the voxels of a box, in the coordinates of a solid: a box that is turned, stretched or sheared.
//!
//! Tells whether a plane lies between such a box and a convex body, by the algorithm of Gilbert, Johnson and Keerthi (A
//! fast procedure for computing the distance between complex objects in three-dimensional space, 1988). Only a plane
//! that is found and checked counts, so that rounding can make the answer less sharp, but not wrong. Pure geometry;
//! knows no solid.

use glam::{BVec3, DMat3, DVec2, DVec3};

use crate::sculpture::region::VoxelBox;

/// Bound on the error of a sum relative to its largest terms, with much to spare.
const ROUNDING: f64 = 1e-12;
/// Maximum number of planes tried. Twenty suffice wherever the gap is as wide as a voxel.
const MOST_PLANES: usize = 32;

/// All points `middle + a half_edges[0] + b half_edges[1] + c half_edges[2]` with `a`, `b`, `c` from -1 to 1.
#[derive(Clone, Copy, Debug)]
pub struct Parallelepiped {
    /// The point in the middle.
    pub middle: DVec3,
    /// Half of each of the three edges at a corner.
    pub half_edges: [DVec3; 3],
}

impl Parallelepiped {
    /// Returns the box around the centres of the voxels of `bounds`, mapped by an affine map; `None` if there are no
    /// voxels.
    pub fn of_voxels(bounds: VoxelBox, map: impl Fn(DVec3) -> DVec3) -> Option<Parallelepiped> {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (middle, half) = ((min + max) * 0.5, (max - min - 1.0) * 0.5);
        let mapped = map(middle);
        let half_edges = DVec3::AXES.map(|axis| map(middle + axis * half) - mapped);
        (!bounds.is_empty()).then_some(Parallelepiped { middle: mapped, half_edges })
    }

    /// Returns the box mapped by a linear map.
    pub fn mapped(&self, map: &DMat3) -> Parallelepiped {
        Parallelepiped {
            middle: *map * self.middle,
            half_edges: self.half_edges.map(|edge| *map * edge),
        }
    }

    /// Returns the same box relative to `origin`.
    pub fn relative_to(&self, origin: DVec3) -> Parallelepiped {
        Parallelepiped { middle: self.middle - origin, ..*self }
    }

    /// Returns half the size, along each axis, of the axis-aligned box around it.
    pub fn extent(&self) -> DVec3 {
        self.half_edges.iter().map(|edge| edge.abs()).sum()
    }

    /// Returns the eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        let [a, b, c] = self.half_edges;
        std::array::from_fn(|i| {
            let side = BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0);
            let signs = DVec3::select(side, DVec3::ONE, DVec3::NEG_ONE);
            self.middle + a * signs.x + b * signs.y + c * signs.z
        })
    }

    /// Returns the distance of the corners that are furthest from the middle.
    pub fn radius(&self) -> f64 {
        self.corners().iter().map(|corner| corner.distance(self.middle)).fold(0.0, f64::max)
    }

    /// Returns the lowest and the highest distance from the y axis, and height, of its points, as the two corners of a
    /// rectangle. The rectangle fits where an edge of the box is parallel to the axis; otherwise it may be larger.
    pub fn around_y(&self) -> [DVec2; 2] {
        let flat = |p: DVec3| DVec2::new(p.x, p.z);
        let (middle, extent) = (flat(self.middle), flat(self.extent()));
        let corners = self.corners().map(flat);
        let furthest = corners.iter().map(|corner| corner.length()).fold(0.0, f64::max);
        let radius = corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let beside = (middle.abs() - extent).max(DVec2::ZERO).length();
        let nearest = beside.max(middle.length() - radius);
        let (height, reach) = (self.middle.y, self.extent().y);
        [DVec2::new(nearest, height - reach), DVec2::new(furthest, height + reach)]
    }

    /// Returns whether a plane lies between the box and every position of a convex body that moves straight by
    /// `displacement`, with at least `margin` on one side. The body contains the origin at its start; `furthest` returns
    /// a point of it that lies furthest along a direction of length 1. `false` also means that no plane was found.
    pub fn is_apart(
        &self,
        furthest: impl Fn(DVec3) -> DVec3,
        displacement: DVec3,
        margin: f64,
    ) -> bool {
        // Rather than the body, the box moves, to the other side.
        let [a, b, c] = self.half_edges;
        let middle = self.middle - displacement * 0.5;
        let edges = [a, b, c, displacement * 0.5];
        let size: DVec3 = self.middle.abs() + edges.iter().map(|edge| edge.abs()).sum::<DVec3>();
        // Points of the difference of box and body, and the point nearest to the origin of what they span.
        let mut points = Vec::with_capacity(4);
        let mut nearest = middle;
        for _ in 0..MOST_PLANES {
            let Some(normal) = nearest.try_normalize() else { return false };
            let low = edges.iter().fold(middle, |p, edge| p - *edge * edge.dot(normal).signum());
            let high = furthest(normal);
            let gap = normal.dot(low - high);
            if gap > margin + ROUNDING * normal.abs().dot(size + high.abs()) {
                return true;
            }
            let point = low - high;
            if points.contains(&point) {
                return false;
            }
            points.push(point);
            nearest = keep_nearest(&mut points);
        }
        false
    }
}

/// Keeps the smallest part of up to four points that spans the same point nearest to the origin. Returns that point.
fn keep_nearest(points: &mut Vec<DVec3>) -> DVec3 {
    let (mut nearest, mut kept) = (DVec3::INFINITY, 0);
    for part in 1..1usize << points.len() {
        let (mut chosen, mut len) = ([DVec3::ZERO; 4], 0);
        for i in (0..points.len()).filter(|i| part >> i & 1 == 1) {
            (chosen[len], len) = (points[i], len + 1);
        }
        let foot = foot(&chosen[..len]);
        if let Some(foot) = foot.filter(|p| p.length_squared() < nearest.length_squared()) {
            (nearest, kept) = (foot, part);
        }
    }
    let mut i = 0;
    points.retain(|_| {
        i += 1;
        kept >> (i - 1) & 1 == 1
    });
    nearest
}

/// Returns the point nearest to the origin of the line, plane or space through two to four points, if it lies between
/// them.
fn foot(points: &[DVec3]) -> Option<DVec3> {
    match *points {
        [a] => Some(a),
        [a, b] => {
            let edge = b - a;
            let share = -a.dot(edge) / edge.length_squared();
            (0.0..=1.0).contains(&share).then(|| a + edge * share)
        }
        [a, b, c] => {
            let normal = (b - a).cross(c - a);
            let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|v| v.dot(normal));
            let between = normal != DVec3::ZERO && weights.iter().all(|weight| *weight >= 0.0);
            between.then(|| normal * (a.dot(normal) / normal.length_squared()))
        }
        [a, b, c, d] => {
            let volume = |a: DVec3, b: DVec3, c: DVec3| a.dot(b.cross(c));
            let weights = [volume(b, d, c), volume(a, c, d), volume(a, d, b), volume(a, b, c)];
            let inside = weights.iter().all(|weight| *weight > 0.0)
                || weights.iter().all(|weight| *weight < 0.0);
            inside.then_some(DVec3::ZERO)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, IVec3};
    use proptest::prelude::*;

    use super::*;

    fn point(most: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-most..most).prop_map(DVec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

        /// A ball's distance from a box is known; turned and moved together, they stay as far apart.
        #[test]
        fn a_box_is_apart_from_a_ball_that_does_not_reach_it(
            middle in point(6.0),
            half in prop::array::uniform3(0.0f64..4.0),
            turn in prop::array::uniform3(-3.0f64..3.0),
            displacement in prop_oneof![Just(DVec3::ZERO), point(3.0)],
        ) {
            let half = DVec3::from(half);
            let turn = DQuat::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]);
            let points = Parallelepiped {
                middle: turn * middle,
                half_edges: DVec3::AXES.map(|axis| turn * (axis * half)),
            };
            let from_box = |p: DVec3| p.distance(p.clamp(middle - half, middle + half));
            let steps = (0..=4000).map(|i| from_box(displacement * (f64::from(i) / 4000.0)));
            let distance = steps.fold(f64::INFINITY, f64::min);
            let apart = points.is_apart(|direction| direction, turn * displacement, 0.0);
            if distance > 1.002 {
                prop_assert!(apart, "{} away", distance);
            }
            if distance < 1.0 {
                prop_assert!(!apart, "{} away", distance);
            }
            if distance < 1.4 {
                prop_assert!(!points.is_apart(|direction| direction, turn * displacement, 0.4));
            }
        }

        #[test]
        fn distances_and_heights_of_all_points_lie_in_the_rectangle(
            middle in point(6.0),
            edges in prop::array::uniform3(prop::array::uniform3(-3.0f64..3.0)),
            share in point(1.0),
        ) {
            let points = Parallelepiped { middle, half_edges: edges.map(DVec3::from) };
            let [a, b, c] = points.half_edges;
            let p = middle + a * share.x + b * share.y + c * share.z;
            let [low, high] = points.around_y();
            let around = DVec2::new(p.x.hypot(p.z), p.y);
            prop_assert!(around.cmpge(low - 1e-9).all() && around.cmple(high + 1e-9).all());
            prop_assert!(p.distance(middle) <= points.radius() + 1e-9);
            prop_assert!((p - middle).abs().cmple(points.extent() + 1e-9).all());
        }
    }

    #[test]
    fn the_box_of_voxels_reaches_from_the_first_centre_to_the_last() {
        let voxels = |min, max| VoxelBox { min: IVec3::splat(min), max: IVec3::splat(max) };
        let points = Parallelepiped::of_voxels(voxels(-8, 8), |p| p * 2.0).unwrap();
        assert_eq!(points.corners()[0], DVec3::splat(-15.0));
        assert_eq!(points.corners()[7], DVec3::splat(15.0));
        assert_eq!(points.extent(), DVec3::splat(15.0));
        assert!(Parallelepiped::of_voxels(voxels(3, 3), |p| p).is_none());
        assert!(Parallelepiped::of_voxels(voxels(i32::MAX, i32::MIN), |p| p).is_none());
        let all = Parallelepiped::of_voxels(voxels(i32::MIN, i32::MAX), |p| p).unwrap();
        assert_eq!(all.corners()[7], DVec3::splat(2147483646.5));
    }
}
