//! Colour values: 24-bit sRGB, and its packing into the 8 or 16 bits that a sculpture may store per voxel. Green gets
//! the most bits, since the eye resolves it best.

use std::fmt;
use std::str::FromStr;

/// A 24-bit sRGB colour.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Rgb(pub [u8; 3]);

impl Rgb {
    /// The default base colour.
    pub const STONE: Rgb = Rgb::new(0xc8, 0xbe, 0xaa);

    /// Returns a colour from its channels.
    pub const fn new(r: u8, g: u8, b: u8) -> Rgb {
        Rgb([r, g, b])
    }
}

/// Writes `#rrggbb`.
impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// Reads `#rrggbb`.
impl FromStr for Rgb {
    type Err = String;

    fn from_str(text: &str) -> Result<Rgb, String> {
        let digits = text
            .strip_prefix('#')
            .filter(|d| d.len() == 6 && d.bytes().all(|c| c.is_ascii_hexdigit()));
        let value = digits.and_then(|d| u32::from_str_radix(d, 16).ok());
        match value {
            Some(v) => Ok(Rgb([(v >> 16) as u8, (v >> 8) as u8, v as u8])),
            None => Err(format!("`{text}` is not a colour; write it as #rrggbb")),
        }
    }
}

/// Bits of colour stored per voxel, chosen when a sculpture is made.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum ColourDepth {
    /// One colour for the whole sculpture.
    None,
    /// G 4, B 2, R 2 bits, green in the highest bits.
    Bits8,
    /// G 7, B 5, R 4 bits, green in the highest bits.
    Bits16,
    /// R, G, B, a byte each.
    #[default]
    Bits24,
}

impl ColourDepth {
    /// All depths, in ascending order.
    pub const ALL: [ColourDepth; 4] =
        [ColourDepth::None, ColourDepth::Bits8, ColourDepth::Bits16, ColourDepth::Bits24];

    /// Returns the bits per voxel.
    pub const fn bits(self) -> u32 {
        match self {
            ColourDepth::None => 0,
            ColourDepth::Bits8 => 8,
            ColourDepth::Bits16 => 16,
            ColourDepth::Bits24 => 24,
        }
    }

    /// Returns the bytes per voxel.
    pub const fn bytes(self) -> usize {
        self.bits() as usize / 8
    }

    /// Returns the depth of `bits` bits, if there is one.
    pub fn from_bits(bits: u32) -> Option<ColourDepth> {
        Self::ALL.into_iter().find(|d| d.bits() == bits)
    }

    /// Returns the colour that is read back after storing `colour` at this depth. Without colour depth, returns
    /// `colour` itself, since it is then the sculpture's one colour.
    pub fn quantise(self, colour: Rgb) -> Rgb {
        match self {
            ColourDepth::None | ColourDepth::Bits24 => colour,
            ColourDepth::Bits8 => unpack8(pack8(colour)),
            ColourDepth::Bits16 => unpack16(pack16(colour)),
        }
    }

    /// Returns the difference between neighbouring levels of red, green and blue.
    pub fn step(self) -> [f32; 3] {
        let bits: [u32; 3] = match self {
            ColourDepth::None | ColourDepth::Bits24 => [8, 8, 8],
            ColourDepth::Bits16 => [4, 7, 5],
            ColourDepth::Bits8 => [2, 4, 2],
        };
        bits.map(|bits| 255.0 / ((1u32 << bits) - 1) as f32)
    }

    /// Writes `colour` to the first [`ColourDepth::bytes`] bytes of `out` (16 bits little-endian).
    #[inline]
    pub fn write(self, colour: Rgb, out: &mut [u8]) {
        match self {
            ColourDepth::None => {}
            ColourDepth::Bits8 => out[0] = pack8(colour),
            ColourDepth::Bits16 => out[..2].copy_from_slice(&pack16(colour).to_le_bytes()),
            ColourDepth::Bits24 => out[..3].copy_from_slice(&colour.0),
        }
    }

    /// Performs the inverse of [`ColourDepth::write`]. Returns black without colour depth.
    #[inline]
    pub fn read(self, bytes: &[u8]) -> Rgb {
        match self {
            ColourDepth::None => Rgb::default(),
            ColourDepth::Bits8 => unpack8(bytes[0]),
            ColourDepth::Bits16 => unpack16(u16::from_le_bytes([bytes[0], bytes[1]])),
            ColourDepth::Bits24 => Rgb([bytes[0], bytes[1], bytes[2]]),
        }
    }
}

/// Packs 24-bit RGB into `GGGGBBRR`, each channel rounded to the nearest level.
pub(crate) fn pack8(Rgb([r, g, b]): Rgb) -> u8 {
    (reduce(g, 4) << 4 | reduce(b, 2) << 2 | reduce(r, 2)) as u8
}

/// Unpacks `GGGGBBRR` to 24-bit RGB over the full range of each channel.
pub(crate) fn unpack8(v: u8) -> Rgb {
    let v = u32::from(v);
    Rgb([expand(v & 3, 2), expand(v >> 4, 4), expand(v >> 2 & 3, 2)])
}

/// Packs 24-bit RGB into `GGGGGGGBBBBBRRRR`, each channel rounded to the nearest level.
pub(crate) fn pack16(Rgb([r, g, b]): Rgb) -> u16 {
    (reduce(g, 7) << 9 | reduce(b, 5) << 4 | reduce(r, 4)) as u16
}

/// Unpacks `GGGGGGGBBBBBRRRR` to 24-bit RGB over the full range of each channel.
pub(crate) fn unpack16(v: u16) -> Rgb {
    let v = u32::from(v);
    Rgb([expand(v & 15, 4), expand(v >> 9, 7), expand(v >> 4 & 31, 5)])
}

fn reduce(channel: u8, bits: u32) -> u32 {
    let max = (1 << bits) - 1;
    (u32::from(channel) * max + 127) / 255
}

fn expand(level: u32, bits: u32) -> u8 {
    let max = (1 << bits) - 1;
    ((level * 255 + max / 2) / max) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_packed_value_survives_unpacking() {
        assert!((0..=u8::MAX).all(|v| pack8(unpack8(v)) == v));
        assert!((0..=u16::MAX).all(|v| pack16(unpack16(v)) == v));
    }

    #[test]
    fn packing_puts_green_highest_and_reaches_both_ends() {
        assert_eq!(pack8(Rgb::new(0, 255, 0)), 0b1111_0000);
        assert_eq!(pack8(Rgb::new(0, 0, 255)), 0b0000_1100);
        assert_eq!(pack8(Rgb::new(255, 0, 0)), 0b0000_0011);
        assert_eq!(pack16(Rgb::new(0, 255, 0)), 0b1111_1110_0000_0000);
        assert_eq!(pack16(Rgb::new(0, 0, 255)), 0b0000_0001_1111_0000);
        assert_eq!(pack16(Rgb::new(255, 0, 0)), 0b0000_0000_0000_1111);
        for depth in ColourDepth::ALL {
            for ends in [Rgb::new(0, 0, 0), Rgb::new(255, 255, 255)] {
                assert_eq!(depth.quantise(ends), ends);
            }
        }
    }

    #[test]
    fn write_then_read_is_quantise() {
        let colour = Rgb::new(200, 131, 77);
        for depth in [ColourDepth::Bits8, ColourDepth::Bits16, ColourDepth::Bits24] {
            let mut bytes = [0; 3];
            depth.write(colour, &mut bytes);
            assert_eq!(depth.read(&bytes), depth.quantise(colour));
        }
    }

    #[test]
    fn text_form_round_trips_and_rejects_nonsense() {
        let colour = Rgb::new(1, 171, 254);
        assert_eq!(colour.to_string().parse::<Rgb>(), Ok(colour));
        for bad in ["", "#12345", "#1234567", "123456", "#12é45", "#+12345"] {
            assert!(bad.parse::<Rgb>().is_err(), "{bad}");
        }
    }
}
