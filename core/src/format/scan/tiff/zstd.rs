//! Unpacks pages packed with ZSTD, which the TIFF decoder does not support: each becomes a file of one page whose
//! strips or tiles are not packed, and which the decoder reads.
//!
//! Takes a file and its current page; gives that other file. Nothing is unpacked beyond the size of a strip or tile.

use std::io::Read;

use ruzstd::decoding::{FrameDecoder, StreamingDecoder};
use tiff::tags::Tag;

use super::super::unpack::{cut, malformed};
use super::{Pages, damaged};
use crate::format::FormatError;
use crate::format::budget::check_budget;

/// The value of [`Tag::Compression`].
const PACKED: u32 = 50000;
/// The entries that describe the layout of a page's pixels, which are copied unchanged.
const KEPT: [Tag; 12] = [
    Tag::ImageWidth,
    Tag::ImageLength,
    Tag::BitsPerSample,
    Tag::PhotometricInterpretation,
    Tag::SamplesPerPixel,
    Tag::RowsPerStrip,
    Tag::PlanarConfiguration,
    Tag::Predictor,
    Tag::TileWidth,
    Tag::TileLength,
    Tag::ExtraSamples,
    Tag::SampleFormat,
];
/// The type of 32-bit values in a directory.
const LONG: u16 = 4;
const IS_PLANAR: u32 = 2;
const HEADER_BYTES: u64 = 8;
/// The largest window that programs write by default.
const MOST_WINDOW_BYTES: u64 = 1 << 27;
/// The largest page: offsets in a file that is not a BigTIFF have 32 bits.
const MOST_PLAIN_BYTES: u64 = 1 << 31;

/// Returns the current page as a file of its own, not packed; `None` if it is not packed with ZSTD. It takes at most
/// `most_bytes`.
pub fn unpacked(
    file: &[u8],
    pages: &mut Pages,
    most_bytes: u64,
) -> Result<Option<Vec<u8>>, FormatError> {
    if pages.get_tag_u32(Tag::Compression).ok() != Some(PACKED) {
        return Ok(None);
    }
    let mut entries: Vec<(Tag, Vec<u32>)> = Vec::new();
    for tag in KEPT {
        let values = pages.find_tag_unsigned_vec::<u32>(tag).map_err(damaged)?;
        entries.extend(values.filter(|own| !own.is_empty()).map(|own| (tag, own)));
    }
    let of = |tag: Tag| {
        let own = entries.iter().find(|(own, _)| *own == tag);
        own.and_then(|(_, values)| values.first().copied())
    };
    let is_tiled = of(Tag::TileWidth).is_some();
    let tags = match is_tiled {
        true => [Tag::TileOffsets, Tag::TileByteCounts],
        false => [Tag::StripOffsets, Tag::StripByteCounts],
    };
    let [begins, lengths] = tags.map(|tag| pages.get_tag_u64_vec(tag).map_err(damaged));
    let (begins, lengths) = (begins?, lengths?);
    let height = of(Tag::ImageLength).unwrap_or(1);
    let [wide, high] = match is_tiled {
        true => [Tag::TileWidth, Tag::TileLength].map(|tag| of(tag).unwrap_or(1)),
        false => {
            let rows = of(Tag::RowsPerStrip).unwrap_or(height).min(height);
            [of(Tag::ImageWidth).unwrap_or(1), rows]
        }
    };
    let is_planar = of(Tag::PlanarConfiguration) == Some(IS_PLANAR);
    let samples = if is_planar { 1 } else { of(Tag::SamplesPerPixel).unwrap_or(1) };
    let pixel_bytes =
        u64::from(samples) * u64::from(of(Tag::BitsPerSample).unwrap_or(1).div_ceil(8));
    let row_bytes = u64::from(wide).saturating_mul(pixel_bytes);
    let per_plane = if is_tiled { 1 } else { height.div_ceil(high.max(1)).max(1) };

    let mut plain = Vec::new();
    let [mut begins_now, mut lengths_now] = [Vec::new(), Vec::new()];
    for (i, (begin, length)) in (0..).zip(begins.into_iter().zip(lengths)) {
        let end = begin.checked_add(length).filter(|end| *end <= file.len() as u64);
        let end = end.ok_or_else(|| cut(begin.saturating_add(length), file.len() as u64))?;
        // The last strip has the remaining rows.
        let rows = match is_tiled {
            true => high,
            false => high.min(height - (i % per_plane) * high),
        };
        let bytes = row_bytes.saturating_mul(rows.into());
        let total = bytes.saturating_add(plain.len() as u64);
        check_budget(total, most_bytes.min(MOST_PLAIN_BYTES))?;
        begins_now.push(HEADER_BYTES as u32 + plain.len() as u32);
        lengths_now.push(bytes as u32);
        unpack(&file[begin as usize..end as usize], bytes, &mut plain)?;
    }
    entries.push((tags[0], begins_now));
    entries.push((tags[1], lengths_now));
    Ok(Some(written(file.starts_with(b"MM"), &plain, entries)))
}

/// Appends the `bytes` bytes of a strip or tile.
fn unpack(packed: &[u8], bytes: u64, plain: &mut Vec<u8>) -> Result<(), FormatError> {
    let wrong = |error: String| malformed("a strip packed with ZSTD", error);
    let mut frame = StreamingDecoder::new_with_max_window_size(packed, MOST_WINDOW_BYTES)
        .map_err(|error| wrong(error.to_string()))?;
    let before = plain.len();
    // One byte more shows whether the frame has ended, and with it its checksum.
    let read = frame.by_ref().take(bytes + 1).read_to_end(plain);
    read.map_err(|error| wrong(error.to_string()))?;
    let found = (plain.len() - before) as u64;
    if found < bytes {
        return Err(cut(bytes, found));
    }
    plain.truncate(before + bytes as usize);
    let frame: FrameDecoder = frame.into_frame_decoder();
    let told = frame.get_checksum_from_data().filter(|_| found == bytes);
    if told.is_some_and(|told| frame.get_calculated_checksum() != Some(told)) {
        return Err(wrong("its checksum is another".to_string()));
    }
    Ok(())
}

/// Returns a TIFF file of one page.
fn written(is_big: bool, pixels: &[u8], mut entries: Vec<(Tag, Vec<u32>)>) -> Vec<u8> {
    let two = |number: u16| if is_big { number.to_be_bytes() } else { number.to_le_bytes() };
    let four = |number: u32| if is_big { number.to_be_bytes() } else { number.to_le_bytes() };
    entries.sort_by_key(|(tag, _)| tag.to_u16());
    let directory = HEADER_BYTES as usize + pixels.len();
    // The directory is followed by the values that do not fit into it.
    let mut beside = directory + 2 + 12 * entries.len() + 4;
    let mut file = Vec::new();
    file.extend_from_slice(if is_big { b"MM" } else { b"II" });
    file.extend(two(42));
    file.extend(four(directory as u32));
    file.extend_from_slice(pixels);
    file.extend(two(entries.len() as u16));
    for (tag, values) in &entries {
        file.extend(two(tag.to_u16()));
        file.extend(two(LONG));
        file.extend(four(values.len() as u32));
        match values[..] {
            [value] => file.extend(four(value)),
            _ => {
                file.extend(four(beside as u32));
                beside += 4 * values.len();
            }
        }
    }
    file.extend(four(0));
    for (_, values) in entries.iter().filter(|(_, values)| values.len() != 1) {
        values.iter().for_each(|value| file.extend(four(*value)));
    }
    file
}
