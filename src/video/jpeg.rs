//! JPEG pictures: decoding, and splitting a stream into pictures (films, and phones that send multipart HTTP).
//!
//! A JPEG delimits itself: marker segments have lengths, and coded data escapes every 0xFF. So the splitter needs no
//! frame sizes from outside, which are often wrong. ITU-T T.81, B.1.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::error::{VideoError, guarded};
use super::frame::{MAX_COMPRESSED_BYTES, MAX_SIDE_PX, VideoFrame, check_size};
use super::reader::Decoded;

const SOI: u8 = 0xD8;
const EOI: u8 = 0xD9;
const SOS: u8 = 0xDA;
const DHT: u8 = 0xC4;

/// The APP0 segment of a film's picture, after the start marker. It makes the decoder use the standard Huffman tables,
/// which webcams omit.
const AVI1: [u8; 9] = [0xFF, 0xE0, 0, 7, b'A', b'V', b'I', b'1', 0];

/// The position of the splitter in a picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum JpegState {
    /// Before a picture.
    Outside,
    /// Between segments: an 0xFF must follow.
    Marker,
    /// After an 0xFF: the marker's code.
    Code,
    /// The two bytes of a segment's length.
    Length { code: u8, high: Option<u8> },
    /// In a segment.
    Segment { left: usize, code: u8 },
    /// In coded data.
    Data,
    /// In coded data after an 0xFF.
    DataCode,
}

/// Cuts a stream of bytes into pictures, and counts discarded ones.
#[derive(Debug)]
pub struct Splitter {
    place: JpegState,
    /// The last byte outside was 0xFF.
    after_ff: bool,
    has_tables: bool,
    picture: Vec<u8>,
    /// Damaged pictures since the last call.
    broken: u64,
    /// Bytes outside of pictures since the last picture.
    outside: usize,
}

impl Splitter {
    pub fn new() -> Splitter {
        Splitter {
            place: JpegState::Outside,
            after_ff: false,
            has_tables: false,
            picture: Vec::new(),
            broken: 0,
            outside: 0,
        }
    }

    /// Reads until a picture is complete or `bytes` are used up. Returns the number of used bytes and whether
    /// [`Splitter::swap_picture`] now has a picture.
    pub fn feed(&mut self, bytes: &[u8]) -> (usize, bool) {
        let mut used = 0;
        while let Some(&byte) = bytes.get(used) {
            // The two states with most bytes skip ahead.
            let rest = &bytes[used..];
            match self.place {
                JpegState::Segment { left, code } => {
                    let n = left.min(rest.len());
                    self.picture.extend_from_slice(&rest[..n]);
                    used += n;
                    self.place = match left - n {
                        0 if code == SOS => JpegState::Data,
                        0 => JpegState::Marker,
                        left => JpegState::Segment { left, code },
                    };
                }
                JpegState::Data => {
                    let n = rest.iter().position(|&b| b == 0xFF).unwrap_or(rest.len());
                    self.picture.extend_from_slice(&rest[..n]);
                    used += n;
                    if n < rest.len() {
                        self.picture.push(0xFF);
                        used += 1;
                        self.place = JpegState::DataCode;
                    }
                }
                JpegState::Outside
                | JpegState::Marker
                | JpegState::Code
                | JpegState::Length { .. }
                | JpegState::DataCode => {
                    used += 1;
                    if self.step(byte) {
                        return (used, true);
                    }
                }
            }
            if self.picture.len() > MAX_COMPRESSED_BYTES {
                self.give_up();
            }
        }
        (used, false)
    }

    /// Consumes a single byte. Returns true at the end of a picture.
    fn step(&mut self, byte: u8) -> bool {
        if self.place == JpegState::Outside {
            self.outside += 1;
            if self.after_ff && byte == SOI {
                self.begin();
            }
            self.after_ff = byte == 0xFF;
            return false;
        }
        self.picture.push(byte);
        match (self.place, byte) {
            (JpegState::Marker, 0xFF) => self.place = JpegState::Code,
            (JpegState::Marker, _) => self.give_up(),
            // Fill bytes before a marker, and escaped or restart codes in data.
            (JpegState::Code | JpegState::DataCode, 0xFF) => {}
            (JpegState::DataCode, 0 | 0xD0..=0xD7) => self.place = JpegState::Data,
            (JpegState::Code | JpegState::DataCode, SOI) => {
                // The picture was cut off; this is the next one.
                self.broken += 1;
                self.begin();
            }
            (JpegState::Code | JpegState::DataCode, EOI) => {
                self.place = JpegState::Outside;
                self.outside = 0;
                return true;
            }
            // Markers without a segment.
            (JpegState::Code | JpegState::DataCode, 0x01 | 0xD0..=0xD7) => {
                self.place = JpegState::Marker
            }
            (JpegState::Code | JpegState::DataCode, 0..=0xBF) => self.give_up(),
            (JpegState::Code | JpegState::DataCode, code) => {
                self.has_tables |= code == DHT;
                self.place = JpegState::Length { code, high: None };
            }
            (JpegState::Length { code, high: None }, _) => {
                self.place = JpegState::Length { code, high: Some(byte) };
            }
            (JpegState::Length { code, high: Some(high) }, _) => {
                let length = usize::from(u16::from_be_bytes([high, byte]));
                match length.checked_sub(2) {
                    None => self.give_up(),
                    Some(0) if code == SOS => self.place = JpegState::Data,
                    Some(0) => self.place = JpegState::Marker,
                    Some(left) => self.place = JpegState::Segment { left, code },
                }
            }
            (JpegState::Outside | JpegState::Segment { .. } | JpegState::Data, _) => {}
        }
        false
    }

    fn begin(&mut self) {
        self.picture.clear();
        self.picture.extend_from_slice(&[0xFF, SOI]);
        self.has_tables = false;
        self.after_ff = false;
        self.place = JpegState::Marker;
    }

    fn give_up(&mut self) {
        self.broken += 1;
        self.picture.clear();
        self.after_ff = false;
        self.place = JpegState::Outside;
    }

    /// Swaps the picture announced by [`Splitter::feed`] for an old buffer. It can be decoded on its own: standard
    /// Huffman tables are added if it has none.
    pub fn swap_picture(&mut self, picture: &mut Vec<u8>) {
        if !self.has_tables && self.picture.len() > 2 {
            self.picture.splice(2..2, AVI1);
        }
        std::mem::swap(&mut self.picture, picture);
        self.picture.clear();
    }

    /// Drops a partial picture, as at the end of a film, and starts over.
    pub fn reset(&mut self) {
        if self.place != JpegState::Outside {
            self.give_up();
        }
        self.outside = 0;
    }

    /// Returns the number of bytes outside of pictures since the last picture.
    pub fn outside(&self) -> usize {
        self.outside
    }

    /// Returns the number of damaged pictures since the last call.
    pub fn take_broken(&mut self) -> u64 {
        std::mem::take(&mut self.broken)
    }
}

/// Decodes one picture, whose colours are BT.601 in full range (JFIF), into `frame`. Kinds that cameras do not send
/// count as damaged: arithmetic coding, 12 bits, unknown CMYK.
pub fn decode(picture: &[u8], subject: &str, frame: &mut VideoFrame) -> Decoded {
    // The decoder may panic on bad input.
    match guarded(subject, || decode_rgba(picture, subject, frame)) {
        Ok(()) => Decoded::Whole,
        Err(error) => Decoded::Broken(error),
    }
}

fn decode_rgba(picture: &[u8], subject: &str, frame: &mut VideoFrame) -> Result<(), VideoError> {
    let options = DecoderOptions::new_fast()
        .jpeg_set_out_colorspace(ColorSpace::RGBA)
        .set_max_width(MAX_SIDE_PX as usize)
        .set_max_height(MAX_SIDE_PX as usize);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(picture), options);
    let malformed = |error| VideoError::malformed(subject, format!("broken JPEG: {error}"));
    decoder.decode_headers().map_err(malformed)?;
    let Some((width, height)) = decoder.dimensions() else {
        return Err(VideoError::malformed(subject, "a JPEG without a size"));
    };
    check_size(width as u64, height as u64, subject)?;
    // The colour space is known only after decoding, so the buffer must have the reported size.
    let bytes = decoder.output_buffer_size();
    if bytes != Some(width * height * 4) {
        return Err(VideoError::unsupported(subject, "a JPEG that does not give RGBA"));
    }
    frame.shape(width as u32, height as u32, subject)?;
    decoder.decode_into(&mut frame.pixels).map_err(malformed)
}
