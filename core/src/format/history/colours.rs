//! The colours of an undo step's record as bytes, a part of those of [`super::record`]:
//!
//! 1. three u32: how many cubes, how many leaves, how many pages of bricks of these leaves;
//! 2. each cube: u64 place, then its state: u32 packed bytes (0 if it has no pages), and these bytes: a page, packed as in
//!    .vsc files, of one colour. Or, in place of the packed bytes, all ones: then eight u64 follow, a mask of painted
//!    children, and the states of these. A place is the x, y and z of the cube in units of its edge (16 bits each, the
//!    lowest first) and its level (16 bits): a cube of level `n` is `8^n` bricks an edge;
//! 3. each leaf: u64 place of its cube, eight u64 for its recorded bricks, eight for those of them that have a page;
//! 4. each of these pages: u32 packed bytes, and these bytes.
//!
//! Cubes and leaves name no brick twice. Leaves rise by z, y and x.

use std::collections::HashSet;

use glam::UVec3;

use super::ContentsShape;
use super::blocks::{BlockReader, BlockWriter};
use super::record::{FAULT, brick_count};
use crate::format::FormatError;
use crate::format::vsc::chunk::{pack_page, unpack_page};
use crate::sculpture::brick::BRICK_VOXELS;
use crate::sculpture::brick_set::LeafKey;
use crate::sculpture::colour_record::ColourRecord;
use crate::sculpture::grid::{brick_dims, unflatten};
use crate::sculpture::index_set::IndexSet;
use crate::sculpture::material::{ColourCube, KeptLeaf, Page, PageView, PaintedChild, levels_of};
use crate::sculpture::{Brick, ColourDepth};

/// Stands for the packed bytes of a cube that has children.
const CHILDREN: u32 = u32::MAX;

/// Greatest size of a packed page, in bytes.
const MAX_PACKED_PAGE: usize = 1 + BRICK_VOXELS as usize * 3;

/// Writes the colours of a record.
pub fn write(record: &ColourRecord, blocks: &mut BlockWriter) -> std::io::Result<()> {
    for count in [record.cubes().len(), record.leaves().len(), record.pages().len()] {
        blocks.u32(count as u32)?;
    }
    let depth = record.depth();
    for (cube, state) in record.cubes() {
        blocks.u64(place_of(*cube))?;
        match state {
            Some(state) => write_state(state, depth, blocks)?,
            None => blocks.u32(0)?,
        }
    }
    for KeptLeaf { leaf, bricks, painted } in record.leaves() {
        blocks.u64(place_of(ColourCube { low: leaf.coords() << 3, level: 1 }))?;
        for word in bricks.words.iter().chain(&painted.words) {
            blocks.u64(*word)?;
        }
    }
    record.pages().iter().try_for_each(|page| write_page(page, depth, blocks))
}

fn write_state(
    state: &PaintedChild,
    depth: ColourDepth,
    blocks: &mut BlockWriter,
) -> std::io::Result<()> {
    let node = match state {
        PaintedChild::Page(page) => return write_page(page, depth, blocks),
        PaintedChild::Node(node) => node,
    };
    blocks.u32(CHILDREN)?;
    for word in node.painted.words {
        blocks.u64(word)?;
    }
    node.painted_children().iter().try_for_each(|child| write_state(child, depth, blocks))
}

fn write_page(page: &Page, depth: ColourDepth, blocks: &mut BlockWriter) -> std::io::Result<()> {
    let mut packed = Vec::new();
    pack_page(PageView::of(page, depth), &mut packed);
    blocks.u32(packed.len() as u32)?;
    blocks.bytes(&packed)
}

/// Reads the colours of a record for contents of `shape`.
pub fn read(blocks: &mut BlockReader, shape: ContentsShape) -> Result<ColourRecord, FormatError> {
    let mut counts = [0; 3];
    for count in &mut counts {
        *count = blocks.u32()? as usize;
    }
    // Each brick is named at most once.
    let is_possible = counts.iter().all(|&count| count as u64 <= brick_count(shape));
    if !is_possible || (counts != [0; 3] && shape.depth == ColourDepth::None) {
        return Err(FAULT);
    }
    let [cube_count, leaf_count, page_count] = counts;
    let dims = brick_dims(shape.dims);
    let mut named = NamedCubes { levels: levels_of(dims), ..NamedCubes::default() };
    let mut cubes = Vec::with_capacity(cube_count);
    for _ in 0..cube_count {
        let cube = read_place(blocks, dims)?;
        if cube.level == 0 {
            return Err(FAULT);
        }
        named.add(cube)?;
        cubes.push((cube, read_state(blocks, cube, shape)?));
    }
    let mut leaves: Vec<KeptLeaf> = Vec::with_capacity(leaf_count);
    let mut painted_count = 0;
    for _ in 0..leaf_count {
        let cube = read_place(blocks, dims)?;
        let (mut bricks, mut painted) = (Brick::EMPTY, Brick::EMPTY);
        for word in bricks.words.iter_mut().chain(&mut painted.words) {
            *word = blocks.u64()?;
        }
        let inside = Brick::below((dims - cube.low).to_array());
        let fits = bricks.and(&inside) == bricks && painted.and(&bricks) == painted;
        if cube.level != 1 || bricks.is_empty() || !fits {
            return Err(FAULT);
        }
        named.add(cube)?;
        painted_count += usize::from(painted.count());
        leaves.push(KeptLeaf { leaf: LeafKey::of(cube.low >> 3), bricks, painted });
    }
    if painted_count != page_count || !leaves.is_sorted_by_key(|kept| kept.leaf) {
        return Err(FAULT);
    }
    let mut pages = Vec::with_capacity(page_count);
    for _ in 0..page_count {
        pages.push(read_page(blocks, shape.depth)?.ok_or(FAULT)?);
    }
    Ok(ColourRecord::from_parts(cubes, leaves, pages, shape.depth))
}

/// Reads the state of a cube.
fn read_state(
    blocks: &mut BlockReader,
    cube: ColourCube,
    shape: ContentsShape,
) -> Result<Option<PaintedChild>, FormatError> {
    let length = blocks.u32()?;
    if length != CHILDREN {
        let page = read_page_of(length, blocks, shape.depth)?;
        let is_uniform = |page: &Page| PageView::of(page, shape.depth).uniform().is_some();
        let fits = cube.level == 0 || page.as_ref().is_none_or(is_uniform);
        return if fits { Ok(page.map(PaintedChild::Page)) } else { Err(FAULT) };
    }
    let mut painted = Brick::EMPTY;
    for word in &mut painted.words {
        *word = blocks.u64()?;
    }
    if cube.level == 0 {
        return Err(FAULT);
    }
    let mut children = Vec::with_capacity(usize::from(painted.count()));
    for index in (0..512).filter(|index| painted.words[index / 64] >> (index % 64) & 1 != 0) {
        let child = read_state(blocks, cube.child_at(index as u32), shape)?;
        children.push(child.ok_or(FAULT)?);
    }
    PaintedChild::of_children(painted, children, cube, shape.dims).ok_or(FAULT).map(Some)
}

/// Reads the colours of a record that has a page for each brick.
pub fn read_pages(
    blocks: &mut BlockReader,
    shape: ContentsShape,
    page_count: usize,
) -> Result<ColourRecord, FormatError> {
    if page_count > 0 && shape.depth == ColourDepth::None {
        return Err(FAULT);
    }
    let dims = brick_dims(shape.dims);
    let mut named = IndexSet::new(brick_count(shape) as usize);
    let mut pages = Vec::with_capacity(page_count);
    for _ in 0..page_count {
        let index = blocks.u32()?;
        if u64::from(index) >= brick_count(shape) || named.contains(index) {
            return Err(FAULT);
        }
        named.insert(index);
        pages.push((unflatten(index, dims), read_page(blocks, shape.depth)?));
    }
    Ok(ColourRecord::of_pages(pages, shape.depth))
}

/// Reads a page, or its absence.
fn read_page(blocks: &mut BlockReader, depth: ColourDepth) -> Result<Option<Page>, FormatError> {
    let length = blocks.u32()?;
    read_page_of(length, blocks, depth)
}

/// Reads a page of so many packed bytes, or its absence.
fn read_page_of(
    length: u32,
    blocks: &mut BlockReader,
    depth: ColourDepth,
) -> Result<Option<Page>, FormatError> {
    let mut packed = [0; MAX_PACKED_PAGE];
    let packed = packed.get_mut(..length as usize).ok_or(FAULT)?;
    blocks.fill(packed)?;
    let mut rest = &*packed;
    let page = match length {
        0 => None,
        _ => Some(unpack_page(depth, &mut rest)?),
    };
    if rest.is_empty() { Ok(page) } else { Err(FAULT) }
}

fn place_of(cube: ColourCube) -> u64 {
    let UVec3 { x, y, z } = cube.low >> cube.log2();
    let parts = [x, y, z, cube.level];
    parts.iter().rev().fold(0, |all, part| all << 16 | u64::from(*part))
}

/// Reads the place of a cube that holds bricks of a sculpture of `dims` bricks.
fn read_place(blocks: &mut BlockReader, dims: UVec3) -> Result<ColourCube, FormatError> {
    let place = blocks.u64()?;
    let part = |i: u32| (place >> (16 * i)) as u32 & 0xFFFF;
    let level = part(3);
    if level > levels_of(dims) {
        return Err(FAULT);
    }
    let at = UVec3::new(part(0), part(1), part(2));
    let log2 = ColourCube { low: UVec3::ZERO, level }.log2();
    if at.cmpgt((dims - 1) >> log2).any() {
        return Err(FAULT);
    }
    Ok(ColourCube { low: at << log2, level })
}

/// The cubes that a record has named so far, and all that hold one of them.
#[derive(Default)]
struct NamedCubes {
    levels: u32,
    named: HashSet<ColourCube>,
    around: HashSet<ColourCube>,
}

impl NamedCubes {
    /// Adds a cube, which must not overlap one of the others.
    fn add(&mut self, cube: ColourCube) -> Result<(), FormatError> {
        let mut above =
            (cube.level + 1..=self.levels).map(|level| ColourCube::around(cube.low, level));
        let is_within = above.clone().any(|above| self.named.contains(&above));
        if is_within || self.around.contains(&cube) || !self.named.insert(cube) {
            return Err(FAULT);
        }
        // Those beyond one that is known are known, too.
        let _ = above.all(|above| self.around.insert(above));
        Ok(())
    }
}
