//! A volume: voxel samples in memory in the layout of files, between file and sculpture.

use std::fmt;
use std::str::FromStr;

use glam::{UVec2, UVec3, Vec3};

/// Sample type of a volume.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Samples {
    /// One unsigned byte.
    U8,
    /// Two bytes, unsigned, little-endian.
    U16Le,
    /// Two bytes, unsigned, big-endian.
    U16Be,
    /// Two bytes, signed, little-endian.
    I16Le,
    /// Two bytes, signed, big-endian.
    I16Be,
    /// IEEE 754 single precision, little-endian.
    F32Le,
    /// IEEE 754 single precision, big-endian.
    F32Be,
    /// Red, green, blue, a byte each.
    Rgb8,
    /// Red, green, blue, opacity, a byte each.
    Rgba8,
    /// Any number of bytes without a known meaning.
    Bytes(u32),
}

impl Samples {
    /// The types with a name, in the order of the manual.
    pub const NAMED: [(Samples, &'static str); 9] = [
        (Samples::U8, "u8"),
        (Samples::U16Le, "u16le"),
        (Samples::U16Be, "u16be"),
        (Samples::I16Le, "i16le"),
        (Samples::I16Be, "i16be"),
        (Samples::F32Le, "f32le"),
        (Samples::F32Be, "f32be"),
        (Samples::Rgb8, "rgb8"),
        (Samples::Rgba8, "rgba8"),
    ];

    /// Returns the usual sample type of a PVM volume with that many components (bytes per voxel).
    pub fn of_components(components: u32) -> Samples {
        match components {
            1 => Samples::U8,
            2 => Samples::U16Be,
            3 => Samples::Rgb8,
            4 => Samples::Rgba8,
            n => Samples::Bytes(n),
        }
    }

    /// Returns the bytes per voxel.
    pub fn bytes(self) -> u32 {
        match self {
            Samples::U8 => 1,
            Samples::U16Le | Samples::U16Be | Samples::I16Le | Samples::I16Be => 2,
            Samples::Rgb8 => 3,
            Samples::F32Le | Samples::F32Be | Samples::Rgba8 => 4,
            Samples::Bytes(n) => n,
        }
    }

    /// Returns whether a voxel holds one number.
    pub fn is_density(self) -> bool {
        !matches!(self, Samples::Rgb8 | Samples::Rgba8 | Samples::Bytes(_))
    }
}

/// Writes the name as [`Samples::from_str`] reads it, or "bytes xN".
impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match Samples::NAMED.iter().find(|(s, _)| s == self) {
            Some((_, name)) => f.write_str(name),
            None => write!(f, "bytes x{}", self.bytes()),
        }
    }
}

impl FromStr for Samples {
    type Err = String;

    fn from_str(text: &str) -> Result<Samples, String> {
        let known = Samples::NAMED.iter().find(|(_, name)| *name == text);
        known.map(|(s, _)| *s).ok_or_else(|| {
            let names = Samples::NAMED.map(|(_, name)| name).join(", ");
            format!("`{text}` is not a voxel type; use one of {names}")
        })
    }
}

/// The four texts of a PVM3 file. Their encoding is not declared; old files are Latin-1.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Texts {
    /// The subject of the volume.
    pub description: Vec<u8>,
    /// Its source.
    pub courtesy: Vec<u8>,
    /// Its acquisition.
    pub parameter: Vec<u8>,
    /// Anything else.
    pub comment: Vec<u8>,
}

impl Texts {
    /// Returns the texts with their names, in the order of the file.
    pub fn named(&self) -> [(&'static str, &[u8]); 4] {
        [
            ("description", &self.description),
            ("courtesy", &self.courtesy),
            ("parameter", &self.parameter),
            ("comment", &self.comment),
        ]
    }

    /// Returns whether no text was stored.
    pub fn is_empty(&self) -> bool {
        self.named().iter().all(|(_, text)| text.is_empty())
    }

    /// Returns a text for display: decoded as UTF-8, else as Latin-1. Control characters other than line ends are
    /// replaced, since a file must not control a terminal.
    pub fn legible(text: &[u8]) -> String {
        let clean = |c: char| match c {
            '\n' => c,
            c if c.is_control() => char::REPLACEMENT_CHARACTER,
            c => c,
        };
        match std::str::from_utf8(text) {
            Ok(text) => text.chars().map(clean).collect(),
            Err(_) => text.iter().map(|&b| clean(char::from(b))).collect(),
        }
    }
}

/// Voxels as stored in a file: x fastest, then y, then z.
#[derive(Clone, PartialEq, Debug)]
pub struct Volume {
    /// Size in voxels.
    pub dims: UVec3,
    /// Edge lengths of a voxel.
    pub voxel_size: Vec3,
    /// Type of a voxel's value.
    pub samples: Samples,
    /// `dims` times [`Samples::bytes`] bytes.
    pub data: Vec<u8>,
    /// The texts stored with it.
    pub texts: Texts,
}

impl Volume {
    /// Returns the byte index of the voxel (x, y, z).
    #[inline(always)]
    pub fn offset(&self, x: u32, y: u32, z: u32) -> usize {
        let row = y as usize + self.dims.y as usize * z as usize;
        (x as usize + self.dims.x as usize * row) * self.samples.bytes() as usize
    }

    /// Returns size and densities of the slice at `at` across an axis (0 to 2), the lower of the other two axes
    /// fastest, for previews. `None` outside the volume, and for a volume of colours.
    pub fn slice(&self, axis: usize, at: u32) -> Option<(UVec2, Vec<f32>)> {
        let inside = self.samples.is_density() && axis < 3 && at < self.dims[axis];
        let (u, v) = inside.then_some(([1, 0, 0][axis], [2, 2, 1][axis]))?;
        let size = UVec2::new(self.dims[u], self.dims[v]);
        let mut densities = Vec::with_capacity(size.element_product() as usize);
        let mut voxel = UVec3::ZERO;
        voxel[axis] = at;
        for j in 0..size.y {
            voxel[v] = j;
            for i in 0..size.x {
                voxel[u] = i;
                densities.push(self.density(voxel)?);
            }
        }
        Some((size, densities))
    }

    /// Returns the density of a voxel inside the volume; `None` in a volume of colours.
    pub fn density(&self, UVec3 { x, y, z }: UVec3) -> Option<f32> {
        let bytes = self.data.get(self.offset(x, y, z)..)?;
        match self.samples {
            Samples::U8 => bytes.first().map(|v| f32::from(*v)),
            Samples::U16Le => bytes.first_chunk().map(|v| u16::from_le_bytes(*v).into()),
            Samples::U16Be => bytes.first_chunk().map(|v| u16::from_be_bytes(*v).into()),
            Samples::I16Le => bytes.first_chunk().map(|v| i16::from_le_bytes(*v).into()),
            Samples::I16Be => bytes.first_chunk().map(|v| i16::from_be_bytes(*v).into()),
            Samples::F32Le => bytes.first_chunk().map(|v| f32::from_le_bytes(*v)),
            Samples::F32Be => bytes.first_chunk().map(|v| f32::from_be_bytes(*v)),
            Samples::Rgb8 | Samples::Rgba8 | Samples::Bytes(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_command_a_terminal() {
        assert_eq!(Texts::legible(b"a\x1b[2Jb\nc\x07"), "a\u{FFFD}[2Jb\nc\u{FFFD}");
        assert_eq!(Texts::legible("Rämpe ü".as_bytes()), "Rämpe ü");
        assert_eq!(Texts::legible(b"Rampe \xfc \x9b1m"), "Rampe ü \u{FFFD}1m");
    }

    #[test]
    fn names_of_samples_round_trip() {
        for (samples, name) in Samples::NAMED {
            assert_eq!(samples.to_string(), name);
            assert_eq!(name.parse(), Ok(samples));
        }
        assert!("u32".parse::<Samples>().unwrap_err().contains("u16le"));
    }
}
