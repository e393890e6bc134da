//! Counts the filled voxels in each cell of a field, with and without the space hidden behind the surface.
//!
//! From a grid, the cells and the hidden space to counts of voxels. Works brick by brick: uniform bricks are counted by
//! their size, a row of them at a time, the others by the part that each cell cuts out of them. Changes nothing; knows
//! no brush.

use std::ops::Range;

use fearless_simd::{Level, dispatch};
use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::field::CellGrid;
use super::hidden::{Hidden, HiddenShare, HiddenShares, brick_of};
use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, BrickKind, WORD_EDGE_VX};

/// Approximate number of voxel layers that are counted together.
const LAYERS: i32 = 48;
/// Edge of a brick, in voxels.
const EDGE: i32 = BRICK_EDGE_VX as i32;
/// The voxels of a word with the lowest coordinate on each axis.
const FIRST_OF_WORD: [u64; 3] = [0x1111_1111_1111_1111, 0x000f_000f_000f_000f, 0xffff];

/// The part of a brick that lies in one cell and in the words at one position, along one axis.
struct CellOverlap {
    cell: usize,
    /// Its thickness in voxels.
    voxels: u32,
    /// Summed over the axes, the index of the word in its brick.
    word: usize,
    /// The voxels of each such word.
    mask: u64,
}

/// The parts of all bricks along an axis.
struct AxisOverlaps {
    /// The first brick.
    first: i32,
    parts: Vec<Vec<CellOverlap>>,
}

impl AxisOverlaps {
    fn new(cells: &CellGrid, axis: usize) -> AxisOverlaps {
        let (voxels, edge) = (cells.voxels(), cells.edge[axis]);
        let (min, max) = (voxels.min[axis], voxels.max[axis]);
        let first = min.div_euclid(EDGE);
        let bricks = first..(max - 1).div_euclid(EDGE) + 1;
        let parts = |b: i32| {
            let mut parts: Vec<CellOverlap> = Vec::new();
            for local in 0..BRICK_EDGE_VX {
                let at = b * EDGE + local as i32;
                if !(min..max).contains(&at) {
                    continue;
                }
                let cell = ((at - min) / edge) as usize;
                let word = ((local / WORD_EDGE_VX) as usize) << axis;
                if parts.last().is_none_or(|part| (part.cell, part.word) != (cell, word)) {
                    parts.push(CellOverlap { cell, voxels: 0, word, mask: 0 });
                }
                if let Some(part) = parts.last_mut() {
                    part.voxels += 1;
                    part.mask |= FIRST_OF_WORD[axis] << ((local % WORD_EDGE_VX) << (2 * axis));
                }
            }
            parts
        };
        AxisOverlaps { first, parts: bricks.map(parts).collect() }
    }

    /// Returns the bricks along the axis that have a part in a range of cells, with those parts.
    fn within(&self, cells: Range<usize>) -> impl Iterator<Item = (i32, &[CellOverlap])> {
        self.all().filter_map(move |(b, parts)| {
            let from = parts.partition_point(|part| part.cell < cells.start);
            let to = parts.partition_point(|part| part.cell < cells.end);
            (from < to).then(|| (b, &parts[from..to]))
        })
    }

    /// Returns one past the last brick.
    fn end(&self) -> i32 {
        self.first + self.parts.len() as i32
    }

    fn all(&self) -> impl Iterator<Item = (i32, &[CellOverlap])> {
        (self.first..).zip(&self.parts).map(|(b, parts)| (b, parts.as_slice()))
    }
}

/// Returns how many voxels of each cell exist, and how many exist or are hidden.
pub fn counts(grid: &Grid, cells: &CellGrid, hidden: &Hidden) -> (Vec<f64>, Vec<f64>) {
    let UVec3 { x: width, y: height, z: depth } = cells.counted;
    let layer = (width * height) as usize;
    let layers = (LAYERS / cells.edge.z).max(1) as usize;
    let axes = [0, 1, 2].map(|axis| AxisOverlaps::new(cells, axis));
    let bricks = |of: fn(&AxisOverlaps) -> i32| IVec3::from(axes.each_ref().map(of));
    let shares = hidden.shares(bricks(|axis| axis.first), bricks(AxisOverlaps::end));
    let mut both = vec![[0u32; 2]; layer * depth as usize];
    both.par_chunks_mut((layer * layers).max(1)).enumerate().for_each(|(i, out)| {
        let first = i * layers;
        let slab = CellSlab { grid, shares: &shares, axes: &axes, group: group(cells), first };
        dispatch!(Level::new(), _simd => slab.count(width as usize, layer, out));
    });
    both.iter().map(|[clay, all]| (f64::from(*clay), f64::from(*all))).unzip()
}

/// Returns the edge of the cubes of voxels that are classified together as hidden or not: a small part of a cell.
fn group(cells: &CellGrid) -> u32 {
    match cells.edge.min_element() {
        ..5 => 1,
        5..9 => 2,
        _ => 4,
    }
}

/// Some layers of cells.
struct CellSlab<'a> {
    grid: &'a Grid,
    shares: &'a HiddenShares<'a>,
    axes: &'a [AxisOverlaps; 3],
    group: u32,
    /// The first layer.
    first: usize,
}

impl CellSlab<'_> {
    /// Adds the counts to `out`, which consists of rows of `width` cells and layers of `layer`.
    #[inline(always)]
    fn count(&self, width: usize, layer: usize, out: &mut [[u32; 2]]) {
        let [along, up, deep] = self.axes;
        let layers = out.len() / layer.max(1);
        // The share of uniform bricks in each cell of a row, as a length in x.
        let mut row = vec![[0u32; 2]; width];
        // The parts of a row of bricks in rows of cells.
        let mut rows: Vec<CellRow> = Vec::new();
        for (z, parts_z) in deep.within(self.first..self.first + layers) {
            for (y, parts_y) in up.all() {
                rows.clear();
                for pz in parts_z {
                    for py in parts_y {
                        rows.push(CellRow {
                            start: (pz.cell - self.first) * layer + py.cell * width,
                            section: pz.voxels * py.voxels,
                            word: pz.word + py.word,
                            mask: pz.mask & py.mask,
                        });
                    }
                }
                row.fill([0; 2]);
                for (x, parts_x) in along.all() {
                    match self.brick(IVec3::new(x, y, z)) {
                        Counted::Nothing => {}
                        Counted::All(by) => {
                            for px in parts_x {
                                let [clay, all] = &mut row[px.cell];
                                *clay += by[0] * px.voxels;
                                *all += by[1] * px.voxels;
                            }
                        }
                        Counted::Clay(clay) => {
                            for row in &rows {
                                for px in parts_x {
                                    let count = row.count(px, &clay);
                                    let [sum_clay, sum_all] = &mut out[row.start + px.cell];
                                    *sum_clay += count;
                                    *sum_all += count;
                                }
                            }
                        }
                        Counted::Voxels(clay, all) => {
                            for row in &rows {
                                for px in parts_x {
                                    let [sum_clay, sum_all] = &mut out[row.start + px.cell];
                                    *sum_clay += row.count(px, &clay);
                                    *sum_all += row.count(px, &all);
                                }
                            }
                        }
                    }
                }
                for CellRow { start, section, .. } in &rows {
                    for (sum, by) in out[*start..*start + width].iter_mut().zip(&row) {
                        sum[0] += by[0] * section;
                        sum[1] += by[1] * section;
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn brick(&self, b: IVec3) -> Counted {
        let (kind, brick) = match brick_of(self.grid, b) {
            None => (BrickKind::Empty, &Brick::EMPTY),
            Some((BrickKind::Full, _)) => return Counted::All([1, 1]),
            Some(found) => found,
        };
        match (kind, self.shares.of(b)) {
            (BrickKind::Empty, HiddenShare::None) => Counted::Nothing,
            (BrickKind::Empty, HiddenShare::All) => Counted::All([0, 1]),
            (_, HiddenShare::None) => Counted::Clay(*brick),
            (_, HiddenShare::All) => Counted::Voxels(*brick, Brick::FULL),
            (_, HiddenShare::Some) => {
                let hidden = self.shares.hidden.brick(b, brick, self.group);
                match hidden.is_empty() {
                    true if kind == BrickKind::Empty => Counted::Nothing,
                    true => Counted::Clay(*brick),
                    false => Counted::Voxels(*brick, brick.or(&hidden)),
                }
            }
        }
    }
}

/// The part of a row of bricks that lies in one row of cells.
struct CellRow {
    /// The first cell.
    start: usize,
    /// Number of voxels of the part with one x.
    section: u32,
    /// The index of the first of its words in each brick.
    word: usize,
    /// The voxels of each of those words.
    mask: u64,
}

impl CellRow {
    /// Returns the number of voxels of a brick in the cell of `x`.
    #[inline(always)]
    fn count(&self, x: &CellOverlap, brick: &Brick) -> u32 {
        (brick.words[self.word + x.word] & self.mask & x.mask).count_ones()
    }
}

/// The voxels of a brick to count.
enum Counted {
    Nothing,
    /// All of them, 0 or 1 times as clay, and as clay or hidden space.
    All([u32; 2]),
    /// These in both counts: no space among them is hidden.
    Clay(Brick),
    /// The first as clay, the second as clay or hidden space.
    Voxels(Brick, Brick),
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::sculpture::bit_block::BitBlock;
    use crate::sculpture::region::VoxelBox;
    use crate::tools::brush::footprint::{Coverage, Footprint, Outline};
    use crate::tools::brush::kernel::visible::Cone;

    /// Returns plates, full and empty bricks and dust, cut off by the borders of bricks and of the grid.
    fn grid() -> Grid {
        let mut grid = Grid::new(UVec3::new(60, 45, 52), Vec3::ONE, 1 << 30).unwrap();
        for i in 0..60 * 45 * 52 {
            let v = grid.voxel_coords(i).as_ivec3();
            let dust = ((v.x * 7919 + v.y * 104_729 + v.z * 1_299_709) as u32).is_multiple_of(31);
            grid.set(v, v.y < 17 && v.x < 40 || v.y == 30 && v.z > 9 || dust && v.y > 20);
        }
        grid
    }

    #[test]
    fn cells_have_as_many_voxels_as_are_counted_one_by_one() {
        let grid = grid();
        let target = Vec3::new(31.0, 31.0, 27.0);
        for (radius, edge) in [(4.0, 1), (13.0, 3), (24.0, 5)] {
            for aim in [Vec3::NEG_Y, Vec3::new(0.5, -1.0, 0.3).normalize()] {
                let across = aim.any_orthonormal_vector();
                let footprint = Footprint {
                    eye_vx: target - aim * 90.0,
                    aim: aim * 90.0,
                    across,
                    down: aim.cross(across),
                    radius,
                    outline: Outline::Round,
                    coverage: Coverage::Visible,
                };
                let around = VoxelBox { min: IVec3::new(20, 25, 20), max: IVec3::new(33, 32, 30) };
                let cells = CellGrid::new(around, target.as_ivec3(), radius, Vec3::ONE);
                assert_eq!(cells.edge, IVec3::splat(edge));
                let margin = (around.min - cells.voxels().min).max_element() as f32;
                let cone = Cone::new(&footprint).unwrap();
                let room = [margin, edge as f32, 2.0 * radius];
                let hidden = Hidden::new(&footprint, cone, &grid, 1.0, room);
                let (clay, all) = counts(&grid, &cells, &hidden);
                let mut naive = vec![[0.0; 2]; clay.len()];
                let VoxelBox { min, max } = cells.voxels();
                let size = max - min;
                let counted = cells.counted.as_ivec3();
                for i in 0..size.element_product() {
                    let at = IVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y);
                    let exists = grid.get(min + at);
                    let cell = at / edge;
                    let cell = cell.x + counted.x * (cell.y + counted.y * cell.z);
                    let [clay, all] = &mut naive[cell as usize];
                    *clay += f64::from(u8::from(exists));
                    let middle = (min + at).as_vec3() + 0.5;
                    *all += f64::from(u8::from(exists || hidden.is(middle, 0.0)));
                }
                assert!(
                    clay.iter().zip(&naive).all(|(found, [clay, _])| found == clay),
                    "{radius} {aim}"
                );
                if group(&cells) == 1 {
                    let same = all.iter().zip(&naive).all(|(found, [_, all])| found == all);
                    assert!(same, "{radius} {aim}");
                }
                // Groups of voxels are judged by their centres: about as much space is hidden.
                let existing: f64 = clay.iter().sum();
                let room = all.iter().sum::<f64>() - existing;
                let expected = naive.iter().map(|[_, all]| all).sum::<f64>() - existing;
                assert!(room > 0.95 * expected && room < 1.05 * expected, "{radius} {aim}");
                assert!(expected > 0.0, "room is hidden");
                let mut filled = BitBlock::of_grid(&grid, around.min, around.max);
                hidden.fill(&mut filled, &grid);
                for i in 0..around.size().element_product() as i32 {
                    let size = around.size().as_ivec3();
                    let at = IVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y);
                    let v = around.min + at;
                    let meant = grid.get(v) || hidden.is(v.as_vec3() + 0.5, 0.0);
                    assert_eq!(filled.get(v), meant, "{radius} {aim} {v}");
                }
            }
        }
    }
}
