//! Computes a palette for the colours of a sculpture: exact where they are few enough, else by median cut and k-means
//! in Oklab, where distances are perceptual.
//!
//! Deterministic: the same colours give the same palette on any machine and with any number of threads.

use std::collections::HashMap;

use glam::{DVec3, UVec3};
use rayon::prelude::*;

use crate::sculpture::history::Contents;
use crate::sculpture::{Brick, Rgb};

/// Rounds of k-means; more change little.
const ROUNDS: usize = 8;
/// Greatest number of distinct colours during the search; beyond that their lowest bits are ignored.
const MOST_POINTS: usize = 1 << 15;

/// Colours, and the one that represents each colour of the sculpture.
#[derive(Debug)]
pub struct Palette {
    pub colours: Vec<Rgb>,
    index: HashMap<Rgb, u8>,
}

impl Palette {
    /// Returns the index of the entry for a colour of the sculpture.
    pub fn index(&self, colour: Rgb) -> u8 {
        self.index.get(&colour).copied().unwrap_or(0)
    }

    /// Returns the number of colours of the sculpture. Each is exact if the palette has as many.
    pub(crate) fn stands_for(&self) -> usize {
        self.index.len()
    }
}

/// Returns a palette of at most `most` (1 to 255) colours for the voxels of a sculpture.
pub fn palette(contents: &Contents, most: usize) -> Palette {
    let mut counts: Vec<(Rgb, u64)> = histogram(contents).into_iter().collect();
    counts.sort_unstable_by_key(|(colour, _)| colour.0);
    let colours: Vec<Rgb> = match counts.len() <= most {
        true => counts.iter().map(|(colour, _)| *colour).collect(),
        false => find(&counts, most),
    };
    let in_oklab: Vec<DVec3> = colours.iter().map(|colour| oklab(*colour)).collect();
    let exact: HashMap<Rgb, u8> = colours.iter().copied().zip(0..).collect();
    let of = |colour: Rgb| match exact.get(&colour) {
        Some(index) => *index,
        None => nearest(&in_oklab, oklab(colour)) as u8,
    };
    let index = counts.par_iter().map(|(colour, _)| (*colour, of(*colour))).collect();
    Palette { colours, index }
}

/// Returns the number of voxels of each colour.
fn histogram(contents: &Contents) -> HashMap<Rgb, u64> {
    let (grid, material) = (&contents.grid, &contents.material);
    let bricks: Vec<(UVec3, &Brick)> = grid.nonempty_bricks().collect();
    let count = |mut counts: HashMap<Rgb, u64>, (b, brick): &(UVec3, &Brick)| {
        let page = material.page(*b);
        match page.map_or(Some(material.base()), |page| page.uniform()) {
            Some(colour) => *counts.entry(colour).or_default() += u64::from(brick.count()),
            None => brick.for_each(|local| {
                let colour = page.map_or(material.base(), |page| page.rgb(local));
                *counts.entry(colour).or_default() += 1;
            }),
        }
        counts
    };
    let add = |mut a: HashMap<Rgb, u64>, b: HashMap<Rgb, u64>| {
        b.into_iter().for_each(|(colour, n)| *a.entry(colour).or_default() += n);
        a
    };
    bricks.par_iter().fold(HashMap::new, count).reduce(HashMap::new, add)
}

/// A colour with its number of voxels.
#[derive(Clone, Copy)]
struct Point {
    at: DVec3,
    weight: f64,
}

fn find(counts: &[(Rgb, u64)], most: usize) -> Vec<Rgb> {
    let mut points = points(counts);
    let mut centres: Vec<DVec3> =
        median_cut(&mut points, most).iter().map(|range| mean(&points[range.clone()])).collect();
    for _ in 0..ROUNDS {
        let owners: Vec<usize> = points.par_iter().map(|p| nearest(&centres, p.at)).collect();
        let mut sums = vec![(DVec3::ZERO, 0.0); centres.len()];
        for (point, owner) in points.iter().zip(owners) {
            sums[owner].0 += point.at * point.weight;
            sums[owner].1 += point.weight;
        }
        // A centre without points stays in place.
        centres
            .iter_mut()
            .zip(sums)
            .filter(|(_, (_, weight))| *weight > 0.0)
            .for_each(|(centre, (sum, weight))| *centre = sum / weight);
    }
    let mut colours: Vec<Rgb> = centres.into_iter().map(from_oklab).collect();
    colours.sort_unstable_by_key(|colour| colour.0);
    colours.dedup();
    colours
}

/// Returns the colours in Oklab; if there are very many, neighbouring ones are merged.
fn points(counts: &[(Rgb, u64)]) -> Vec<Point> {
    // A rare colour still needs a similar entry: weights grow more slowly than counts.
    let weight = |voxels: u64| (voxels as f64).sqrt();
    if counts.len() <= MOST_POINTS {
        let point =
            |(colour, voxels): &(Rgb, u64)| Point { at: oklab(*colour), weight: weight(*voxels) };
        return counts.iter().map(point).collect();
    }
    let mut cells: Vec<([u8; 3], DVec3, u64)> = counts
        .par_iter()
        .map(|(colour, n)| (colour.0.map(|level| level >> 3), oklab(*colour) * *n as f64, *n))
        .collect();
    cells.par_sort_by_key(|(cell, ..)| *cell);
    let same = cells.chunk_by(|a, b| a.0 == b.0);
    same.map(|cell| {
        let voxels: u64 = cell.iter().map(|(.., n)| n).sum();
        let sum: DVec3 = cell.iter().map(|(_, at, _)| *at).sum();
        Point { at: sum / voxels as f64, weight: weight(voxels) }
    })
    .collect()
}

/// Sorts the points into at most `most` groups: repeatedly splits that of the largest variance at its mean, across its
/// longest axis.
fn median_cut(points: &mut [Point], most: usize) -> Vec<std::ops::Range<usize>> {
    let mut groups = vec![(0..points.len(), variance(points))];
    while groups.len() < most {
        let widest = (0..groups.len()).max_by(|&a, &b| {
            let spread = |i: usize| groups[i].1.element_sum();
            spread(a).total_cmp(&spread(b)).then(b.cmp(&a))
        });
        let Some(widest) = widest else { break };
        let (range, variances) = groups[widest].clone();
        if variances.element_sum() <= 1e-12 || range.len() < 2 {
            break;
        }
        let axis = (0..3).fold(0, |a, b| if variances[b] > variances[a] { b } else { a });
        let group = &mut points[range.clone()];
        group.sort_by(|a, b| a.at[axis].total_cmp(&b.at[axis]));
        let cut = mean(group)[axis];
        let below = group.partition_point(|p| p.at[axis] < cut).clamp(1, group.len() - 1);
        let (low, high) = group.split_at(below);
        let middle = range.start + below;
        let halves = [(range.start..middle, variance(low)), (middle..range.end, variance(high))];
        let [low, high] = halves;
        groups[widest] = low;
        groups.push(high);
    }
    groups.into_iter().map(|(range, _)| range).collect()
}

fn mean(points: &[Point]) -> DVec3 {
    let weight: f64 = points.iter().map(|p| p.weight).sum();
    points.iter().map(|p| p.at * p.weight).sum::<DVec3>() / weight
}

/// Returns the variance of each axis, times the weight.
fn variance(points: &[Point]) -> DVec3 {
    let mean = mean(points);
    points.iter().map(|p| (p.at - mean).powf(2.0) * p.weight).sum()
}

fn nearest(centres: &[DVec3], at: DVec3) -> usize {
    let mut best = (0, f64::INFINITY);
    for (i, centre) in centres.iter().enumerate() {
        let distance = centre.distance_squared(at);
        if distance < best.1 {
            best = (i, distance);
        }
    }
    best.0
}

/// Converts sRGB to Oklab (Ottosson 2020).
fn oklab(colour: Rgb) -> DVec3 {
    let linear = colour.0.map(|level| {
        let v = f64::from(level) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    });
    let [r, g, b] = linear;
    let l = (0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b).cbrt();
    let m = (0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b).cbrt();
    let s = (0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b).cbrt();
    DVec3::new(
        0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
        1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
        0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
    )
}

/// Inverts [`oklab`], rounded.
fn from_oklab(lab: DVec3) -> Rgb {
    let l = (lab.x + 0.396_337_777_4 * lab.y + 0.215_803_757_3 * lab.z).powi(3);
    let m = (lab.x - 0.105_561_345_8 * lab.y - 0.063_854_172_8 * lab.z).powi(3);
    let s = (lab.x - 0.089_484_177_5 * lab.y - 1.291_485_548_0 * lab.z).powi(3);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    Rgb(linear.map(|v| {
        let v = v.clamp(0.0, 1.0);
        let level = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (level * 255.0).round() as u8
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oklab_leads_back_to_every_colour_tried() {
        for i in 0..4096u32 {
            let colour = Rgb([(i >> 8) * 17, (i >> 4 & 15) * 17, (i & 15) * 17].map(|v| v as u8));
            assert_eq!(from_oklab(oklab(colour)), colour);
        }
        assert!((oklab(Rgb::new(255, 255, 255)) - DVec3::X).length() < 1e-6);
    }

    #[test]
    fn a_palette_is_close_to_many_colours_and_keeps_a_rare_one() {
        let mut counts: Vec<(Rgb, u64)> = (0..32 * 32 * 32u32)
            .map(|i| (Rgb([i >> 10, i >> 5 & 31, i & 31].map(|v| (v * 4) as u8)), 100))
            .collect();
        counts.push((Rgb::new(255, 0, 255), 50));
        let colours = find(&counts, 255);
        assert!(colours.len() <= 255 && colours.len() > 240, "{}", colours.len());
        let centres: Vec<DVec3> = colours.iter().map(|c| oklab(*c)).collect();
        let error = |(colour, _): &(Rgb, u64)| {
            let at = oklab(*colour);
            centres[nearest(&centres, at)].distance(at)
        };
        let mean = counts.iter().map(error).sum::<f64>() / counts.len() as f64;
        // The colours fill a volume; 255 cells of it are some 0.02 wide in Oklab.
        assert!(mean < 0.03, "{mean}");
        assert!(error(&(Rgb::new(255, 0, 255), 50)) < 0.05);
        assert_eq!(colours, find(&counts, 255));
    }
}
