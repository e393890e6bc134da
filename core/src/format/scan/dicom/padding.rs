//! Padding pixels (PixelPaddingValue, PS3.3 C.7.5.1.1.2): they are no density, and would bias the automatic threshold.
//!
//! Takes stored numbers; replaces padding with the least of the others.

use super::data_set::DataSet;
use super::pixels::PixelLayout;
use super::tags::{self, Tag};
use crate::format::scan::numbers::Number;

/// The least and the greatest padding value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Padding {
    least: i64,
    most: i64,
}

impl Padding {
    /// Returns `None` where the file names no padding, or inverts its numbers.
    pub fn of(data: &DataSet, layout: &PixelLayout) -> Option<Padding> {
        let is_signed = matches!(layout.number, Number::I8 | Number::I16);
        let is_grey = is_signed || matches!(layout.number, Number::U8 | Number::U16);
        if !is_grey || layout.is_negative() {
            return None;
        }
        let value = |tag: Tag| {
            let stored = data.u16(tag)?;
            Some(if is_signed { i64::from(stored as i16) } else { i64::from(stored) })
        };
        let first = value(tags::PADDING)?;
        let last = value(tags::PADDING_LIMIT).unwrap_or(first);
        Some(Padding { least: first.min(last), most: first.max(last) })
    }

    /// Replaces padding with the least other number. Returns whether there was padding, and other numbers.
    pub fn fill(self, data: &mut [u8], number: Number) -> bool {
        let width = number.bytes() as usize;
        let value = |bytes: &[u8]| match (number, bytes) {
            (Number::I8, [byte]) => i64::from(*byte as i8),
            (Number::U8, [byte]) => i64::from(*byte),
            (Number::I16, [a, b]) => i64::from(i16::from_le_bytes([*a, *b])),
            (Number::U16, [a, b]) => i64::from(u16::from_le_bytes([*a, *b])),
            _ => i64::MAX,
        };
        let is_padding = |value: i64| (self.least..=self.most).contains(&value);
        let others = data.chunks_exact(width).map(value).filter(|value| !is_padding(*value));
        let Some(least) = others.min().filter(|least| *least != i64::MAX) else { return false };
        let mut is_filled = false;
        for bytes in data.chunks_exact_mut(width) {
            if is_padding(value(bytes)) {
                bytes.copy_from_slice(&least.to_le_bytes()[..width]);
                is_filled = true;
            }
        }
        is_filled
    }
}
