//! Colours for labels: whole numbers that name parts of a body, such as tissues, instead of measuring them.

use crate::sculpture::Rgb;

/// From a hue to the next, as a share of the circle. Steps of the golden ratio never come near one another soon.
const HUE_STEP: f32 = 0.618_034;
/// Saturation and brightness, in turn, so that hues that are close after all differ otherwise.
const SHADES: [(f32, f32); 4] = [(0.62, 0.95), (0.85, 0.72), (0.40, 0.88), (0.72, 0.55)];

/// The colours of the labels 0 to 255; they repeat from there on.
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

/// The colour of a label. Fractions are cut off.
#[inline]
pub fn colour(colours: &[Rgb; 256], label: f32) -> Rgb {
    colours[(label as i64 & 255) as usize]
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
