//! Samples of a picture for antialiasing: the same eye, shifted by fractions of a pixel. The mean of their
//! pictures, in linear light, is the antialiased one.
//!
//! Maps the index of a sample to its offset, and an eye and an offset to the shifted eye. The offsets are the Halton
//! sequence of the bases 2 and 3 (J. H. Halton, Numerische Mathematik 2, 1960), shifted so that it begins at the
//! pixel's centre: any number of its first points covers the pixel evenly. Does not know how pictures are made or
//! averaged.

use glam::Vec2;

use super::eye::Eye;

/// The most samples of a picture.
pub const MAX_SAMPLES: u32 = 64;

/// Returns the position of sample `index` in a pixel: in pixels from the pixel's centre, -0.5 to 0.5, y downwards.
/// Sample 0 is at the centre.
pub fn sample_offset_px(index: u32) -> Vec2 {
    let centred = |base| {
        let at = radical_inverse(index, base);
        (if at < 0.5 { at } else { at - 1.0 }) as f32
    };
    Vec2::new(centred(2), centred(3))
}

/// Returns the digits of `index` in `base`, mirrored at the radix point: 0 to 1.
fn radical_inverse(mut index: u32, base: u32) -> f64 {
    let (mut inverse, mut place) = (0.0, 1.0);
    while index > 0 {
        place /= f64::from(base);
        inverse += place * f64::from(index % base);
        index /= base;
    }
    inverse
}

impl Eye {
    /// Returns the eye whose pixel centres lie `offset_px` to the right of and below those of this one: the same
    /// position, with the projection shifted. Without offset it is the same eye to the bit.
    pub fn shifted_by_px(&self, offset_px: Vec2) -> Eye {
        // Clip space is two units wide and high.
        let shift = 2.0 * offset_px / self.size.as_vec2();
        let mut eye = *self;
        let columns = &mut eye.projection;
        for column in
            [&mut columns.x_axis, &mut columns.y_axis, &mut columns.z_axis, &mut columns.w_axis]
        {
            column.x -= shift.x * column.w;
            column.y -= shift.y * column.w;
        }
        eye
    }

    /// Returns the eye of sample `index` of its picture.
    pub fn sample(&self, index: u32) -> Eye {
        self.shifted_by_px(sample_offset_px(index))
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, UVec2, Vec3};

    use super::*;
    use crate::view::eye::Frustum;
    use crate::view::{Camera, StereoRig};

    /// Returns a mono eye, an off-axis one, and a stereo pair.
    fn eyes() -> [Eye; 4] {
        let camera = Camera { eye: Vec3::new(3.0, 2.0, 9.0), ..Camera::default() };
        let mono = camera.eye(UVec2::new(641, 480));
        let off_axis = Frustum { left: -0.3, right: 0.5, down: -0.2, up: 0.4 }.projection(0.1);
        let off_axis = Eye { projection: off_axis, ..mono };
        let rig = StereoRig { eye_distance: 0.4, convergence: 5.0, swap: false };
        let [left, right] = rig.eyes(&off_axis);
        [mono, off_axis, left, right]
    }

    #[test]
    fn a_shifted_eye_sees_through_points_that_fraction_of_a_pixel_away() {
        let world_from_grid = Affine3A::from_rotation_y(0.7)
            * Affine3A::from_scale(Vec3::new(1.0, 2.0, 0.5))
            * Affine3A::from_translation(Vec3::new(-4.0, 1.0, 2.0));
        for eye in eyes() {
            let rays = eye.pixel_rays(&world_from_grid);
            for offset in [Vec2::new(0.25, -0.4), Vec2::new(-0.5, 0.125), sample_offset_px(9)] {
                let shifted = eye.shifted_by_px(offset);
                assert_eq!(shifted.eye_from_world, eye.eye_from_world);
                let through = shifted.pixel_rays(&world_from_grid);
                assert_eq!(through.origin, rays.origin);
                for (x, y) in [(0, 0), (640, 479), (17, 300)] {
                    let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) + offset;
                    let gap = through.direction(x, y) - rays.direction_at(at.x, at.y);
                    let pixel = rays.step_x.length().min(rays.step_y.length());
                    assert!(gap.length() < 1e-3 * pixel, "{offset} at {x}, {y}: {gap}");
                    // Rasterised geometry moves the other way by as much, at any depth.
                    for t in [0.5, 30.0] {
                        let point = rays.origin + rays.direction_at(at.x, at.y) * t;
                        let clip = shifted.clip_from_grid(&world_from_grid) * point.extend(1.0);
                        let seen =
                            (Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5) * eye.size.as_vec2();
                        let centre = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                        assert!(seen.abs_diff_eq(centre, 2e-3), "{seen} for {centre}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_first_sample_is_the_eye_itself() {
        assert_eq!(sample_offset_px(0), Vec2::ZERO);
        for eye in eyes() {
            assert_eq!(eye.sample(0), eye);
        }
    }

    #[test]
    fn samples_cover_the_pixel_evenly() {
        let all: Vec<Vec2> = (0..MAX_SAMPLES).map(sample_offset_px).collect();
        assert!(all.iter().all(|at| at.abs().max_element() <= 0.5));
        // Each column of a division by 2, 4 ... 64 has one of as many samples, and each row of one by 3, 9, 27.
        let strata = |axis: usize, count: usize| {
            let mut taken = vec![0; count];
            for at in &all[..count] {
                let share = f64::from(at[axis]).rem_euclid(1.0);
                taken[(share * count as f64 + 1e-3) as usize % count] += 1;
            }
            taken
        };
        for count in [2, 4, 8, 16, 32, 64] {
            assert_eq!(strata(0, count), vec![1; count]);
        }
        for count in [3, 9, 27] {
            assert_eq!(strata(1, count), vec![1; count]);
        }
        // The part of the pixel beyond an upright or slanting edge equals the share of samples beyond the edge.
        for count in [16, 64] {
            let mean = all[..count].iter().sum::<Vec2>() / count as f32;
            assert!(mean.abs().max_element() < 0.06, "{count}: {mean}");
            for corner in [Vec2::ONE, Vec2::new(-1.0, 1.0)] {
                let beyond = all[..count].iter().filter(|at| at.dot(corner) > 0.0).count();
                let share = beyond as f32 / count as f32;
                assert!((0.4..0.6).contains(&share), "{count} {corner}: {share}");
            }
        }
    }
}
