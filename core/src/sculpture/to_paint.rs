//! Finds the voxels of a region that are to be painted: existing ones, or those that do not exist yet. Whole cubes of the
//! tree are found at once, all others brick by brick.
//!
//! Takes a grid and a [`Region`]; gives voxels in portions, so that their lists never take much memory, and the memory
//! that painting them may need. Changes nothing.

use fearless_simd::{Level, Simd, dispatch};
use glam::UVec3;
use rayon::prelude::*;

use super::brick::{BRICK_EDGE_VX, Brick};
use super::colour::Rgb;
use super::contents::Contents;
use super::edit::EditOp;
use super::grid::{Cube, Grid, NODE_EDGE_LOG2};
use super::material::{ColourCube, ColourGrowth, Material};
use super::region::{BoxCoverage, BrickBox, Region, RowReach};

/// Regions of fewer bricks than this stay on one thread: waking others would cost more than it gains.
const PARALLEL_BRICKS: u64 = 2048;

/// Leaves in a portion of voxels, or a few more.
const PORTION_LEAVES: usize = 256;

/// Bricks on an edge of a leaf.
const LEAF_EDGE: u32 = 8;

/// Voxels by brick.
type VoxelsByBrick = Vec<(UVec3, Brick)>;

/// Voxels that are to be painted.
#[derive(Default, Debug)]
pub(super) struct ToPaint {
    /// Cubes of whole bricks.
    pub cubes: Vec<ColourCube>,
    /// Voxels by brick, those of a leaf beside each other.
    pub bricks: VoxelsByBrick,
}

impl ToPaint {
    pub fn append(&mut self, mut other: ToPaint) {
        self.cubes.append(&mut other.cubes);
        self.bricks.append(&mut other.bricks);
    }
}

/// Which voxels are to be painted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum PaintTarget {
    Existing,
    Missing,
}

/// Returns the cube of the tree of colours.
pub(super) fn colour_cube(cube: Cube) -> ColourCube {
    ColourCube { low: cube.low, level: cube.log2 / NODE_EDGE_LOG2 }
}

/// Returns whether painting with a colour can change anything.
pub(super) fn may_paint(material: &Material, colour: Rgb) -> bool {
    let all_alike =
        material.page_count() == 0 && material.depth().quantise(colour) == material.base();
    material.depth().bytes() > 0 && !all_alike
}

/// Calls `f` with the wanted voxels of a region, in portions. `by_cube`: whether cubes are listed as such.
pub(super) fn for_each_portion(
    grid: &Grid,
    region: &impl Region,
    wanted: PaintTarget,
    by_cube: bool,
    f: &mut dyn FnMut(ToPaint),
) {
    let Some(bricks) = BrickBox::around(region, grid) else { return };
    let mut whole = ToPaint::default();
    let mut leaves = grid.visit(bricks, &mut |cube| {
        let (is_all, is_none) = match wanted {
            PaintTarget::Existing => (cube.is_full, cube.is_empty),
            PaintTarget::Missing => (cube.is_empty, cube.is_full),
        };
        let coverage = if is_none { BoxCoverage::None } else { region.coverage(cube.voxels()) };
        let at_once = by_cube && is_all && coverage == BoxCoverage::All;
        if at_once && grid.holds_whole_bricks(cube) {
            whole.cubes.push(colour_cube(cube));
            return false;
        }
        coverage != BoxCoverage::None
    });
    if !whole.cubes.is_empty() {
        f(whole);
    }
    let finder = Finder { grid, region, wanted, bricks };
    let level = Level::new();
    find_in_rows(
        &mut leaves,
        bricks.brick_count() >= PARALLEL_BRICKS,
        &|row| dispatch!(level, simd => finder.in_row(simd, row)),
        f,
    );
}

/// Calls `f` with what `in_row` finds in rows of leaves along x, portion by portion. Calls through pointers, so that it is
/// compiled once for all regions.
fn find_in_rows(
    leaves: &mut [UVec3],
    parallel: bool,
    in_row: &(dyn Fn(&[UVec3]) -> VoxelsByBrick + Sync),
    f: &mut dyn FnMut(ToPaint),
) {
    leaves.sort_unstable_by_key(|leaf| (leaf.z, leaf.y, leaf.x));
    let rows: Vec<&[UVec3]> = leaves.chunk_by(|a, b| (a.y, a.z) == (b.y, b.z)).collect();
    let most_in_row = rows.iter().map(|row| row.len()).max().unwrap_or(1);
    for rows in rows.chunks((PORTION_LEAVES / most_in_row).max(1)) {
        let found: Vec<VoxelsByBrick> = match parallel {
            true => rows.par_iter().map(|row| in_row(row)).collect(),
            false => rows.iter().map(|row| in_row(row)).collect(),
        };
        f(ToPaint { bricks: found.concat(), ..ToPaint::default() });
    }
}

/// Finds wanted voxels in leaves.
struct Finder<'a, R> {
    grid: &'a Grid,
    region: &'a R,
    wanted: PaintTarget,
    bricks: BrickBox,
}

impl<R: Region> Finder<'_, R> {
    /// Returns the wanted voxels of leaves of one row along x, leaf by leaf.
    #[inline(always)]
    fn in_row<S: Simd>(&self, simd: S, leaves: &[UVec3]) -> VoxelsByBrick {
        let mut found = Vec::new();
        let Some(first) = leaves.first() else { return found };
        let low = first * LEAF_EDGE;
        let (from, end) = (self.bricks.min.max(low), self.bricks.max.min(low + LEAF_EDGE));
        let mut rows = Vec::new();
        for z in from.z..end.z {
            for y in from.y..end.y {
                let mut cut = R::Row::default();
                let (y_vx, z_vx) = (y * BRICK_EDGE_VX, z * BRICK_EDGE_VX);
                let reach = self.region.cut_row(simd, y_vx, z_vx, &mut cut);
                rows.push((y, z, cut, reach));
            }
        }
        for leaf in leaves {
            for (y, z, cut, reach) in &rows {
                let RowReach { touched, whole } = reach;
                let low = (leaf.x * LEAF_EDGE).max(touched.start).max(self.bricks.min.x);
                let end = ((leaf.x + 1) * LEAF_EDGE).min(touched.end).min(self.bricks.max.x);
                for b in (low..end).map(|x| UVec3::new(x, *y, *z)) {
                    let brick = self.grid.brick(b);
                    let has_some = match self.wanted {
                        PaintTarget::Existing => !brick.is_empty(),
                        PaintTarget::Missing => !brick.is_full(),
                    };
                    if !has_some {
                        continue;
                    }
                    let mask = match whole.contains(&b.x) {
                        true => Brick::FULL,
                        false => self.region.mask(simd, cut, reach, b.x),
                    };
                    let mask = match self.wanted {
                        PaintTarget::Existing => mask.and(brick),
                        PaintTarget::Missing => mask.and(&self.grid.valid_mask(b)).and_not(brick),
                    };
                    if !mask.is_empty() {
                        found.push((b, mask));
                    }
                }
            }
        }
        found
    }
}

/// The colours that an edit paints with.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum PaintedWith {
    /// Those of an edit.
    Edit(EditOp),
    /// Existing voxels get colours of their own.
    AnyColours {
        /// Whether unpainted bricks stay as they are.
        keeps_base: bool,
    },
}

/// Returns an upper bound of the bytes by which painting a region makes the colours larger: a quick one, or a close one.
pub(crate) fn growth(
    contents: &Contents,
    region: &impl Region,
    painted: PaintedWith,
    is_close: bool,
) -> u64 {
    let Contents { grid, material, .. } = contents;
    let (wanted, colour) = match painted {
        PaintedWith::Edit(EditOp::Subtract) => return 0,
        PaintedWith::Edit(EditOp::Add(colour)) => {
            (PaintTarget::Missing, Some(colour.unwrap_or(material.base())))
        }
        PaintedWith::Edit(EditOp::Recolour(colour)) => (PaintTarget::Existing, Some(colour)),
        PaintedWith::AnyColours { .. } => (PaintTarget::Existing, None),
    };
    let keeps_base = match painted {
        PaintedWith::AnyColours { keeps_base } => keeps_base,
        _ => colour.is_some_and(|colour| material.depth().quantise(colour) == material.base()),
    };
    if material.depth().bytes() == 0 || colour.is_some_and(|colour| !may_paint(material, colour)) {
        return 0;
    }
    if !is_close {
        let bricks = BrickBox::around(region, grid).map_or(0, BrickBox::brick_count);
        let most = if keeps_base { material.page_count() as u64 } else { u64::MAX };
        return material.most_growth(bricks.min(most));
    }
    let mut growth = ColourGrowth::of(material);
    for_each_portion(grid, region, wanted, colour.is_some(), &mut |portion| {
        if let Some(colour) = colour {
            portion.cubes.into_iter().for_each(|cube| growth.add_cube(cube, colour));
        }
        for (b, mask) in portion.bricks {
            match colour {
                Some(colour) => growth.add_painted(b, colour, mask.is_full()),
                None if keeps_base && material.page(b).is_none() => {}
                None => growth.add_coloured(b),
            }
        }
    });
    growth.bytes()
}

/// Returns an upper bound of the bytes by which painting listed bricks in any colours makes the colours larger.
pub(crate) fn growth_of_bricks(
    material: &Material,
    bricks: impl IntoIterator<Item = UVec3>,
) -> u64 {
    let mut growth = ColourGrowth::of(material);
    if material.depth().bytes() > 0 {
        bricks.into_iter().for_each(|b| growth.add_coloured(b));
    }
    growth.bytes()
}
