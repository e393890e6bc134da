//! Options for volumes: which voxels exist, which volume and which part of the file is read, and whether it is
//! resampled to cubic voxels.

use std::fmt;
use std::num::NonZeroU32;
use std::str::FromStr;

use glam::UVec3;

use super::three;

/// The rule by which voxels of a volume exist in the sculpture.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub enum Existence {
    /// Densities: those of at least the automatic threshold; labels: all but 0; RGB: those that are not black; RGBA:
    /// those with an opacity of at least 128.
    #[default]
    Auto,
    /// Densities of at least this, in the units of the file. In colours it is compared with the opacity or, where there
    /// is none, with the maximum of red, green and blue.
    Threshold(f64),
    /// Densities in an inclusive range. For colours as [`Existence::Threshold`].
    Range(f64, f64),
}

impl Existence {
    /// Returns the least and the greatest density that exist; `None` where they are to be determined from the volume.
    pub fn bounds(self) -> Option<(f64, f64)> {
        match self {
            Existence::Auto => None,
            Existence::Threshold(least) => Some((least, f64::INFINITY)),
            Existence::Range(least, most) => Some((least, most)),
        }
    }
}

/// Writes `auto`, the threshold, or both as `300..1200`.
impl fmt::Display for Existence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Existence::Auto => f.write_str("auto"),
            Existence::Threshold(threshold) => write!(f, "{threshold}"),
            Existence::Range(least, most) => write!(f, "{least}..{most}"),
        }
    }
}

impl FromStr for Existence {
    type Err = String;

    fn from_str(text: &str) -> Result<Existence, String> {
        let number = |text: &str| text.trim().parse().ok().filter(|n: &f64| n.is_finite());
        if text == "auto" {
            return Ok(Existence::Auto);
        }
        let Some((least, most)) = text.split_once("..") else {
            let wrong = || {
                format!("`{text}` is not a threshold; use auto, a number, or two such as 300..1200")
            };
            return number(text).map(Existence::Threshold).ok_or_else(wrong);
        };
        match (number(least), number(most)) {
            (Some(least), Some(most)) if least <= most => Ok(Existence::Range(least, most)),
            (Some(_), Some(_)) => Err(format!("`{text}`: the lower threshold must come first")),
            _ => Err(format!("`{text}` must be two numbers, such as 300..1200")),
        }
    }
}

/// One of several channels or times of a file, counted from 1.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Ordinal(NonZeroU32);

impl Ordinal {
    /// Returns `None` for 0.
    pub fn new(number: u32) -> Option<Ordinal> {
        NonZeroU32::new(number).map(Ordinal)
    }

    /// Returns the number, 1 or more.
    pub fn get(self) -> u32 {
        self.0.get()
    }
}

impl fmt::Display for Ordinal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for Ordinal {
    type Err = String;

    fn from_str(text: &str) -> Result<Ordinal, String> {
        let number = text.parse().ok().and_then(Ordinal::new);
        number.ok_or_else(|| format!("`{text}` must be a whole number counted from 1, such as 2"))
    }
}

/// Whether a volume is resampled to cubic voxels.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub enum Cubic {
    /// Voxels keep their edges in the file.
    #[default]
    No,
    /// Resampled to the shortest edge of voxels in the file.
    Finest,
    /// Resampled to an edge in the file's unit of length: millimetres in scans.
    EdgeMm(f32),
}

/// Writes `no`, `finest` or `0.5mm`.
impl fmt::Display for Cubic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cubic::No => f.write_str("no"),
            Cubic::Finest => f.write_str("finest"),
            Cubic::EdgeMm(mm) => write!(f, "{mm}mm"),
        }
    }
}

impl FromStr for Cubic {
    type Err = String;

    fn from_str(text: &str) -> Result<Cubic, String> {
        match text {
            "no" => return Ok(Cubic::No),
            "finest" => return Ok(Cubic::Finest),
            _ => {}
        }
        let mm = text.strip_suffix("mm").and_then(|mm| mm.trim().parse().ok());
        mm.filter(|mm: &f32| mm.is_finite() && *mm > 0.0)
            .map(Cubic::EdgeMm)
            .ok_or_else(|| format!("`{text}` must be no, finest, or an edge such as 0.5mm"))
    }
}

/// A box of voxels of a file, counted from 0 along the axes of the file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ScanRegion {
    /// The lowest voxel.
    pub low: UVec3,
    /// The highest voxel, inclusive.
    pub high: UVec3,
}

impl ScanRegion {
    /// Returns the size in voxels.
    pub fn dims(&self) -> UVec3 {
        self.high - self.low + 1
    }
}

/// Writes `0,0,10..127,127,60`.
impl fmt::Display for ScanRegion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = (self.low, self.high);
        write!(f, "{},{},{}..{},{},{}", low.x, low.y, low.z, high.x, high.y, high.z)
    }
}

impl FromStr for ScanRegion {
    type Err = String;

    fn from_str(text: &str) -> Result<ScanRegion, String> {
        let ends = text.split_once("..").and_then(|(low, high)| {
            let (low, high) = (three::<u32>(low, ',')?, three::<u32>(high, ',')?);
            Some((UVec3::from(low), UVec3::from(high)))
        });
        let is_box =
            |(low, high): &(UVec3, UVec3)| low.cmple(*high).all() && high.max_element() < u32::MAX;
        ends.filter(is_box).map(|(low, high)| ScanRegion { low, high }).ok_or_else(|| {
            format!(
                "`{text}` must be the lowest and the highest voxel of the file, such as 0,0,10..127,127,60"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_forms_round_trip() {
        for text in ["auto", "127.5", "-1024", "300..1200", "-1000..-0.5", "7..7"] {
            assert_eq!(text.parse::<Existence>().map(|e| e.to_string()), Ok(text.to_string()));
        }
        for text in ["no", "finest", "0.5mm"] {
            assert_eq!(text.parse::<Cubic>().map(|c| c.to_string()), Ok(text.to_string()));
        }
        for text in ["1", "2", "4294967295"] {
            assert_eq!(text.parse::<Ordinal>().map(|n| n.to_string()), Ok(text.to_string()));
        }
        let text = "0,0,10..127,127,60";
        let region: ScanRegion = text.parse().unwrap();
        assert_eq!((region.to_string().as_str(), region.dims()), (text, UVec3::new(128, 128, 51)));
    }

    #[test]
    fn nonsense_is_explained() {
        for text in ["nan", "", "1..", "..2", "1..inf", "2..1", "1..2..3", "a..b"] {
            assert!(text.parse::<Existence>().is_err(), "{text}");
        }
        assert!("2..1".parse::<Existence>().unwrap_err().contains("lower threshold"));
        for text in ["", "0", "-1", "1.5", "two", "4294967296"] {
            assert!(text.parse::<Ordinal>().unwrap_err().contains("from 1"), "{text}");
        }
        for text in ["", "0mm", "-1mm", "nanmm", "5", "yes"] {
            assert!(text.parse::<Cubic>().unwrap_err().contains("finest"), "{text}");
        }
        for text in
            ["", "1,2,3", "1,2..3,4", "5,0,0..4,9,9", "-1,0,0..2,2,2", "0,0,0..4294967295,1,1"]
        {
            assert!(text.parse::<ScanRegion>().unwrap_err().contains("lowest"), "{text}");
        }
    }
}
