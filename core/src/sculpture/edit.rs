//! Applies an [`EditOp`] to a [`Region`] of voxels, leaf by leaf of the grid's tree, in parallel where that pays. The
//! only place where existence bits change after loading.
//!
//! Takes the contents and the recorder of the open stroke; returns counts of what changed, tells the
//! recorder which bricks have changed, and marks them dirty. Knows no tool: a tool is anything that
//! implements [`Region`].

use std::cell::RefCell;
use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch};
use glam::UVec3;
use rayon::prelude::*;

use super::brick::{BRICK_EDGE_VX, Brick};
use super::brick_set::{BrickSet, LeafKey};
use super::colour::Rgb;
use super::contents::Contents;
pub use super::edit_stats::EditStats;
use super::grid::{ChangedLeaf, Cube, CubeEdit, Grid, LeafEdit, LeafPlace, Lent, LentLeaf};
use super::material::Material;
use super::region::{BoxCoverage, BrickBox, Region, RowReach};
use super::stroke::StrokeRecorder;
use super::to_paint::{PaintTarget, ToPaint, colour_cube, for_each_portion, may_paint};

/// An operation on the voxels of a region.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum EditOp {
    /// Make them exist. New ones get the colour, or the base colour.
    Add(Option<Rgb>),
    /// Remove them.
    Subtract,
    /// Give existing ones the colour.
    Recolour(Rgb),
}

thread_local! {
    /// Room for the new bricks of a leaf.
    static SCRATCH: RefCell<Box<[Brick; 512]>> = RefCell::new(Box::new([Brick::EMPTY; 512]));
}

/// Edits of boxes of fewer bricks than this stay on one thread: waking others would cost more than it gains.
const PARALLEL_BRICKS: u64 = 2048;

/// In boxes of at most so many bricks, an edit opens cubes without asking whether its region reaches them: most are
/// reached, and the question would cost more than the edit.
const SMALL_BRICKS: u64 = 20 * 20 * 20;

/// Applies `op` to the voxels of `region` that lie within the grid.
pub fn edit(
    contents: &mut Contents,
    region: &impl Region,
    op: EditOp,
    recorder: &mut StrokeRecorder,
    dirty: &mut BrickSet,
) -> EditStats {
    let colour = match op {
        EditOp::Add(colour) => Some(colour.unwrap_or(contents.material.base())),
        EditOp::Recolour(colour) => Some(colour),
        EditOp::Subtract => None,
    };
    let colour = colour.filter(|colour| may_paint(&contents.material, *colour));
    let bricks = match BrickBox::around(region, &contents.grid) {
        Some(bricks) if colour.is_some() || !matches!(op, EditOp::Recolour(_)) => bricks,
        _ => return EditStats::default(),
    };
    let Contents { grid, material, .. } = contents;
    let adds = match op {
        EditOp::Add(_) => true,
        EditOp::Subtract => false,
        EditOp::Recolour(colour) => {
            let mut stats = EditStats::default();
            for_each_portion(grid, region, PaintTarget::Existing, true, &mut |voxels| {
                stats += paint(material, &voxels, colour, recorder, dirty);
            });
            return stats;
        }
    };
    let bits = EditBits { adds, paint: colour.is_some() };
    let done = change_bits(grid, recorder, region, bits, bricks);
    recorder.close_edit(done.changed, dirty);
    if let Some(colour) = colour {
        // These voxels are new, not recoloured.
        paint(material, &done.to_paint, colour, recorder, dirty);
    }
    done.stats
}

/// Paints voxels and returns the counts of those with another colour than before.
fn paint(
    material: &mut Material,
    voxels: &ToPaint,
    colour: Rgb,
    recorder: &mut StrokeRecorder,
    dirty: &mut BrickSet,
) -> EditStats {
    let mut stats = EditStats::default();
    if voxels.cubes.is_empty() && voxels.bricks.is_empty() {
        return stats;
    }
    recorder.begin_painting(material);
    let of_cubes = material.paint_cubes(&voxels.cubes, colour);
    let of_bricks = material.paint_bricks(&voxels.bricks, colour);
    for painted in [of_cubes, of_bricks] {
        recorder.close_painting(&painted, dirty);
        stats.voxels_recoloured += painted.voxels;
        stats.bricks_changed += painted.bricks;
    }
    stats
}

/// Adds the voxels of `region` that lie within the grid to a mask, or removes them from it.
pub(crate) fn edit_mask(
    mask: &mut Grid,
    region: &impl Region,
    adds: bool,
    recorder: &mut StrokeRecorder,
    dirty: &mut BrickSet,
) -> EditStats {
    let Some(bricks) = BrickBox::around(region, mask) else { return EditStats::default() };
    let bits = EditBits { adds, paint: false };
    let Changed { changed, stats, .. } = change_bits(mask, recorder, region, bits, bricks);
    recorder.close_edit(changed, dirty);
    let EditStats { voxels_added, voxels_removed, bricks_changed, .. } = stats;
    // No voxel of the sculpture has changed.
    let voxels_masked = voxels_added + voxels_removed;
    EditStats { voxels_masked, bricks_changed, ..EditStats::default() }
}

/// The changes of an edit.
#[derive(Default)]
struct Changed {
    /// The leaves in which bits have changed.
    changed: Vec<ChangedLeaf>,
    /// The voxels that remain to be painted.
    to_paint: ToPaint,
    stats: EditStats,
}

impl Changed {
    fn append(&mut self, mut other: Changed) {
        self.changed.append(&mut other.changed);
        self.to_paint.append(other.to_paint);
        self.stats += other.stats;
    }
}

/// The kind of an edit of bits.
#[derive(Clone, Copy)]
struct EditBits {
    /// Whether voxels are added; otherwise they are removed.
    adds: bool,
    /// Whether new voxels are listed to be painted.
    paint: bool,
}

/// Makes the voxels of a region within `bricks` exist or not.
fn change_bits(
    grid: &mut Grid,
    recorder: &StrokeRecorder,
    region: &impl Region,
    bits: EditBits,
    bricks: BrickBox,
) -> Changed {
    let (bounds, is_small) = (region.bounds_vx(), bricks.brick_count() <= SMALL_BRICKS);
    let (place, mut to_paint) = (grid.leaf_place(), ToPaint::default());
    let mut choose = |cube: Cube| {
        if bits.adds && cube.is_full || !bits.adds && cube.is_empty {
            return CubeEdit::Skip;
        }
        // Small regions reach most cubes around them, and cover none that exceeds their bounds.
        let voxels = cube.voxels();
        if is_small && (voxels.min.cmplt(bounds.min).any() || voxels.max.cmpgt(bounds.max).any()) {
            return CubeEdit::Open;
        }
        match region.coverage(voxels) {
            BoxCoverage::None => CubeEdit::Skip,
            BoxCoverage::Part => CubeEdit::Open,
            BoxCoverage::All if bits.paint && !cube.is_empty => CubeEdit::Open,
            BoxCoverage::All if bits.paint && !place.holds_whole_bricks(cube) => CubeEdit::Open,
            BoxCoverage::All if bits.paint => {
                to_paint.cubes.push(colour_cube(cube));
                CubeEdit::Fill
            }
            BoxCoverage::All if bits.adds => CubeEdit::Fill,
            BoxCoverage::All => CubeEdit::Clear,
        }
    };
    let Lent { mut leaves, changed, voxels_added, voxels_removed } = grid.lend(bricks, &mut choose);
    let mut done = Changed { changed, to_paint, ..Changed::default() };
    done.stats.voxels_added += voxels_added;
    done.stats.voxels_removed += voxels_removed;
    done.stats.bricks_changed +=
        done.changed.iter().map(|leaf| u64::from(leaf.bricks.count())).sum::<u64>();
    let work = LeafWork { region, recorder, bits, bricks, place };
    let level = Level::new();
    let edit_row = |row: &mut [LentLeaf], cut: &mut Vec<_>, done: &mut Changed| {
        SCRATCH.with_borrow_mut(
            |scratch| dispatch!(level, simd => work.edit_row(simd, row, cut, scratch, done)),
        );
    };
    sort_rows(&mut leaves);
    if bricks.brick_count() >= PARALLEL_BRICKS {
        edit_at_once(&mut leaves, &|row, done| edit_row(row, &mut Vec::new(), done), &mut done);
    } else {
        let mut cut = Vec::new();
        rows_of(&mut leaves).for_each(|row| edit_row(row, &mut cut, &mut done));
    }
    grid.put_back(leaves);
    done
}

/// Sorts leaves by rows along x, which share what a region computes for the rows of bricks.
fn sort_rows(leaves: &mut [LentLeaf]) {
    leaves.sort_unstable_by_key(|leaf| (leaf.leaf.z, leaf.leaf.y, leaf.leaf.x));
}

/// Returns the rows of sorted leaves.
fn rows_of(leaves: &mut [LentLeaf]) -> impl Iterator<Item = &mut [LentLeaf]> {
    leaves.chunk_by_mut(|a, b| (a.leaf.y, a.leaf.z) == (b.leaf.y, b.leaf.z))
}

/// Edits rows of sorted leaves on all threads. Calls `edit_row` through a pointer, so that it is compiled once for all
/// regions.
fn edit_at_once(
    leaves: &mut [LentLeaf],
    edit_row: &(dyn Fn(&mut [LentLeaf], &mut Changed) + Sync),
    done: &mut Changed,
) {
    let one = |row| {
        let mut done = Changed::default();
        edit_row(row, &mut done);
        done
    };
    let rows: Vec<&mut [LentLeaf]> = rows_of(leaves).collect();
    let parts: Vec<Changed> = rows.into_par_iter().map(one).collect();
    parts.into_iter().for_each(|part| done.append(part));
}

/// An edit of the bits of leaves.
struct LeafWork<'a, R> {
    region: &'a R,
    recorder: &'a StrokeRecorder,
    bits: EditBits,
    bricks: BrickBox,
    place: LeafPlace,
}

/// Bricks on an edge of a leaf.
const LEAF_EDGE: u32 = 8;

impl<R: Region> LeafWork<'_, R> {
    /// Edits leaves of one row along x, and adds what changes to `done`. `rows` and `scratch` give it room.
    #[inline(always)]
    fn edit_row<S: Simd>(
        &self,
        simd: S,
        leaves: &mut [LentLeaf],
        rows: &mut Vec<CutRow<R>>,
        scratch: &mut [Brick; 512],
        done: &mut Changed,
    ) {
        let Some(first) = leaves.first() else { return };
        let low = first.leaf * LEAF_EDGE;
        let (from, end) = (self.bricks.min.max(low), self.bricks.max.min(low + LEAF_EDGE));
        rows.clear();
        for z in from.z..end.z {
            for y in from.y..end.y {
                let mut cut = R::Row::default();
                let RowReach { touched, whole } =
                    self.region.cut_row(simd, y * BRICK_EDGE_VX, z * BRICK_EDGE_VX, &mut cut);
                let touched =
                    touched.start.max(self.bricks.min.x)..touched.end.min(self.bricks.max.x);
                if !touched.is_empty() {
                    rows.push(CutRow { y, z, cut, reach: RowReach { touched, whole } });
                }
            }
        }
        for lent in leaves {
            let key = LeafKey::of(lent.leaf);
            let before = (!self.recorder.has_leaf(key)).then(|| lent.bits());
            let mut edit = lent.edit(self.place, scratch);
            for row in &*rows {
                match self.bits.adds {
                    true => self.add_row(simd, row, &mut edit, done),
                    false => self.subtract_row(simd, row, &mut edit, &mut done.stats),
                }
            }
            let changed = edit.finish();
            if !changed.is_empty() {
                done.stats.bricks_changed += u64::from(changed.count());
                done.changed.push(ChangedLeaf { leaf: key, bricks: changed, before });
            }
        }
    }

    #[inline(always)]
    fn subtract_row<S: Simd>(
        &self,
        simd: S,
        row: &CutRow<R>,
        edit: &mut LeafEdit,
        stats: &mut EditStats,
    ) {
        let (x, reach) = (edit.low().x, &row.reach);
        let (occupied, _) = edit.row(row.y, row.z);
        let whole = occupied & bits_of(&reach.whole, x);
        stats.voxels_removed += edit.clear_in_row(row.y, row.z, whole);
        let mut rest = occupied & bits_of(&reach.touched, x) & !whole;
        while rest != 0 {
            let i = rest.trailing_zeros();
            rest &= rest - 1;
            let b = UVec3::new(x + i, row.y, row.z);
            let (old, count) = edit.brick(b);
            let bits = old.and_not(&self.region.mask(simd, &row.cut, reach, b.x));
            let left = bits.count();
            if left != count {
                edit.replace(b, count, &bits, left);
                stats.voxels_removed += u64::from(count - left);
            }
        }
    }

    #[inline(always)]
    fn add_row<S: Simd>(&self, simd: S, row: &CutRow<R>, edit: &mut LeafEdit, done: &mut Changed) {
        let (x, reach) = (edit.low().x, &row.reach);
        let (_, full) = edit.row(row.y, row.z);
        let mut rest = !full & bits_of(&reach.touched, x);
        let whole = bits_of(&reach.whole, x);
        while rest != 0 {
            let i = rest.trailing_zeros();
            rest &= rest - 1;
            let b = UVec3::new(x + i, row.y, row.z);
            let (old, count) = edit.brick(b);
            let mask = match whole >> i & 1 != 0 {
                true => Brick::FULL,
                false => self.region.mask(simd, &row.cut, reach, b.x),
            };
            let mask = mask.and(&edit.valid_mask(b));
            let bits = old.or(&mask);
            let now = bits.count();
            if now != count {
                if self.bits.paint {
                    done.to_paint.bricks.push((b, mask.and_not(&old)));
                }
                edit.replace(b, count, &bits, now);
                done.stats.voxels_added += u64::from(now - count);
            }
        }
    }
}

/// A row of bricks along x, cut by a region.
struct CutRow<R: Region> {
    y: u32,
    z: u32,
    cut: R::Row,
    reach: RowReach,
}

/// Returns the bricks of a range that lie in the leaf from brick `x` on: a bit each.
#[inline(always)]
fn bits_of(range: &Range<u32>, x: u32) -> u32 {
    let below = |end: u32| (1u32 << end.saturating_sub(x).min(LEAF_EDGE)) - 1;
    below(range.end) & !below(range.start)
}

#[cfg(test)]
mod tests {
    use glam::{IVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::sculpture::brick::local_coords;
    use crate::sculpture::region::{BoxCoverage, RowReach, VoxelBox};
    use crate::sculpture::{Brick, ColourDepth, Material};

    /// An arbitrary set of voxels, such as a spray tool or a selection may produce.
    #[derive(Debug)]
    struct Scattered {
        bounds: VoxelBox,
        seed: u64,
    }

    impl Scattered {
        fn brick(&self, b: UVec3) -> Brick {
            let mut words = [0; 8];
            let mut state =
                self.seed ^ (u64::from(b.x) << 40 | u64::from(b.y) << 20 | u64::from(b.z));
            for word in &mut words {
                state = (state ^ state >> 31).wrapping_mul(0x9E37_79B9_7F4A_7C15);
                *word = state & state >> 7;
            }
            let origin = (b * BRICK_EDGE_VX).as_ivec3();
            let mut brick = Brick { words };
            for [x, y, z] in (0..512).map(local_coords) {
                let v = origin + UVec3::new(x, y, z).as_ivec3();
                let within = v.cmpge(self.bounds.min).all() && v.cmplt(self.bounds.max).all();
                brick.set(x, y, z, within && (brick.get(x, y, z) || b.x % 3 == 1));
            }
            brick
        }
    }

    impl Region for Scattered {
        type Row = UVec3;

        fn bounds_vx(&self) -> VoxelBox {
            self.bounds
        }

        fn cut_row<S: Simd>(&self, _: S, y_vx: u32, z_vx: u32, row: &mut UVec3) -> RowReach {
            *row = UVec3::new(0, y_vx / BRICK_EDGE_VX, z_vx / BRICK_EDGE_VX);
            let full = |x: &u32| self.brick(row.with_x(*x)).is_full();
            let whole = (0..9).find(full).map_or(0..0, |start| start..start + 1);
            RowReach { touched: 0..9, whole }
        }

        fn mask<S: Simd>(&self, _: S, row: &UVec3, _: &RowReach, brick_x: u32) -> Brick {
            self.brick(row.with_x(brick_x))
        }

        fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
            // Even bricks in the middle are scattered.
            self.bounds.coverage(bounds).and(BoxCoverage::Part)
        }
    }

    proptest! {
        #[test]
        fn any_region_changes_what_it_covers_and_nothing_else(
            dims in prop::array::uniform3(1u32..50),
            corners in prop::array::uniform2(prop::array::uniform3(-5i32..60)),
            seeds in prop::array::uniform4(any::<u64>()),
        ) {
            let dims = UVec3::from(dims);
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            grid.fill_bricks(|b| Scattered { bounds: VoxelBox { min: IVec3::MIN, max: IVec3::MAX }, seed: 5 }.brick(b));
            let material = Material::for_grid(&grid, ColourDepth::Bits8, Rgb::new(9, 9, 9));
            let mut contents = Contents::new(grid, material);
            let start = contents.clone();
            let (mut recorder, mut dirty) =
                (StrokeRecorder::default(), BrickSet::default());
            let (a, b) = (IVec3::from(corners[0]), IVec3::from(corners[1]));
            let red = Rgb::new(255, 0, 0);
            for (i, seed) in seeds.into_iter().enumerate() {
                let region = Scattered { bounds: VoxelBox { min: a.min(b), max: a.max(b) }, seed };
                let op = [EditOp::Add(Some(red)), EditOp::Subtract, EditOp::Recolour(red)][i % 3];
                let before = contents.clone();
                edit(&mut contents, &region, op, &mut recorder, &mut dirty);
                for index in 0..before.grid.brick_count() {
                    let b = before.grid.brick_coords(index);
                    let mask = region.brick(b).and(&before.grid.valid_mask(b));
                    let (old, new) = (*before.grid.brick_at(index), *contents.grid.brick_at(index));
                    let (expected, painted) = match op {
                        EditOp::Add(_) => (old.or(&mask), mask.and_not(&old)),
                        EditOp::Subtract => (old.and_not(&mask), Brick::EMPTY),
                        EditOp::Recolour(_) => (old, old.and(&mask)),
                    };
                    prop_assert_eq!(new, expected);
                    for local in 0..512 {
                        let [x, y, z] = local_coords(local);
                        let is = contents.material.rgb(b, local);
                        let was = before.material.rgb(b, local);
                        prop_assert_eq!(is, if painted.get(x, y, z) { red } else { was });
                    }
                }
            }
            recorder.finish().swap(&mut contents, &mut dirty);
            prop_assert_eq!(contents, start);
        }

        /// Boxes that cover whole leaves and nodes, in grids of several, and their record.
        #[test]
        fn boxes_change_whole_nodes_at_once(
            dims in prop::array::uniform3(1u32..100),
            long in 0usize..3,
            edits in prop::collection::vec(
                (prop::array::uniform2(prop::array::uniform3(-70i32..700)), 0u32..7, any::<bool>()),
                1..8,
            ),
            strokes in 1usize..3,
        ) {
            let mut dims = UVec3::from(dims);
            dims[long] *= 7;
            let mut contents = Contents::of_bits(Grid::new(dims, Vec3::ONE, 1 << 30).unwrap());
            let mut recorder = StrokeRecorder::default();
            let mut records = Vec::new();
            for edits in edits.chunks(edits.len().div_ceil(strokes)) {
                let start = contents.clone();
                for (corners, aligned, adds) in edits {
                    // To the voxel, or to cubes of up to 64 voxels.
                    let [a, b] = corners.map(|v| IVec3::from(v) >> *aligned << *aligned);
                    let region = VoxelBox { min: a.min(b), max: a.max(b) + (1 << aligned) };
                    let before = contents.grid.clone();
                    let op = if *adds { EditOp::Add(None) } else { EditOp::Subtract };
                    let mut dirty = BrickSet::default();
                    let stats = edit(&mut contents, &region, op, &mut recorder, &mut dirty);
                    let (mut changed, mut voxels) = (0, [0; 2]);
                    for (b, old) in before.bricks_from(0) {
                        let mask = brick_in(&region, b).and(&before.valid_mask(b));
                        let expected = if *adds { old.or(&mask) } else { old.and_not(&mask) };
                        let new = contents.grid.brick(b);
                        prop_assert_eq!(*new, expected);
                        prop_assert_eq!(dirty.contains(b), expected != *old);
                        changed += u64::from(expected != *old);
                        voxels[0] += u64::from(new.and_not(old).count());
                        voxels[1] += u64::from(old.and_not(new).count());
                    }
                    crate::sculpture::grid::tests::check(&contents.grid);
                    prop_assert_eq!([stats.voxels_added, stats.voxels_removed], voxels);
                    prop_assert_eq!((stats.bricks_changed, dirty.len() as u64), (changed, changed));
                }
                let taken = recorder.bytes();
                let record = recorder.finish();
                prop_assert_eq!(taken, record.heap_bytes());
                records.push((start, record));
            }
            // Back and forth and back again.
            let ended = contents.clone();
            let mut dirty = BrickSet::default();
            let mut forth = Vec::new();
            for (start, record) in records.into_iter().rev() {
                forth.push(record.swap(&mut contents, &mut dirty));
                crate::sculpture::grid::tests::check(&contents.grid);
                prop_assert_eq!(&contents, &start);
            }
            for record in forth.into_iter().rev() {
                record.swap(&mut contents, &mut dirty);
            }
            prop_assert_eq!(contents, ended);
        }
    }

    /// Returns the voxels of a box in a brick, one by one.
    fn brick_in(region: &VoxelBox, b: UVec3) -> Brick {
        let mut brick = Brick::EMPTY;
        for [x, y, z] in (0..512).map(local_coords) {
            let v = (b * BRICK_EDGE_VX + UVec3::new(x, y, z)).as_ivec3();
            brick.set(x, y, z, region.contains(v));
        }
        brick
    }
}
