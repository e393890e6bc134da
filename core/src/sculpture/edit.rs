//! Applies an [`EditOp`] to a [`Region`] of voxels, row of bricks by row of bricks, in parallel where that pays. The
//! only place where existence bits change after loading.
//!
//! Takes the contents and the recorder of the open stroke; returns counts of what changed, stores the
//! earlier values in the recorder, and marks bricks dirty. Knows no tool: a tool is anything that
//! implements [`Region`].

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch};
use glam::UVec3;

use super::brick::{BRICK_EDGE_VX, Brick};
use super::brick_set::{BrickMask, BrickSet};
use super::colour::Rgb;
use super::contents::Contents;
pub use super::edit_stats::EditStats;
use super::grid::{Grid, GridBand};
use super::material::{Brush, Page};
use super::region::{BrickBox, Region};
use super::row_edit::{RowEdit, RowPiece};
use super::stroke::{BandRecord, StrokeBands, StrokeRecorder};

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

/// Edits of boxes of fewer bricks than this stay on one thread: waking others would cost more than it gains.
const PARALLEL_BRICKS: u64 = 2048;

/// Applies `op` to the voxels of `region` that lie within the grid.
pub fn edit(
    contents: &mut Contents,
    region: &impl Region,
    op: EditOp,
    recorder: &mut StrokeRecorder,
    dirty: &mut BrickSet,
) -> EditStats {
    let brush = match op {
        EditOp::Add(colour) => brush_for(contents, colour.unwrap_or(contents.material.base())),
        EditOp::Recolour(colour) => brush_for(contents, colour),
        EditOp::Subtract => None,
    };
    let paint = brush.is_some();
    let bricks = match BrickBox::around(region, &contents.grid) {
        Some(bricks) if paint || !matches!(op, EditOp::Recolour(_)) => bricks,
        _ => return EditStats::default(),
    };
    let parallel = bricks.brick_count() >= PARALLEL_BRICKS;
    let slabs = bricks.min.z..bricks.max.z;
    BitEdit { region, op, paint, bricks }.apply(&mut contents.grid, recorder);
    let StrokeBands { bands, pages_kept, .. } = recorder.recording();
    let any_to_paint = bands.iter().any(|band| !band.to_paint.is_empty());
    if let Some(brush) = brush.as_ref().filter(|_| any_to_paint) {
        let recolour = matches!(op, EditOp::Recolour(_));
        let per_band = contents.grid.bricks_per_band();
        let touched = contents.grid.bands_of(slabs);
        contents.material.edit_bands(
            per_band,
            touched,
            parallel,
            bands,
            &|first, pages, record| paint_band(brush, first, pages, record, pages_kept, recolour),
        );
    }
    recorder.close_edit(dirty)
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
    let op = if adds { EditOp::Add(None) } else { EditOp::Subtract };
    BitEdit { region, op, paint: false, bricks }.apply(mask, recorder);
    let EditStats { voxels_added, voxels_removed, bricks_changed, .. } = recorder.close_edit(dirty);
    // No voxel of the sculpture has changed.
    let voxels_masked = voxels_added + voxels_removed;
    EditStats { voxels_masked, bricks_changed, ..EditStats::default() }
}

/// An operation on the bits of the voxels of a region within a box of bricks.
struct BitEdit<'a, R> {
    region: &'a R,
    op: EditOp,
    /// Whether voxels to paint are listed in the records.
    paint: bool,
    bricks: BrickBox,
}

impl<R: Region> BitEdit<'_, R> {
    fn apply(&self, grid: &mut Grid, recorder: &mut StrokeRecorder) {
        let parallel = self.bricks.brick_count() >= PARALLEL_BRICKS;
        let StrokeBands { bands, bits_kept, .. } = recorder.recording();
        let level = Level::new();
        let slabs = self.bricks.min.z..self.bricks.max.z;
        grid.edit_bands(slabs, parallel, bands, &|grid, record| {
            dispatch!(level, simd => self.apply_to_band(simd, bits_kept, grid, record));
        });
    }

    /// Edits the bits in a band of the grid.
    #[inline(always)]
    fn apply_to_band<S: Simd>(
        &self,
        simd: S,
        bits_kept: &BrickSet,
        grid: &mut GridBand,
        record: &mut BandRecord,
    ) {
        let &BitEdit { region, op, paint, ref bricks } = self;
        let mut cut = Default::default();
        for z in grid.slabs_of(bricks.min.z..bricks.max.z) {
            for y in bricks.min.y..bricks.max.y {
                let row = BrickRow { x: bricks.min.x..bricks.max.x, y, z };
                let cut = &mut cut;
                let mut edit = RowEdit::new(grid, record, bits_kept);
                match op {
                    EditOp::Add(_) => row.walk(
                        simd,
                        region,
                        cut,
                        #[inline(always)]
                        |piece| edit.add(piece, paint),
                    ),
                    EditOp::Subtract => row.walk(
                        simd,
                        region,
                        cut,
                        #[inline(always)]
                        |piece| edit.subtract(piece),
                    ),
                    EditOp::Recolour(_) => row.walk(
                        simd,
                        region,
                        cut,
                        #[inline(always)]
                        |piece| edit.paint(piece),
                    ),
                }
                edit.close_word();
            }
        }
    }
}

/// Returns the brush for `colour`, unless painting with it cannot change anything.
fn brush_for(contents: &Contents, colour: Rgb) -> Option<Brush> {
    let material = &contents.material;
    let all_alike =
        material.page_count() == 0 && material.depth().quantise(colour) == material.base();
    (material.depth().bytes() > 0 && !all_alike).then(|| material.brush(colour))
}

/// Returns a quick upper bound for [`count_new_pages`]; `None` if `op` paints nothing new.
pub(crate) fn max_new_pages(contents: &Contents, region: &impl Region, op: EditOp) -> Option<u64> {
    let (EditOp::Add(Some(colour)) | EditOp::Recolour(colour)) = op else { return None };
    let Contents { grid, material, .. } = contents;
    let new = brush_for(contents, colour).is_some_and(|brush| !brush.is_base());
    let bricks = BrickBox::around(region, grid).filter(|_| new)?;
    Some(bricks.brick_count().min((grid.brick_count() - material.page_count()) as u64))
}

/// Returns the number of colour pages that `op` would make.
pub fn count_new_pages(contents: &Contents, region: &impl Region, op: EditOp) -> u64 {
    let Some(bricks) = BrickBox::around(region, &contents.grid) else { return 0 };
    dispatch!(Level::new(), simd => {
        let mut pages = 0;
        let mut cut = Default::default();
        for z in bricks.min.z..bricks.max.z {
            for y in bricks.min.y..bricks.max.y {
                let row = BrickRow { x: bricks.min.x..bricks.max.x, y, z };
                row.walk(
                    simd,
                    region,
                    &mut cut,
                    #[inline(always)]
                    |piece| pages += new_pages_of(piece, contents, op),
                );
            }
        }
        pages
    })
}

/// Returns the number of colour pages that `op` would make in a piece.
#[inline(always)]
fn new_pages_of(piece: RowPiece<impl Simd, impl Region>, contents: &Contents, op: EditOp) -> u64 {
    let Contents { grid, material, .. } = contents;
    let mut pages = 0;
    piece.each(
        #[inline(always)]
        |b| {
            let index = grid.brick_index(b);
            if material.page(index).is_some() {
                return;
            }
            let (mask, old) = (piece.mask(b), grid.brick_at(index));
            let painted = match op {
                EditOp::Add(_) => mask.and(&grid.valid_mask(b)).and_not(old),
                EditOp::Recolour(_) => mask.and(old),
                EditOp::Subtract => Brick::EMPTY,
            };
            pages += u64::from(!painted.is_empty());
        },
    );
    pages
}

/// Paints the voxels listed for a band. Returns the number of new pages.
fn paint_band(
    brush: &Brush,
    first: u32,
    pages: &mut [Option<Page>],
    record: &mut BandRecord,
    pages_kept: &BrickSet,
    recolour: bool,
) -> usize {
    let mut made = 0;
    for (index, mask) in record.to_paint.drain(..) {
        let page = &mut pages[(index - first) as usize];
        let differing = brush.differing(page.as_deref(), &mask);
        if differing.is_empty() {
            continue;
        }
        if !pages_kept.contains(index) {
            record.earlier.keep_page(index, page.clone());
        }
        made += usize::from(brush.paint(page, &differing));
        record.pages_changed.push(BrickMask { word: index / 64, mask: 1 << (index % 64) });
        if recolour {
            record.stats.voxels_recoloured += u64::from(differing.count());
            record.stats.bricks_changed += 1;
        }
    }
    made
}

/// A row of bricks along x, in brick coordinates.
pub(super) struct BrickRow {
    pub x: Range<u32>,
    pub y: u32,
    pub z: u32,
}

impl BrickRow {
    /// Intersects the region with this row and calls `f` with the covered pieces, in ascending order.
    #[inline(always)]
    pub fn walk<S: Simd, R: Region>(
        self,
        simd: S,
        region: &R,
        cut: &mut R::Row,
        mut f: impl FnMut(RowPiece<S, R>),
    ) {
        let reach = region.cut_row(simd, self.y * BRICK_EDGE_VX, self.z * BRICK_EDGE_VX, cut);
        let end = reach.touched.end.min(self.x.end);
        let mut x = reach.touched.start.max(self.x.start);
        let whole = reach.whole.start.max(x)..reach.whole.end.min(end);
        while x < end {
            let brick = UVec3::new(x, self.y, self.z);
            if x == whole.start && !whole.is_empty() {
                f(RowPiece::Whole { first: brick, len: whole.end - x });
                x = whole.end;
            } else {
                f(RowPiece::Part { simd, brick, region, cut, reach: &reach });
                x += 1;
            }
        }
    }
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
                (StrokeRecorder::new(&contents.grid), BrickSet::new(contents.grid.brick_count()));
            let (a, b) = (IVec3::from(corners[0]), IVec3::from(corners[1]));
            let red = Rgb::new(255, 0, 0);
            for (i, seed) in seeds.into_iter().enumerate() {
                let region = Scattered { bounds: VoxelBox { min: a.min(b), max: a.max(b) }, seed };
                let op = [EditOp::Add(Some(red)), EditOp::Subtract, EditOp::Recolour(red)][i % 3];
                let before = contents.clone();
                let pages = count_new_pages(&contents, &region, op);
                prop_assert!(max_new_pages(&contents, &region, op).is_none_or(|most| pages <= most));
                edit(&mut contents, &region, op, &mut recorder, &mut dirty);
                let made = contents.material.page_count() - before.material.page_count();
                prop_assert_eq!(made as u64, if op == EditOp::Subtract { 0 } else { pages });
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
                        let is = contents.material.rgb(index, local);
                        let was = before.material.rgb(index, local);
                        prop_assert_eq!(is, if painted.get(x, y, z) { red } else { was });
                    }
                }
            }
            recorder.finish().swap(&mut contents, &mut dirty);
            prop_assert_eq!(contents, start);
        }
    }
}
