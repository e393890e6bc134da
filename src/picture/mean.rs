//! The mean of the samples of a picture, in linear light.
//!
//! Takes pictures of 8-bit sRGB one after another, gives their mean. Light is linear in the square of a value, as for
//! the shaders ([`crate::shade::illumination`]). Sums are integers, so the mean does not depend on the order, and that
//! of one picture is bit-identical. Does not know where pictures come from.

use glam::UVec2;
use image::{Rgb, RgbImage};

/// Pictures of one size, added up.
pub(super) struct PictureMean {
    size: UVec2,
    /// Per channel, of the squares of the values.
    sums: Vec<[u32; 3]>,
    count: u32,
}

impl PictureMean {
    /// Starts without a picture.
    pub fn new(size: UVec2) -> PictureMean {
        PictureMean { size, sums: vec![[0; 3]; size.x as usize * size.y as usize], count: 0 }
    }

    /// Adds a picture, given by the value of each of its pixels, row by row from the top.
    pub fn add(&mut self, pixels: impl IntoIterator<Item = [u8; 3]>) {
        for (sums, rgb) in self.sums.iter_mut().zip(pixels) {
            for (sum, value) in sums.iter_mut().zip(rgb) {
                *sum += u32::from(value) * u32::from(value);
            }
        }
        self.count += 1;
    }

    /// Returns the mean of the pictures.
    pub fn picture(&self) -> RgbImage {
        let share = 1.0 / f64::from(self.count.max(1));
        RgbImage::from_fn(self.size.x, self.size.y, |x, y| {
            let sums = self.sums[(x + y * self.size.x) as usize];
            Rgb(sums.map(|sum| (f64::from(sum) * share).sqrt().round() as u8))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::MAX_SAMPLES;

    #[test]
    fn the_mean_of_equal_pictures_is_each_of_them_and_light_adds_up() {
        let all: Vec<[u8; 3]> = (0..=255).map(|v| [v, 255 - v, 0]).collect();
        let mut mean = PictureMean::new(UVec2::new(16, 16));
        for _ in 0..MAX_SAMPLES {
            mean.add(all.iter().copied());
            let picture = mean.picture();
            assert!(picture.pixels().map(|p| p.0).eq(all.iter().copied()));
        }
        // Half the light of white is 180.3, a quarter 127.5.
        let mut mean = PictureMean::new(UVec2::ONE);
        mean.add([[255, 255, 0]]);
        mean.add([[0, 255, 0]]);
        assert_eq!(mean.picture().get_pixel(0, 0).0, [180, 255, 0]);
        mean.add([[0, 0, 255]]);
        mean.add([[0, 0, 255]]);
        assert_eq!(mean.picture().get_pixel(0, 0).0, [128, 180, 180]);
    }
}
