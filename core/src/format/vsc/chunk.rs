//! Packs some thousand bricks with their colours to bytes, and back.
//!
//! A chunk is packed by LZ4 (Collet, "LZ4 Block Format Description") from these parts:
//!
//! 1. a byte a brick: bits 0 and 1 say whether it is empty (0), full (1) or mixed (2), bit 2
//!    whether it has a page of colours. A full brick is full as far as it lies within the grid;
//! 2. two bytes for each mixed brick, two bits for each of its words, the first word lowest: 0
//!    empty, 1 full, 2 mixed;
//! 3. eight bytes for each mixed word;
//! 4. the pages. A page begins with the number of its colours, if they are at most 16: then the
//!    colours follow and, of two or more, half a byte a voxel that names one of them, the first
//!    voxel in the lower half. A page of more colours begins with 0, and all 512 follow.
//!
//! Numbers are little-endian; bricks, words, voxels and colours are those of memory. A chunk of
//! nothing but empty or nothing but full bricks without pages takes no bytes at all.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::UVec3;

use crate::format::FormatError;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::brick::BRICK_VOXELS;
use crate::sculpture::grid::BrickRun;
use crate::sculpture::material::{MAX_PAGE_BYTES, Page, PageView};
use crate::sculpture::{Brick, ColourDepth};

pub(super) const EMPTY: u8 = 0;
pub(super) const FULL: u8 = 1;
pub(super) const MIXED: u8 = 2;
pub(super) const HAS_PAGE: u8 = 4;

/// Greatest number of colours that a page lists once instead of at every voxel.
const PALETTE: usize = 16;

const VOXELS: usize = BRICK_VOXELS as usize;

/// Greatest expansion of a byte by LZ4.
const MOST_PER_BYTE: u64 = 255;

/// An entry of the file's table of chunks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ChunkEntry {
    /// Bytes in the file; 0 for a uniform chunk.
    pub packed_bytes: u32,
    /// Unpacked bytes; for a chunk without bytes 1 if it is full, 0 if it is empty.
    pub plain_bytes: u32,
    /// Number of bricks with a page.
    pub pages: u32,
    /// CRC-32 of the packed bytes.
    pub checksum: u32,
}

/// The memory for bits that is left for the chunks of a file.
#[derive(Debug)]
pub struct BitsRoom {
    /// Bytes taken so far.
    taken: AtomicU64,
    budget_bytes: u64,
}

impl BitsRoom {
    /// Returns the room for a grid within `budget_bytes`.
    pub fn new(budget_bytes: u64) -> BitsRoom {
        BitsRoom { taken: AtomicU64::new(0), budget_bytes }
    }

    /// Takes the room of so many bricks that are neither empty nor full.
    fn take(&self, mixed: usize) -> Result<(), FormatError> {
        let bytes = (mixed * size_of::<Brick>()) as u64;
        let needed = self.taken.fetch_add(bytes, Ordering::Relaxed) + bytes;
        let what = "the sculpture needs at least";
        OverBudget::check(what, needed, MemoryBudget::Grids, self.budget_bytes)
            .map_err(|error| FormatError::Grid(error.into()))
    }
}

impl ChunkEntry {
    /// Checks the entry of a chunk of `bricks` before memory is allocated for it.
    pub fn check(&self, bricks: usize, depth: ColourDepth) -> Result<(), FormatError> {
        let page = 1 + (VOXELS.max(PALETTE + VOXELS / 2)) * depth.bytes().max(1);
        let most = (bricks * 67) as u64 + u64::from(self.pages) * page as u64;
        let plain = u64::from(self.plain_bytes);
        let fits = match self.packed_bytes {
            0 => plain <= 1 && self.pages == 0,
            packed => plain <= most && plain <= MOST_PER_BYTE * u64::from(packed),
        };
        let pages_fit = self.pages == 0 || depth != ColourDepth::None;
        if fits && pages_fit && self.pages as usize <= bricks {
            Ok(())
        } else {
            Err(FormatError::Damaged("its table asks for too much"))
        }
    }
}

/// Packs bricks, given with their coordinates. `valid` returns the bits that a brick may have, `page` its
/// colours.
pub fn pack<'a>(
    bricks: impl Iterator<Item = (UVec3, &'a Brick)>,
    valid: impl Fn(UVec3) -> Brick,
    mut page: impl FnMut(UVec3) -> Option<PageView<'a>>,
) -> (ChunkEntry, Vec<u8>) {
    let mut classes = Vec::with_capacity(bricks.size_hint().1.unwrap_or(0) * 16);
    let (mut shapes, mut words, mut pages) = (Vec::new(), Vec::new(), Vec::new());
    let mut page_count = 0;
    for (b, brick) in bricks {
        let class = if brick.is_empty() {
            EMPTY
        } else if brick.is_full() || *brick == valid(b) {
            FULL
        } else {
            let mut shape = 0u16;
            for (w, &word) in brick.words.iter().enumerate() {
                let class = match word {
                    0 => EMPTY,
                    u64::MAX => FULL,
                    _ => {
                        words.extend_from_slice(&word.to_le_bytes());
                        MIXED
                    }
                };
                shape |= u16::from(class) << (2 * w);
            }
            shapes.extend_from_slice(&shape.to_le_bytes());
            MIXED
        };
        let colours = page(b);
        if let Some(colours) = colours {
            page_count += 1;
            pack_page(colours, &mut pages);
        }
        classes.push(class | if colours.is_some() { HAS_PAGE } else { 0 });
    }
    if classes.iter().all(|&class| class == classes[0]) && classes[0] <= FULL {
        let entry = ChunkEntry { plain_bytes: u32::from(classes[0]), ..ChunkEntry::default() };
        return (entry, Vec::new());
    }
    for part in [shapes, words, pages] {
        classes.extend_from_slice(&part);
    }
    let packed = lz4_flex::block::compress(&classes);
    let entry = ChunkEntry {
        packed_bytes: packed.len() as u32,
        plain_bytes: classes.len() as u32,
        pages: page_count,
        checksum: crc32fast::hash(&packed),
    };
    (entry, packed)
}

/// Unpacks a chunk to a run of its bricks, and returns its pages with the coordinates of their bricks. The entry must have
/// been checked.
pub fn unpack(
    entry: &ChunkEntry,
    packed: &[u8],
    bricks: &mut BrickRun,
    depth: ColourDepth,
    room: &BitsRoom,
) -> Result<Vec<(UVec3, Page)>, FormatError> {
    if entry.packed_bytes == 0 {
        let is_full = entry.plain_bytes == 1;
        while bricks.left() > 0 {
            if is_full { bricks.add_full() } else { bricks.add_empty() }
        }
        return Ok(Vec::new());
    }
    if crc32fast::hash(packed) != entry.checksum {
        return Err(FormatError::Damaged("a checksum is wrong"));
    }
    let mut plain = vec![0; entry.plain_bytes as usize];
    let unpacked = lz4_flex::block::decompress_into(packed, &mut plain);
    if unpacked.ok() != Some(plain.len()) {
        return Err(FormatError::Damaged("a part does not unpack"));
    }
    let mut rest = &plain[..];
    let classes = take(&mut rest, bricks.left())?;
    let mixed = classes.iter().filter(|&&class| class & !HAS_PAGE == MIXED).count();
    let shapes = take(&mut rest, 2 * mixed)?;
    room.take(mixed)?;
    bricks.reserve(mixed);
    let mut shapes = shapes.as_chunks::<2>().0.iter().map(|&bytes| u16::from_le_bytes(bytes));
    let mut painted = Vec::with_capacity(entry.pages as usize);
    for class in classes {
        if class & HAS_PAGE != 0 {
            painted.push(bricks.next());
        }
        match class & !HAS_PAGE {
            EMPTY => bricks.add_empty(),
            FULL => bricks.add_full(),
            MIXED => {
                let brick = unpack_brick(shapes.next().unwrap_or_default(), &mut rest)?;
                if !bricks.add_brick(&brick) {
                    return Err(FormatError::Damaged("it has voxels beyond its border"));
                }
            }
            _ => return Err(FormatError::Damaged("a brick is of no known kind")),
        }
    }
    let mut pages = Vec::with_capacity(painted.len());
    for b in painted {
        pages.push((b, unpack_page(depth, &mut rest)?));
    }
    if !rest.is_empty() || pages.len() != entry.pages as usize {
        return Err(FormatError::Damaged("a part has another length than it says"));
    }
    Ok(pages)
}

/// Unpacks a mixed brick from its words' classes and the following words in `rest`.
#[inline]
fn unpack_brick(shape: u16, rest: &mut &[u8]) -> Result<Brick, FormatError> {
    let mut brick = Brick::EMPTY;
    for (w, word) in brick.words.iter_mut().enumerate() {
        *word = match (shape >> (2 * w)) as u8 & 3 {
            EMPTY => 0,
            FULL => u64::MAX,
            MIXED => {
                let Some((bytes, after)) = rest.split_first_chunk() else { return Err(CUT) };
                *rest = after;
                u64::from_le_bytes(*bytes)
            }
            _ => return Err(FormatError::Damaged("a brick is of no known kind")),
        };
    }
    Ok(brick)
}

const CUT: FormatError = FormatError::Damaged("a part ends too early");

/// Splits off the first `count` bytes.
fn take<'a>(rest: &mut &'a [u8], count: usize) -> Result<&'a [u8], FormatError> {
    let (taken, after) = rest.split_at_checked(count).ok_or(CUT)?;
    *rest = after;
    Ok(taken)
}

/// Packs the colours of a brick, as in part 4 above.
pub(crate) fn pack_page(page: PageView, out: &mut Vec<u8>) {
    let bytes = page.depth().bytes();
    let mut buffer = [0; MAX_PAGE_BYTES];
    let colours = page.write_to(&mut buffer);
    if page.uniform().is_some() {
        out.push(1);
        out.extend_from_slice(&colours[..bytes]);
        return;
    }
    let mut palette: Vec<&[u8]> = Vec::with_capacity(PALETTE);
    let mut places = [0u8; VOXELS];
    for (colour, place) in colours.chunks_exact(bytes.max(1)).zip(&mut places) {
        // Mostly the colour of the previous voxel.
        let known = palette.iter().position(|known| *known == colour);
        *place = match known {
            Some(at) => at as u8,
            None if palette.len() == PALETTE => {
                out.push(0);
                out.extend_from_slice(colours);
                return;
            }
            None => {
                palette.push(colour);
                palette.len() as u8 - 1
            }
        };
    }
    out.push(palette.len() as u8);
    palette.iter().for_each(|colour| out.extend_from_slice(colour));
    if palette.len() > 1 {
        out.extend(places.as_chunks::<2>().0.iter().map(|[low, high]| low | high << 4));
    }
}

/// Unpacks the colours of a brick and advances `rest` past them.
pub(crate) fn unpack_page(depth: ColourDepth, rest: &mut &[u8]) -> Result<Page, FormatError> {
    let bytes = depth.bytes();
    let count = usize::from(take(rest, 1)?[0]);
    if count == 0 {
        return Ok(Page::of_bytes(take(rest, VOXELS * bytes)?, depth));
    }
    if count > PALETTE {
        return Err(FormatError::Damaged("a page has too many colours"));
    }
    let palette = take(rest, count * bytes)?;
    if count == 1 {
        return Ok(Page::uniform(depth.read(palette), depth));
    }
    let mut buffer = [0; MAX_PAGE_BYTES];
    let page = &mut buffer[..VOXELS * bytes];
    let voxels = page.chunks_exact_mut(2 * bytes.max(1));
    for (pair, both) in voxels.zip(take(rest, VOXELS / 2)?) {
        for (out, place) in pair.chunks_exact_mut(bytes.max(1)).zip([both & 15, both >> 4]) {
            let at = usize::from(place) * bytes;
            let colour = palette.get(at..at + bytes);
            out.copy_from_slice(colour.ok_or(FormatError::Damaged("a colour is missing"))?);
        }
    }
    Ok(Page::of_bytes(page, depth))
}
