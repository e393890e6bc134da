//! Brightness pictures: conversion from colour, blur against noise, interpolation, local threshold.

use glam::DVec2;

/// A greyscale picture.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Grey {
    /// Pixels.
    pub width: usize,
    /// Pixels.
    pub height: usize,
    /// Rows from the top, `width * height` bytes.
    pub pixels: Vec<u8>,
}

impl Grey {
    /// Converts rows of RGBA, 8 bits each; missing pixels are black.
    pub fn from_rgba(width: u32, height: u32, rgba: &[u8]) -> Grey {
        let (width, height) = (width as usize, height as usize);
        let mut pixels: Vec<u8> = rgba
            .chunks_exact(4)
            .take(width * height)
            // Rec. 601, scaled to integers.
            .map(|p| {
                ((77 * u32::from(p[0]) + 150 * u32::from(p[1]) + 29 * u32::from(p[2])) >> 8) as u8
            })
            .collect();
        pixels.resize(width * height, 0);
        Grey { width, height, pixels }
    }

    /// Returns the bilinear brightness; pixel centres are at integers. Clamped to the edge.
    pub fn at(&self, place: DVec2) -> f64 {
        if self.pixels.is_empty() {
            return 0.0;
        }
        let limit = |v: f64, size: usize| v.clamp(0.0, (size - 1) as f64);
        let (x, y) = (limit(place.x, self.width), limit(place.y, self.height));
        let (x0, y0) = (x as usize, y as usize);
        let (x1, y1) = ((x0 + 1).min(self.width - 1), (y0 + 1).min(self.height - 1));
        let (fx, fy) = (x - x0 as f64, y - y0 as f64);
        let pixel = |x: usize, y: usize| f64::from(self.pixels[y * self.width + x]);
        let upper = pixel(x0, y0) * (1.0 - fx) + pixel(x1, y0) * fx;
        let lower = pixel(x0, y1) * (1.0 - fx) + pixel(x1, y1) * fx;
        upper * (1.0 - fy) + lower * fy
    }

    /// Returns the picture blurred with weights 1 2 1 along both axes, against noise.
    pub fn blurred(&self) -> Grey {
        let (w, h) = (self.width, self.height);
        let mut across = vec![0u16; w * h];
        for (row, out) in self.pixels.chunks_exact(w.max(1)).zip(across.chunks_exact_mut(w.max(1)))
        {
            for x in 0..w {
                let (left, right) = (row[x.saturating_sub(1)], row[(x + 1).min(w - 1)]);
                out[x] = u16::from(left) + 2 * u16::from(row[x]) + u16::from(right);
            }
        }
        let mut pixels = vec![0; w * h];
        for y in 0..h {
            let (above, below) = (y.saturating_sub(1) * w, (y + 1).min(h - 1) * w);
            for x in 0..w {
                let sum = across[above + x] + 2 * across[y * w + x] + across[below + x];
                pixels[y * w + x] = ((sum + 8) >> 4) as u8;
            }
        }
        Grey { width: w, height: h, pixels }
    }

    /// Returns the pixels darker by more than `margin` than the mean of those up to `reach` pixels away (D. Bradley, G.
    /// Roth: "Adaptive Thresholding using the Integral Image", 2007).
    pub fn dark(&self, reach: usize, margin: u32) -> Vec<bool> {
        let (w, h) = (self.width, self.height);
        // sums[y * (w + 1) + x] is the sum of all pixels above and left of (x, y).
        let mut sums = vec![0u32; (w + 1) * (h + 1)];
        for y in 0..h {
            let mut row = 0;
            for x in 0..w {
                row += u32::from(self.pixels[y * w + x]);
                sums[(y + 1) * (w + 1) + x + 1] = sums[y * (w + 1) + x + 1].wrapping_add(row);
            }
        }
        let mut dark = vec![false; w * h];
        for y in 0..h {
            let (top, bottom) = (y.saturating_sub(reach), (y + reach + 1).min(h));
            for x in 0..w {
                let (left, right) = (x.saturating_sub(reach), (x + reach + 1).min(w));
                let at = |x: usize, y: usize| sums[y * (w + 1) + x];
                // Sums of large pictures wrap around; their differences are still correct.
                let sum = at(right, bottom)
                    .wrapping_sub(at(left, bottom))
                    .wrapping_sub(at(right, top))
                    .wrapping_add(at(left, top));
                let count = ((right - left) * (bottom - top)) as u32;
                dark[y * w + x] = (u32::from(self.pixels[y * w + x]) + margin) * count < sum;
            }
        }
        dark
    }
}
