//! Parses the elements of a DICOM file (PS3.5, PS3.10): tags with their values, in sequences of items, and the
//! fragments of packed pixels.
//!
//! Takes bytes; gives values that borrow from them. Nothing is allocated from a length in the file before that many
//! bytes have been seen, and nesting is bounded. Knows no meaning of tags except which are sequences.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::DeflateDecoder;

use super::super::unpack::malformed;
use super::syntax::Syntax;
use super::tags::{self, Tag};
use crate::format::FormatError;
use crate::format::budget::check_budget;

/// Position of the mark of a DICOM file, and its bytes.
pub const MAGIC_AT: usize = 128;
pub const MAGIC: &[u8] = b"DICM";
/// The group of a file's first elements after the meta group.
const FIRST_GROUP: u32 = 0x0008;
/// Number of elements by which a file without a mark is recognised, and their greatest length.
const BARE_ELEMENTS: usize = 4;
const MOST_BARE_BYTES: u32 = 1 << 8;
/// Greatest number of elements of one file, and nesting of sequences: both far beyond real files.
const MOST_ELEMENTS: usize = 1 << 20;
const MOST_DEPTH: usize = 32;
/// A length that is not known in advance.
const UNDEFINED: u32 = u32::MAX;

/// Returns whether the first bytes of a file are those of a DICOM file, with the mark or without.
pub(crate) fn is_dicom(start: &[u8]) -> bool {
    begin_of(start).is_some()
}

/// Returns the start of the elements of a file. Some files lack the mark, or the bytes before it; they are recognised
/// by typical first elements.
fn begin_of(file: &[u8]) -> Option<usize> {
    if file.get(MAGIC_AT..).is_some_and(|rest| rest.starts_with(MAGIC)) {
        return Some(MAGIC_AT + MAGIC.len());
    }
    let marked = file.starts_with(MAGIC).then_some(MAGIC.len());
    // A stray byte before the first element has been seen in practice.
    let places = marked.into_iter().chain([0, 1, MAGIC_AT]);
    places.into_iter().find(|at| file.get(*at..).is_some_and(begins_with_elements))
}

/// Returns whether bytes begin with little-endian elements of the groups that come first in a DICOM file, in order.
fn begins_with_elements(bytes: &[u8]) -> bool {
    let mut at = 0;
    let mut last = 0;
    for i in 0..BARE_ELEMENTS {
        let Some(head) = bytes.get(at..).and_then(|rest| rest.first_chunk::<8>()) else {
            return false;
        };
        let half = |i: usize| u32::from(u16::from_le_bytes([head[i], head[i + 1]]));
        let tag = half(0) << 16 | half(2);
        let is_first = i > 0 || matches!(tag >> 16, tags::META_GROUP | FIRST_GROUP);
        if !is_first || tag <= last && i > 0 || !matches!(tag >> 16, 2..=0x28) {
            return false;
        }
        let is_explicit = head[4..6].iter().all(u8::is_ascii_uppercase);
        let is_long = matches!(&head[4..6], b"OB" | b"OW" | b"SQ" | b"UN" | b"UT");
        let length = match (is_explicit, is_long) {
            (true, true) => bytes
                .get(at + 8..)
                .and_then(|rest| rest.first_chunk())
                .map_or(u32::MAX, |length| u32::from_le_bytes(*length) + 4),
            (true, false) => half(6),
            (false, _) => half(6) << 16 | half(4),
        };
        if length > MOST_BARE_BYTES {
            return false;
        }
        (at, last) = (at + 8 + length as usize, tag);
    }
    true
}

/// The available part of a file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ReadExtent {
    /// The whole file.
    Whole,
    /// Its first bytes: it is no error if the rest is cut off.
    Start,
}

enum ElementValue<'a> {
    Bytes(&'a [u8]),
    /// 16-bit numbers of any meaning.
    Words(&'a [u8]),
    Items(Vec<DataSet<'a>>),
    /// The first fragment is the offset table.
    Fragments(Vec<&'a [u8]>),
}

/// The pixels of a file as they are stored.
pub enum StoredPixels<'a> {
    /// One frame after another; `swapped` where pairs of bytes are in the wrong order.
    Native { bytes: &'a [u8], swapped: bool },
    /// Packed, each frame in one or more fragments. The offset table may be empty.
    Packed { offsets: &'a [u8], fragments: &'a [&'a [u8]] },
}

/// Elements of a file or of an item of a sequence.
pub struct DataSet<'a> {
    elements: Vec<(Tag, ElementValue<'a>)>,
    is_big: bool,
}

/// Returns the syntax of a file, and the bytes of its data set, unpacked if necessary to at most `budget_bytes`.
pub fn open(
    file: &[u8],
    part: ReadExtent,
    budget_bytes: u64,
) -> Result<(Syntax, Cow<'_, [u8]>), FormatError> {
    let Some(begin) = begin_of(file) else {
        return Err(FormatError::Scan(
            "this is not a DICOM file: it has no `DICM` at byte 128, and does not begin with elements either; export it again from the program that it came from"
                .to_string(),
        ));
    };
    let mut meta = Parser {
        bytes: file,
        at: begin,
        left: MOST_ELEMENTS,
        part,
        is_big: false,
        is_explicit: true,
    };
    let elements = meta.elements(file.len(), 0, true)?;
    let meta_end = meta.at;
    let meta = DataSet { elements, is_big: false };
    let rest = &file[meta_end..];
    let syntax = match meta.text(tags::TRANSFER_SYNTAX) {
        // If it is not stated, the elements themselves show it.
        None if meta.elements.is_empty() => match is_explicit(rest, false) {
            Some(true) => Syntax::ExplicitLittle,
            _ => Syntax::ImplicitLittle,
        },
        uid => Syntax::of(&uid.unwrap_or_default())?,
    };
    if !syntax.is_deflated() {
        return Ok((syntax, Cow::Borrowed(rest)));
    }
    let mut unpacked = Vec::new();
    let read =
        DeflateDecoder::new(rest).take(budget_bytes.saturating_add(1)).read_to_end(&mut unpacked);
    match (read, part) {
        (Err(error), ReadExtent::Whole) => {
            Err(malformed("the deflated data set", error.to_string()))
        }
        _ => {
            check_budget(unpacked.len() as u64, budget_bytes)?;
            Ok((syntax, Cow::Owned(unpacked)))
        }
    }
}

/// Returns whether the elements of a data set state their value types, judged by the first one. `None` where this
/// cannot be determined.
fn is_explicit(bytes: &[u8], is_big: bool) -> Option<bool> {
    let head = bytes.first_chunk::<8>()?;
    if head[4..6].iter().all(u8::is_ascii_uppercase) {
        return Some(true);
    }
    let group = [head[0], head[1]];
    let group = if is_big { u16::from_be_bytes(group) } else { u16::from_le_bytes(group) };
    // Otherwise these bytes are a length, and the first element is never long.
    let length = [head[4], head[5], head[6], head[7]];
    let length = if is_big { u32::from_be_bytes(length) } else { u32::from_le_bytes(length) };
    (u32::from(group) == FIRST_GROUP && length <= MOST_BARE_BYTES).then_some(false)
}

impl<'a> DataSet<'a> {
    /// Parses the elements of `bytes`, as [`open`] returns them.
    pub fn parse(
        bytes: &'a [u8],
        syntax: Syntax,
        part: ReadExtent,
    ) -> Result<DataSet<'a>, FormatError> {
        let is_big = syntax.is_big();
        // The elements themselves decide, not the syntax named in the header.
        let is_explicit = is_explicit(bytes, is_big).unwrap_or(syntax.is_explicit());
        let mut parser = Parser { bytes, at: 0, left: MOST_ELEMENTS, part, is_big, is_explicit };
        let elements = parser.elements(bytes.len(), 0, false)?;
        Ok(DataSet { elements, is_big })
    }

    fn value(&self, tag: Tag) -> Option<&ElementValue<'a>> {
        self.elements.iter().find(|(own, _)| *own == tag).map(|(_, value)| value)
    }

    fn bytes(&self, tag: Tag) -> Option<&'a [u8]> {
        match self.value(tag) {
            Some(ElementValue::Bytes(bytes) | ElementValue::Words(bytes)) if !bytes.is_empty() => {
                Some(bytes)
            }
            _ => None,
        }
    }

    /// Returns a text without its padding; `None` where it is missing or empty.
    pub fn text(&self, tag: Tag) -> Option<String> {
        let text = String::from_utf8_lossy(self.bytes(tag)?);
        let text = text.trim_matches(|c: char| c.is_whitespace() || c == '\0');
        (!text.is_empty()).then(|| text.to_string())
    }

    /// Returns the finite numbers of a text; `None` where one cannot be read.
    pub fn decimals<const N: usize>(&self, tag: Tag) -> Option<[f64; N]> {
        self.all_decimals(tag)?.get(..N)?.try_into().ok()
    }

    /// Returns all of a text's numbers.
    pub(crate) fn all_decimals(&self, tag: Tag) -> Option<Vec<f64>> {
        let number = |text: &str| text.trim().parse().ok().filter(|n: &f64| n.is_finite());
        self.text(tag)?.split('\\').map(number).collect()
    }

    /// Returns the first of a list of 16-bit numbers.
    pub fn u16(&self, tag: Tag) -> Option<u16> {
        let bytes = *self.bytes(tag)?.first_chunk()?;
        Some(if self.is_big { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
    }

    /// Returns the items of a sequence; none where it is missing.
    pub(crate) fn items(&self, tag: Tag) -> &[DataSet<'a>] {
        match self.value(tag) {
            Some(ElementValue::Items(items)) => items,
            _ => &[],
        }
    }

    /// Returns the pixels with the tag of their number type.
    pub fn pixels(&self) -> Option<(Tag, StoredPixels<'_>)> {
        tags::PIXELS.into_iter().find_map(|tag| match self.value(tag)? {
            ElementValue::Bytes(bytes) => {
                Some((tag, StoredPixels::Native { bytes, swapped: false }))
            }
            ElementValue::Words(bytes) => {
                Some((tag, StoredPixels::Native { bytes, swapped: self.is_big }))
            }
            ElementValue::Fragments(all) => {
                let (offsets, fragments) = all.split_first()?;
                Some((tag, StoredPixels::Packed { offsets, fragments }))
            }
            ElementValue::Items(_) => None,
        })
    }
}

struct Parser<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Number of elements that may still follow.
    left: usize,
    part: ReadExtent,
    is_big: bool,
    is_explicit: bool,
}

impl<'a> Parser<'a> {
    /// Returns the elements up to `end` or the end of an item without a length; only those of the file's meta group if
    /// `is_meta`.
    fn elements(
        &mut self,
        end: usize,
        depth: usize,
        is_meta: bool,
    ) -> Result<Vec<(Tag, ElementValue<'a>)>, FormatError> {
        let mut elements = Vec::new();
        while self.at < end {
            let start = self.at;
            match self.element(end, depth) {
                Ok((tag, _)) if is_meta && tag >> 16 != tags::META_GROUP => {
                    self.at = start;
                    break;
                }
                Ok((tags::ITEM_END | tags::SEQUENCE_END, _)) => break,
                Ok(element) => elements.push(element),
                // The bytes end here, or the meta group does.
                Err(_) if self.part == ReadExtent::Start || is_meta => {
                    self.at = start;
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        Ok(elements)
    }

    fn element(
        &mut self,
        end: usize,
        depth: usize,
    ) -> Result<(Tag, ElementValue<'a>), FormatError> {
        self.left = self.left.checked_sub(1).ok_or_else(|| {
            malformed("the data set", format!("more than {MOST_ELEMENTS} elements"))
        })?;
        let place = self.at;
        let tag = self.tag(end)?;
        let (vr, length) = self.length(tag, end)?;
        let is_sequence = match vr {
            Some(vr) => &vr == b"SQ" || &vr == b"UN" && length == UNDEFINED,
            None => tags::SEQUENCES.contains(&tag) || length == UNDEFINED,
        };
        if length == UNDEFINED && tags::PIXELS.contains(&tag) {
            return Ok((tag, ElementValue::Fragments(self.fragments(end)?)));
        }
        if is_sequence && tag != tags::ITEM {
            let was_explicit = self.is_explicit;
            // Values of unknown types are always stored without types.
            self.is_explicit &= vr != Some(*b"UN");
            let items = self.items(length, end, depth + 1);
            self.is_explicit = was_explicit;
            return Ok((tag, ElementValue::Items(items?)));
        }
        let value = self.take(length as usize, end).ok_or_else(|| {
            malformed(
                &format!(
                    "element ({:04X},{:04X}) at byte {place} of the data set",
                    tag >> 16,
                    tag & 0xFFFF
                ),
                match length {
                    UNDEFINED => "a value without a length".to_string(),
                    _ => format!("{length} bytes were expected, but there are {}", end - self.at),
                },
            )
        })?;
        Ok((
            tag,
            if vr == Some(*b"OW") {
                ElementValue::Words(value)
            } else {
                ElementValue::Bytes(value)
            },
        ))
    }

    /// Returns the items of a sequence whose length, possibly undefined, has been read.
    fn items(
        &mut self,
        length: u32,
        end: usize,
        depth: usize,
    ) -> Result<Vec<DataSet<'a>>, FormatError> {
        if depth > MOST_DEPTH {
            return Err(malformed(
                "the data set",
                format!("more than {MOST_DEPTH} nested sequences"),
            ));
        }
        let end = self.end_of(length, end)?;
        let mut items = Vec::new();
        while self.at < end {
            let tag = self.tag(end)?;
            let (_, length) = self.length(tag, end)?;
            match tag {
                tags::ITEM => {
                    let item_end = self.end_of(length, end)?;
                    let elements = self.elements(item_end, depth, false)?;
                    items.push(DataSet { elements, is_big: self.is_big });
                }
                tags::SEQUENCE_END => break,
                _ => return Err(malformed("a sequence", "something that is no item")),
            }
        }
        Ok(items)
    }

    fn fragments(&mut self, end: usize) -> Result<Vec<&'a [u8]>, FormatError> {
        let mut fragments = Vec::new();
        while self.at < end {
            let tag = self.tag(end)?;
            let (_, length) = self.length(tag, end)?;
            match tag {
                tags::ITEM => {
                    let fragment = self.take(length as usize, end);
                    fragments.push(fragment.ok_or_else(|| self.cut("packed pixels"))?);
                }
                _ => break,
            }
        }
        Ok(fragments)
    }

    /// Returns the end of a part of the given length that begins here.
    fn end_of(&self, length: u32, end: usize) -> Result<usize, FormatError> {
        match length {
            UNDEFINED => Ok(end),
            length if length as usize <= end - self.at => Ok(self.at + length as usize),
            // The readable part of a truncated sequence is useful.
            _ if self.part == ReadExtent::Start => Ok(end),
            _ => Err(self.cut("a sequence")),
        }
    }

    fn cut(&self, what: &str) -> FormatError {
        malformed(&format!("{what} at byte {} of the data set", self.at), "the file ends in it")
    }

    fn take(&mut self, length: usize, end: usize) -> Option<&'a [u8]> {
        let taken = self.bytes[..end].get(self.at..)?.get(..length)?;
        self.at += length;
        Some(taken)
    }

    fn number<const N: usize>(&mut self, end: usize) -> Result<u32, FormatError> {
        let bytes = self.take(N, end).ok_or_else(|| self.cut("an element"))?;
        let join = |sum: u32, byte: &u8| sum << 8 | u32::from(*byte);
        Ok(if self.is_big { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) })
    }

    fn tag(&mut self, end: usize) -> Result<Tag, FormatError> {
        Ok(self.number::<2>(end)? << 16 | self.number::<2>(end)?)
    }

    /// Returns the type of an element's value, where it is stored, and its length.
    fn length(&mut self, tag: Tag, end: usize) -> Result<(Option<[u8; 2]>, u32), FormatError> {
        if !self.is_explicit || tag >> 16 == tags::ITEM >> 16 {
            return Ok((None, self.number::<4>(end)?));
        }
        let place = self.at;
        let vr = self.take(2, end).and_then(|vr| vr.first_chunk().copied());
        let vr: [u8; 2] = vr.ok_or_else(|| self.cut("an element"))?;
        if !vr.iter().all(u8::is_ascii_uppercase) {
            return Err(malformed(
                &format!("byte {place} of the data set"),
                format!("a value of the unknown type `{}`", vr.escape_ascii()),
            ));
        }
        let is_long = matches!(
            &vr,
            b"OB"
                | b"OD"
                | b"OF"
                | b"OL"
                | b"OV"
                | b"OW"
                | b"SQ"
                | b"SV"
                | b"UC"
                | b"UN"
                | b"UR"
                | b"UT"
                | b"UV"
        );
        let length = match is_long {
            true => {
                self.number::<2>(end)?;
                self.number::<4>(end)?
            }
            false => self.number::<2>(end)?,
        };
        Ok((Some(vr), length))
    }
}
