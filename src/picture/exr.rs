//! Pictures of linear light as OpenEXR files: one part, scan lines, no compression.
//!
//! Turns named channels into the bytes of a file, as described in "OpenEXR File Layout". Half floats hold light and
//! directions, floats distances. It needs no crate, since reading and compressing, which are most of the format, are
//! not needed. Knows no pictures beyond their numbers.

use glam::UVec2;

/// The numbers of a channel, row by row from the top.
#[derive(Debug)]
pub enum Samples {
    Half(Vec<f32>),
    Float(Vec<f32>),
}

/// A channel. Programs group those of a layer by the name before the dot.
#[derive(Debug)]
pub struct Channel {
    pub name: &'static str,
    pub samples: Samples,
}

const MAGIC: u32 = 20_000_630;
const VERSION: u32 = 2;

/// The largest finite half float.
const MAX_HALF: f32 = 65_504.0;

/// Returns the bytes of a file; every channel has a value for each of the pixels of `size`.
pub fn encoded(size: UVec2, mut channels: Vec<Channel>) -> Vec<u8> {
    // The order that the format requires.
    channels.sort_by_key(|channel| channel.name);
    let mut file = Vec::new();
    put(&mut file, MAGIC);
    put(&mut file, VERSION);
    header(&mut file, size, &channels);
    let (width, height) = (size.x as usize, size.y as usize);
    let row_bytes: usize = channels.iter().map(|channel| channel.samples.bytes() * width).sum();
    // The offset of each row, with its number and length.
    let first = file.len() + height * 8;
    let block = 8 + row_bytes;
    for y in 0..height {
        file.extend(((first + y * block) as u64).to_le_bytes());
    }
    file.reserve(height * block);
    for y in 0..height {
        put(&mut file, y as u32);
        put(&mut file, row_bytes as u32);
        for channel in &channels {
            channel.samples.put_row(&mut file, y * width..(y + 1) * width);
        }
    }
    file
}

fn put(file: &mut Vec<u8>, value: u32) {
    file.extend(value.to_le_bytes());
}

fn header(file: &mut Vec<u8>, size: UVec2, channels: &[Channel]) {
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            file.extend(text.as_bytes());
            file.push(0);
        }
        put(file, value.len() as u32);
        file.extend(value);
    };
    let mut list = Vec::new();
    for Channel { name, samples } in channels {
        list.extend(name.as_bytes());
        list.push(0);
        // The type of pixels, no matter whether linear, sampled at every pixel.
        for value in [samples.kind(), 0, 1, 1] {
            put(&mut list, value);
        }
    }
    list.push(0);
    let window: Vec<u8> =
        [0, 0, size.x - 1, size.y - 1].into_iter().flat_map(u32::to_le_bytes).collect();
    let one = 1f32.to_le_bytes();
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &one);
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &one);
    file.push(0);
}

impl Samples {
    /// Returns the format's number of the type.
    fn kind(&self) -> u32 {
        match self {
            Samples::Half(_) => 1,
            Samples::Float(_) => 2,
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Samples::Half(_) => 2,
            Samples::Float(_) => 4,
        }
    }

    fn put_row(&self, file: &mut Vec<u8>, pixels: std::ops::Range<usize>) {
        match self {
            Samples::Half(values) => {
                file.extend(values[pixels].iter().flat_map(|v| half(*v).to_le_bytes()));
            }
            Samples::Float(values) => {
                file.extend(values[pixels].iter().flat_map(|v| v.to_le_bytes()));
            }
        }
    }
}

/// Returns the nearest half float, with ties to even; too large values become the largest finite one.
fn half(value: f32) -> u16 {
    let sign = (value.to_bits() >> 16) as u16 & 0x8000;
    if value.is_nan() {
        return sign | 0x7E00;
    }
    let bits = value.abs().min(MAX_HALF).to_bits();
    let exponent = (bits >> 23) as i32 - 127;
    // Below 2^-14 the steps are even.
    let dropped = if exponent < -14 { 13 + (-14 - exponent) } else { 13 };
    if dropped > 24 {
        return sign;
    }
    let mantissa = bits & 0x007F_FFFF | 0x0080_0000;
    let rounding = (1 << (dropped - 1)) - 1 + (mantissa >> dropped & 1);
    let steps = (mantissa + rounding) >> dropped;
    // The leading bit of a normal number adds one to the exponent.
    let base = if exponent < -14 { 0 } else { (exponent + 14) as u32 };
    sign | ((base << 10) + steps) as u16
}

#[cfg(test)]
pub(super) mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Returns the number of a half float, by its definition.
    fn number(half: u16) -> f64 {
        let (exponent, mantissa) = (i32::from(half >> 10 & 31), f64::from(half & 0x3FF));
        let size = match exponent {
            0 => mantissa * 2f64.powi(-24),
            _ => (1.0 + mantissa / 1024.0) * 2f64.powi(exponent - 15),
        };
        if half >> 15 == 1 { -size } else { size }
    }

    /// Reads a file of the kind written here.
    pub fn read(file: &[u8]) -> (UVec2, BTreeMap<String, Vec<f64>>) {
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap());
        let text = |at: &mut usize| {
            let length = file[*at..].iter().position(|byte| *byte == 0).unwrap();
            let text = String::from_utf8(file[*at..*at + length].to_vec()).unwrap();
            *at += length + 1;
            text
        };
        assert_eq!((word(0), word(4)), (MAGIC, VERSION));
        let mut at = 8;
        let mut attributes = BTreeMap::new();
        loop {
            let name = text(&mut at);
            if name.is_empty() {
                break;
            }
            let kind = text(&mut at);
            let length = word(at) as usize;
            attributes.insert(name, (kind, at + 4, length));
            at += 4 + length;
        }
        let (_, window, 16) = attributes["dataWindow"] else { panic!("four numbers") };
        let size = UVec2::new(word(window + 8) + 1, word(window + 12) + 1);
        let (_, mut list, _) = attributes["channels"];
        let mut channels = Vec::new();
        while file[list] != 0 {
            let name = text(&mut list);
            channels.push((name, word(list)));
            list += 16;
        }
        let sorted = channels.windows(2).all(|pair| pair[0].0 < pair[1].0);
        assert!(sorted, "{channels:?}");
        let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for y in 0..size.y as usize {
            let offset = u64::from_le_bytes(file[at + 8 * y..at + 8 * y + 8].try_into().unwrap());
            let mut place = offset as usize;
            assert_eq!(word(place), y as u32);
            let end = place + 8 + word(place + 4) as usize;
            place += 8;
            for (name, kind) in &channels {
                let row = values.entry(name.clone()).or_default();
                for _ in 0..size.x {
                    let bytes = if *kind == 1 { 2 } else { 4 };
                    row.push(match kind {
                        1 => number(u16::from_le_bytes([file[place], file[place + 1]])),
                        _ => f64::from(f32::from_bits(word(place))),
                    });
                    place += bytes;
                }
            }
            assert_eq!(place, end);
            assert!(y + 1 < size.y as usize || end == file.len());
        }
        (size, values)
    }

    #[test]
    fn a_file_has_what_was_written() {
        let size = UVec2::new(3, 2);
        let red = vec![0.0, 0.5, 1.0, -2.0, 1e6, 3e-6];
        let depth = vec![1.25e-7, 2.0, 3.0, 4.0, 5.0, 1e30];
        let file = encoded(
            size,
            vec![
                Channel { name: "Z", samples: Samples::Float(depth.clone()) },
                Channel { name: "R", samples: Samples::Half(red) },
            ],
        );
        let (found, channels) = read(&file);
        assert_eq!(found, size);
        assert_eq!(channels["Z"], depth.iter().map(|v| f64::from(*v)).collect::<Vec<_>>());
        let red = &channels["R"];
        assert_eq!(red[..5], [0.0, 0.5, 1.0, -2.0, 65_504.0]);
        assert!((red[5] - 3e-6).abs() <= 2f64.powi(-25), "{}", red[5]);
    }

    #[test]
    fn halves_are_the_nearest_ones() {
        for bits in 0..0x7C00u16 {
            let exact = number(bits) as f32;
            assert_eq!((half(exact), half(-exact)), (bits, bits | 0x8000));
            // The middle to the next one rounds to even.
            if bits < 0x7BFF {
                let middle = ((number(bits) + number(bits + 1)) / 2.0) as f32;
                assert_eq!(half(middle), bits + (bits & 1), "{bits:x}");
                assert_eq!(half(middle * 1.000_001), bits + 1);
            }
        }
        assert_eq!((half(f32::INFINITY), half(f32::NAN)), (0x7BFF, 0x7E00));
    }
}
