//! The histogram of a volume's densities.

use std::convert::Infallible;
use std::ops::Range;

use rayon::prelude::*;

/// Number of bins where densities are not whole numbers.
const FINE_BINS: usize = 1 << 16;
/// Number of voxels counted by one worker at a time.
const CHUNK_VOXELS: usize = 1 << 22;
/// The range of no values.
const NO_RANGE: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);

/// Calls `of_chunk` for the chunks of `len` voxels on all threads, and adds up the counts that it returns. Called
/// through a pointer, so that the parallel loop is compiled once, not per voxel type.
fn sum_of_chunks(
    len: usize,
    count: usize,
    of_chunk: &(dyn Fn(Range<usize>) -> Vec<u64> + Sync),
) -> Vec<u64> {
    chunks(len).map(of_chunk).reduce(
        || vec![0; count],
        |mut sum, counts| {
            sum.iter_mut().zip(counts).for_each(|(a, b)| *a += b);
            sum
        },
    )
}

/// Returns the least and the greatest of the values that `of_chunk` returns for each chunk.
fn range_of_chunks(
    len: usize,
    of_chunk: &(dyn Fn(Range<usize>) -> (f32, f32) + Sync),
) -> (f32, f32) {
    chunks(len).map(of_chunk).reduce(|| NO_RANGE, |a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// Returns `0..len` in pieces of `CHUNK_VOXELS`.
fn chunks(len: usize) -> impl ParallelIterator<Item = Range<usize>> {
    (0..len.div_ceil(CHUNK_VOXELS)).into_par_iter().map(move |chunk| {
        let start = chunk * CHUNK_VOXELS;
        start..(start + CHUNK_VOXELS).min(len)
    })
}

/// Counts how often each of `count` bins occurs. Bins beyond are not counted.
fn count_all<T: Sync>(voxels: &[T], count: usize, bin: impl Fn(&T) -> usize + Sync) -> Vec<u64> {
    sum_of_chunks(voxels.len(), count, &|chunk| {
        // Four tables in turn, so that equal neighbours need not wait for one another.
        let mut tables: [Vec<u32>; 4] = std::array::from_fn(|_| vec![0; count]);
        let (fours, rest) = voxels[chunk].as_chunks::<4>();
        let mut add = |table: usize, voxel: &T| {
            if let Some(n) = tables[table].get_mut(bin(voxel)) {
                *n += 1;
            }
        };
        for four in fours {
            (0..4).for_each(|i| add(i, &four[i]));
        }
        rest.iter().for_each(|voxel| add(0, voxel));
        let sum = |bin: usize| tables.iter().map(|t| u64::from(t[bin])).sum();
        (0..count).map(sum).collect()
    })
}

/// Counts as [`count_all`] does, from voxels that `each` gives portion by portion.
fn count_portions<T: Sync, E>(
    each: &impl Fn(&mut dyn FnMut(&[T])) -> Result<(), E>,
    count: usize,
    bin: impl Fn(&T) -> usize + Sync,
) -> Result<Vec<u64>, E> {
    let mut sum = vec![0; count];
    each(&mut |voxels| {
        let counts = count_all(voxels, count, &bin);
        sum.iter_mut().zip(counts).for_each(|(a, b)| *a += b);
    })?;
    Ok(sum)
}

/// Frequencies of densities.
#[derive(Clone, PartialEq, Debug)]
pub struct Histogram {
    /// Least finite density; like `max` 0, without bins, if there is none.
    pub min: f32,
    /// The greatest finite density.
    pub max: f32,
    /// Number of voxels in each of the equal bins that start at `min`.
    pub bins: Vec<u64>,
    /// Width of a bin.
    pub bin_width: f64,
}

/// The values that a sample type can have.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SampleRange {
    /// A range of whole numbers.
    Whole {
        /// The least value.
        first: i32,
        /// Number of values, which is the number of bins.
        count: usize,
    },
    /// Any number: bins divide the range that occurs.
    Any,
}

impl Histogram {
    /// Counts the finite values of all voxels. Whole numbers get a bin each.
    pub fn of<const B: usize>(
        voxels: &[[u8; B]],
        value: impl Fn(&[u8; B]) -> f32 + Sync,
        values: SampleRange,
    ) -> Histogram {
        let whole = |f: &mut dyn FnMut(&[[u8; B]])| {
            f(voxels);
            Ok::<(), Infallible>(())
        };
        match Histogram::of_portions(whole, value, values) {
            Ok(histogram) => histogram,
            Err(never) => match never {},
        }
    }

    /// Counts as [`Histogram::of`] does, from voxels that `each` gives portion by portion, as often as it is called.
    pub fn of_portions<const B: usize, E>(
        each: impl Fn(&mut dyn FnMut(&[[u8; B]])) -> Result<(), E>,
        value: impl Fn(&[u8; B]) -> f32 + Sync,
        values: SampleRange,
    ) -> Result<Histogram, E> {
        match values {
            SampleRange::Whole { first, count } => {
                let bin = |v: &[u8; B]| (value(v) as i32 - first) as usize;
                Ok(Histogram::of_whole(count_portions(&each, count, bin)?, first))
            }
            SampleRange::Any => {
                let widen = |(min, max): (f32, f32), v: f32| (min.min(v), max.max(v));
                let (mut min, mut max) = NO_RANGE;
                each(&mut |voxels| {
                    let range = range_of_chunks(voxels.len(), &|chunk| {
                        let values = voxels[chunk].iter().map(&value);
                        values.filter(|v| v.is_finite()).fold(NO_RANGE, widen)
                    });
                    (min, max) = (min.min(range.0), max.max(range.1));
                })?;
                Histogram::of_range((min, max), &each, &value)
            }
        }
    }

    /// Creates a histogram from the counts of `first` and the following numbers.
    fn of_whole(mut bins: Vec<u64>, first: i32) -> Histogram {
        let Some(least) = bins.iter().position(|&n| n > 0) else { return Histogram::EMPTY };
        let most = bins.iter().rposition(|&n| n > 0).unwrap_or(least);
        bins.truncate(most + 1);
        bins.drain(..least);
        let number = |bin: usize| (first + bin as i32) as f32;
        Histogram { min: number(least), max: number(most), bins, bin_width: 1.0 }
    }

    /// Counts the finite values, which lie in a range.
    fn of_range<const B: usize, E>(
        (min, max): (f32, f32),
        each: &impl Fn(&mut dyn FnMut(&[[u8; B]])) -> Result<(), E>,
        value: &(impl Fn(&[u8; B]) -> f32 + Sync),
    ) -> Result<Histogram, E> {
        if min > max {
            return Ok(Histogram::EMPTY);
        }
        let range = f64::from(max) - f64::from(min);
        let (count, bin_width) =
            if range == 0.0 { (1, 1.0) } else { (FINE_BINS, range / (FINE_BINS - 1) as f64) };
        // Non-finite values are counted in a bin of their own, which is then dropped.
        let mut bins = count_portions(each, count + 1, |v| {
            let v = value(v);
            let bin = ((f64::from(v) - f64::from(min)) / bin_width) as usize;
            if v.is_finite() { bin.min(count - 1) } else { count }
        })?;
        bins.truncate(count);
        Ok(Histogram { min, max, bins, bin_width })
    }

    const EMPTY: Histogram = Histogram { min: 0.0, max: 0.0, bins: Vec::new(), bin_width: 1.0 };

    /// Returns the lower end of a bin.
    pub fn start_of(&self, bin: usize) -> f64 {
        f64::from(self.min) + bin as f64 * self.bin_width
    }

    /// Returns the number of voxels of finite density below `density`, to a bin.
    pub(crate) fn count_below(&self, density: f64) -> u64 {
        let starts = (0..self.bins.len()).map(|bin| self.start_of(bin));
        starts.zip(&self.bins).take_while(|(start, _)| *start < density).map(|(_, n)| n).sum()
    }

    /// Returns the density below which the fraction `quantile` of all voxels lies, to a bin.
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
