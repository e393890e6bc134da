//! Colours for labels: whole numbers that name parts of a body, such as tissues, instead of measuring them.

use glam::UVec3;

use super::volume::{Texts, Volume};
use crate::sculpture::Rgb;

/// Step from one hue to the next, as a fraction of the circle. Multiples of the golden ratio stay far apart for long.
const HUE_STEP: f32 = 0.618_034;
/// Saturation and brightness, in turn, so that close hues still differ.
const SHADES: [(f32, f32); 4] = [(0.62, 0.95), (0.85, 0.72), (0.40, 0.88), (0.72, 0.55)];

/// Returns the colours of the labels 0 to 255; they repeat from there on.
pub fn colours() -> [Rgb; 256] {
    std::array::from_fn(|label| {
        let (saturation, brightness) = SHADES[label % SHADES.len()];
        let hue = (label as f32 * HUE_STEP).fract() * 6.0;
        Rgb([5.0f32, 3.0, 1.0].map(|offset| {
            // Smith, Color gamut transform pairs, 1978.
            let k = (offset + hue) % 6.0;
            let fade = k.min(4.0 - k).clamp(0.0, 1.0);
            (brightness * (1.0 - saturation * fade) * 255.0).round() as u8
        }))
    })
}

/// Returns the colour of a label. Fractions are cut off.
#[inline]
pub fn colour(colours: &[Rgb; 256], label: f32) -> Rgb {
    colours[(label as i64 & 255) as usize]
}

/// Range of the number of distinct values in a volume that looks like labels.
const LABELS: std::ops::RangeInclusive<usize> = 3..=64;
const VOXELS_PER_LABEL: usize = 100;

/// Returns whether a volume holds only a few distinct whole numbers including 0, as labels do.
pub(crate) fn look_like_labels(volume: &Volume) -> bool {
    let bytes = volume.samples.bytes() as usize;
    if !volume.samples.is_density() {
        return false;
    }
    let (mut patterns, mut last): (Vec<&[u8]>, &[u8]) = (Vec::new(), &[]);
    for voxel in volume.data.chunks_exact(bytes) {
        if voxel != last && !patterns.contains(&voxel) {
            if patterns.len() == *LABELS.end() {
                return false;
            }
            patterns.push(voxel);
        }
        last = voxel;
    }
    let values = |voxel: &&[u8]| {
        let Volume { voxel_size, samples, .. } = *volume;
        let (dims, data, texts) = (UVec3::ONE, voxel.to_vec(), Texts::default());
        let one = Volume { dims, voxel_size, samples, data, texts };
        one.density(UVec3::ZERO).unwrap_or(f32::NAN)
    };
    let values: Vec<f32> = patterns.iter().map(values).collect();
    LABELS.contains(&values.len())
        && values.contains(&0.0)
        && values.iter().all(|value| *value >= 0.0 && value.fract() == 0.0)
        && volume.data.len() / bytes >= VOXELS_PER_LABEL * values.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_labels_of_a_file_can_be_told_apart() {
        let colours = colours();
        let distance = |a: Rgb, b: Rgb| -> i32 {
            a.0.iter().zip(b.0).map(|(a, b)| (i32::from(*a) - i32::from(b)).abs()).sum()
        };
        for a in 1..32 {
            for b in 1..a {
                let d = distance(colours[a], colours[b]);
                assert!(d >= 24, "{a} {} and {b} {}: {d}", colours[a], colours[b]);
            }
        }
        assert_eq!(colour(&colours, 3.7), colours[3]);
        assert_eq!(colour(&colours, 259.0), colours[3]);
        assert_eq!(colour(&colours, -1.0), colours[255]);
        assert_eq!(colour(&colours, f32::NAN), colours[0]);
    }
}
