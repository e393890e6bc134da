//! The resampling of a stroke's path: however the hand moved and however often the device
//! spoke, the tool is used at a spacing that depends on the tool and the direction alone.

use glam::Vec3;

use crate::tools::construct::Primitive;

/// Most samples on one straight way: beyond that something has leapt, and the tool is lifted.
const MOST_SAMPLES: f32 = 4096.0;

/// How far, in edges of the smallest voxel edge, the tool may have gone beside its new way since the
/// last sample; beyond that it is used at the bend, too.
const BESIDE: f32 = 0.15;

/// A path that is being drawn.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Path {
    at: Vec3,
    /// Length drawn since the last sample, in the units of `spacing`.
    since: f32,
    spacing: f32,
    /// Direction of the way at the last sample, in the units of `spacing`.
    heading: Vec3,
    /// Length of a voxel edge on each axis.
    edges: Vec3,
}

impl Path {
    /// A path from `start` (voxels) with samples every `spacing`, measured in units of which a
    /// voxel has `edges`. The start itself counts as sampled.
    pub fn new(start: Vec3, spacing: f32, edges: Vec3) -> Path {
        let spacing = if spacing.is_finite() { spacing.max(1e-3) } else { 1e-3 };
        Path { at: start, since: 0.0, spacing, heading: Vec3::ZERO, edges }
    }

    /// Goes straight to `to` and gives the samples on the way; to what is too far for any
    /// movement it jumps, and what is no point it does not hear.
    pub fn line_to(&mut self, to: Vec3, mut sample: impl FnMut(Vec3)) {
        let length = self.distance(to);
        if !to.is_finite() || length == 0.0 {
            return;
        }
        let first = self.spacing - self.since;
        // Counted, not summed up: far out a step is less than what a number can tell apart.
        let count = ((length - first) / self.spacing).floor() + 1.0;
        if count.is_nan() || count > MOST_SAMPLES {
            self.jump_to(to, sample);
            return;
        }
        let from = std::mem::replace(&mut self.at, to);
        let count = count.max(0.0) as u32;
        for i in 0..count {
            let share = (first + i as f32 * self.spacing) / length;
            sample(from.lerp(to, share.clamp(0.0, 1.0)));
        }
        self.since = (self.since + length - count as f32 * self.spacing).max(0.0);
    }

    /// Goes straight to `to` and gives the samples that a solid needs to look swept along the way.
    pub fn sweep_to(&mut self, to: Vec3, solid: &Primitive, mut sample: impl FnMut(Vec3)) {
        let way = (to - self.at) * self.edges;
        let heading = way.normalize_or_zero();
        if !way.is_finite() || heading == Vec3::ZERO {
            return;
        }
        // The sine of the bend; what is sharper than a right angle leaves the whole tip behind.
        let bend = match heading.dot(self.heading) {
            straight if straight > 0.0 => (1.0 - straight * straight).max(0.0).sqrt(),
            _ => self.heading.length(),
        };
        if self.since * bend > BESIDE {
            // What the tool would have cut or filled at the bend.
            let bend = self.at;
            self.jump_to(bend, &mut sample);
        }
        self.spacing = solid.spacing_along(way);
        self.since = self.since.min(self.spacing);
        let mut sampled = self.since == 0.0;
        self.line_to(to, |stop| {
            sampled = true;
            sample(stop);
        });
        if sampled {
            self.heading = heading;
        }
    }

    /// Goes on at `to` without the way there, and gives a sample there.
    pub fn jump_to(&mut self, to: Vec3, mut sample: impl FnMut(Vec3)) {
        if !to.is_finite() {
            return;
        }
        self.at = to;
        self.since = 0.0;
        sample(to);
    }

    /// Where the path ends, in voxels.
    pub fn end(&self) -> Vec3 {
        self.at
    }

    /// Distance from the end of the path to `to`, in the units of the spacing.
    pub fn distance(&self, to: Vec3) -> f32 {
        ((to - self.at) * self.edges).length()
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec2};
    use proptest::prelude::*;

    use super::*;
    use crate::tools::construct::Solid;
    use crate::tools::sweep::SCALLOP_VX;

    fn samples(points: &[Vec3], spacing: f32, edges: Vec3) -> Vec<Vec3> {
        let mut path = Path::new(points[0], spacing, edges);
        let mut out = Vec::new();
        points[1..].iter().for_each(|&p| path.line_to(p, |s| out.push(s)));
        out
    }

    #[test]
    fn a_straight_line_is_sampled_evenly() {
        let out = samples(&[Vec3::ZERO, Vec3::X * 10.0], 2.5, Vec3::ONE);
        let xs: Vec<f32> = out.iter().map(|s| s.x).collect();
        assert_eq!(xs, [2.5, 5.0, 7.5, 10.0]);
        let flat = samples(&[Vec3::ZERO, Vec3::Z * 10.0], 4.0, Vec3::new(1.0, 1.0, 2.0));
        assert_eq!(flat.len(), 5, "long voxels count as long");
    }

    /// Directions that are spread evenly over the sphere.
    fn spread(count: u32) -> impl Iterator<Item = Vec3> {
        (0..count).map(move |i| {
            let z = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
            let across = Vec2::from_angle(i as f32 * 2.399_963) * (1.0 - z * z).sqrt();
            across.extend(z)
        })
    }

    /// What a stroke with bends and curves leaves, against the tool at every place of its path.
    #[test]
    fn a_stroke_leaves_what_a_swept_solid_would() {
        let mut points = vec![Vec3::ZERO];
        let mut walk = |steps: u32, way: &dyn Fn(u32) -> Vec3| {
            for i in 0..steps {
                let end = points[points.len() - 1];
                points.push(end + way(i));
            }
        };
        walk(9, &|_| Vec3::X);
        walk(9, &|_| Vec3::new(0.8, 0.9, 0.0));
        walk(9, &|_| Vec3::NEG_Y);
        walk(40, &|i| (Vec2::from_angle(i as f32 * 0.05) * 0.9).extend(0.3));
        walk(2, &|_| Vec3::new(5.0, -2.0, -9.0));
        for solid in Solid::ALL {
            for (half, turn) in [(14.0, 0.0), (25.0, 0.3), (40.0, 0.0)] {
                let tool = Primitive {
                    solid,
                    centre_vx: Vec3::ZERO,
                    half: Vec3::new(half, half, half * 0.8),
                    rotation: Quat::from_rotation_y(turn),
                };
                let mut path = Path::new(Vec3::ZERO, 1.0, Vec3::ONE);
                let mut stops = vec![Vec3::ZERO];
                for &point in &points[1..] {
                    path.sweep_to(point, &tool, |stop| stops.push(stop));
                }
                // Not denser than the tool's finest spacing asks for, but for bends.
                let length: f32 = points.windows(2).map(|p| p[0].distance(p[1])).sum();
                let most = length / tool.spacing_anywhere() + points.len() as f32;
                assert!((stops.len() as f32) < most, "{} stops", stops.len());

                let placed = tool.in_grid(Vec3::ONE);
                let shape = tool.shape();
                // Ways to the surface begin inside: a torus has nothing in its middle.
                let inmost = |way: Vec3| match solid {
                    Solid::Torus => {
                        let ring = 1.0 - shape.round().x as f32;
                        let flat = Vec3::new(way.x, 0.0, way.z).normalize_or(Vec3::X) * ring;
                        tool.rotation * (flat * tool.half)
                    }
                    _ => Vec3::ZERO,
                };
                let covered = |p: Vec3| {
                    let inside =
                        |stop: &Vec3| shape.contains(placed.tool_point(p - *stop).as_dvec3());
                    stops.iter().any(inside)
                };
                // The last sample is not at the very end.
                let end = stops[stops.len() - 1];
                let last = points.windows(2).rposition(|p| {
                    (p[0].distance(end) + end.distance(p[1]) - p[0].distance(p[1])).abs() < 1e-3
                });
                let surface: Vec<Vec3> = spread(150)
                    .map(|way| {
                        let (mut low, mut high) = (0.0, 3.0 * half);
                        for _ in 0..30 {
                            let middle = 0.5 * (low + high);
                            let p = placed.tool_point(inmost(way) + way * middle).as_dvec3();
                            if shape.contains(p) { low = middle } else { high = middle }
                        }
                        inmost(way) + way * low
                    })
                    .collect();
                for leg in points[..last.unwrap() + 1].windows(2) {
                    for share in [0.0, 0.35, 0.7] {
                        let at = leg[0].lerp(leg[1], share);
                        for p in surface.iter().map(|s| *s + at).filter(|p| !covered(*p)) {
                            let near = SCALLOP_VX as f32 + 0.08;
                            let along = (leg[1] - leg[0]).normalize();
                            let found = spread(200).chain([along, -along]).any(|way| {
                                (1..=12).any(|part| covered(p + way * near * part as f32 / 12.0))
                            });
                            assert!(found, "{solid:?} of {half} leaves {p} out, at {at}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_too_far_is_jumped_to_and_what_is_no_point_is_not_heard() {
        for far in [1e5, 1e7, 1e30, f32::MAX] {
            let out = samples(&[Vec3::ZERO, Vec3::X * far, Vec3::ZERO], 1.0, Vec3::ONE);
            assert_eq!(out, [Vec3::X * far, Vec3::ZERO], "{far}");
        }
        // Far out, where a step is less than what a number can tell apart.
        let out = samples(&[Vec3::X * 1e8, Vec3::new(1e8, 50.0, 0.0)], 1.0, Vec3::ONE);
        assert_eq!(out.len(), 50);
        let points = [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::X * 3.0];
        let xs: Vec<f32> = samples(&points, 1.0, Vec3::ONE).iter().map(|s| s.x).collect();
        assert_eq!(xs, [1.0, 2.0, 3.0]);
    }

    proptest! {
        /// Whatever a path goes through, it ends, with few samples, all of them points.
        #[test]
        fn a_path_ends_wherever_it_goes(
            ways in prop::collection::vec(prop::array::uniform3(prop::num::f32::ANY), 1..20),
            spacing in prop::num::f32::ANY,
        ) {
            let mut path = Path::new(Vec3::ZERO, spacing, Vec3::ONE);
            for way in ways {
                let mut out = Vec::new();
                path.line_to(Vec3::from(way), |sample| out.push(sample));
                prop_assert!(out.len() <= MOST_SAMPLES as usize);
                prop_assert!(out.iter().all(|sample| sample.is_finite()), "{out:?}");
                prop_assert!(path.end().is_finite());
            }
        }

        /// However often the device speaks on the same straight way, the samples are the same.
        #[test]
        fn samples_do_not_depend_on_the_events(
            cuts in prop::collection::vec(0.0f32..1.0, 0..20),
            spacing in 0.5f32..5.0,
        ) {
            let (a, b) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(20.0, -7.0, 11.0));
            let mut cuts = cuts;
            cuts.sort_by(f32::total_cmp);
            let mut points = vec![a];
            points.extend(cuts.iter().map(|&t| a.lerp(b, t)));
            points.push(b);
            let (once, often) = (samples(&[a, b], spacing, Vec3::ONE), samples(&points, spacing, Vec3::ONE));
            // A sample on the very end may fall to either side of it by rounding.
            prop_assert!(once.len().abs_diff(often.len()) <= 1);
            for (p, q) in once.iter().zip(&often) {
                prop_assert!(p.abs_diff_eq(*q, 1e-2), "{p} {q}");
            }
        }
    }
}
