//! The record of an undo step as bytes, packed by [`super::blocks`]:
//!
//! 1. five u32: how many masks of empty, full and mixed bricks, how many mixed bricks, how many pages;
//! 2. each mask: u32 word, u64 bricks; the empty ones first, then the full, then the mixed;
//! 3. the eight u64 of each mixed brick;
//! 4. each page: u32 linear index, u32 packed bytes (0 for a brick without a page), and these bytes, packed
//!    as in .vsc files;
//! 5. where the step changed the mask: its record, in the same form without pages.

use std::io::{BufRead, Write};

use super::ContentsShape;
use super::blocks::{BlockReader, BlockWriter};
use crate::format::FormatError;
use crate::format::vsc::chunk::{pack_page, unpack_page};
use crate::sculpture::brick::BRICK_VOXELS;
use crate::sculpture::brick_set::{BrickMask, BrickSet};
use crate::sculpture::grid::{brick_dims, unflatten, valid_mask};
use crate::sculpture::record::BrickRecord;
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
    let kinds = record.kinds();
    for masks in kinds {
        blocks.u32(masks.len() as u32)?;
    }
    blocks.u32(record.mixed_bits().len() as u32)?;
    blocks.u32(record.pages().len() as u32)?;
    for bricks in kinds.into_iter().flatten() {
        blocks.u32(bricks.word)?;
        blocks.u64(bricks.mask)?;
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
    let mut blocks = BlockReader::new(packed);
    let record = read_part(&mut blocks, shape)?;
    if blocks.is_empty()? {
        return Ok(record);
    }
    let mask = read_part(&mut blocks, ContentsShape { depth: ColourDepth::None, ..shape })?;
    if mask.is_empty() || !blocks.is_empty()? {
        return Err(FAULT);
    }
    Ok(record.with_mask(mask))
}

fn read_part(blocks: &mut BlockReader, shape: ContentsShape) -> Result<BrickRecord, FormatError> {
    let dims = brick_dims(shape.dims);
    let brick_count = dims.as_u64vec3().element_product();
    let mut counts = [0; 5];
    for count in &mut counts {
        *count = blocks.u32()? as usize;
    }
    let [empty, full, mixed, mixed_bricks, page_count] = counts;
    // Each brick is named at most once, though a word may be named for several of its bricks.
    let words = brick_count.div_ceil(64);
    if counts.iter().any(|&count| count as u64 > brick_count)
        || (page_count > 0 && shape.depth == ColourDepth::None)
    {
        return Err(FAULT);
    }
    let mut named = BrickSet::new(brick_count as usize);
    let mut masks = |count: usize| -> Result<Vec<BrickMask>, FormatError> {
        let mut masks = Vec::with_capacity(count);
        for _ in 0..count {
            let bricks = BrickMask { word: blocks.u32()?, mask: blocks.u64()? };
            let zeros = u64::from(bricks.mask.leading_zeros());
            // A word without bricks has no last one; it is refused.
            let last = (u64::from(bricks.word) * 64 + 63).saturating_sub(zeros);
            if bricks.mask == 0
                || u64::from(bricks.word) >= words
                || last >= brick_count
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
    let valid = |index: u32| valid_mask(shape.dims, unflatten(index, dims));
    let mut full_bricks = full.iter().flat_map(|bricks| bricks.indices());
    if !full_bricks.all(|index| valid(index).is_full())
        || mixed.iter().map(|bricks| bricks.mask.count_ones() as usize).sum::<usize>()
            != mixed_bricks
    {
        return Err(FAULT);
    }
    let mut mixed_bits = Vec::with_capacity(mixed_bricks);
    for index in mixed.iter().flat_map(|bricks| bricks.indices()) {
        let mut brick = Brick::EMPTY;
        for word in &mut brick.words {
            *word = blocks.u64()?;
        }
        if brick != brick.and(&valid(index)) {
            return Err(FAULT);
        }
        mixed_bits.push(brick);
    }
    let mut painted = BrickSet::new(brick_count as usize);
    let mut pages = Vec::with_capacity(page_count);
    let mut packed = vec![0; MAX_PACKED_PAGE];
    for _ in 0..page_count {
        let (index, length) = (blocks.u32()?, blocks.u32()? as usize);
        let packed = packed.get_mut(..length).ok_or(FAULT)?;
        if u64::from(index) >= brick_count || painted.contains(index) {
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
    Ok(BrickRecord::from_parts([empty, full, mixed], mixed_bits, pages))
}
