//! The default palette of MagicaVoxel files without one.

use crate::sculpture::Rgb;

/// Returns the palette: entry 0 is no voxel; then follow a cube of six levels per channel except black, and ramps of
/// red, green, blue and grey.
pub(crate) fn default_palette() -> [Rgb; 256] {
    const LEVELS: [u8; 6] = [255, 204, 153, 102, 51, 0];
    const RAMP: [u8; 10] = [0xee, 0xdd, 0xbb, 0xaa, 0x88, 0x77, 0x55, 0x44, 0x22, 0x11];
    let cube = (0..215).map(|i| Rgb([LEVELS[i / 36], LEVELS[i / 6 % 6], LEVELS[i % 6]]));
    let ramps = (0..40).map(|i| {
        let level = RAMP[i % 10];
        let channels = [!(10..30).contains(&i), (10..20).contains(&i) || i >= 30, i >= 20];
        Rgb(channels.map(|on| if on { level } else { 0 }))
    });
    let mut palette = [Rgb::default(); 256];
    palette[1..].iter_mut().zip(cube.chain(ramps)).for_each(|(to, from)| *to = from);
    palette
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_entries_are_right() {
        let palette = default_palette();
        for (index, colour) in [
            (1, "#ffffff"),
            (2, "#ffffcc"),
            (7, "#ffccff"),
            (215, "#000033"),
            (216, "#ee0000"),
            (226, "#00ee00"),
            (236, "#0000ee"),
            (246, "#eeeeee"),
            (255, "#111111"),
        ] {
            assert_eq!(palette[index].to_string(), colour, "{index}");
        }
    }
}
