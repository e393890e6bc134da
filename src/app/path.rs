//! Owns the resampling of a stroke's path: however the hand moved and however often the device
//! spoke, the tool is used at a fixed spacing.

use glam::Vec3;

/// A path that is being drawn.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Path {
    at: Vec3,
    /// Length drawn since the last sample, in the units of `spacing`.
    since: f32,
    spacing: f32,
    /// Length of a voxel edge on each axis.
    edges: Vec3,
}

impl Path {
    /// A path from `start` (voxels) with samples every `spacing`, measured in units of which a
    /// voxel has `edges`. The start itself counts as sampled.
    pub fn new(start: Vec3, spacing: f32, edges: Vec3) -> Path {
        Path { at: start, since: 0.0, spacing: spacing.max(1e-3), edges }
    }

    /// Goes straight to `to` and gives the samples on the way.
    pub fn line_to(&mut self, to: Vec3, mut sample: impl FnMut(Vec3)) {
        let from = std::mem::replace(&mut self.at, to);
        let length = ((to - from) * self.edges).length();
        let mut next = self.spacing - self.since;
        while next <= length {
            sample(from.lerp(to, next / length));
            next += self.spacing;
        }
        self.since = self.spacing - (next - length);
    }

    /// Goes on at `to` without the way there, and gives a sample there.
    pub fn jump_to(&mut self, to: Vec3, mut sample: impl FnMut(Vec3)) {
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
    use super::*;
    use proptest::prelude::*;

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

    proptest! {
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
