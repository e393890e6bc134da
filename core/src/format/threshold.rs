//! The automatic threshold: finds in a histogram of densities the density from which voxels belong to the body rather
//! than to its surroundings.
//!
//! Otsu's threshold (1979) splits the densities into the two classes with the greatest distance of means relative to
//! their sizes. On head scans that is the skin. But it lies about half-way between the means, and so cuts into a body
//! whose own densities reach far down, such as a pollen grain unevenly lit by the microscope. Where the histogram has a
//! valley between the two means, the valley is taken instead: densities are rarest there, so that the surface is
//! cleanest. (Of the others tried on the test volumes, minimum cross entropy and the triangle method both leave the
//! noise of the air around the heads.)

use super::histogram::Histogram;

/// Number of bins in which a valley is sought; few enough that noise makes none.
const COARSE_BINS: usize = 128;
/// Least height of a valley's far side relative to its floor.
const PROMINENCE: f64 = 1.5;
/// Gaps between occurring values count as empty if fewer than this many fit the whole range.
const GAPS: f64 = 16.0;

/// Returns the density from which voxels exist. If all are equal, returns this density if it is above 0, else a density
/// above it.
pub fn automatic(histogram: &Histogram) -> f64 {
    let Histogram { min, max, .. } = *histogram;
    if min == max {
        return f64::from(if max > 0.0 { max } else { max.next_up() });
    }
    let otsu = otsu(histogram);
    valley(histogram, otsu.means).unwrap_or(otsu.threshold)
}

struct Otsu {
    threshold: f64,
    /// Mean densities below and from the threshold on.
    means: [f64; 2],
}

fn otsu(histogram: &Histogram) -> Otsu {
    let bins = || histogram.bins.iter().enumerate().map(|(i, &count)| (i as f64, count as f64));
    let (count, sum) = bins().fold((0.0, 0.0), |(n, s), (i, c)| (n + c, s + i * c));
    let (mut below, mut sum_below) = (0.0, 0.0);
    let mut best = (-1.0, [0.0; 2]);
    let (mut first, mut last) = (0, 0);
    for (i, c) in bins() {
        below += c;
        sum_below += i * c;
        let above = count - below;
        if below == 0.0 || above == 0.0 {
            continue;
        }
        let means = [sum_below / below, (sum - sum_below) / above];
        let variance = below * above * (means[1] - means[0]).powi(2);
        // It is constant over empty bins; their middle is the best cut.
        if variance > best.0 * (1.0 + 1e-12) {
            best = (variance, means);
            first = i as usize;
        }
        if variance >= best.0 * (1.0 - 1e-12) {
            last = i as usize;
        }
    }
    let value = |bin: f64| f64::from(histogram.min) + bin * histogram.bin_width;
    Otsu { threshold: histogram.start_of((first + last) / 2 + 1), means: best.1.map(value) }
}

/// Returns the lowest point between two densities, if it lies clearly below both its sides.
fn valley(histogram: &Histogram, [from, to]: [f64; 2]) -> Option<f64> {
    let min = f64::from(histogram.min);
    // A few very dense voxels must not squeeze all others into one bin.
    let most = histogram.quantile(0.999);
    let top = if most > min { most } else { f64::from(histogram.max) };
    // Whole bins, since otherwise some would hold more of the histogram's bins than others.
    let width = ((top - min) / COARSE_BINS as f64 / histogram.bin_width).ceil().max(1.0)
        * histogram.bin_width;
    let coarse = |value: f64| (((value - min) / width) as usize).min(COARSE_BINS - 1);
    let mut counts = [0.0; COARSE_BINS];
    let mut occupied = histogram.bins.iter().enumerate().filter(|(_, n)| **n > 0).peekable();
    while let Some((bin, &count)) = occupied.next() {
        // Values stretched to a wider range leave gaps that are no valleys.
        let gap = occupied.peek().map_or(1, |(next, _)| next - bin);
        let filled = if gap as f64 * histogram.bin_width * GAPS > top - min { 1 } else { gap };
        for i in bin..bin + filled {
            counts[coarse(histogram.start_of(i))] += count as f64 / filled as f64;
        }
    }
    let at = |i: usize| counts[i.min(COARSE_BINS - 1)];
    let smooth: Vec<f64> =
        (0..COARSE_BINS).map(|i| at(i.saturating_sub(1)) + 2.0 * at(i) + at(i + 1)).collect();

    let between = &smooth[coarse(from)..=coarse(to)];
    let floor = between.iter().copied().fold(f64::INFINITY, f64::min);
    let first = between.iter().position(|&c| c == floor)?;
    let run = between[first..].iter().take_while(|&&c| c == floor).count();
    let highest = |side: &[f64]| side.iter().copied().fold(0.0, f64::max);
    let clear = |side: &[f64]| highest(side) > PROMINENCE * floor;
    (clear(&between[..first]) && clear(&between[first + run..]))
        .then(|| min + (coarse(from) + first) as f64 * width + run as f64 * width / 2.0)
}

#[cfg(test)]
mod tests {
    use super::super::histogram::SampleRange;
    use super::*;

    fn threshold_of(values: impl IntoIterator<Item = u8>) -> f64 {
        let voxels: Vec<[u8; 1]> = values.into_iter().map(|v| [v]).collect();
        let values = SampleRange::Whole { first: 0, count: 256 };
        automatic(&Histogram::of(&voxels, |[v]| f32::from(*v), values))
    }

    /// Returns `count` values spread evenly over a range.
    fn spread(range: std::ops::Range<u32>, count: u32) -> impl Iterator<Item = u8> {
        (0..count).map(move |i| (range.start + i * (range.end - range.start) / count) as u8)
    }

    #[test]
    fn two_values_are_cut_in_the_middle_however_few() {
        for (empty, full) in [(1000, 1), (1, 1000), (500, 500), (100_000, 1)] {
            let values = (0..empty).map(|_| 0).chain((0..full).map(|_| 255));
            let threshold = threshold_of(values);
            assert!((100.0..156.0).contains(&threshold), "{empty} {full}: {threshold}");
        }
    }

    #[test]
    fn all_equal_means_all_or_nothing() {
        assert!(threshold_of([0; 10]) > 0.0);
        assert_eq!(threshold_of([255; 10]), 255.0);
        assert_eq!(threshold_of([7]), 7.0);
        let none = Histogram::of(&[[0u8; 4]], |_| f32::NAN, SampleRange::Any);
        assert!(automatic(&none) > 0.0);
    }

    #[test]
    fn the_valley_is_found_below_a_body_of_many_densities() {
        // Like the pollen grain: nine tenths are 0, the body reaches from 10 to 250.
        let values = (0..9000).map(|_| 0).chain(spread(20..250, 1000));
        let threshold = threshold_of(values);
        assert!((1.0..=20.0).contains(&threshold), "{threshold}");
        // Like a head: air with some noise, tissue, little bone.
        let values = spread(0..30, 5000).chain(spread(60..80, 4000)).chain(spread(80..200, 500));
        let threshold = threshold_of(values);
        assert!((30.0..=60.0).contains(&threshold), "{threshold}");
    }

    #[test]
    fn without_a_valley_the_classes_decide() {
        // Ever rarer towards the dense end, like a field that fades.
        let values = (0..200u32).flat_map(|v| (0..200 - v).map(move |_| v as u8));
        let threshold = threshold_of(values);
        assert!((60.0..90.0).contains(&threshold), "{threshold}");
        // The same with only every eighth value.
        let values = (0..25u32).flat_map(|v| (0..25 - v).map(move |_| 8 * v as u8));
        let threshold = threshold_of(values);
        assert!((60.0..90.0).contains(&threshold), "{threshold}");
    }
}
