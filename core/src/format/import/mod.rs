//! Converts a volume to a sculpture: determines which voxels exist, and their colours.
//!
//! Works by bricks, in parallel. A volume that stays in its files is read once for each of the questions that it answers:
//! the histogram, the bits, the colours (`build`). Knows no files.

mod build;
mod view;

use tracing::warn;

pub use self::view::VolumeView;
use self::view::Voxels;
use super::FormatError;
use super::histogram::{Histogram, SampleRange};
use super::labels;
use super::options::{Colouring, Existence, ExportForm, ImportOptions};
use super::ramp::Ramp;
use super::signature::Signature;
use super::threshold;
use super::volume::{Samples, Texts};
use crate::progress::Progress;
use crate::sculpture::colour::{unpack8, unpack16};
use crate::sculpture::history::Contents;
use crate::sculpture::{ColourDepth, Grid, Limits, Rgb};

/// RGBA voxels of this opacity or more exist.
pub(super) const OPAQUE: f64 = 128.0;
/// Fraction of the voxels below the upper end of a ramp; the rest are outliers such as metal.
pub(super) const RAMP_QUANTILE: f64 = 0.999;

pub(super) const U8: SampleRange = SampleRange::Whole { first: 0, count: 1 << 8 };
const U16: SampleRange = SampleRange::Whole { first: 0, count: 1 << 16 };
const I16: SampleRange = SampleRange::Whole { first: i16::MIN as i32, count: 1 << 16 };

/// Wraps in `Some` an expression that uses the conversion of a density from its bytes and its range of values, compiled
/// for each density type; `None` for other types.
macro_rules! with_density {
    ($samples:expr, |$value:ident, $values:ident| $body:expr) => {
        with_density!(@each $samples, $value, $values, $body,
            (U8, 1, U8, |v| f32::from(v[0])),
            (U16Le, 2, U16, |v| f32::from(u16::from_le_bytes(*v))),
            (U16Be, 2, U16, |v| f32::from(u16::from_be_bytes(*v))),
            (I16Le, 2, I16, |v| f32::from(i16::from_le_bytes(*v))),
            (I16Be, 2, I16, |v| f32::from(i16::from_be_bytes(*v))),
            (F32Le, 4, SampleRange::Any, |v| f32::from_le_bytes(*v)),
            (F32Be, 4, SampleRange::Any, |v| f32::from_be_bytes(*v)))
    };
    (@each $samples:expr, $value:ident, $values:ident, $body:expr,
        $(($name:ident, $bytes:literal, $range:expr, |$v:ident| $read:expr)),*) => {
        match $samples {
            $(Samples::$name => {
                let ($value, $values) = (|$v: &[u8; $bytes]| $read, $range);
                Some($body)
            })*
            Samples::Rgb8 | Samples::Rgba8 | Samples::Bytes(_) => None,
        }
    };
}

/// Converts a volume to a sculpture, with the axes of the file. `signature` is that of [`trusted_signature`].
pub fn to_contents(
    volume: VolumeView,
    signature: Option<Signature>,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, FormatError> {
    let job = VolumeImport { volume, options, limits, signature, progress };
    let form = signature.map(|s| s.form);
    let packed = match options.colouring {
        Colouring::Packed => true,
        Colouring::Auto => form == Some(ExportForm::Packed),
        _ => false,
    };
    if packed {
        return job.packed();
    }
    match volume.samples {
        Samples::Rgb8 => job.colours(|v: &[u8; 3]| (v[0].max(v[1]).max(v[2]), *v), 1.0),
        Samples::Rgba8 => job.colours(|[r, g, b, a]: &[u8; 4]| (*a, [*r, *g, *b]), OPAQUE),
        Samples::Bytes(n) => Err(FormatError::Components(n)),
        densities => with_density!(densities, |value, values| job.densities(value, values))
            .unwrap_or(Err(FormatError::Components(densities.bytes()))),
    }
}

/// Returns the histogram of a volume of densities; `None` for one of colours.
pub fn histogram(
    volume: &VolumeView,
    progress: &dyn Progress,
) -> Result<Option<Histogram>, FormatError> {
    with_density!(volume.samples, |value, values| {
        Histogram::of_portions(|f| volume.for_each(progress, f), value, values)
    })
    .transpose()
}

/// Returns the signature stored with a volume of `samples`, if this program wrote it.
pub fn trusted_signature(texts: &Texts, samples: Samples) -> Option<Signature> {
    match Signature::find(texts, samples)? {
        Ok(signature) => Some(signature),
        Err(reason) => {
            warn!("the file's virtual-sculpture line is ignored: {reason}");
            None
        }
    }
}

struct VolumeImport<'a> {
    volume: VolumeView<'a>,
    options: &'a ImportOptions,
    limits: &'a Limits,
    signature: Option<Signature>,
    progress: &'a dyn Progress,
}

impl VolumeImport<'_> {
    fn densities<const B: usize>(
        &self,
        value: impl Fn(&[u8; B]) -> f32 + Sync + Copy,
        values: SampleRange,
    ) -> Result<Contents, FormatError> {
        let own = self.signature.is_some_and(|s| s.form == ExportForm::Densities);
        let colouring = match self.options.colouring {
            Colouring::Auto if own => Colouring::None,
            chosen => chosen,
        };
        let is_plain = matches!(colouring, Colouring::Auto | Colouring::None);
        let bounds = match self.options.existence {
            Existence::Auto => own.then_some((OPAQUE, f64::INFINITY)),
            chosen => chosen.bounds(),
        };
        let depth = if colouring == Colouring::None { ColourDepth::None } else { self.depth() };
        if let Voxels::Held(_) = self.volume.voxels {
            let VolumeView { dims, voxel_size, .. } = self.volume;
            Grid::check(dims, voxel_size, self.limits.grid_bytes)?;
        }
        if colouring == Colouring::Labels {
            let colours = labels::colours();
            let exists = within(bounds.unwrap_or((f64::NEG_INFINITY, f64::INFINITY)), value);
            let is_label = |v: &[u8; B]| value(v) != 0.0 && exists(v);
            return self.build(depth, is_label, |v| labels::colour(&colours, value(v)));
        }
        if let (Some(bounds), true) = (bounds, is_plain) {
            return self.build(depth, within(bounds, value), |_| Rgb::STONE);
        }
        let each = |f: &mut dyn FnMut(&[[u8; B]])| self.volume.for_each(self.progress, f);
        let histogram = Histogram::of_portions(each, value, values)?;
        let bounds = bounds.unwrap_or_else(|| (threshold::automatic(&histogram), f64::INFINITY));
        if is_plain {
            return self.build(depth, within(bounds, value), |_| Rgb::STONE);
        }
        let top = histogram.quantile(RAMP_QUANTILE).min(bounds.1).max(bounds.0);
        let ramp = match colouring {
            Colouring::Tissue => Ramp::tissue(bounds.0, top),
            _ => Ramp::grey(bounds.0, top),
        };
        self.build(depth, within(bounds, value), |v| ramp.colour(value(v)))
    }

    /// Colours the voxels. `of` returns the value to compare with a threshold, and the colour.
    fn colours<const B: usize>(
        &self,
        of: impl Fn(&[u8; B]) -> (u8, [u8; 3]) + Sync,
        default_threshold: f64,
    ) -> Result<Contents, FormatError> {
        let depth = match self.options.colouring {
            Colouring::None => ColourDepth::None,
            Colouring::Grey | Colouring::Tissue | Colouring::Labels => {
                let samples = self.volume.samples;
                return Err(FormatError::NotDensities {
                    colouring: self.options.colouring,
                    samples,
                });
            }
            Colouring::Auto | Colouring::Packed => self.depth(),
        };
        let bounds = self.options.existence.bounds();
        let (least, most) = bounds.unwrap_or((default_threshold, f64::INFINITY));
        let exists = |v: &[u8; B]| (least..=most).contains(&f64::from(of(v).0));
        self.build(depth, exists, |v| Rgb(of(v).1))
    }

    fn packed(&self) -> Result<Contents, FormatError> {
        if self.options.existence != Existence::Auto {
            return Err(FormatError::ThresholdOfPacked);
        }
        let depth = |own| self.options.colour_depth.unwrap_or(own);
        match self.volume.samples {
            Samples::U8 => self.build(depth(ColourDepth::Bits8), |[v]| *v != 0, |[v]| unpack8(*v)),
            Samples::U16Be => self.build(
                depth(ColourDepth::Bits16),
                |v| *v != [0; 2],
                |v| unpack16(u16::from_be_bytes(*v)),
            ),
            Samples::U16Le => self.build(
                depth(ColourDepth::Bits16),
                |v| *v != [0; 2],
                |v| unpack16(u16::from_le_bytes(*v)),
            ),
            Samples::Rgb8 => self.build(depth(ColourDepth::Bits24), |v| *v != [0; 3], |v| Rgb(*v)),
            other => Err(FormatError::NotPacked(other)),
        }
    }

    /// Returns the colour depth: the requested one, else the original one, else the greatest.
    fn depth(&self) -> ColourDepth {
        let own = self.signature.filter(|s| s.form != ExportForm::Densities);
        self.options.colour_depth.or(own.map(|s| s.colour_depth)).unwrap_or(ColourDepth::Bits24)
    }
}

/// Returns whether a density lies within inclusive bounds; false for NaN.
fn within<const B: usize>(
    (least, most): (f64, f64),
    value: impl Fn(&[u8; B]) -> f32 + Sync,
) -> impl Fn(&[u8; B]) -> bool + Sync {
    // The nearest f32 inside the bounds, so that values need not be widened.
    let (low, high) = (least as f32, most as f32);
    let low = if f64::from(low) < least { low.next_up() } else { low };
    let high = if f64::from(high) > most { high.next_down() } else { high };
    move |v| {
        let value = value(v);
        (value >= low) & (value <= high)
    }
}
