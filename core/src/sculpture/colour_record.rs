//! The colours of an undo step, and of the stroke in progress: the earlier pages of some bricks, by leaf, and earlier
//! states of whole cubes, which take an entry each, whatever their size.
//!
//! A stroke keeps the colours as it found them, which costs nothing until they change, and which bricks and cubes have
//! changed. Takes the changes of painting; gives the record. Knows no bits, no document and no budget.

use std::collections::TryReserveError;

use glam::UVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::brick::Brick;
use super::brick_set::{BrickSet, LeafKey};
use super::colour::ColourDepth;
use super::material::{ColourCube, KeptLeaf, Material, Page, Painted, PaintedChild};
use super::memory;

/// Earlier colours of some bricks, each named at most once.
#[derive(Clone, Default, Debug)]
pub struct ColourRecord {
    cubes: Vec<(ColourCube, Option<PaintedChild>)>,
    leaves: Vec<KeptLeaf>,
    /// The pages of the painted bricks of `leaves`, in their order.
    pages: Vec<Page>,
    /// The colour depth; any in a record of nothing.
    depth: ColourDepth,
}

impl ColourRecord {
    /// Returns a record of the pages of bricks, or their absence, each brick listed once.
    pub(crate) fn of_pages(
        mut bricks: Vec<(UVec3, Option<Page>)>,
        depth: ColourDepth,
    ) -> ColourRecord {
        let index = |b: UVec3| super::brick::local_index(b.x & 7, b.y & 7, b.z & 7);
        bricks.sort_unstable_by_key(|(b, _)| (LeafKey::of(*b >> 3), index(*b)));
        let mut record = ColourRecord { depth, ..ColourRecord::default() };
        for (b, page) in bricks {
            let leaf = LeafKey::of(b >> 3);
            if record.leaves.last().is_none_or(|last| last.leaf != leaf) {
                record.leaves.push(KeptLeaf { leaf, bricks: Brick::EMPTY, painted: Brick::EMPTY });
            }
            let Some(kept) = record.leaves.last_mut() else { continue };
            kept.bricks.set(b.x & 7, b.y & 7, b.z & 7, true);
            kept.painted.set(b.x & 7, b.y & 7, b.z & 7, page.is_some());
            record.pages.extend(page);
        }
        record
    }

    /// Returns the colour depth of the pages.
    pub(crate) fn depth(&self) -> ColourDepth {
        self.depth
    }

    /// Returns whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.cubes.is_empty() && self.leaves.is_empty()
    }

    /// Returns the heap bytes in use, shared or not.
    pub fn heap_bytes(&self) -> usize {
        let cubes =
            self.cubes.iter().map(|(_, child)| child.as_ref().map_or(0, PaintedChild::heap_bytes));
        self.cubes.capacity() * CUBE_BYTES
            + cubes.sum::<usize>()
            + self.leaves.capacity() * LEAF_BYTES
            + self.pages.capacity() * size_of::<Page>()
            + self.pages.iter().map(Page::heap_bytes).sum::<usize>()
    }

    /// Returns an upper bound of the heap bytes of the reverse record.
    pub(super) fn reverse_bytes(&self, material: &Material) -> usize {
        let cubes = self.cubes.iter().map(|(cube, _)| bytes_of_cube(material, *cube));
        let leaves = self
            .leaves
            .iter()
            .map(|kept| LEAF_BYTES + bytes_of_pages(material, kept.leaf, &kept.bricks));
        cubes.sum::<usize>() + leaves.sum::<usize>()
    }

    /// Returns a copy, unless the system lacks the memory for it. Pages and nodes are shared.
    pub(super) fn copied(&self) -> Result<ColourRecord, TryReserveError> {
        Ok(ColourRecord {
            cubes: memory::copied(&self.cubes)?,
            leaves: memory::copied(&self.leaves)?,
            pages: memory::copied(&self.pages)?,
            depth: self.depth,
        })
    }

    /// Returns an empty record with room for the reverse, unless the system lacks the memory for it.
    pub(super) fn room(&self, material: &Material) -> Result<ColourRecord, TryReserveError> {
        let mut room = ColourRecord::default();
        room.cubes.try_reserve_exact(self.cubes.len())?;
        room.leaves.try_reserve_exact(self.leaves.len())?;
        let pages = self.leaves.iter().map(|kept| painted_in(material, kept.leaf, &kept.bricks));
        room.pages.try_reserve_exact(pages.sum())?;
        Ok(room)
    }

    /// Writes the kept colours; those that they replace go to `reverse`, which is empty. Adds the bricks that differ to
    /// `touched`.
    pub(super) fn swap_into(
        self,
        reverse: &mut ColourRecord,
        material: &mut Material,
        touched: &mut BrickSet,
    ) {
        for (cube, child) in self.cubes {
            let old = material.replace(cube, child);
            material.for_each_differing(cube, old.as_ref(), &mut |leaf, bricks| {
                touched.insert_in(leaf, bricks);
            });
            reverse.cubes.push((cube, old));
        }
        reverse.depth = self.depth;
        let mut pages = self.pages.into_iter();
        for kept in &self.leaves {
            reverse.leaves.push(material.keep(kept.leaf, kept.bricks, &mut reverse.pages));
            material.put_kept(kept, &mut pages);
            touched.insert_in(kept.leaf, &kept.bricks);
        }
        reverse.shrink_to_fit();
    }

    fn shrink_to_fit(&mut self) {
        self.cubes.shrink_to_fit();
        self.leaves.shrink_to_fit();
        self.pages.shrink_to_fit();
    }

    /// Returns the cubes with their states.
    pub(crate) fn cubes(&self) -> &[(ColourCube, Option<PaintedChild>)] {
        &self.cubes
    }

    /// Returns the leaves with recorded bricks, rising by key.
    pub(crate) fn leaves(&self) -> &[KeptLeaf] {
        &self.leaves
    }

    /// Returns the pages of the painted bricks of the leaves, in their order.
    pub(crate) fn pages(&self) -> &[Page] {
        &self.pages
    }

    /// Returns a record of the values of [`ColourRecord::cubes`], [`ColourRecord::leaves`] and [`ColourRecord::pages`],
    /// which must name no brick twice.
    pub(crate) fn from_parts(
        cubes: Vec<(ColourCube, Option<PaintedChild>)>,
        leaves: Vec<KeptLeaf>,
        pages: Vec<Page>,
        depth: ColourDepth,
    ) -> ColourRecord {
        ColourRecord { cubes, leaves, pages, depth }
    }
}

impl PartialEq for ColourRecord {
    /// Compares the states of bricks. The depth of a record that names none does not matter.
    fn eq(&self, other: &ColourRecord) -> bool {
        (self.is_empty() || self.depth == other.depth)
            && self.cubes == other.cubes
            && self.leaves == other.leaves
            && self.pages == other.pages
    }
}

const CUBE_BYTES: usize = size_of::<(ColourCube, Option<PaintedChild>)>();
const LEAF_BYTES: usize = size_of::<KeptLeaf>();

/// Returns the bytes that the present state of a cube takes in a record.
fn bytes_of_cube(material: &Material, cube: ColourCube) -> usize {
    CUBE_BYTES + material.find(cube).map_or(0, PaintedChild::heap_bytes)
}

/// Returns the bytes that the present pages of bricks of a leaf take in a record.
fn bytes_of_pages(material: &Material, leaf: LeafKey, bricks: &Brick) -> usize {
    let mut bytes = 0;
    material
        .for_each_page(leaf, bricks, &mut |page| bytes += size_of::<Page>() + page.heap_bytes());
    bytes
}

/// Returns how many bricks of a leaf have a page.
fn painted_in(material: &Material, leaf: LeafKey, bricks: &Brick) -> usize {
    let mut painted = 0;
    material.for_each_page(leaf, bricks, &mut |_| painted += 1);
    painted
}

/// Collects the record of the stroke in progress.
#[derive(Debug, Default)]
pub(super) struct ColourRecorder {
    /// The colours as the stroke found them, once it paints.
    before: Option<Material>,
    /// The bricks that have changed, but for those of `cubes`.
    leaves: FxHashMap<LeafKey, Brick>,
    /// The cubes that have changed, none within another.
    cubes: FxHashSet<ColourCube>,
    /// The bytes of the record so far.
    bytes: usize,
}

impl ColourRecorder {
    /// Prepares for an edit of colours, which may be the first.
    pub fn begin(&mut self, material: &Material) {
        // An earlier edit may have been prepared for and have changed nothing; the colours may be others since.
        if self.leaves.is_empty() && self.cubes.is_empty() {
            self.before = Some(material.clone());
        }
    }

    /// Notes the changes of painting.
    pub fn note(&mut self, painted: &Painted) {
        let Some(before) = &self.before else { return };
        let levels = before.whole().level;
        for cube in &painted.cubes {
            if is_in(&self.cubes, cube.low, cube.level, levels) || !self.cubes.insert(*cube) {
                continue;
            }
            self.bytes += bytes_of_cube(before, *cube);
        }
        if !painted.cubes.is_empty() {
            // All that lies within a new cube is part of it.
            let all = self.cubes.clone();
            let mut bytes = 0;
            self.cubes.retain(|cube| {
                let stays = !is_in(&all, cube.low, cube.level + 1, levels);
                bytes += if stays { 0 } else { bytes_of_cube(before, *cube) };
                stays
            });
            self.leaves.retain(|leaf, bricks| {
                let stays = !is_in(&all, leaf.coords() << 3, 1, levels);
                bytes += if stays { 0 } else { LEAF_BYTES + bytes_of_pages(before, *leaf, bricks) };
                stays
            });
            self.bytes -= bytes;
        }
        for (leaf, bricks) in &painted.leaves {
            if is_in(&self.cubes, leaf.coords() << 3, 1, levels) {
                continue;
            }
            let known = self.leaves.entry(*leaf).or_insert_with(|| {
                self.bytes += LEAF_BYTES;
                Brick::EMPTY
            });
            self.bytes += bytes_of_pages(before, *leaf, &bricks.and_not(known));
            *known = known.or(bricks);
        }
    }

    /// Returns the bytes that the record takes so far.
    pub fn bytes(&self) -> usize {
        if self.bytes == 0 { 0 } else { size_of::<ColourRecord>() + self.bytes }
    }

    /// Resumes a stroke that has ended with a record. `now`: the colours at its end.
    pub fn resume(&mut self, record: &ColourRecord, now: &Material) {
        let (mut before, mut reverse) = (now.clone(), ColourRecord::default());
        record.clone().swap_into(&mut reverse, &mut before, &mut BrickSet::default());
        self.before = Some(before);
        let leaves = record.leaves.iter().map(|kept| (kept.leaf, kept.bricks));
        let cubes = record.cubes.iter().map(|(cube, _)| *cube);
        self.note(&Painted {
            leaves: leaves.collect(),
            cubes: cubes.collect(),
            ..Painted::default()
        });
    }

    /// Ends the stroke and returns its record.
    pub fn finish(&mut self) -> ColourRecord {
        let Some(before) = self.before.take() else { return ColourRecord::default() };
        self.bytes = 0;
        let mut cubes: Vec<ColourCube> = self.cubes.drain().collect();
        cubes.sort_unstable_by_key(|cube| (cube.low.z, cube.low.y, cube.low.x));
        let mut leaves: Vec<_> = self.leaves.drain().collect();
        leaves.sort_unstable_by_key(|(leaf, _)| *leaf);
        let mut record = ColourRecord { depth: before.depth(), ..ColourRecord::default() };
        record.cubes = cubes.into_iter().map(|cube| (cube, before.find(cube).cloned())).collect();
        for (leaf, bricks) in leaves {
            record.leaves.push(before.keep(leaf, bricks, &mut record.pages));
        }
        record.shrink_to_fit();
        record
    }
}

/// Returns whether a brick lies in one of the cubes of a level or higher.
fn is_in(cubes: &FxHashSet<ColourCube>, b: UVec3, level: u32, levels: u32) -> bool {
    !cubes.is_empty() && (level..=levels).any(|level| cubes.contains(&ColourCube::around(b, level)))
}
