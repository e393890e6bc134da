//! Owns the histogram of a volume's densities, and the threshold that is read off it.

use rayon::prelude::*;

/// Most bins; enough to have each 16-bit value by itself.
const MAX_BINS: usize = 1 << 16;
/// Voxels counted by one worker at a time.
const CHUNK_VOXELS: usize = 1 << 20;

/// How often densities occur.
#[derive(Clone, PartialEq, Debug)]
pub struct Histogram {
    /// Least and greatest finite density; both 0 where there is none.
    pub min: f32,
    pub max: f32,
    /// Voxels in each of the equal bins that `min` is the start of.
    pub bins: Vec<u64>,
    /// Width of a bin.
    pub bin_width: f64,
}

impl Histogram {
    /// Counts the finite values of all voxels. Whole numbers get a bin each.
    pub fn of<const B: usize>(
        voxels: &[[u8; B]],
        value: impl Fn(&[u8; B]) -> f32 + Sync,
        whole: bool,
    ) -> Histogram {
        let (min, max) = voxels
            .par_chunks(CHUNK_VOXELS)
            .map(|chunk| {
                chunk
                    .iter()
                    .map(&value)
                    .filter(|v| v.is_finite())
                    .fold((f32::INFINITY, f32::NEG_INFINITY), |(min, max), v| {
                        (min.min(v), max.max(v))
                    })
            })
            .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        if min > max {
            return Histogram { min: 0.0, max: 0.0, bins: vec![0], bin_width: 1.0 };
        }
        let range = f64::from(max) - f64::from(min);
        let (count, bin_width) = if range == 0.0 {
            (1, 1.0)
        } else if whole && range < MAX_BINS as f64 {
            (range as usize + 1, 1.0)
        } else {
            (MAX_BINS, range / (MAX_BINS - 1) as f64)
        };
        let bin = |v: f32| (((f64::from(v) - f64::from(min)) / bin_width) as usize).min(count - 1);
        let bins = voxels
            .par_chunks(CHUNK_VOXELS)
            .fold(
                || vec![0u64; count],
                |mut bins, chunk| {
                    for v in chunk.iter().map(&value).filter(|v| v.is_finite()) {
                        bins[bin(v)] += 1;
                    }
                    bins
                },
            )
            .reduce(
                || vec![0u64; count],
                |mut sum, bins| {
                    sum.iter_mut().zip(bins).for_each(|(a, b)| *a += b);
                    sum
                },
            );
        Histogram { min, max, bins, bin_width }
    }

    /// Lower end of a bin.
    pub fn start_of(&self, bin: usize) -> f64 {
        f64::from(self.min) + bin as f64 * self.bin_width
    }

    /// Voxels of finite density below `density`, to a bin.
    pub fn count_below(&self, density: f64) -> u64 {
        let starts = (0..self.bins.len()).map(|bin| self.start_of(bin));
        starts.zip(&self.bins).take_while(|(start, _)| *start < density).map(|(_, n)| n).sum()
    }

    /// The density below which the share `quantile` of all voxels lies, to a bin.
    pub fn quantile(&self, quantile: f64) -> f64 {
        let wanted = quantile * self.bins.iter().sum::<u64>() as f64;
        let mut below = 0;
        for (bin, &count) in self.bins.iter().enumerate() {
            below += count;
            if below as f64 >= wanted {
                return self.start_of(bin);
            }
        }
        f64::from(self.max)
    }
}
