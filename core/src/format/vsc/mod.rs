//! The .vsc format: a sculpture without loss, packed by bricks. It is fast and small because it stores
//! existence instead of densities.
//!
//! All numbers are little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `89 56 53 43 0D 0A 1A 0A`: no text file begins so, and none copied as text still does |
//! | 4 | version: 1, or 2 with a mask, or 3 with flags, or 4 with a canvas, or 5 with a map of nodes |
//! | 3 x 4 | size in voxels |
//! | 3 x 4 | edge lengths of a voxel, as `f32` |
//! | 1 | bits of colour: 0, 8, 16 or 24 |
//! | 3 | base colour: red, green, blue |
//! | 4 | bricks of a chunk |
//! | 4 | number of chunks |
//! | 4 | bytes of the texts |
//! | 4 | from version 3 on: flags, 1 for a mask, 2 for near voxels that are shown as cubes |
//! | 3 x 4 | from version 4 on: the signed coordinates of the first voxel, as `i32` |
//! | 3 x 4 | from version 4 on: the size of the box with which the sculpture began, from signed coordinates 0 on |
//! | 4 | from version 4 on: 1 if tools that reach beyond the box make it grow, else 0 |
//! | 2 x 4 | of version 5: packed bytes and plain bytes of the map; see [`nodes`] |
//! | 4 | CRC-32 of all before, and of table, texts and map |
//! | 16 each | the table: for each chunk packed bytes, plain bytes, pages, CRC-32 of the packed bytes |
//! | | the texts: none at all, or four times a length and so many bytes: description, courtesy, parameter, comment |
//! | | of version 5: the map, packed by LZ4 |
//! | | the chunks, one after the other; see [`chunk`] |
//! | | with a mask: the mask, as a file of version 1 of the same size, without colours and texts |
//!
//! Each sculpture is written in the lowest version that can represent it, so that earlier programs read as much as
//! possible; version 5 is for large boxes, whose files then grow with the surface alone. Bricks are counted x fastest, then
//! y, then z; those of version 5 within their leaves, of which a chunk holds eight. Chunks are independent, so that all
//! cores pack and unpack.

pub(super) mod chunk;
mod nodes;

use std::io::Write;

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use self::chunk::{BitsRoom, ChunkEntry};
use self::nodes::{CHUNK_LEAVES, NodeMap, bricks_of};
use super::budget::check_colour_budget;
use super::error::excerpt;
use super::limits::TEXTS_LIMIT;
use super::spec::{Export, FormatSpec, Import, Sign};
use super::volume::Texts;
use super::{FormatError, go_on};
use crate::progress::Progress;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::canvas_frame::CanvasFrame;
use crate::sculpture::grid::{BrickRun, uniform_in};
use crate::sculpture::history::{Contents, SurfaceKind};
use crate::sculpture::material::Page;
use crate::sculpture::{ColourDepth, Grid, Limits, Material, Rgb};

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, &MAGIC)],
    write: Some(Export::Sculpture),
    ..FormatSpec::new("a sculpture", &["vsc"], Import::Sculpture)
};

const MAGIC: [u8; 8] = [0x89, b'V', b'S', b'C', b'\r', b'\n', 0x1A, b'\n'];
const VERSION: u32 = 1;
const VERSION_WITH_MASK: u32 = 2;
const VERSION_WITH_FLAGS: u32 = 3;
const VERSION_WITH_CANVAS: u32 = 4;
const VERSION_WITH_NODES: u32 = 5;

/// Bricks of the largest sculpture that is written without a map: those of 1024^3 voxels.
const MOST_LISTED_BRICKS: usize = 1 << 21;

const FLAG_MASK: u32 = 1;
const FLAG_CUBES: u32 = 2;

/// Size before the optional flags and the checksum, in bytes.
const START_BYTES: usize = 52;
const ENTRY_BYTES: usize = 16;
/// Size of the flags, and of the canvas that follows them.
const FLAGS_BYTES: usize = 4;
const CANVAS_BYTES: usize = 28;
/// Size of the lengths of the map, which follow the canvas.
const MAP_BYTES: usize = 8;

/// Number of bricks of a chunk in written files, and its limits in read files.
const CHUNK_BRICKS: u32 = 4096;
const CHUNK_RANGE: std::ops::RangeInclusive<u32> = 64..=1 << 16;

/// The part of a file before its chunks.
#[derive(Clone, PartialEq, Debug)]
pub struct VscHeader {
    /// Size in voxels.
    pub dims: UVec3,
    /// Edge lengths of a voxel in world units.
    pub voxel_size: Vec3,
    /// Bits of colour per voxel.
    pub colour_depth: ColourDepth,
    /// Colour of unpainted voxels.
    pub base: Rgb,
    /// The texts stored with it.
    pub texts: Texts,
    chunk_bricks: usize,
    entries: Vec<ChunkEntry>,
    /// Start of the chunks.
    body: usize,
    /// Whether the mask follows them.
    has_mask: bool,
    /// The form in which near voxels are shown.
    pub surface: SurfaceKind,
    /// Where the box lies.
    pub frame: CanvasFrame,
    /// The map of a file of version 5.
    map: Option<NodeMap>,
}

/// Packs a sculpture.
pub fn write(
    contents: &Contents,
    texts: &Texts,
    progress: &dyn Progress,
) -> Result<Vec<u8>, FormatError> {
    let mut file = Vec::new();
    write_to(contents, texts, progress, &mut file)?;
    Ok(file)
}

/// Packs a sculpture to a writer, which receives a chunk at a time.
pub fn write_to(
    contents: &Contents,
    texts: &Texts,
    progress: &dyn Progress,
    out: &mut dyn Write,
) -> Result<(), FormatError> {
    let Contents { grid, material, mask, surface, frame } = contents;
    let texts = packed_texts(texts)?;
    let depth = material.depth();
    progress.begin("packing");
    let map = (grid.brick_count() > MOST_LISTED_BRICKS).then(|| NodeMap::of(contents));
    let chunks = match &map {
        None => listed_chunks(contents, progress),
        Some((map, _)) => chunks_of_leaves(contents, map, progress),
    };
    progress.end();
    go_on(progress)?;
    let mut head = MAGIC.to_vec();
    let mut number = |v: u32| head.extend_from_slice(&v.to_le_bytes());
    let version = match (surface, mask) {
        _ if map.is_some() => VERSION_WITH_NODES,
        _ if !contents.canvas().is_plain() => VERSION_WITH_CANVAS,
        (SurfaceKind::Cubes, _) => VERSION_WITH_FLAGS,
        (SurfaceKind::Smooth, Some(_)) => VERSION_WITH_MASK,
        (SurfaceKind::Smooth, None) => VERSION,
    };
    number(version);
    grid.dims().to_array().into_iter().for_each(&mut number);
    grid.voxel_size().to_array().into_iter().for_each(|edge| number(edge.to_bits()));
    let Rgb([r, g, b]) = material.base();
    number(u32::from_le_bytes([depth.bits() as u8, r, g, b]));
    number(CHUNK_BRICKS);
    number(chunks.len() as u32);
    number(texts.len() as u32);
    if version >= VERSION_WITH_FLAGS {
        let cubes = if *surface == SurfaceKind::Cubes { FLAG_CUBES } else { 0 };
        number(cubes | if mask.is_some() { FLAG_MASK } else { 0 });
    }
    if version >= VERSION_WITH_CANVAS {
        frame.origin.to_array().into_iter().for_each(|at| number(at as u32));
        frame.home.to_array().into_iter().for_each(&mut number);
        number(u32::from(frame.grows));
    }
    let map = map.map(|(_, plain)| (lz4_flex::block::compress(&plain), plain.len()));
    if let Some((packed, plain_bytes)) = &map {
        number(packed.len() as u32);
        number(*plain_bytes as u32);
    }
    let mut tail = Vec::with_capacity(chunks.len() * ENTRY_BYTES + texts.len());
    for (entry, _) in &chunks {
        let ChunkEntry { packed_bytes, plain_bytes, pages, checksum } = *entry;
        for v in [packed_bytes, plain_bytes, pages, checksum] {
            tail.extend_from_slice(&v.to_le_bytes());
        }
    }
    tail.extend_from_slice(&texts);
    tail.extend(map.into_iter().flat_map(|(packed, _)| packed));
    let checksum = checksum(&head, &tail);
    head.extend_from_slice(&checksum.to_le_bytes());
    out.write_all(&head)?;
    out.write_all(&tail)?;
    // Each is freed as soon as it is written.
    for (_, packed) in chunks {
        out.write_all(&packed)?;
    }
    match mask {
        Some(mask) => {
            let mask = Contents::of_bits((**mask).clone());
            write_to(&mask, &Texts::default(), &(), out)
        }
        None => Ok(()),
    }
}

/// Packs all bricks in linear order.
fn listed_chunks(contents: &Contents, progress: &dyn Progress) -> Vec<(ChunkEntry, Vec<u8>)> {
    let Contents { grid, material, .. } = contents;
    (0..grid.brick_count())
        .into_par_iter()
        .step_by(CHUNK_BRICKS as usize)
        .map(|first| {
            if progress.is_cancelled() {
                return (ChunkEntry::default(), Vec::new());
            }
            let bricks = grid.bricks_from(first).take(CHUNK_BRICKS as usize);
            let mut colours = material.reader();
            chunk::pack(bricks, |b| grid.valid_mask(b), |b| colours.page(b))
        })
        .collect()
}

/// Packs the bricks of the leaves of a map.
fn chunks_of_leaves(
    contents: &Contents,
    map: &NodeMap,
    progress: &dyn Progress,
) -> Vec<(ChunkEntry, Vec<u8>)> {
    let Contents { grid, material, .. } = contents;
    map.leaves()
        .par_chunks(CHUNK_LEAVES)
        .map(|leaves| {
            if progress.is_cancelled() {
                return (ChunkEntry::default(), Vec::new());
            }
            let bricks = leaves.iter().flat_map(|leaf| bricks_of(grid.brick_dims(), *leaf));
            let mut colours = material.reader();
            let bricks = bricks.map(|b| (b, grid.brick(b)));
            chunk::pack(bricks, |b| grid.valid_mask(b), |b| colours.page(b))
        })
        .collect()
}

/// Reads the header, and checks that the file has the stated length and that the sculpture is within `limits`.
pub(crate) fn read_header(file: &[u8], limits: &Limits) -> Result<VscHeader, FormatError> {
    if !file.starts_with(&MAGIC) {
        return Err(FormatError::NotVsc(excerpt(&file[..file.len().min(8)])));
    }
    let number = |at: usize| {
        let bytes = file.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
        u32::from_le_bytes(bytes.unwrap_or_default())
    };
    let version = number(8);
    let (flags_bytes, flags) = flags_of(version, file.len(), number(START_BYTES))?;
    // Without the checksum.
    let head_bytes = START_BYTES + flags_bytes;
    let Some((head, rest)) = file.split_at_checked(head_bytes + 4) else {
        return Err(FormatError::Damaged("it ends within its header"));
    };
    let dims = UVec3::new(number(12), number(16), number(20));
    let voxel_size = Vec3::from([24, 28, 32].map(|at| f32::from_bits(number(at))));
    Grid::check_size(dims, voxel_size)?;
    let (colour_depth, base) = colours_of(number(36))?;
    let (chunk_bricks, count, text_bytes) = (number(40), number(44), number(48));
    let bricks = ((dims + (BRICK_EDGE_VX - 1)) / BRICK_EDGE_VX).as_u64vec3().element_product();
    if !chunks_fit(version, bricks, chunk_bricks, count) {
        return Err(FormatError::Damaged("its chunks do not fit its size"));
    }
    if u64::from(text_bytes) > TEXTS_LIMIT {
        return Err(FormatError::TextsTooLong);
    }
    let cut = FormatError::Damaged("it ends within its table");
    let map_at = START_BYTES + FLAGS_BYTES + CANVAS_BYTES;
    let (map_bytes, plain_map_bytes) = match version {
        VERSION_WITH_NODES => (number(map_at), number(map_at + 4)),
        _ => (0, 0),
    };
    let tail_bytes = count as usize * ENTRY_BYTES + text_bytes as usize + map_bytes as usize;
    let (tail, body) = rest.split_at_checked(tail_bytes).ok_or(cut)?;
    if checksum(&head[..head_bytes], tail) != number(head_bytes) {
        return Err(FormatError::Damaged("the checksum of its header is wrong"));
    }
    if flags & !(FLAG_MASK | FLAG_CUBES) != 0 {
        return Err(FormatError::Damaged("its flags are unknown"));
    }
    let of_frame = |i| number(START_BYTES + 4 + 4 * i);
    let frame = match version {
        VERSION_WITH_CANVAS.. => frame_of(std::array::from_fn(of_frame))?,
        _ => CanvasFrame::of(dims),
    };
    let (table, rest) = tail.split_at(count as usize * ENTRY_BYTES);
    let (texts, map) = rest.split_at(text_bytes as usize);
    let map = match version {
        VERSION_WITH_NODES => Some(NodeMap::unpack(map, plain_map_bytes, dims, colour_depth)?),
        _ => None,
    };
    let sizes = match &map {
        None => sizes_of_chunks(bricks as usize, chunk_bricks as usize),
        Some(map) => map.chunk_sizes(),
    };
    if sizes.len() != count as usize {
        return Err(FormatError::Damaged("its chunks do not fit its size"));
    }
    let entries = entries(table, &sizes, colour_depth)?;
    let has_mask = flags & FLAG_MASK != 0;
    check_length(&entries, body, has_mask)?;
    check_colours(&entries, &Material::new(colour_depth, base, dims), limits)?;
    Ok(VscHeader {
        dims,
        voxel_size,
        colour_depth,
        base,
        texts: unpacked_texts(texts)?,
        chunk_bricks: chunk_bricks as usize,
        entries,
        body: head.len() + tail_bytes,
        has_mask,
        surface: match flags & FLAG_CUBES {
            0 => SurfaceKind::Smooth,
            _ => SurfaceKind::Cubes,
        },
        frame,
        map,
    })
}

/// Returns the bytes between the start of a header and its checksum, in a file of `file_bytes`, and the flags, which are
/// `stored` where the version has any.
fn flags_of(version: u32, file_bytes: usize, stored: u32) -> Result<(usize, u32), FormatError> {
    match version {
        VERSION => Ok((0, 0)),
        VERSION_WITH_MASK => Ok((0, FLAG_MASK)),
        VERSION_WITH_FLAGS => Ok((FLAGS_BYTES, stored)),
        VERSION_WITH_CANVAS => Ok((FLAGS_BYTES + CANVAS_BYTES, stored)),
        VERSION_WITH_NODES => Ok((FLAGS_BYTES + CANVAS_BYTES + MAP_BYTES, stored)),
        _ if file_bytes < START_BYTES => Err(FormatError::Damaged("it ends within its header")),
        _ => Err(FormatError::VscVersion(version)),
    }
}

/// Returns whether `count` chunks of `chunk_bricks` can be those of so many bricks.
fn chunks_fit(version: u32, bricks: u64, chunk_bricks: u32, count: u32) -> bool {
    match version {
        VERSION_WITH_NODES => chunk_bricks == CHUNK_BRICKS,
        _ => {
            CHUNK_RANGE.contains(&chunk_bricks)
                && u64::from(count) == bricks.div_ceil(u64::from(chunk_bricks))
        }
    }
}

/// Returns an error unless the chunks fill the body of a file, up to its mask if it has one.
fn check_length(entries: &[ChunkEntry], body: &[u8], has_mask: bool) -> Result<(), FormatError> {
    let packed: u64 = entries.iter().map(|entry| u64::from(entry.packed_bytes)).sum();
    if packed > body.len() as u64 || (packed < body.len() as u64) != has_mask {
        return Err(FormatError::Damaged("it is shorter or longer than it says"));
    }
    Ok(())
}

/// Returns the depth and the base of the colours from their number.
fn colours_of(number: u32) -> Result<(ColourDepth, Rgb), FormatError> {
    let [bits, r, g, b] = number.to_le_bytes();
    let depth = ColourDepth::from_bits(u32::from(bits));
    Ok((depth.ok_or(FormatError::Damaged("its bits of colour are unknown"))?, Rgb([r, g, b])))
}

/// Returns the bricks of each chunk.
fn sizes_of_chunks(bricks: usize, chunk: usize) -> Vec<usize> {
    (0..bricks).step_by(chunk).map(|first| chunk.min(bricks - first)).collect()
}

/// Returns the frame of the numbers that follow the flags.
fn frame_of(
    [x, y, z, home_x, home_y, home_z, grows]: [u32; 7],
) -> Result<CanvasFrame, FormatError> {
    let frame = CanvasFrame {
        origin: IVec3::new(x as i32, y as i32, z as i32),
        home: UVec3::new(home_x, home_y, home_z),
        grows: grows == 1,
    };
    match frame.check().is_ok() && grows <= 1 {
        true => Ok(frame),
        false => Err(FormatError::Damaged("its canvas is not possible")),
    }
}

/// Returns the rows of the table, each checked against the number of bricks of its chunk.
fn entries(
    table: &[u8],
    sizes: &[usize],
    depth: ColourDepth,
) -> Result<Vec<ChunkEntry>, FormatError> {
    let entries = table.as_chunks::<ENTRY_BYTES>().0.iter().map(|entry| {
        let part = |i: usize| u32::from_le_bytes(std::array::from_fn(|b| entry[4 * i + b]));
        ChunkEntry {
            packed_bytes: part(0),
            plain_bytes: part(1),
            pages: part(2),
            checksum: part(3),
        }
    });
    let entries: Vec<ChunkEntry> = entries.collect();
    for (entry, bricks) in entries.iter().zip(sizes) {
        entry.check(*bricks, depth)?;
    }
    Ok(entries)
}

/// Most bytes that a page takes in memory beyond those that it takes in a chunk, before the chunk is packed.
const PAGE_MORE_BYTES: u64 = 96;

/// Checks the memory that the colours of all pages would take.
fn check_colours(
    entries: &[ChunkEntry],
    colours: &Material,
    limits: &Limits,
) -> Result<(), FormatError> {
    let pages: u64 = entries.iter().map(|entry| u64::from(entry.pages)).sum();
    if pages == 0 {
        return Ok(());
    }
    let plain = entries.iter().filter(|entry| entry.pages > 0);
    let plain: u64 = plain.map(|entry| u64::from(entry.plain_bytes)).sum();
    let needed = colours.bytes_for_pages(pages, plain + pages * PAGE_MORE_BYTES);
    check_colour_budget(needed, limits.colour_bytes)
}

/// Unpacks a sculpture, within `limits`.
pub fn read(
    file: &[u8],
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<(Contents, Texts), FormatError> {
    let header = read_header(file, limits)?;
    let VscHeader { dims, voxel_size, colour_depth: depth, base, chunk_bricks, .. } = header;
    let mut grid = Grid::of_size(dims, voxel_size)?;
    let mut rest = &file[header.body..];
    let chunks: Vec<(ChunkEntry, &[u8])> = header
        .entries
        .iter()
        .map(|&entry| {
            // The header's check has added up the lengths.
            let (packed, after) = rest.split_at(entry.packed_bytes as usize);
            rest = after;
            (entry, packed)
        })
        .collect();
    progress.begin("unpacking");
    let room = BitsRoom::new(limits.grid_bytes);
    let unpack = |chunk: usize, bricks: &mut BrickRun| {
        go_on(progress)?;
        let (entry, packed) = &chunks[chunk];
        chunk::unpack(entry, packed, bricks, depth, &room)
    };
    let pages: Result<Vec<Vec<(UVec3, Page)>>, FormatError> = match &header.map {
        None => {
            grid.try_fill_runs(chunk_bricks, |first, bricks| unpack(first / chunk_bricks, bricks))
        }
        Some(map) => {
            let leaves = (map.leaves(), CHUNK_LEAVES);
            grid.try_fill_leaves(|cube| map.is_full(cube), leaves, unpack)
        }
    };
    progress.end();
    let mut material = Material::for_grid(&grid, depth, base);
    material.set_pages(pages?.into_iter().flatten().collect());
    if let Some(map) = &header.map {
        map.painted().iter().for_each(|(cube, page)| material.set_cube(*cube, page.clone()));
    }
    let (surface, frame) = (header.surface, header.frame);
    let mut contents = Contents { surface, frame, ..Contents::new(grid, material) };
    if header.has_mask {
        contents.mask = Some(Box::new(read_mask(rest, &contents.grid, limits)?));
        contents.drop_empty_mask();
    }
    Ok((contents, header.texts))
}

/// Unpacks the mask of a grid.
fn read_mask(file: &[u8], grid: &Grid, limits: &Limits) -> Result<Grid, FormatError> {
    let header = read_header(file, limits)?;
    if header.has_mask || header.colour_depth != ColourDepth::None || header.dims != grid.dims() {
        return Err(FormatError::Damaged("its mask does not fit its size"));
    }
    let (mask, _) = read(file, limits, &())?;
    let mut bits = grid.emptied();
    bits.fill_cubes(|cube| uniform_in(&mask.grid, cube), |b| *mask.grid.brick(b));
    Ok(bits)
}

fn checksum(head: &[u8], tail: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(head);
    crc.update(tail);
    crc.finalize()
}

fn packed_texts(texts: &Texts) -> Result<Vec<u8>, FormatError> {
    let mut packed = Vec::new();
    if texts.is_empty() {
        return Ok(packed);
    }
    for (_, text) in texts.named() {
        packed.extend_from_slice(&(text.len() as u32).to_le_bytes());
        packed.extend_from_slice(text);
    }
    if packed.len() as u64 > TEXTS_LIMIT {
        return Err(FormatError::TextsTooLong);
    }
    Ok(packed)
}

fn unpacked_texts(mut packed: &[u8]) -> Result<Texts, FormatError> {
    let mut texts = Texts::default();
    if packed.is_empty() {
        return Ok(texts);
    }
    let Texts { description, courtesy, parameter, comment } = &mut texts;
    for text in [description, courtesy, parameter, comment] {
        let (len, rest) = packed.split_first_chunk().ok_or(FormatError::TextsCut)?;
        let len = u32::from_le_bytes(*len) as usize;
        let (bytes, rest) = rest.split_at_checked(len).ok_or(FormatError::TextsCut)?;
        *text = bytes.to_vec();
        packed = rest;
    }
    if packed.is_empty() { Ok(texts) } else { Err(FormatError::Trailing(packed.len() as u64)) }
}

#[cfg(test)]
mod tests;
