//! Decodes the pixels of a DICOM frame (PS3.3 C.7.6.3, PS3.5 chapter 8 and annexes A and G): native, in RLE, JPEG or
//! JPEG 2000, to little-endian numbers without unused bits.
//!
//! Takes the data set of a file; gives bytes of one frame at a time. Knows nothing of series or patients.

use jpeg_decoder::{ColorTransform, Decoder, PixelFormat};

use super::data_set::{DataSet, StoredPixels};
use super::jpeg2000;
use super::syntax::Syntax;
use super::tags;
use crate::format::FormatError;
use crate::format::scan::numbers::Number;
use crate::format::scan::unpack::{cut, malformed};

/// Greatest number of byte planes of a frame in RLE, and bytes of its header.
const MOST_RLE_PLANES: usize = 15;
const RLE_HEADER_BYTES: usize = 64;

/// The storage of the pixels of a file.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PixelLayout {
    pub columns: u32,
    pub rows: u32,
    /// The number type to which a frame is read.
    pub number: Number,
    /// Number of stored bits of each sample.
    bits_stored: u32,
    high_bit: u32,
    is_signed: bool,
    /// Whether red, green and blue are in separate planes of each frame, instead of interleaved.
    is_planar: bool,
    /// Whether two pixels share their colour differences (4:2:2).
    is_halved: bool,
    colours: PhotometricInterpretation,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum PhotometricInterpretation {
    /// High values are light.
    Grey,
    /// Low values are light.
    Negative,
    Rgb,
    /// Luminance and two colour differences.
    Ybr,
}

impl PixelLayout {
    pub fn of(data: &DataSet) -> Result<PixelLayout, FormatError> {
        let (Some(rows), Some(columns)) = (data.u16(tags::ROWS), data.u16(tags::COLUMNS)) else {
            return Err(no_image(data));
        };
        if rows == 0 || columns == 0 {
            return Err(malformed(
                "the DICOM header",
                format!("a picture of {columns}x{rows} pixels"),
            ));
        }
        let samples = data.u16(tags::SAMPLES_PER_PIXEL).unwrap_or(1);
        let photometric = data.text(tags::PHOTOMETRIC).unwrap_or_default();
        let colours = match (samples, photometric.as_str()) {
            (1, "MONOCHROME1") => PhotometricInterpretation::Negative,
            (1, "MONOCHROME2" | "") => PhotometricInterpretation::Grey,
            // The codestream itself declares the colour differences; they are converted during decoding.
            (3, "RGB" | "YBR_RCT" | "YBR_ICT") => PhotometricInterpretation::Rgb,
            (3, "YBR_FULL" | "YBR_FULL_422") => PhotometricInterpretation::Ybr,
            _ => {
                return Err(FormatError::Scan(format!(
                    "pixels of {samples} samples in the colours `{}` are not read; convert them to MONOCHROME2 or RGB",
                    photometric.chars().take(16).collect::<String>().escape_debug()
                )));
            }
        };
        let allocated = data.u16(tags::BITS_ALLOCATED).map_or(8, u32::from);
        let bits_stored = data.u16(tags::BITS_STORED).map_or(allocated, u32::from);
        let high_bit = data.u16(tags::HIGH_BIT).map_or(bits_stored.wrapping_sub(1), u32::from);
        let is_signed = data.u16(tags::IS_SIGNED) == Some(1);
        let kind = data.pixels().map_or(tags::WHOLE_PIXELS, |(tag, _)| tag);
        let number = match (kind, allocated, is_signed) {
            (tags::FLOAT_PIXELS, ..) if samples == 1 => Number::F32,
            (tags::DOUBLE_PIXELS, ..) if samples == 1 => Number::F64,
            (_, 8, _) if samples == 3 => Number::Rgb,
            (_, 8, false) => Number::U8,
            (_, 8, true) => Number::I8,
            (_, 16, false) if samples == 1 => Number::U16,
            (_, 16, true) if samples == 1 => Number::I16,
            (_, 32, false) if samples == 1 => Number::U32,
            (_, 32, true) if samples == 1 => Number::I32,
            _ => {
                return Err(FormatError::Scan(format!(
                    "pixels of {samples} x {allocated} bits are not read; convert them to 8, 16 or 32 bits, or to RGB of 8 bits"
                )));
            }
        };
        if bits_stored == 0 || bits_stored > high_bit.saturating_add(1) || high_bit >= allocated {
            return Err(malformed(
                "the DICOM header",
                format!("{bits_stored} bits up to bit {high_bit} of {allocated}"),
            ));
        }
        let is_halved = photometric == "YBR_FULL_422";
        let is_planar = samples == 3 && data.u16(tags::PLANAR) == Some(1);
        let (columns, rows) = (columns.into(), rows.into());
        Ok(PixelLayout {
            columns,
            rows,
            number,
            bits_stored,
            high_bit,
            is_signed,
            is_planar,
            is_halved,
            colours,
        })
    }

    /// Returns whether light and dark are swapped as the pixels are read.
    pub(crate) fn is_negative(&self) -> bool {
        self.colours == PhotometricInterpretation::Negative
    }

    /// Returns whether frames of both can lie in one volume.
    pub fn fits(&self, other: &PixelLayout) -> bool {
        let of = |layout: &PixelLayout| (layout.columns, layout.rows, layout.number);
        of(self) == of(other)
    }

    fn pixels(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    fn bytes(&self) -> usize {
        self.pixels() * self.number.bytes() as usize
    }

    /// Returns the bytes of a sample.
    fn width(&self) -> usize {
        if self.number == Number::Rgb { 1 } else { self.number.bytes() as usize }
    }

    /// Returns one of the `frames` frames of a file.
    pub fn frame(
        &self,
        data: &DataSet,
        syntax: Syntax,
        frames: usize,
        index: usize,
    ) -> Result<Vec<u8>, FormatError> {
        let (_, stored) = data.pixels().ok_or_else(|| no_image(data))?;
        let mut bytes = match stored {
            StoredPixels::Native { bytes, swapped } => {
                if self.is_halved {
                    return Err(FormatError::Scan(
                        "colours with half as many differences (YBR_FULL_422) are read in JPEG only; convert them to RGB"
                            .to_string(),
                    ));
                }
                let begin = index.checked_mul(self.bytes());
                let frame = begin
                    .and_then(|begin| bytes.get(begin..)?.get(..self.bytes()).map(|f| (begin, f)));
                let whole = (self.bytes() as u64).saturating_mul(frames as u64);
                let (begin, frame) = frame.ok_or_else(|| cut(whole, bytes.len() as u64))?;
                match swapped && self.width() == 1 {
                    // The number of bytes is even; the last may be padding.
                    true => (begin..begin + frame.len())
                        .map(|i| bytes.get(i ^ 1).copied().unwrap_or(0))
                        .collect(),
                    false => frame.to_vec(),
                }
            }
            StoredPixels::Packed { offsets, fragments } => {
                let packed = fragments_of(offsets, fragments, frames, index)?;
                match syntax {
                    Syntax::Rle => self.unpack_rle(&packed)?,
                    Syntax::Jpeg => self.unpack_jpeg(&packed)?,
                    Syntax::Jpeg2000 => self.unpack_jpeg2000(&packed)?,
                    _ => {
                        let frame = packed.get(..self.bytes());
                        frame.ok_or_else(|| cut(self.bytes() as u64, packed.len() as u64))?.to_vec()
                    }
                }
            }
        };
        if syntax.is_big() {
            bytes.chunks_exact_mut(self.width()).for_each(<[u8]>::reverse);
        }
        if self.number == Number::Rgb {
            // All decoders return interleaved red, green and blue.
            let is_packed = matches!(syntax, Syntax::Rle | Syntax::Jpeg | Syntax::Jpeg2000);
            if self.is_planar && !is_packed {
                bytes = interleaved(&bytes);
            }
            if self.colours == PhotometricInterpretation::Ybr && syntax != Syntax::Jpeg {
                bytes.as_chunks_mut().0.iter_mut().for_each(to_rgb);
            }
        } else {
            self.trim(&mut bytes);
        }
        Ok(bytes)
    }

    /// Clears unused bits, extends signs, and inverts negatives.
    fn trim(&self, bytes: &mut [u8]) {
        let width = self.width();
        let is_whole = !matches!(self.number, Number::F32 | Number::F64);
        let is_full = self.bits_stored as usize == width * 8;
        if !is_whole || is_full && !self.is_negative() {
            return;
        }
        let unused = 32 - self.bits_stored;
        let mask = u32::MAX >> unused;
        for sample in bytes.chunks_exact_mut(width) {
            let stored = sample.iter().rev().fold(0, |sum, byte| sum << 8 | u32::from(*byte));
            let mut value = stored >> (self.high_bit + 1 - self.bits_stored) & mask;
            if self.is_negative() {
                // For signed numbers, too: the complement of x is -1 - x.
                value = !value & mask;
            }
            if self.is_signed {
                value = ((value << unused) as i32 >> unused) as u32;
            }
            sample.copy_from_slice(&value.to_le_bytes()[..width]);
        }
    }

    fn unpack_rle(&self, packed: &[u8]) -> Result<Vec<u8>, FormatError> {
        let damaged = |what: &str| malformed("the RLE pixels", what);
        let header = packed.get(..RLE_HEADER_BYTES).ok_or_else(|| damaged("the header is cut"))?;
        let (numbers, _) = header.as_chunks::<4>();
        let place = |i: usize| u32::from_le_bytes(numbers[i]) as usize;
        let planes = self.number.bytes() as usize;
        if place(0) != planes || planes > MOST_RLE_PLANES {
            return Err(damaged("they have another number of planes than the header says"));
        }
        let mut bytes = vec![0; self.bytes()];
        for plane in 0..planes {
            let end = if plane + 1 < planes { place(plane + 2) } else { packed.len() };
            let segment =
                packed.get(place(plane + 1)..end).ok_or_else(|| damaged("a plane is cut"))?;
            // The planes of a sample begin with its highest byte.
            let width = self.width();
            let first = plane / width * width + (width - 1 - plane % width);
            let mut targets = bytes[first..].iter_mut().step_by(planes);
            let mut rest = segment;
            let mut written = 0;
            while written < self.pixels() {
                let Some((&control, after)) = rest.split_first() else { break };
                let (count, run) = match control {
                    0..=127 => (usize::from(control) + 1, false),
                    128 => (0, false),
                    _ => (257 - usize::from(control), true),
                };
                let used = if run { 1 } else { count };
                let Some((values, after)) = after.split_at_checked(used) else { break };
                for i in 0..count {
                    if let Some(target) = targets.next() {
                        *target = values[if run { 0 } else { i }];
                        written += 1;
                    }
                }
                rest = after;
            }
            if written < self.pixels() {
                return Err(damaged("a plane ends before its last pixel"));
            }
        }
        Ok(bytes)
    }

    fn unpack_jpeg2000(&self, packed: &[u8]) -> Result<Vec<u8>, FormatError> {
        let channels = if self.number == Number::Rgb { 3 } else { 1 };
        let samples = jpeg2000::samples(packed, [self.columns, self.rows], channels)?;
        let width = self.width();
        Ok(samples.into_iter().flat_map(|s| s.to_le_bytes().into_iter().take(width)).collect())
    }

    fn unpack_jpeg(&self, packed: &[u8]) -> Result<Vec<u8>, FormatError> {
        let damaged = |what: String| malformed("the JPEG pixels", what);
        let mut decoder = Decoder::new(packed);
        decoder.set_max_decoding_buffer_size(self.pixels() * 4);
        match self.colours {
            PhotometricInterpretation::Rgb => decoder.set_color_transform(ColorTransform::RGB),
            PhotometricInterpretation::Ybr => decoder.set_color_transform(ColorTransform::YCbCr),
            PhotometricInterpretation::Grey | PhotometricInterpretation::Negative => {}
        }
        decoder.read_info().map_err(no_jpeg)?;
        let info = decoder.info().ok_or_else(|| damaged("no picture".to_string()))?;
        let (columns, rows) = (info.width.into(), info.height.into());
        let is_colour = self.number == Number::Rgb;
        let fits = match info.pixel_format {
            PixelFormat::L8 | PixelFormat::L16 => !is_colour,
            PixelFormat::RGB24 => is_colour,
            PixelFormat::CMYK32 => false,
        };
        if (self.columns, self.rows) != (columns, rows) || !fits {
            return Err(damaged(format!(
                "{:?} of {columns}x{rows} pixels, where the header says {}x{}",
                info.pixel_format, self.columns, self.rows
            )));
        }
        let pixels = decoder.decode().map_err(no_jpeg)?;
        let stored = if info.pixel_format == PixelFormat::L16 { 2 } else { 1 };
        let samples = self.pixels() * if is_colour { 3 } else { 1 };
        if pixels.len() != samples * stored {
            return Err(cut((samples * stored) as u64, pixels.len() as u64));
        }
        if stored == self.width() {
            let is_foreign = cfg!(target_endian = "big") && stored == 2;
            let turn = |pair: &[u8; 2]| [pair[1], pair[0]];
            return Ok(if is_foreign {
                pixels.as_chunks().0.iter().flat_map(turn).collect()
            } else {
                pixels
            });
        }
        let mut bytes = vec![0; self.bytes()];
        for (wide, narrow) in bytes.chunks_exact_mut(self.width()).zip(pixels.chunks_exact(stored))
        {
            let both = stored.min(wide.len());
            wide[..both].copy_from_slice(&narrow[..both]);
        }
        Ok(bytes)
    }
}

/// Returns the joined fragments of a frame.
fn fragments_of(
    offsets: &[u8],
    fragments: &[&[u8]],
    frames: usize,
    index: usize,
) -> Result<Vec<u8>, FormatError> {
    if frames == 1 {
        return Ok(fragments.concat());
    }
    if fragments.len() == frames {
        return Ok(fragments[index].to_vec());
    }
    let (offsets, _) = offsets.as_chunks::<4>();
    let Some(own) = offsets.get(index).filter(|_| offsets.len() == frames) else {
        return Err(malformed(
            "the packed pixels",
            format!(
                "{} fragments for {frames} frames, and no table of where frames begin",
                fragments.len()
            ),
        ));
    };
    let begin = u64::from(u32::from_le_bytes(*own));
    let end = offsets.get(index + 1).map_or(u64::MAX, |next| u32::from_le_bytes(*next).into());
    // Each fragment is preceded by a tag and a length.
    let mut at = 0u64;
    let mut joined = Vec::new();
    for fragment in fragments {
        if (begin..end).contains(&at) {
            joined.extend_from_slice(fragment);
        }
        at += fragment.len() as u64 + 8;
    }
    Ok(joined)
}

/// Returns the error of JPEG pixels that cannot be read.
fn no_jpeg(error: jpeg_decoder::Error) -> FormatError {
    match error {
        jpeg_decoder::Error::Unsupported(what) => FormatError::Scan(format!(
            "its pixels are packed as a kind of JPEG that is not read ({what:?}); unpack it first, such as with \
             `gdcmconv --raw` or dcmtk"
        )),
        error => malformed("the JPEG pixels", error.to_string()),
    }
}

/// Converts planes of red, green and blue to triples.
fn interleaved(planes: &[u8]) -> Vec<u8> {
    let count = planes.len() / 3;
    (0..count).flat_map(|i| [planes[i], planes[i + count], planes[i + 2 * count]]).collect()
}

/// Converts YBR_FULL of PS3.3 C.7.6.3.1.2, which is that of JPEG.
fn to_rgb(pixel: &mut [u8; 3]) {
    let [y, cb, cr] = pixel.map(f32::from);
    let (cb, cr) = (cb - 128.0, cr - 128.0);
    *pixel = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb]
        .map(|value| value.round() as u8);
}

/// Returns the error of a file without pixels.
fn no_image(data: &DataSet) -> FormatError {
    FormatError::Scan(match data.items(tags::DIRECTORY_RECORDS).is_empty() {
        false => "this is only the table of contents of a medium (DICOMDIR); open one of the files with pictures, or \
                  their folder"
            .to_string(),
        true => format!(
            "this DICOM file holds no picture, but an object of modality {}; open the files of an image series",
            data.text(tags::MODALITY).map_or("unknown".to_string(), |m| m.escape_debug().take(16).collect())
        ),
    })
}
