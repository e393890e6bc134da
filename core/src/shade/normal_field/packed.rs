//! Unit vectors in 16 bits: octahedral, 8 bits for each of two coordinates.
//!
//! The octahedron is unfolded onto a square (Meyer, Süßmuth, Sußner, Stamminger and Greiner, "On floating-point normal
//! vectors", 2010), whose coordinates are stored as 0 to 254: with an odd number of steps, the axes of the grid are
//! exact. The mean error is 0.35 degrees, the largest 0.95. 255 is never stored, which leaves a value for "no normal".

use fearless_simd::{Simd, f32x16, prelude::*, u32x16};
use glam::{Vec2, Vec3};

/// A unit vector in 16 bits, or none.
#[repr(transparent)]
#[derive(Clone, Copy, PartialEq, Eq, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PackedNormal(pub u16);

/// The depth of a surface voxel's centre below the surface, in a byte: 0 to 2 voxels.
#[repr(transparent)]
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PackedDepth(pub u8);

impl PackedDepth {
    /// Units per voxel.
    pub const PER_VX: f32 = 64.0;
    /// An existing voxel is not outside, and the depth of a surface is limited to the adjacent voxels.
    const RANGE: [f32; 2] = [3.0, 127.0];

    /// Returns the depth in voxels.
    #[inline(always)]
    pub fn vx(self) -> f32 {
        f32::from(self.0) * (1.0 / Self::PER_VX)
    }

    /// Packs a depth in voxels, clamped to the range of a surface voxel.
    #[inline(always)]
    pub fn pack(depth_vx: f32) -> PackedDepth {
        let [least, most] = Self::RANGE;
        PackedDepth((depth_vx * Self::PER_VX + 0.5).clamp(least, most) as u8)
    }
}

/// Steps on either side of 0.
const STEPS: f32 = 127.0;

impl PackedNormal {
    /// No normal: that of a voxel in the middle of a symmetric neighbourhood.
    pub const NONE: PackedNormal = PackedNormal(u16::MAX);

    /// Packs a vector of any length but 0.
    #[inline(always)]
    pub fn pack(v: Vec3) -> PackedNormal {
        let sum = v.x.abs() + v.y.abs() + v.z.abs();
        // Neither 0 nor infinite nor NaN.
        if !(sum > 0.0 && sum < f32::INFINITY) {
            return PackedNormal::NONE;
        }
        let flat = Vec2::new(v.x, v.y) / sum;
        let flat = if v.z < 0.0 { folded(flat) } else { flat };
        let [x, y] = [flat.x, flat.y];
        let [x, y] = [(x * STEPS + (STEPS + 0.5)) as u16, (y * STEPS + (STEPS + 0.5)) as u16];
        PackedNormal(x | y << 8)
    }

    /// Returns the vector, of unit length up to rounding; `None` for [`PackedNormal::NONE`].
    #[inline(always)]
    pub fn unpack(self) -> Option<Vec3> {
        if self == PackedNormal::NONE {
            return None;
        }
        let flat = Vec2::new(f32::from(self.0 & 255), f32::from(self.0 >> 8)) / STEPS - 1.0;
        let z = 1.0 - flat.x.abs() - flat.y.abs();
        let flat = if z < 0.0 { folded(flat) } else { flat };
        Some(flat.extend(z).normalize())
    }
}

/// Folds the outer triangles of the square over the inner ones, or back.
#[inline(always)]
fn folded(v: Vec2) -> Vec2 {
    let other = 1.0 - Vec2::new(v.y.abs(), v.x.abs());
    // Without `signum`, which distinguishes the zeros.
    Vec2::new(
        if v.x < 0.0 { -other.x } else { other.x },
        if v.y < 0.0 { -other.y } else { other.y },
    )
}

/// Performs [`PackedNormal::unpack`] on sixteen vectors. They are not normalised: their length is between 0.57 and 1.
/// Results for voxels without a normal are unspecified.
#[inline(always)]
pub fn unpack_many<S: Simd>(simd: S, packed: u32x16<S>) -> [f32x16<S>; 3] {
    let x = (packed & 255).to_float::<f32x16<S>>() * (1.0 / STEPS) - 1.0;
    let y = (packed >> 8 & 255).to_float::<f32x16<S>>() * (1.0 / STEPS) - 1.0;
    let (x_size, y_size) = (x.abs(), y.abs());
    let one = f32x16::splat(simd, 1.0);
    let z = one - x_size - y_size;
    let outer = z.simd_lt(0.0);
    let (folded_x, folded_y) = (signed(one - y_size, x), signed(one - x_size, y));
    [outer.select(folded_x, x), outer.select(folded_y, y), z]
}

/// Returns `size` with the sign of `of`.
#[inline(always)]
fn signed<S: Simd>(size: f32x16<S>, of: f32x16<S>) -> f32x16<S> {
    of.simd_lt(0.0).select(-size, size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Random;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn every_direction_comes_back_within_a_degree_and_the_axes_exactly() {
        let mut random = Random(3);
        let (mut sum, mut worst) = (0.0, 0f32);
        for _ in 0..100_000 {
            let v = Vec3::new(random.unit(), random.unit(), random.unit()) - 0.5;
            let angle = PackedNormal::pack(v).unpack().unwrap().angle_between(v).to_degrees();
            (sum, worst) = (sum + angle, worst.max(angle));
        }
        assert!(sum / 1e5 < 0.36 && worst < 0.96, "{} {worst}", sum / 1e5);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for v in [axis, -axis] {
                assert_eq!(PackedNormal::pack(v * 7.0).unpack(), Some(v));
            }
        }
        for none in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
            assert_eq!(PackedNormal::pack(none), PackedNormal::NONE);
        }
    }

    #[test]
    fn all_values_unpack_alike_one_by_one_and_with_vectors() {
        for first in (0..=u16::MAX).step_by(16) {
            let codes: [u32; 16] = std::array::from_fn(|i| u32::from(first) + i as u32);
            let found = dispatch!(Level::new(), simd => {
                unpack_many(simd, u32x16::load_array_ref(simd, &codes)).map(|v| v.to_array())
            });
            for (lane, &code) in codes.iter().enumerate() {
                let packed = PackedNormal(code as u16);
                let (x, y) = (code & 255, code >> 8);
                let Some(expected) = packed.unpack().filter(|_| x < 255 && y < 255) else {
                    continue;
                };
                let found = Vec3::new(found[0][lane], found[1][lane], found[2][lane]);
                assert!(found.normalize().abs_diff_eq(expected, 1e-6), "{code:#x}");
                // The edges of the square meet, so that some directions have several codes.
                let again = PackedNormal::pack(expected).unpack().unwrap();
                assert!(again.abs_diff_eq(expected, 1e-6), "{code:#x}: {again}, not {expected}");
            }
        }
    }
}
