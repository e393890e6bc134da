//! The record of an undo step as bytes, packed by [`super::blocks`]:
//!
//! 1. two u32: how many words of 64 bricks, how many mixed bricks;
//! 2. each word: u64 place, u64 bricks, u64 full ones, u64 mixed ones. A place is the x, y and z of a leaf of 8^3
//!    bricks (16 bits each, the lowest first) and the index of the word in it (16 bits);
//! 3. the eight u64 of each mixed brick;
//! 4. the colours ([`super::colours`]);
//! 5. where the step changed the mask: its record, in the same form.
//!
//! Earlier versions of the program wrote two other layouts, which are only read. [`Layout::Pages`] differs thus:
//!
//! 1. a third u32: how many pages;
//! 4. in place of the colours each page: u32 linear index, u32 packed bytes (0 for a brick without a page), and these
//!    bytes, packed as in .vsc files.
//!
//! [`Layout::Linear`] is that of `Pages`, but:
//!
//! 1. five u32: how many masks of empty, full and mixed bricks, how many mixed bricks, how many pages;
//! 2. each mask: u32 linear index of its first brick divided by 64, u64 bricks; the empty ones first, then the full,
//!    then the mixed.

use std::io::{BufRead, Write};

use glam::UVec3;

use super::ContentsShape;
use super::blocks::{BlockReader, BlockWriter};
use super::colours;
use crate::format::FormatError;
use crate::sculpture::brick::local_coords;
use crate::sculpture::brick_set::LeafKey;
use crate::sculpture::colour_record::ColourRecord;
use crate::sculpture::grid::{brick_dims, unflatten, valid_mask};
use crate::sculpture::index_set::{IndexMask, IndexSet};
use crate::sculpture::record::{BrickRecord, WordRecord};
use crate::sculpture::{Brick, ColourDepth};

pub(super) const FAULT: FormatError =
    FormatError::Damaged("an undo step does not fit its sculpture");

/// Packs a record to `out`, block by block.
pub fn write(record: &BrickRecord, out: &mut dyn Write) -> std::io::Result<()> {
    let mut blocks = BlockWriter::new(out);
    write_part(record, &mut blocks)?;
    if let Some(mask) = record.mask() {
        write_part(mask, &mut blocks)?;
    }
    blocks.finish()
}

fn write_part(record: &BrickRecord, blocks: &mut BlockWriter) -> std::io::Result<()> {
    blocks.u32(record.word_count() as u32)?;
    blocks.u32(record.mixed_bits().len() as u32)?;
    for word in record.words() {
        let UVec3 { x, y, z } = word.leaf.coords();
        let place = [x, y, z, u32::from(word.word)];
        blocks.u64(place.iter().rev().fold(0, |all, part| all << 16 | u64::from(*part)))?;
        for mask in [word.bricks, word.full, word.mixed] {
            blocks.u64(mask)?;
        }
    }
    for &word in record.mixed_bits().iter().flat_map(|brick| &brick.words) {
        blocks.u64(word)?;
    }
    colours::write(record.colours().unwrap_or(&ColourRecord::default()), blocks)
}

/// The layouts of records in files, of all versions of the program.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Bricks and colours by cubes: the layout that is written.
    Cubes,
    /// Bricks by leaf, a page of colours for each brick.
    Pages,
    /// Bricks by linear index, a page of colours for each brick.
    Linear,
}

/// Unpacks a record for contents of `shape`.
pub fn read(
    packed: &mut dyn BufRead,
    shape: ContentsShape,
    layout: Layout,
) -> Result<BrickRecord, FormatError> {
    let part = |blocks: &mut BlockReader, shape| match layout {
        Layout::Linear => read_linear_part(blocks, shape),
        Layout::Cubes | Layout::Pages => read_part(blocks, shape, layout),
    };
    let mut blocks = BlockReader::new(packed);
    let record = part(&mut blocks, shape)?;
    if blocks.is_empty()? {
        return Ok(record);
    }
    let mask = part(&mut blocks, ContentsShape { depth: ColourDepth::None, ..shape })?;
    if mask.is_empty() || !blocks.is_empty()? {
        return Err(FAULT);
    }
    Ok(record.with_mask(mask))
}

/// Returns the number of bricks of a sculpture.
pub(super) fn brick_count(shape: ContentsShape) -> u64 {
    brick_dims(shape.dims).as_u64vec3().element_product()
}

/// Returns the counts at the beginning of a part.
fn read_counts<const N: usize>(
    blocks: &mut BlockReader,
    shape: ContentsShape,
) -> Result<[usize; N], FormatError> {
    let mut counts = [0; N];
    for count in &mut counts {
        *count = blocks.u32()? as usize;
    }
    // Each brick is named at most once, though a word may be named for several of its bricks.
    let is_possible = counts.iter().all(|&count| count as u64 <= brick_count(shape));
    if is_possible { Ok(counts) } else { Err(FAULT) }
}

fn read_part(
    blocks: &mut BlockReader,
    shape: ContentsShape,
    layout: Layout,
) -> Result<BrickRecord, FormatError> {
    let dims = brick_dims(shape.dims);
    let [word_count, mixed_count] = read_counts(blocks, shape)?;
    let page_count = match layout {
        Layout::Pages => Some(read_counts::<1>(blocks, shape)?[0]),
        Layout::Cubes | Layout::Linear => None,
    };
    let mut words: Vec<WordRecord> = Vec::with_capacity(word_count);
    let mut mixed = 0;
    for _ in 0..word_count {
        let place = blocks.u64()?;
        let [bricks, full, of_mixed] = [blocks.u64()?, blocks.u64()?, blocks.u64()?];
        let part = |i: u32| (place >> (16 * i)) as u32 & 0xFFFF;
        let (leaf, word) = (UVec3::new(part(0), part(1), part(2)), part(3));
        if leaf.cmpge((dims + 7) / 8).any() || word > 7 {
            return Err(FAULT);
        }
        let inside = Brick::below((dims - leaf * 8).to_array()).words[word as usize];
        let word =
            WordRecord { leaf: LeafKey::of(leaf), word: word as u8, bricks, full, mixed: of_mixed };
        let follows =
            words.last().is_none_or(|last| (last.leaf, last.word) < (word.leaf, word.word));
        if !follows || bricks == 0 || bricks & !inside != 0 {
            return Err(FAULT);
        }
        if (full | of_mixed) & !bricks != 0 || full & of_mixed != 0 {
            return Err(FAULT);
        }
        mixed += of_mixed.count_ones() as usize;
        words.push(word);
    }
    if mixed != mixed_count {
        return Err(FAULT);
    }
    let mut mixed_bits = Vec::with_capacity(mixed_count);
    for word in &words {
        for bit in (0..64).filter(|bit| word.mixed >> bit & 1 != 0) {
            let brick = read_brick(blocks)?;
            let at = UVec3::from(local_coords(u32::from(word.word) << 6 | bit));
            let valid = valid_mask(shape.dims, word.leaf.coords() * 8 + at);
            if brick.is_empty() || brick == valid || brick != brick.and(&valid) {
                return Err(FAULT);
            }
            mixed_bits.push(brick);
        }
    }
    let colours = match page_count {
        Some(page_count) => colours::read_pages(blocks, shape, page_count)?,
        None => colours::read(blocks, shape)?,
    };
    Ok(BrickRecord::from_parts(words, mixed_bits).with_colours(colours))
}

fn read_linear_part(
    blocks: &mut BlockReader,
    shape: ContentsShape,
) -> Result<BrickRecord, FormatError> {
    let dims = brick_dims(shape.dims);
    let [empty, full, mixed, mixed_bricks, page_count] = read_counts(blocks, shape)?;
    let mut named = IndexSet::new(brick_count(shape) as usize);
    let mut masks = |count: usize| -> Result<Vec<IndexMask>, FormatError> {
        let mut masks = Vec::with_capacity(count);
        for _ in 0..count {
            let bricks = IndexMask { word: blocks.u32()?, mask: blocks.u64()? };
            let zeros = u64::from(bricks.mask.leading_zeros());
            // A word without bricks has no last one; it is refused.
            let last = (u64::from(bricks.word) * 64 + 63).saturating_sub(zeros);
            if bricks.mask == 0
                || last >= brick_count(shape)
                || named.mask(bricks.word) & bricks.mask != 0
            {
                return Err(FAULT);
            }
            named.insert_mask(bricks);
            masks.push(bricks);
        }
        Ok(masks)
    };
    let [empty, full, mixed] = [masks(empty)?, masks(full)?, masks(mixed)?];
    let count = |masks: &[IndexMask]| -> usize {
        masks.iter().map(|bricks| bricks.mask.count_ones() as usize).sum()
    };
    if count(&mixed) != mixed_bricks {
        return Err(FAULT);
    }
    let mut values = Vec::with_capacity(count(&empty) + count(&full) + mixed_bricks);
    let places = |masks: Vec<IndexMask>| {
        masks.into_iter().flat_map(IndexMask::indices).map(move |index| unflatten(index, dims))
    };
    values.extend(places(empty).map(|b| (b, Brick::EMPTY)));
    for b in places(full) {
        if !valid_mask(shape.dims, b).is_full() {
            return Err(FAULT);
        }
        values.push((b, Brick::FULL));
    }
    for b in places(mixed) {
        let brick = read_brick(blocks)?;
        if brick != brick.and(&valid_mask(shape.dims, b)) {
            return Err(FAULT);
        }
        values.push((b, brick));
    }
    let colours = colours::read_pages(blocks, shape, page_count)?;
    let record = BrickRecord::of_bricks(values, |b| valid_mask(shape.dims, b));
    Ok(record.with_colours(colours))
}

fn read_brick(blocks: &mut BlockReader) -> Result<Brick, FormatError> {
    let mut brick = Brick::EMPTY;
    for word in &mut brick.words {
        *word = blocks.u64()?;
    }
    Ok(brick)
}
