//! Decodes the pixels of a DICOM frame in JPEG 2000 (ISO/IEC 15444-1; PS3.5 annex A.4.4): a codestream to whole
//! numbers.
//!
//! Takes the bytes of a frame and the size that the header states; gives the interleaved samples of the pixels. Knows
//! nothing of their meaning.

use hayro_jpeg2000::{DecodeSettings, DecoderContext, Image};

use crate::format::FormatError;
use crate::format::scan::unpack::malformed;

/// The markers at the start of a codestream: start of codestream, and sizes.
const BEGIN: [u8; 4] = [0xFF, 0x4F, 0xFF, 0x51];
/// Distance from there to the byte of the first component that holds its bits minus one and, in the highest bit, its
/// sign.
const SIGN_BYTES: usize = 42;
/// Greatest number of bits of a sample: a DICOM sample of 16 bits, which single precision represents exactly.
const MOST_BITS: u8 = 16;

/// Returns the samples of `columns` times `rows` pixels of `channels` each.
pub(super) fn samples(
    packed: &[u8],
    [columns, rows]: [u32; 2],
    channels: usize,
) -> Result<Vec<i32>, FormatError> {
    let damaged = |what: String| malformed("the JPEG 2000 pixels", what);
    let failed = |error: hayro_jpeg2000::DecodeError| damaged(error.to_string());
    let settings = DecodeSettings { resolve_palette_indices: false, ..DecodeSettings::default() };
    let image = Image::new(packed, &settings).map_err(failed)?;
    // Checked before memory is allocated.
    if (image.width(), image.height()) != (columns, rows) {
        return Err(damaged(format!(
            "{}x{} pixels, where the header says {columns}x{rows}",
            image.width(),
            image.height()
        )));
    }
    let begin = packed.windows(BEGIN.len()).position(|bytes| bytes == BEGIN);
    let depth = begin.and_then(|begin| packed.get(begin + SIGN_BYTES));
    let is_signed = depth.is_some_and(|depth| depth & 0x80 != 0);
    let mut context = DecoderContext::default();
    let image = image.decode(&mut context).map_err(failed)?;
    let components = image.components();
    let pixels = columns as usize * rows as usize;
    let fits = |samples: &[f32]| samples.len() == pixels;
    if components.len() != channels || !components.iter().all(|c| fits(c.samples())) {
        return Err(damaged(format!(
            "{} samples a pixel, where the header says {channels}",
            components.len()
        )));
    }
    let mut samples = vec![0; pixels * channels];
    for (channel, component) in components.iter().enumerate() {
        let bits = component.bit_depth();
        if bits > MOST_BITS {
            return Err(FormatError::Scan(format!(
                "its pixels are packed as JPEG 2000 of {bits} bits, of which {MOST_BITS} are read; unpack it first, such as \
                 with `gdcmconv --raw` or dcmtk"
            )));
        }
        // The decoder shifts signed numbers up by half their range, as if they were unsigned.
        let (most, shift) = ((1 << bits) - 1, if is_signed { 1 << (bits - 1) } else { 0 });
        let targets = samples[channel..].iter_mut().step_by(channels);
        for (target, sample) in targets.zip(component.samples()) {
            *target = (sample.round() as i32).clamp(0, most) - shift;
        }
    }
    Ok(samples)
}
