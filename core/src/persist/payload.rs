//! Encodes numbers and texts in the payloads of records: little-endian, texts preceded by their length (u32).
//!
//! Takes and gives bytes alone; knows neither files nor the kinds of records.

use crate::format::FormatError;

/// The error of a payload that this program does not write.
pub(super) const DAMAGED: FormatError =
    FormatError::Damaged("an entry of the journal has no known form");

pub(super) fn put_text(text: &str, out: &mut Vec<u8>) {
    put_bytes(text.as_bytes(), out);
}

/// Appends bytes, preceded by their number.
pub(super) fn put_bytes(bytes: &[u8], out: &mut Vec<u8>) {
    out.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
    out.extend_from_slice(bytes);
}

pub(super) fn take_text<'a>(rest: &mut &'a [u8]) -> Result<&'a str, FormatError> {
    str::from_utf8(take_bytes(rest)?).map_err(|_| DAMAGED)
}

/// Splits off bytes that are preceded by their number.
pub(super) fn take_bytes<'a>(rest: &mut &'a [u8]) -> Result<&'a [u8], FormatError> {
    let (length, after) = rest.split_first_chunk().ok_or(DAMAGED)?;
    let length = u32::from_le_bytes(*length) as usize;
    let (bytes, after) = after.split_at_checked(length).ok_or(DAMAGED)?;
    *rest = after;
    Ok(bytes)
}

pub(super) fn take_u64(rest: &mut &[u8]) -> Result<u64, FormatError> {
    let (bytes, after) = rest.split_first_chunk().ok_or(DAMAGED)?;
    *rest = after;
    Ok(u64::from_le_bytes(*bytes))
}
