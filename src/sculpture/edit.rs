//! Owns the one place where existence bits and colours change: a [`Region`] of voxels meets
//! an [`EditOp`], brick by brick, in parallel.
//!
//! Takes the contents and the open [`Stroke`]; gives counts of what changed, fills the
//! stroke's record with the earlier values, and marks bricks dirty. Knows no tool: a tool is
//! whatever can say which voxels of a brick it covers.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::brick::{BRICK_EDGE_VX, Brick};
use super::colour::Rgb;
use super::grid::Grid;
use super::history::{BrickRecord, Contents};

/// What happens to the voxels of a region.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum EditOp {
    /// They exist afterwards; those that did not before get the colour.
    Add(Rgb),
    /// They are gone afterwards.
    Subtract,
    /// Those that exist get the colour.
    Recolour(Rgb),
}

/// How much of a brick a region covers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Coverage {
    None,
    All,
    Some(Brick),
}

/// A half-open box of voxels, `min` inclusive and `max` exclusive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VoxelBox {
    pub min: IVec3,
    pub max: IVec3,
}

impl VoxelBox {
    pub fn of_grid(grid: &Grid) -> VoxelBox {
        VoxelBox { min: IVec3::ZERO, max: grid.dims().as_ivec3() }
    }

    pub fn intersect(self, other: VoxelBox) -> VoxelBox {
        VoxelBox { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    pub fn is_empty(self) -> bool {
        !self.min.cmplt(self.max).all()
    }
}

/// A set of voxels that can be asked brick by brick.
pub trait Region: Sync {
    /// A box outside of which the region covers nothing (it may reach beyond the grid).
    fn bounds_vx(&self) -> VoxelBox;

    /// The voxels covered of the brick whose lower corner is `origin_vx`. Voxels beyond the
    /// grid's border may be included; the edit cuts them off.
    fn coverage(&self, origin_vx: UVec3) -> Coverage;
}

/// A region of all voxels.
pub struct Everywhere;

impl Region for Everywhere {
    fn bounds_vx(&self) -> VoxelBox {
        VoxelBox { min: IVec3::ZERO, max: IVec3::MAX }
    }

    fn coverage(&self, _: UVec3) -> Coverage {
        Coverage::All
    }
}

/// What an edit did.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct EditStats {
    pub voxels_added: u64,
    pub voxels_removed: u64,
    pub voxels_recoloured: u64,
    pub bricks_changed: u64,
}

impl EditStats {
    pub fn voxels_changed(&self) -> u64 {
        self.voxels_added + self.voxels_removed + self.voxels_recoloured
    }
}

impl std::ops::AddAssign for EditStats {
    fn add_assign(&mut self, other: EditStats) {
        self.voxels_added += other.voxels_added;
        self.voxels_removed += other.voxels_removed;
        self.voxels_recoloured += other.voxels_recoloured;
        self.bricks_changed += other.bricks_changed;
    }
}

/// Bricks that changed since the renderer last asked.
#[derive(Debug, Default)]
pub struct DirtySet {
    marks: Vec<u64>,
    list: Vec<u32>,
}

impl DirtySet {
    pub fn new(brick_count: usize) -> DirtySet {
        DirtySet { marks: vec![0; brick_count.div_ceil(64)], list: Vec::new() }
    }

    #[inline]
    pub fn mark(&mut self, brick: u32) {
        let (word, bit) = (brick as usize / 64, 1u64 << (brick % 64));
        if self.marks[word] & bit == 0 {
            self.marks[word] |= bit;
            self.list.push(brick);
        }
    }

    #[inline]
    fn contains(&self, brick: u32) -> bool {
        self.marks[brick as usize / 64] >> (brick % 64) & 1 != 0
    }

    pub fn bricks(&self) -> &[u32] {
        &self.list
    }

    pub fn clear(&mut self) {
        for &brick in &self.list {
            self.marks[brick as usize / 64] = 0;
        }
        self.list.clear();
    }
}

/// An open undo step: the values that bricks had when it began.
#[derive(Debug)]
pub struct Stroke {
    pub label: String,
    record: BrickRecord,
    bits_saved: DirtySet,
    pages_saved: DirtySet,
}

impl Stroke {
    pub fn new(label: String, brick_count: usize) -> Stroke {
        Stroke {
            label,
            record: BrickRecord::default(),
            bits_saved: DirtySet::new(brick_count),
            pages_saved: DirtySet::new(brick_count),
        }
    }

    pub fn into_record(self) -> BrickRecord {
        self.record
    }

    #[inline]
    fn save_bits(&mut self, index: u32, bits: &Brick) {
        if !self.bits_saved.contains(index) {
            self.bits_saved.mark(index);
            self.record.save_bits(index, bits);
        }
    }

    fn save_page(&mut self, index: u32, page: Option<&[u8]>) {
        if !self.pages_saved.contains(index) {
            self.pages_saved.mark(index);
            self.record.save_page(index, page.map(Box::from));
        }
    }
}

/// One brick that an edit changes.
struct BrickEdit {
    index: u32,
    /// Voxels whose colour is set.
    painted: Brick,
    /// New bits and their count, if existence changes.
    bits: Option<(Brick, u16)>,
}

/// Applies `op` to the voxels of `region` that lie within the grid.
pub fn edit(
    contents: &mut Contents,
    region: &impl Region,
    op: EditOp,
    stroke: &mut Stroke,
    dirty: &mut DirtySet,
) -> EditStats {
    let bounds = region.bounds_vx().intersect(VoxelBox::of_grid(&contents.grid));
    if bounds.is_empty() {
        return EditStats::default();
    }
    let colours = contents.material.depth().bytes() > 0;
    let first = bounds.min.as_uvec3() / BRICK_EDGE_VX;
    let end = (bounds.max.as_uvec3() + (BRICK_EDGE_VX - 1)) / BRICK_EDGE_VX;
    let size = end - first;
    let grid = &contents.grid;

    // Masks are computed in parallel, a row of bricks a task; writing them is cheap.
    let rows: Vec<Vec<BrickEdit>> = (0..size.y * size.z)
        .into_par_iter()
        .map(|row| {
            let (by, bz) = (first.y + row % size.y, first.z + row / size.y);
            (first.x..end.x)
                .filter_map(|bx| edit_brick(grid, region, op, UVec3::new(bx, by, bz), colours))
                .collect()
        })
        .collect();

    let mut stats = EditStats::default();
    for edit in rows.into_iter().flatten() {
        let at = edit.index as usize;
        if let Some((bits, count)) = edit.bits {
            let before = contents.grid.counts()[at];
            stats.voxels_added += u64::from(count.saturating_sub(before));
            stats.voxels_removed += u64::from(before.saturating_sub(count));
            stroke.save_bits(edit.index, &contents.grid.bricks()[at]);
            contents.grid.set_counted_brick(at, bits, count);
        }
        if let EditOp::Add(colour) | EditOp::Recolour(colour) = op
            && !edit.painted.is_empty()
        {
            stroke.save_page(edit.index, contents.material.page(at));
            contents.material.paint(at, &edit.painted, colour);
            if matches!(op, EditOp::Recolour(_)) {
                stats.voxels_recoloured += u64::from(edit.painted.count());
            }
        }
        stats.bricks_changed += 1;
        dirty.mark(edit.index);
    }
    stats
}

/// The change to one brick, or none if `op` leaves it as it is.
fn edit_brick(
    grid: &Grid,
    region: &impl Region,
    op: EditOp,
    b: UVec3,
    colours: bool,
) -> Option<BrickEdit> {
    let index = grid.brick_index(b);
    let count = grid.counts()[index];
    // An empty brick has nothing to remove or paint: do not even ask the region.
    if count == 0 && !matches!(op, EditOp::Add(_)) {
        return None;
    }
    let mask = match region.coverage(b * BRICK_EDGE_VX) {
        Coverage::None => return None,
        Coverage::All => Brick::FULL,
        Coverage::Some(mask) => mask,
    };
    let old = grid.bricks()[index];
    let (painted, bits) = match op {
        EditOp::Add(_) => {
            let added = mask.and(&grid.valid_mask(b)).and_not(&old);
            (if colours { added } else { Brick::EMPTY }, old.or(&added))
        }
        EditOp::Subtract => (Brick::EMPTY, old.and_not(&mask)),
        EditOp::Recolour(_) => (if colours { old.and(&mask) } else { Brick::EMPTY }, old),
    };
    let bits = (bits != old).then(|| (bits, bits.count()));
    (bits.is_some() || !painted.is_empty()).then_some(BrickEdit {
        index: index as u32,
        painted,
        bits,
    })
}
