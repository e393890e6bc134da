//! The number types of scans, and their conversion to the samples of a volume: types that a sculpture's volumes support
//! stay as they are, everything else becomes 32-bit floating point.

use glam::UVec3;

use crate::format::budget::check_budget;
use crate::format::volume::Samples;
use crate::format::{FormatError, Volume};

/// Numbers as they are stored.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
    /// Three bytes: red, green, blue.
    Rgb,
    /// Four bytes: red, green, blue, opacity.
    Rgba,
}

/// Calls `$go` with a function that reads a number as f64 from its bytes.
macro_rules! with_number {
    ($number:expr, $big:expr, $go:expr) => {
        match $number {
            Number::U8 | Number::Rgb | Number::Rgba => $go(1, &|b| f64::from(b[0])),
            Number::I8 => $go(1, &|b| f64::from(b[0] as i8)),
            Number::I16 => $go(2, &|b| f64::from(i16::from_le_bytes(taken(b, $big)))),
            Number::U16 => $go(2, &|b| f64::from(u16::from_le_bytes(taken(b, $big)))),
            Number::I32 => $go(4, &|b| f64::from(i32::from_le_bytes(taken(b, $big)))),
            Number::U32 => $go(4, &|b| f64::from(u32::from_le_bytes(taken(b, $big)))),
            Number::I64 => $go(8, &|b| i64::from_le_bytes(taken(b, $big)) as f64),
            Number::U64 => $go(8, &|b| u64::from_le_bytes(taken(b, $big)) as f64),
            Number::F32 => $go(4, &|b| f64::from(f32::from_le_bytes(taken(b, $big)))),
            Number::F64 => $go(8, &|b| f64::from_le_bytes(taken(b, $big))),
        }
    };
}

impl Number {
    /// Returns the bytes of a voxel.
    pub fn bytes(self) -> u64 {
        match self {
            Number::I8 | Number::U8 => 1,
            Number::I16 | Number::U16 => 2,
            Number::Rgb => 3,
            Number::I32 | Number::U32 | Number::F32 | Number::Rgba => 4,
            Number::I64 | Number::U64 | Number::F64 => 8,
        }
    }

    /// Returns the bytes of all voxels. An error if they and the samples made of them do not fit into `budget_bytes`.
    pub fn check(self, dims: UVec3, budget_bytes: u64) -> Result<u64, FormatError> {
        let [x, y, z] = dims.to_array().map(u64::from);
        let count = x.checked_mul(y).and_then(|n| n.checked_mul(z));
        let total = count.and_then(|n| n.checked_mul(self.bytes() + 4)).unwrap_or(u64::MAX);
        check_budget(total, budget_bytes)?;
        Ok(total / (self.bytes() + 4) * self.bytes())
    }

    /// Returns the numbers of samples, and whether their first byte is the highest; `None` for bytes without a meaning.
    pub(crate) fn of(samples: Samples) -> Option<(Number, bool)> {
        Some(match samples {
            Samples::U8 => (Number::U8, false),
            Samples::U16Le => (Number::U16, false),
            Samples::U16Be => (Number::U16, true),
            Samples::I16Le => (Number::I16, false),
            Samples::I16Be => (Number::I16, true),
            Samples::F32Le => (Number::F32, false),
            Samples::F32Be => (Number::F32, true),
            Samples::Rgb8 => (Number::Rgb, false),
            Samples::Rgba8 => (Number::Rgba, false),
            Samples::Bytes(_) => return None,
        })
    }

    /// Returns the bytes of a volume of these numbers.
    pub(crate) fn volume_bytes(self, dims: UVec3) -> u64 {
        let sizes = dims.to_array().map(u64::from);
        sizes.into_iter().fold(self.bytes(), u64::saturating_mul)
    }

    /// Returns the sample type that holds these numbers unchanged.
    pub(crate) fn same(self, is_big: bool) -> Option<Samples> {
        Some(match (self, is_big) {
            (Number::U8, _) => Samples::U8,
            (Number::I16, false) => Samples::I16Le,
            (Number::I16, true) => Samples::I16Be,
            (Number::U16, false) => Samples::U16Le,
            (Number::U16, true) => Samples::U16Be,
            (Number::F32, false) => Samples::F32Le,
            (Number::F32, true) => Samples::F32Be,
            (Number::Rgb, _) => Samples::Rgb8,
            (Number::Rgba, _) => Samples::Rgba8,
            _ => return None,
        })
    }

    /// Converts numbers to samples, each times a slope plus an intercept. Whole numbers that fit 16 bits stay whole.
    pub(crate) fn into_samples(
        self,
        data: Vec<u8>,
        is_big: bool,
        scale: [f64; 2],
    ) -> (Samples, Vec<u8>) {
        if self.is_kept(scale)
            && let Some(samples) = self.same(is_big)
        {
            return (samples, data);
        }
        let samples = self
            .samples_unless_small(is_big, scale)
            .unwrap_or_else(|| Number::samples_of_range(self.range(&data, is_big, scale)));
        let mut out = Vec::new();
        self.convert(&data, is_big, scale, samples, &mut out);
        (samples, out)
    }

    fn is_colour(self) -> bool {
        matches!(self, Number::Rgb | Number::Rgba)
    }

    /// Returns whether the scale changes no number.
    pub(crate) fn is_kept(self, scale: [f64; 2]) -> bool {
        scale == [1.0, 0.0] || self.is_colour()
    }

    /// Returns the samples of numbers, each times a slope plus an intercept; `None` if they depend on the range of whole
    /// numbers that may fit 16 bits ([`Number::samples_of_range`]).
    pub(crate) fn samples_unless_small(self, is_big: bool, scale: [f64; 2]) -> Option<Samples> {
        let same = self.same(is_big).filter(|_| self.is_kept(scale));
        let is_small = matches!(self, Number::I8 | Number::U8 | Number::I16 | Number::U16);
        let is_whole = scale.iter().all(|part| part.fract() == 0.0);
        same.or((!is_small || !is_whole).then_some(Samples::F32Le))
    }

    /// Returns the samples of whole numbers of a range.
    pub(crate) fn samples_of_range((least, most): (f64, f64)) -> Samples {
        match least >= f64::from(i16::MIN) && most <= f64::from(i16::MAX) {
            true => Samples::I16Le,
            false => Samples::F32Le,
        }
    }

    /// Returns the least and the greatest of numbers, each times `slope` plus `intercept`.
    pub(crate) fn range(
        self,
        data: &[u8],
        is_big: bool,
        [slope, intercept]: [f64; 2],
    ) -> (f64, f64) {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        with_number!(self, is_big, |bytes: usize, read: &dyn Fn(&[u8]) -> f64| {
            for number in data.chunks_exact(bytes) {
                let value = read(number) * slope + intercept;
                (least, most) = (least.min(value), most.max(value));
            }
        });
        (least, most)
    }

    /// Appends numbers, each times `slope` plus `intercept`, to `out` as [`Samples::I16Le`] or else as
    /// [`Samples::F32Le`].
    pub(crate) fn convert(
        self,
        data: &[u8],
        is_big: bool,
        [slope, intercept]: [f64; 2],
        samples: Samples,
        out: &mut Vec<u8>,
    ) {
        out.reserve(data.len() / self.bytes() as usize * samples.bytes() as usize);
        let is_whole = samples == Samples::I16Le;
        with_number!(self, is_big, |bytes: usize, read: &dyn Fn(&[u8]) -> f64| {
            for number in data.chunks_exact(bytes) {
                let value = read(number) * slope + intercept;
                match is_whole {
                    true => out.extend_from_slice(&(value as i16).to_le_bytes()),
                    false => out.extend_from_slice(&(value as f32).to_le_bytes()),
                }
            }
        });
    }

    /// Converts numbers to [`Samples::F32Le`], each times a slope plus an intercept.
    pub(crate) fn to_floats(self, data: &[u8], is_big: bool, scale: [f64; 2]) -> Vec<u8> {
        let mut out = Vec::new();
        self.convert(data, is_big, scale, Samples::F32Le, &mut out);
        out
    }
}

/// Returns the bytes of a number, the lowest first.
#[inline(always)]
fn taken<const N: usize>(bytes: &[u8], is_big: bool) -> [u8; N] {
    let mut own = [0; N];
    own.copy_from_slice(&bytes[..N]);
    if is_big {
        own.reverse();
    }
    own
}

/// Returns a volume of numbers; an axis without a length has an edge of 1.
pub fn volume(
    dims: UVec3,
    voxel_size: glam::Vec3,
    (samples, data): (Samples, Vec<u8>),
    description: Vec<u8>,
) -> Volume {
    let texts = crate::format::Texts { description, ..Default::default() };
    Volume { dims, voxel_size, samples, data, texts }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_types_keep_their_values() {
        let of = |number: Number, data: &[u8], is_big, scale| {
            let (samples, data) = number.into_samples(data.to_vec(), is_big, scale);
            let dims = UVec3::new(data.len() as u32 / samples.bytes(), 1, 1);
            let volume = volume(dims, glam::Vec3::ONE, (samples, data), Vec::new());
            let values = (0..dims.x).filter_map(|x| volume.density(UVec3::new(x, 0, 0)));
            (samples, values.collect::<Vec<f32>>())
        };
        let one = [1.0, 0.0];
        assert_eq!(of(Number::I8, &[0xFF, 5], false, one), (Samples::I16Le, vec![-1.0, 5.0]));
        assert_eq!(of(Number::U16, &[1, 2], true, one), (Samples::U16Be, vec![258.0]));
        assert_eq!(of(Number::U16, &[1, 2], true, [1.0, -1024.0]), (Samples::I16Le, vec![-766.0]));
        assert_eq!(
            of(Number::U16, &[0xFF, 0xFF], false, [1.0, 1.0]),
            (Samples::F32Le, vec![65536.0])
        );
        assert_eq!(of(Number::U8, &[10, 0], false, [0.5, 1.0]), (Samples::F32Le, vec![6.0, 1.0]));
        for is_big in [false, true] {
            let flip = |mut bytes: Vec<u8>| {
                if is_big {
                    bytes.reverse();
                }
                bytes
            };
            let f64s = flip((-2.5f64).to_le_bytes().to_vec());
            assert_eq!(of(Number::F64, &f64s, is_big, one), (Samples::F32Le, vec![-2.5]));
            let i32s = flip((-70_000i32).to_le_bytes().to_vec());
            assert_eq!(of(Number::I32, &i32s, is_big, one), (Samples::F32Le, vec![-70_000.0]));
            let u64s = flip(70_000u64.to_le_bytes().to_vec());
            assert_eq!(of(Number::U64, &u64s, is_big, one), (Samples::F32Le, vec![70_000.0]));
        }
        assert!(Number::F64.check(UVec3::splat(u32::MAX), u64::MAX - 1).is_err());
        assert_eq!(Number::F64.check(UVec3::new(2, 3, 4), 1000).ok(), Some(192));
    }
}
