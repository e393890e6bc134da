//! Random numbers of a final picture: an Owen-scrambled Sobol sequence for each decision of each pixel.
//!
//! Maps pixel, sample and the order of decisions to points of the unit square. The first 2^n samples of a decision are
//! evenly spread over the square for every n, pixels and decisions are independent of each other, and nothing depends
//! on threads. After Burley, "Practical Hash-based Owen Scrambling" (JCGT 9, 2020): a nested uniform scramble is a hash
//! in which low bits affect only higher ones, applied to reversed bits. Uses only integers, so that a device computes
//! the same numbers.
//!
//! Knows no light and no rays.

use glam::Vec2;

/// The decisions of one path.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    /// The sample's index, bits reversed.
    reversed_index: u32,
    /// A hash of the pixel and the number of decisions so far.
    state: u32,
}

impl Sampler {
    /// Returns the sampler of sample `index` of a pixel.
    #[inline(always)]
    pub fn new(pixel: u32, index: u32) -> Sampler {
        Sampler { reversed_index: index.reverse_bits(), state: hash(pixel) }
    }

    /// Returns the point of the next decision: both coordinates from 0 to below 1.
    #[inline(always)]
    pub(crate) fn next_2d(&mut self) -> Vec2 {
        self.state = self.state.wrapping_add(0x9E37_79B9);
        let seed = hash(self.state);
        // The order of the points, then the points.
        let x = scramble(self.reversed_index, seed);
        let y = second_dimension(x);
        let x = scramble(x.reverse_bits(), seed.rotate_left(11) ^ 0x68BC_21EB).reverse_bits();
        let y = scramble(y.reverse_bits(), seed.rotate_left(21) ^ 0x02E5_BE93).reverse_bits();
        Vec2::new(unit(x), unit(y))
    }

    /// Returns the number of the next decision, from 0 to below 1.
    #[inline(always)]
    pub(crate) fn next_1d(&mut self) -> f32 {
        self.state = self.state.wrapping_add(0x9E37_79B9);
        let seed = hash(self.state);
        let x = scramble(self.reversed_index, seed);
        unit(scramble(x.reverse_bits(), seed.rotate_left(11) ^ 0x68BC_21EB).reverse_bits())
    }
}

/// Returns a hash of 32 bits (C. Wellons, "lowbias32").
#[inline(always)]
fn hash(mut x: u32) -> u32 {
    x = (x ^ x >> 16).wrapping_mul(0x7FEB_352D);
    x = (x ^ x >> 15).wrapping_mul(0x846C_A68B);
    x ^ x >> 16
}

/// Returns a permutation in which every bit depends only on itself and the lower ones (after Laine and Karras).
#[inline(always)]
fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(seed >> 16 | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^ x.wrapping_mul(0x53A2_2864)
}

/// Returns the second coordinate of the Sobol point whose first is `x`: its digits times Pascal's triangle modulo 2.
#[inline(always)]
fn second_dimension(mut x: u32) -> u32 {
    x ^= x << 1 & 0xAAAA_AAAA;
    x ^= x << 2 & 0xCCCC_CCCC;
    x ^= x << 4 & 0xF0F0_F0F0;
    x ^= x << 8 & 0xFF00_FF00;
    x ^ x << 16
}

#[inline(always)]
fn unit(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(pixel: u32, decision: u32, count: u32) -> Vec<Vec2> {
        let of = |index| {
            let mut sampler = Sampler::new(pixel, index);
            for _ in 0..decision {
                sampler.next_2d();
            }
            sampler.next_2d()
        };
        (0..count).map(of).collect()
    }

    /// The first 2^n points are one in each of 2^n rectangles, whatever their shape.
    #[test]
    fn every_decision_is_spread_over_all_elementary_intervals() {
        for (pixel, decision) in [(0, 0), (1, 0), (77, 3), (u32::MAX, 12)] {
            for bits in 0..8 {
                let points = points(pixel, decision, 1 << bits);
                for x_bits in 0..=bits {
                    let (columns, rows) = (1 << x_bits, 1 << (bits - x_bits));
                    let mut taken = vec![0; 1 << bits];
                    for p in &points {
                        let (x, y) =
                            ((p.x * columns as f32) as usize, (p.y * rows as f32) as usize);
                        taken[x + y * columns] += 1;
                    }
                    assert!(taken.iter().all(|count| *count == 1), "{columns}x{rows}");
                }
            }
        }
    }

    #[test]
    fn pixels_and_decisions_are_independent() {
        let correlation = |a: &[Vec2], b: &[Vec2]| {
            let sum: f32 = a.iter().zip(b).map(|(a, b)| (a.x - 0.5) * (b.x - 0.5)).sum();
            sum / a.len() as f32 * 12.0
        };
        let mut sum = 0.0;
        for pixel in 0..200 {
            let first = points(pixel, 0, 64);
            assert_ne!(first, points(pixel + 1, 0, 64));
            sum += correlation(&first, &points(pixel, 1, 64)).abs();
            sum += correlation(&first, &points(pixel + 1, 0, 64)).abs();
        }
        // The average for independent points is 0.1.
        assert!(sum / 400.0 < 0.15, "{}", sum / 400.0);
    }

    #[test]
    fn single_numbers_are_stratified() {
        let mut taken = [0; 64];
        for index in 0..64 {
            taken[(Sampler::new(5, index).next_1d() * 64.0) as usize] += 1;
        }
        assert_eq!(taken, [1; 64]);
    }
}
