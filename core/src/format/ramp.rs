//! Colour ramps for densities: grey, or the tissues of a body.

use crate::sculpture::Rgb;

/// Colours from the least dense existing voxel to the densest, evenly spaced. The ramp starts above black, so that a
/// surface at the threshold is not dark.
const GREY: [Rgb; 2] = [Rgb::new(112, 112, 112), Rgb::new(255, 255, 255)];
/// Skin, fat, flesh, bone, teeth, in their order in a head CT.
const TISSUE: [Rgb; 6] = [
    Rgb::new(222, 178, 148),
    Rgb::new(214, 150, 118),
    Rgb::new(170, 84, 70),
    Rgb::new(214, 190, 150),
    Rgb::new(236, 224, 196),
    Rgb::new(255, 252, 244),
];

/// Colours by density over a range.
#[derive(Clone, Debug)]
pub struct Ramp {
    from: f32,
    colours_per_unit: f32,
    colours: [Rgb; 256],
}

impl Ramp {
    /// Returns a grey ramp as in black-and-white photographs: the brighter, the denser.
    pub fn grey(from: f64, to: f64) -> Ramp {
        Ramp::new(&GREY, from, to)
    }

    /// Returns a ramp of tissues: skin over flesh over bone.
    pub fn tissue(from: f64, to: f64) -> Ramp {
        Ramp::new(&TISSUE, from, to)
    }

    fn new(stops: &[Rgb], from: f64, to: f64) -> Ramp {
        let colours = std::array::from_fn(|i| {
            let place = i as f32 / 255.0 * (stops.len() - 1) as f32;
            let stop = (place as usize).min(stops.len() - 2);
            let (a, b, t) = (stops[stop].0, stops[stop + 1].0, place - stop as f32);
            Rgb(std::array::from_fn(|c| {
                (f32::from(a[c]) * (1.0 - t) + f32::from(b[c]) * t).round() as u8
            }))
        });
        let range = to - from;
        // An empty range maps all densities to its end.
        let colours_per_unit = if range > 0.0 { 255.0 / range } else { 1e9 };
        Ramp { from: from as f32, colours_per_unit: colours_per_unit as f32, colours }
    }

    /// Returns the colour of a density, clamped to the range.
    #[inline]
    pub fn colour(&self, density: f32) -> Rgb {
        // The cast maps everything below 0 to 0.
        let place = (density - self.from) * self.colours_per_unit + 0.5;
        self.colours[(place as usize).min(255)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_range_are_the_ends_of_the_colours() {
        for (ramp, stops) in
            [(Ramp::grey(40.0, 240.0), &GREY[..]), (Ramp::tissue(40.0, 240.0), &TISSUE[..])]
        {
            for (density, stop) in
                [(-1e9, 0), (40.0, 0), (240.0, stops.len() - 1), (1e9, stops.len() - 1)]
            {
                assert_eq!(ramp.colour(density), stops[stop], "{density}");
            }
        }
        assert_eq!(Ramp::grey(7.0, 7.0).colour(8.0), GREY[1]);
    }

    #[test]
    fn denser_is_never_darker_in_grey() {
        let ramp = Ramp::grey(0.0, 255.0);
        assert!((0..255).all(|v| ramp.colour(v as f32).0 <= ramp.colour(v as f32 + 1.0).0));
    }
}
