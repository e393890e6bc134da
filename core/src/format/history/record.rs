//! The record of an undo step as bytes, packed by [`super::blocks`]:
//!
//! 1. three u32: how many words of 64 bricks, how many mixed bricks, how many pages;
//! 2. each word: u64 place, u64 bricks, u64 full ones, u64 mixed ones. A place is the x, y and z of a leaf of 8^3
//!    bricks (16 bits each, the lowest first) and the index of the word in it (16 bits);
//! 3. the eight u64 of each mixed brick;
//! 4. each page: u32 linear index, u32 packed bytes (0 for a brick without a page), and these bytes, packed
//!    as in .vsc files;
//! 5. where the step changed the mask: its record, in the same form without pages.
//!
//! Records of earlier versions of the program name bricks by linear index instead ([`read_linear`]):
//!
//! 1. five u32: how many masks of empty, full and mixed bricks, how many mixed bricks, how many pages;
//! 2. each mask: u32 linear index of its first brick divided by 64, u64 bricks; the empty ones first, then the full,
//!    then the mixed. The rest is the same.

use std::io::{BufRead, Write};

use glam::UVec3;

use super::ContentsShape;
use super::blocks::{BlockReader, BlockWriter};
use crate::format::FormatError;
use crate::format::vsc::chunk::{pack_page, unpack_page};
use crate::sculpture::brick::{BRICK_VOXELS, local_coords};
use crate::sculpture::brick_set::LeafKey;
use crate::sculpture::grid::{brick_dims, unflatten, valid_mask};
use crate::sculpture::index_set::{IndexMask, IndexSet};
use crate::sculpture::material::Page;
use crate::sculpture::record::{BrickRecord, WordRecord};
use crate::sculpture::{Brick, ColourDepth};

const FAULT: FormatError = FormatError::Damaged("an undo step does not fit its sculpture");

/// Greatest size of a packed page, in bytes.
const MAX_PACKED_PAGE: usize = 1 + BRICK_VOXELS as usize * 3;

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
    blocks.u32(record.pages().len() as u32)?;
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
    let mut packed = Vec::new();
    for (index, page) in record.pages() {
        packed.clear();
        if let Some(page) = page {
            pack_page(page, page.len() / BRICK_VOXELS as usize, &mut packed);
        }
        blocks.u32(*index)?;
        blocks.u32(packed.len() as u32)?;
        blocks.bytes(&packed)?;
    }
    Ok(())
}

/// Unpacks a record for contents of `shape`.
pub fn read(packed: &mut dyn BufRead, shape: ContentsShape) -> Result<BrickRecord, FormatError> {
    read_parts(packed, shape, read_part)
}

/// Unpacks a record that names bricks by linear index, for contents of `shape`.
pub fn read_linear(
    packed: &mut dyn BufRead,
    shape: ContentsShape,
) -> Result<BrickRecord, FormatError> {
    read_parts(packed, shape, read_linear_part)
}

/// Reads a part of a record: that of the sculpture, or that of the mask.
type PartReader = fn(&mut BlockReader, ContentsShape) -> Result<BrickRecord, FormatError>;

fn read_parts(
    packed: &mut dyn BufRead,
    shape: ContentsShape,
    part: PartReader,
) -> Result<BrickRecord, FormatError> {
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
fn brick_count(shape: ContentsShape) -> u64 {
    brick_dims(shape.dims).as_u64vec3().element_product()
}

/// Returns the counts at the beginning of a part, the last of which is that of the pages.
fn read_counts<const N: usize>(
    blocks: &mut BlockReader,
    shape: ContentsShape,
) -> Result<[usize; N], FormatError> {
    let mut counts = [0; N];
    for count in &mut counts {
        *count = blocks.u32()? as usize;
    }
    let has_pages = counts.last().is_some_and(|count| *count > 0);
    // Each brick is named at most once, though a word may be named for several of its bricks.
    let is_possible = counts.iter().all(|&count| count as u64 <= brick_count(shape));
    if !is_possible || (has_pages && shape.depth == ColourDepth::None) {
        return Err(FAULT);
    }
    Ok(counts)
}

fn read_part(blocks: &mut BlockReader, shape: ContentsShape) -> Result<BrickRecord, FormatError> {
    let dims = brick_dims(shape.dims);
    let [word_count, mixed_count, page_count] = read_counts(blocks, shape)?;
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
    let pages = read_pages(blocks, shape, page_count)?;
    Ok(BrickRecord::from_parts(words, mixed_bits, pages))
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
    let pages = read_pages(blocks, shape, page_count)?;
    let record = BrickRecord::of_bricks(values, |b| valid_mask(shape.dims, b));
    Ok(record.with_pages(pages))
}

fn read_brick(blocks: &mut BlockReader) -> Result<Brick, FormatError> {
    let mut brick = Brick::EMPTY;
    for word in &mut brick.words {
        *word = blocks.u64()?;
    }
    Ok(brick)
}

fn read_pages(
    blocks: &mut BlockReader,
    shape: ContentsShape,
    page_count: usize,
) -> Result<Vec<(u32, Option<Page>)>, FormatError> {
    let mut painted = IndexSet::new(brick_count(shape) as usize);
    let mut pages = Vec::with_capacity(page_count);
    let mut packed = vec![0; MAX_PACKED_PAGE];
    for _ in 0..page_count {
        let (index, length) = (blocks.u32()?, blocks.u32()? as usize);
        let packed = packed.get_mut(..length).ok_or(FAULT)?;
        if u64::from(index) >= brick_count(shape) || painted.contains(index) {
            return Err(FAULT);
        }
        painted.insert(index);
        blocks.fill(packed)?;
        let mut rest = &*packed;
        let page = match length {
            0 => None,
            _ => Some(unpack_page(shape.depth.bytes(), &mut rest)?),
        };
        if !rest.is_empty() {
            return Err(FAULT);
        }
        pages.push((index, page));
    }
    Ok(pages)
}
