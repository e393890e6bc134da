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

    /// Returns whether there is padding in the data, and the least other number.
    pub fn find(self, data: &[u8], number: Number) -> (bool, Option<i64>) {
        let (mut is_there, mut least) = (false, None);
        for bytes in data.chunks_exact(number.bytes() as usize) {
            let value = value_of(bytes, number);
            match self.has(value) {
                true => is_there = true,
                false => least = Some(least.map_or(value, |least: i64| least.min(value))),
            }
        }
        (is_there, least)
    }

    /// Replaces padding with `by`.
    pub fn replace(self, data: &mut [u8], number: Number, by: i64) {
        let width = number.bytes() as usize;
        for bytes in data.chunks_exact_mut(width) {
            if self.has(value_of(bytes, number)) {
                bytes.copy_from_slice(&by.to_le_bytes()[..width]);
            }
        }
    }

    fn has(self, value: i64) -> bool {
        (self.least..=self.most).contains(&value)
    }
}

/// Returns a number of a type that may have padding ([`Padding::of`]).
fn value_of(bytes: &[u8], number: Number) -> i64 {
    match (number, bytes) {
        (Number::I8, [byte]) => i64::from(*byte as i8),
        (Number::U8, [byte]) => i64::from(*byte),
        (Number::I16, [a, b]) => i64::from(i16::from_le_bytes([*a, *b])),
        (Number::U16, [a, b]) => i64::from(u16::from_le_bytes([*a, *b])),
        _ => i64::MAX,
    }
}
