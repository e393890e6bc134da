//! Resamples a brush's path, so that the brush is used at an even spacing independent of the rate of events. Solids
//! sweep instead ([`super::sweep`]).

use glam::Vec3;

/// Most samples on one straight line. A longer one is a jump: the tool is lifted.
const MOST_SAMPLES: f32 = 4096.0;

/// The path of a brush in use.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Path {
    at: Vec3,
    /// Length since the last sample, in the units of `spacing`.
    since: f32,
    spacing: f32,
    /// The spacing at full size.
    whole: f32,
    /// Length of a voxel edge on each axis.
    edges: Vec3,
}

impl Path {
    /// Begins at `start` (voxels) with samples every `spacing`, measured in units of which a voxel has `edges`. The
    /// start itself counts as sampled.
    pub fn new(start: Vec3, spacing: f32, edges: Vec3) -> Path {
        let spacing = if spacing.is_finite() { spacing.max(1e-3) } else { 1e-3 };
        Path { at: start, since: 0.0, spacing, whole: spacing, edges }
    }

    /// Scales the brush and its spacing, down to one unit, from here on.
    pub fn scale(&mut self, share: f32) {
        if share.is_finite() {
            self.spacing = (self.whole * share).max(self.whole.min(1.0));
        }
    }

    /// Goes straight to `to` and gives the samples on the path. Jumps if it is too far for a movement, and ignores a
    /// position that is not finite.
    pub fn line_to(&mut self, to: Vec3, mut sample: impl FnMut(Vec3)) {
        let length = self.distance(to);
        if !to.is_finite() || length == 0.0 {
            return;
        }
        // The spacing may now be less than the length since the last sample.
        self.since = self.since.min(self.spacing);
        let first = self.spacing - self.since;
        // Counted, not summed up: far out, a step is below the precision of a float.
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

    /// Continues at `to` without a path there, and gives a sample.
    pub fn jump_to(&mut self, to: Vec3, mut sample: impl FnMut(Vec3)) {
        if !to.is_finite() {
            return;
        }
        self.at = to;
        self.since = 0.0;
        sample(to);
    }

    /// Moves the path.
    pub fn shift(&mut self, by: Vec3) {
        self.at += by;
    }

    /// Returns the end of the path, in voxels.
    pub fn end(&self) -> Vec3 {
        self.at
    }

    /// Returns the distance from the end of the path to `to`, in the units of the spacing.
    pub fn distance(&self, to: Vec3) -> f32 {
        ((to - self.at) * self.edges).length()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

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

    #[test]
    fn a_smaller_brush_is_used_closer_together() {
        let mut path = Path::new(Vec3::ZERO, 4.0, Vec3::ONE);
        let mut xs = Vec::new();
        path.line_to(Vec3::X * 7.0, |s| xs.push(s.x));
        path.scale(0.5);
        path.line_to(Vec3::X * 10.0, |s| xs.push(s.x));
        path.scale(f32::NAN);
        path.line_to(Vec3::X * 12.0, |s| xs.push(s.x));
        path.scale(1e-6);
        path.line_to(Vec3::X * 14.0, |s| xs.push(s.x));
        assert_eq!(xs, [4.0, 7.0, 9.0, 11.0, 12.0, 13.0, 14.0]);
    }

    #[test]
    fn a_path_jumps_to_far_points_and_ignores_invalid_ones() {
        for far in [1e5, 1e7, 1e30, f32::MAX] {
            let out = samples(&[Vec3::ZERO, Vec3::X * far, Vec3::ZERO], 1.0, Vec3::ONE);
            assert_eq!(out, [Vec3::X * far, Vec3::ZERO], "{far}");
        }
        // Far out, where a step is below the precision of a float.
        let out = samples(&[Vec3::X * 1e8, Vec3::new(1e8, 50.0, 0.0)], 1.0, Vec3::ONE);
        assert_eq!(out.len(), 50);
        let points = [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::X * 3.0];
        let xs: Vec<f32> = samples(&points, 1.0, Vec3::ONE).iter().map(|s| s.x).collect();
        assert_eq!(xs, [1.0, 2.0, 3.0]);
    }

    proptest! {
        /// Checks that any input gives few samples, all of them finite.
        #[test]
        fn a_path_ends_wherever_it_goes(
            places in prop::collection::vec(prop::array::uniform3(prop::num::f32::ANY), 1..20),
            spacing in prop::num::f32::ANY,
        ) {
            let mut path = Path::new(Vec3::ZERO, spacing, Vec3::ONE);
            for place in places {
                let mut out = Vec::new();
                path.line_to(Vec3::from(place), |sample| out.push(sample));
                prop_assert!(out.len() <= MOST_SAMPLES as usize);
                prop_assert!(out.iter().all(|sample| sample.is_finite()), "{out:?}");
                prop_assert!(path.end().is_finite());
            }
        }

        /// Checks that the rate of events on a straight line does not change the samples.
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
            // Rounding decides about a sample at the very end.
            prop_assert!(once.len().abs_diff(often.len()) <= 1);
            for (p, q) in once.iter().zip(&often) {
                prop_assert!(p.abs_diff_eq(*q, 1e-2), "{p} {q}");
            }
        }
    }
}
