//! The shadow of the sun, which is the first distant lamp: whether a ray from a voxel reaches a point of its disc.
//!
//! Each voxel casts one ray per picture. The first picture uses the centre of the disc; the further samples of an
//! antialiased picture use points all over it, different ones for each voxel, so that shadows are sharp in the first
//! and soft in the mean. The points depend only on the voxel and the index of the sample.
//!
//! Works in grid coordinates. shaders/shadow.wgsl is the twin.

use glam::{Affine3A, Mat3, UVec3, Vec2, Vec3};

use super::light::{LightSource, Shadow};
use crate::sculpture::Grid;
use crate::surface::raycast;

/// The distance from the centre of a voxel to the origin of its ray, along its normal: above the steps of a slanted
/// face.
const LIFT_VX: f32 = 1.5;

/// The sun of a picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ShadowSun {
    /// Its index among the lights in use.
    pub light: usize,
    /// Towards the centre of its disc.
    pub towards: Vec3,
    /// From there to its edge, in two perpendicular directions.
    pub across: [Vec3; 2],
    /// The index of the sample.
    pub sample: u32,
}

impl ShadowSun {
    /// Returns the first distant one of `sources`, which are in eye space.
    pub(super) fn new(
        shadow: &Shadow,
        sources: impl Iterator<Item = LightSource>,
        eye_from_grid: &Affine3A,
    ) -> Option<ShadowSun> {
        let mut distant = sources.enumerate().filter_map(|(light, source)| match source {
            LightSource::Direction(direction) => Some((light, direction)),
            LightSource::Position(_) => None,
        });
        let (light, direction) = distant.next()?;
        let grid_from_eye = Mat3::from(eye_from_grid.matrix3).inverse();
        let towards = grid_from_eye * direction;
        let scale = towards.length().recip();
        let (right, up) = direction.any_orthonormal_pair();
        let radius = (0.5 * shadow.sun_deg).to_radians().tan();
        let across = [right, up].map(|axis| grid_from_eye * axis * (radius * scale));
        Some(ShadowSun { light, towards: towards * scale, across, sample: shadow.sample })
    }

    /// Returns the part of its light that reaches a voxel whose surface points `outwards` (a covector of any length): 1
    /// or 0. Returns 1 if the surface is turned away, since it gets no light in any case.
    pub(super) fn reaching(&self, grid: &Grid, voxel: UVec3, outwards: Vec3) -> f32 {
        let lift = outwards.try_normalize().unwrap_or(self.towards);
        if lift.dot(self.towards) <= 0.0 {
            return 1.0;
        }
        let Vec2 { x, y } = on_disc(voxel, self.sample);
        let direction = self.towards + self.across[0] * x + self.across[1] * y;
        let origin = voxel.as_vec3() + 0.5 + lift * LIFT_VX;
        if raycast::cast(grid, origin, direction).is_some() { 0.0 } else { 1.0 }
    }
}

/// Returns a point of the unit disc; its centre for sample 0.
pub(super) fn on_disc(voxel: UVec3, sample: u32) -> Vec2 {
    if sample == 0 {
        return Vec2::ZERO;
    }
    let mut hash = voxel.x.wrapping_mul(0x9E37_79B1)
        ^ voxel.y.wrapping_mul(0x85EB_CA77)
        ^ voxel.z.wrapping_mul(0xC2B2_AE3D);
    hash = (hash ^ hash >> 15).wrapping_mul(0x2C1B_3C6D);
    hash = (hash ^ hash >> 12).wrapping_mul(0x297A_2D39);
    hash ^= hash >> 15;
    // Successive samples by the additive recurrence of the plastic number, which covers the square evenly
    // (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018), in 16 bits.
    let a = hash.wrapping_add(sample.wrapping_mul(49472)) & 0xFFFF;
    let b = (hash >> 16).wrapping_add(sample.wrapping_mul(37345)) & 0xFFFF;
    let square = Vec2::new(a as f32, b as f32) * (1.0 / 32768.0) - 1.0;
    // Maps the square to the disc by concentric ellipses.
    let Vec2 { x, y } = square;
    Vec2::new(x * (1.0 - 0.5 * y * y).sqrt(), y * (1.0 - 0.5 * x * x).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::Grid;
    use glam::IVec3;

    /// Returns a floor of 4 voxels' height with a wall on it, and a sun at 45 degrees behind the wall.
    fn scene(sun_deg: f32, sample: u32) -> (Grid, ShadowSun) {
        let mut grid = Grid::new(UVec3::new(64, 64, 64), Vec3::ONE, 1 << 20).unwrap();
        for (x, z) in (0..64).flat_map(|x| (0..64).map(move |z| (x, z))) {
            (0..4).for_each(|y| grid.set(IVec3::new(x, y, z), true));
            if x == 20 {
                (4..24).for_each(|y| grid.set(IVec3::new(x, y, z), true));
            }
        }
        let shadow = Shadow { sun_deg, sample };
        let sources = [
            LightSource::Position(Vec3::ZERO),
            LightSource::Direction(Vec3::new(-1.0, 1.0, 0.0).normalize()),
        ];
        let sun = ShadowSun::new(&shadow, sources.into_iter(), &Affine3A::IDENTITY).unwrap();
        (grid, sun)
    }

    fn floor(sun: &ShadowSun, grid: &Grid, x: u32) -> f32 {
        sun.reaching(grid, UVec3::new(x, 3, 30), Vec3::Y)
    }

    #[test]
    fn a_wall_throws_a_sharp_shadow_as_long_as_it_is_high() {
        let (grid, sun) = scene(10.0, 0);
        assert_eq!(sun.light, 1, "the first distant one");
        for x in 0..64 {
            let lit = !(22..40).contains(&x);
            if x != 20 && x != 21 && x != 40 {
                assert_eq!(floor(&sun, &grid, x) == 1.0, lit, "{x}");
            }
        }
        // The side away from the sun has no light to lose.
        assert_eq!(sun.reaching(&grid, UVec3::new(20, 10, 30), Vec3::X), 1.0);
    }

    #[test]
    fn the_mean_of_samples_has_a_penumbra_that_grows_with_the_sun() {
        let width = |sun_deg: f32| {
            let (grid, sun) = scene(sun_deg, 0);
            let share = |x: u32| {
                (1..65).map(|sample| floor(&ShadowSun { sample, ..sun }, &grid, x)).sum::<f32>()
                    / 64.0
            };
            (24..60).filter(|x| (0.03..0.97).contains(&share(*x))).count()
        };
        let widths = [1.0, 8.0, 24.0].map(width);
        assert!(widths[0] <= 2 && widths[1] >= 3 && widths[2] >= 9, "{widths:?}");
    }

    #[test]
    fn samples_lie_on_the_disc_and_all_over_it() {
        let voxel = UVec3::new(7, 91, 300);
        assert_eq!(on_disc(voxel, 0), Vec2::ZERO);
        let points: Vec<Vec2> = (1..65).map(|sample| on_disc(voxel, sample)).collect();
        assert!(points.iter().all(|point| point.length() <= 1.0001));
        for quadrant in [Vec2::ONE, -Vec2::ONE, Vec2::new(1.0, -1.0), Vec2::new(-1.0, 1.0)] {
            let there = points.iter().filter(|p| (**p * quadrant).min_element() > 0.0).count();
            assert!((12..21).contains(&there), "{there}");
        }
        let mean = points.iter().sum::<Vec2>() / 64.0;
        assert!(mean.length() < 0.08, "{mean}");
    }
}
