//! How much of each cell of a field exists, with and without the room that is hidden behind the surface.
//!
//! From a grid, the cells and the hidden room to counts of voxels. Goes by bricks: those that are all of a kind are counted by
//! their size, a row of them at a time, the others by what each cell cuts out of them. Changes nothing; knows no brush.

use std::ops::Range;

use fearless_simd::{Level, dispatch};
use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::level_field::Cells;
use super::level_hidden::{Hidden, HiddenShare, Shares};
use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, BrickKind};

/// Layers of voxels that are counted together, about.
const LAYERS: i32 = 48;
/// Edge of a brick, in voxels.
const EDGE: i32 = BRICK_EDGE_VX as i32;

/// The part of a brick that lies in one cell, as far as one axis tells.
struct Part {
    cell: usize,
    /// How thick it is.
    voxels: u32,
    mask: Brick,
}

/// The parts of all bricks along an axis.
struct Axis {
    /// Of the first brick.
    first: i32,
    parts: Vec<Vec<Part>>,
}

impl Axis {
    fn new(cells: &Cells, axis: usize) -> Axis {
        let (voxels, edge) = (cells.voxels(), cells.edge[axis]);
        let (min, max) = (voxels.min[axis], voxels.max[axis]);
        let first = min.div_euclid(EDGE);
        let bricks = first..(max - 1).div_euclid(EDGE) + 1;
        let parts = |b: i32| {
            let mut parts: Vec<Part> = Vec::new();
            for local in 0..EDGE {
                let at = b * EDGE + local;
                if !(min..max).contains(&at) {
                    continue;
                }
                let cell = ((at - min) / edge) as usize;
                if parts.last().is_none_or(|part| part.cell != cell) {
                    parts.push(Part { cell, voxels: 0, mask: Brick::EMPTY });
                }
                if let Some(part) = parts.last_mut() {
                    part.voxels += 1;
                    part.mask = part.mask.or(&layer(axis, local as u32));
                }
            }
            parts
        };
        Axis { first, parts: bricks.map(parts).collect() }
    }

    /// The bricks along the axis that have a part in some cells, and those parts.
    fn within(&self, cells: Range<usize>) -> impl Iterator<Item = (i32, &[Part])> {
        self.all().filter_map(move |(b, parts)| {
            let from = parts.partition_point(|part| part.cell < cells.start);
            let to = parts.partition_point(|part| part.cell < cells.end);
            (from < to).then(|| (b, &parts[from..to]))
        })
    }

    /// After the last brick.
    fn end(&self) -> i32 {
        self.first + self.parts.len() as i32
    }

    fn all(&self) -> impl Iterator<Item = (i32, &[Part])> {
        (self.first..).zip(&self.parts).map(|(b, parts)| (b, parts.as_slice()))
    }
}

/// The voxels of a brick with one coordinate.
fn layer(axis: usize, at: u32) -> Brick {
    let mut to = [BRICK_EDGE_VX; 3];
    to[axis] = at + 1;
    let mut below = [BRICK_EDGE_VX; 3];
    below[axis] = at;
    Brick::below(to).and_not(&Brick::below(below))
}

/// How many voxels of each cell exist, and how many exist or are hidden.
pub fn counts(grid: &Grid, cells: &Cells, hidden: &Hidden) -> (Vec<f64>, Vec<f64>) {
    let UVec3 { x: width, y: height, z: depth } = cells.counted;
    let layer = (width * height) as usize;
    let layers = (LAYERS / cells.edge.z).max(1) as usize;
    let axes = [0, 1, 2].map(|axis| Axis::new(cells, axis));
    let bricks = |of: fn(&Axis) -> i32| IVec3::from(axes.each_ref().map(of));
    let shares = hidden.shares(bricks(|axis| axis.first), bricks(Axis::end));
    let mut both = vec![[0u32; 2]; layer * depth as usize];
    both.par_chunks_mut((layer * layers).max(1)).enumerate().for_each(|(i, out)| {
        let first = i * layers;
        let slab = Slab { grid, hidden, shares: &shares, axes: &axes, group: group(cells), first };
        dispatch!(Level::new(), _simd => slab.count(width as usize, layer, out));
    });
    both.iter().map(|[clay, all]| (f64::from(*clay), f64::from(*all))).unzip()
}

/// The edge of the cubes of voxels that are hidden or not together: a small part of a cell.
fn group(cells: &Cells) -> u32 {
    match cells.edge.min_element() {
        ..5 => 1,
        5..9 => 2,
        _ => 4,
    }
}

/// Some layers of cells.
struct Slab<'a> {
    grid: &'a Grid,
    hidden: &'a Hidden,
    shares: &'a Shares<'a>,
    axes: &'a [Axis; 3],
    group: u32,
    /// The first layer.
    first: usize,
}

impl Slab<'_> {
    /// Adds to `out`: rows of `width` cells, layers of `layer`.
    #[inline(always)]
    fn count(&self, width: usize, layer: usize, out: &mut [[u32; 2]]) {
        let [along, up, deep] = self.axes;
        let layers = out.len() / layer.max(1);
        // What bricks that are all of a kind have in each cell of a row, by their thickness in x alone.
        let mut row = vec![[0u32; 2]; width];
        for (z, parts_z) in deep.within(self.first..self.first + layers) {
            for (y, parts_y) in up.all() {
                let mut rows: Vec<(usize, Brick, u32)> = Vec::with_capacity(16);
                for pz in parts_z {
                    for py in parts_y {
                        let start = (pz.cell - self.first) * layer + py.cell * width;
                        rows.push((start, pz.mask.and(&py.mask), pz.voxels * py.voxels));
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
                            for (start, mask, _) in &rows {
                                let clay = clay.and(mask);
                                for px in parts_x {
                                    let count = u32::from(clay.and(&px.mask).count());
                                    out[start + px.cell][0] += count;
                                    out[start + px.cell][1] += count;
                                }
                            }
                        }
                        Counted::Voxels(clay, all) => {
                            for (start, mask, _) in &rows {
                                let [clay, all] = [&clay, &all].map(|brick| brick.and(mask));
                                for px in parts_x {
                                    let [sum_clay, sum_all] = &mut out[start + px.cell];
                                    *sum_clay += u32::from(clay.and(&px.mask).count());
                                    *sum_all += u32::from(all.and(&px.mask).count());
                                }
                            }
                        }
                    }
                }
                for (start, _, section) in &rows {
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
                let hidden = self.hidden.brick(b, brick, self.group);
                match hidden.is_empty() {
                    true if kind == BrickKind::Empty => Counted::Nothing,
                    true => Counted::Clay(*brick),
                    false => Counted::Voxels(*brick, brick.or(&hidden)),
                }
            }
        }
    }
}

/// What is counted of a brick.
enum Counted {
    Nothing,
    /// As clay, and with hidden room, how often each voxel.
    All([u32; 2]),
    /// Clay among which no room is hidden.
    Clay(Brick),
    /// The clay, and that with hidden room.
    Voxels(Brick, Brick),
}

/// A brick at coordinates that may be outside the grid, and its kind. None if nothing exists in it.
#[inline(always)]
pub fn brick_of(grid: &Grid, b: IVec3) -> Option<(BrickKind, &Brick)> {
    let outside = b.cmplt(IVec3::ZERO).any() || b.cmpge(grid.brick_dims().as_ivec3()).any();
    let index = (!outside).then(|| grid.brick_index(b.as_uvec3()))?;
    let kind = grid.brick_kind(index);
    (kind != BrickKind::Empty).then(|| (kind, grid.brick(b.as_uvec3())))
}
