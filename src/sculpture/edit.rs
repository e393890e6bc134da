//! Owns the one place where existence bits and colours change: a [`Region`] of voxels meets
//! an [`EditOp`], row of bricks by row of bricks, in parallel where that pays.
//!
//! Takes the contents and the recorder of the open stroke; gives counts of what changed, leaves
//! the earlier values in the recorder, and marks bricks dirty. Knows no tool: a tool is whatever
//! can say which voxels of a brick it covers.

use std::ops::Range;

use glam::UVec3;

use super::brick::{BRICK_EDGE_VX, Brick};
use super::brick_set::{BrickMask, BrickSet};
use super::colour::Rgb;
use super::history::Contents;
use super::material::{Brush, Page};
use super::region::{BrickBox, Region};
use super::row_edit::{Cover, RowEdit};
use super::stroke::{BandRecord, Recording, StrokeRecorder};

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

/// What an edit did.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct EditStats {
    pub voxels_added: u64,
    pub voxels_removed: u64,
    /// Voxels that existed before and have another colour now.
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

/// Edits of boxes of fewer bricks than this stay on one thread: waking others costs more.
const PARALLEL_BRICKS: u64 = 2048;

/// Does `op` to the voxels of `region` that lie within the grid.
pub fn edit(
    contents: &mut Contents,
    region: &impl Region,
    op: EditOp,
    recorder: &mut StrokeRecorder,
    dirty: &mut BrickSet,
) -> EditStats {
    let brush = match op {
        EditOp::Add(colour) | EditOp::Recolour(colour) => brush_for(contents, colour),
        EditOp::Subtract => None,
    };
    let paint = brush.is_some();
    let bricks = match BrickBox::around(region, &contents.grid) {
        Some(bricks) if paint || !matches!(op, EditOp::Recolour(_)) => bricks,
        _ => return EditStats::default(),
    };
    let parallel = bricks.brick_count() >= PARALLEL_BRICKS;
    let Recording { bands, bits_kept, pages_kept } = recorder.recording();
    let slabs = bricks.min.z..bricks.max.z;
    contents.grid.edit_bands(slabs.clone(), parallel, bands, |grid, record| {
        let mut cut = Default::default();
        for z in grid.slabs_of(slabs.clone()) {
            for y in bricks.min.y..bricks.max.y {
                let row = BrickRow { x: bricks.min.x..bricks.max.x, y, z };
                let cut = &mut cut;
                let mut edit = RowEdit::new(grid, record, bits_kept);
                match op {
                    EditOp::Add(_) => row.walk(region, cut, |b, cover| edit.add(b, cover, paint)),
                    EditOp::Subtract => row.walk(region, cut, |b, cover| edit.subtract(b, cover)),
                    EditOp::Recolour(_) => row.walk(region, cut, |b, cover| edit.paint(b, cover)),
                }
                edit.close_word();
            }
        }
    });
    let any_to_paint = bands.iter().any(|band| !band.to_paint.is_empty());
    if let Some(brush) = brush.as_ref().filter(|_| any_to_paint) {
        let recolour = matches!(op, EditOp::Recolour(_));
        let per_band = contents.grid.bricks_per_band();
        let touched = contents.grid.bands_of(slabs);
        contents.material.edit_bands(per_band, touched, parallel, bands, |first, pages, record| {
            paint_band(brush, first, pages, record, pages_kept, recolour)
        });
    }
    recorder.close_edit(dirty)
}

/// The brush for `colour`, unless painting with it cannot change anything.
fn brush_for(contents: &Contents, colour: Rgb) -> Option<Brush> {
    let material = &contents.material;
    let all_alike =
        material.page_count() == 0 && material.depth().quantise(colour) == material.base();
    (material.depth().bytes() > 0 && !all_alike).then(|| material.brush(colour))
}

/// A quick upper bound for [`count_new_pages`]; none if `op` paints nothing new.
pub fn max_new_pages(contents: &Contents, region: &impl Region, op: EditOp) -> Option<u64> {
    let (EditOp::Add(colour) | EditOp::Recolour(colour)) = op else { return None };
    let Contents { grid, material } = contents;
    let new = brush_for(contents, colour).is_some_and(|brush| !brush.is_base());
    let bricks = BrickBox::around(region, grid).filter(|_| new)?;
    Some(bricks.brick_count().min((grid.bricks().len() - material.page_count()) as u64))
}

/// The number of colour pages that `op` would make.
pub fn count_new_pages(contents: &Contents, region: &impl Region, op: EditOp) -> u64 {
    let Contents { grid, material } = contents;
    let Some(bricks) = BrickBox::around(region, grid) else { return 0 };
    let mut pages = 0;
    let mut cut = Default::default();
    for z in bricks.min.z..bricks.max.z {
        for y in bricks.min.y..bricks.max.y {
            let row = BrickRow { x: bricks.min.x..bricks.max.x, y, z };
            row.walk(region, &mut cut, |b, cover| {
                let index = grid.brick_index(b);
                if material.page(index).is_some() {
                    return;
                }
                let (mask, old) = (cover.mask(), &grid.bricks()[index]);
                let painted = match op {
                    EditOp::Add(_) => mask.and(&grid.valid_mask(b)).and_not(old),
                    EditOp::Recolour(_) => mask.and(old),
                    EditOp::Subtract => Brick::EMPTY,
                };
                pages += u64::from(!painted.is_empty());
            });
        }
    }
    pages
}

/// Paints the voxels that a band has put down for it. Returns the number of pages made.
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
struct BrickRow {
    x: Range<u32>,
    y: u32,
    z: u32,
}

impl BrickRow {
    /// Cuts the region by this row, and calls `f` with each brick that it touches, in rising
    /// order, and how much of the brick is covered.
    #[inline(always)]
    fn walk<R: Region>(self, region: &R, cut: &mut R::Row, mut f: impl FnMut(UVec3, Cover<R>)) {
        let reach = region.cut_row(self.y * BRICK_EDGE_VX, self.z * BRICK_EDGE_VX, cut);
        for x in reach.touched.start.max(self.x.start)..reach.touched.end.min(self.x.end) {
            let cover = match reach.whole.contains(&x) {
                true => Cover::Whole,
                false => Cover::Part { region, cut, reach: &reach, x },
            };
            f(UVec3::new(x, self.y, self.z), cover);
        }
    }
}
