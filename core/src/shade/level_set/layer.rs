//! The levels of one layer of voxels, as plain rows: for visiting many cells in turn, with each page read once.
//!
//! Takes a level set and its grid, returns the levels of cells between two layers.

use std::ops::Range;

use glam::{UVec2, UVec3};

use super::{LevelSet, NO_PAGE, beyond, place};
use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;

/// The levels of the voxels of a layer along z, with a margin of one voxel around the grid.
#[derive(Clone, Default, Debug)]
pub struct LevelLayer {
    /// Voxels of a row, with its margins.
    width: usize,
    /// Rows y = -1, 0, ... of voxels x = -1, 0, ...
    levels: Vec<i8>,
}

impl LevelLayer {
    /// Reads the part of layer `z` of `grid` in some bricks along x and y, with the margins beside those at its border.
    /// The layer may be the one before the first or after the last. Other voxels are unspecified then.
    pub fn read(&mut self, set: &LevelSet, grid: &Grid, z: i64, bricks: &[Range<u32>; 2]) {
        let dims = grid.dims();
        let UVec2 { x: width, y: height } = dims.truncate() + 2;
        let (width, height) = (width as usize, height as usize);
        self.width = width;
        self.levels.resize(width * height, 0);
        let inside = z.clamp(0, i64::from(dims.z) - 1);
        self.read_inside(set, grid, inside as u32, bricks);
        let [xs, ys] = bricks;
        let [is_left, is_right] = [xs.start == 0, xs.end == grid.brick_dims().x];
        let within = |bricks: &Range<u32>, axis: u32| {
            let end = (bricks.end * BRICK_EDGE_VX).min(axis) as usize;
            (bricks.start * BRICK_EDGE_VX) as usize + 1..end + 1
        };
        let (columns, rows) = (within(xs, dims.x), within(ys, dims.y));
        for row in self.levels[width * rows.start..width * rows.end].chunks_exact_mut(width) {
            if is_left {
                row[0] = beyond(row[1]);
            }
            if is_right {
                row[width - 1] = beyond(row[width - 2]);
            }
        }
        let with_margins =
            columns.start - usize::from(is_left)..columns.end + usize::from(is_right);
        let (first, last) = (width, width * (height - 2));
        for (is_there, to, from) in
            [(ys.start == 0, 0, first), (ys.end == grid.brick_dims().y, width * (height - 1), last)]
        {
            for x in with_margins.clone().filter(|_| is_there) {
                let at_border = self.levels[from + x.clamp(1, width - 2)];
                self.levels[to + x] = beyond(at_border);
            }
        }
        if inside != z {
            // The margins lie beyond the border by now, as seen from voxels inside.
            for row in self.levels[width * rows.start..width * rows.end].chunks_exact_mut(width) {
                row[columns.clone()].iter_mut().for_each(|level| *level = beyond(*level));
            }
        }
    }

    /// Reads the voxels of some bricks of the layer, without margins.
    fn read_inside(&mut self, set: &LevelSet, grid: &Grid, z: u32, [xs, ys]: &[Range<u32>; 2]) {
        let dims = grid.dims();
        let (brick_z, local_z) = (z / BRICK_EDGE_VX, z % BRICK_EDGE_VX);
        for brick_y in ys.clone() {
            let rows = BRICK_EDGE_VX.min(dims.y - brick_y * BRICK_EDGE_VX) as usize;
            let first_row = (1 + brick_y * BRICK_EDGE_VX) as usize * self.width;
            for brick_x in xs.clone() {
                let length = BRICK_EDGE_VX.min(dims.x - brick_x * BRICK_EDGE_VX) as usize;
                let first = first_row + 1 + (brick_x * BRICK_EDGE_VX) as usize;
                let b = UVec3::new(brick_x, brick_y, brick_z);
                let mut buffer = [0; 64];
                let levels: &[i8; 64] = match set.page(b) {
                    NO_PAGE => {
                        buffer.fill(set.far(grid, b));
                        &buffer
                    }
                    page => {
                        let slice = &set.pages[page as usize][place(0, 0, local_z)..];
                        slice.first_chunk().unwrap_or(&buffer)
                    }
                };
                for (y, row) in levels.chunks_exact(8).take(rows).enumerate() {
                    let to = first + y * self.width;
                    let to = &mut self.levels[to..to + length];
                    match to.first_chunk_mut::<8>() {
                        Some(to) => to.copy_from_slice(row),
                        None => to.copy_from_slice(&row[..length]),
                    }
                }
            }
        }
    }

    /// Returns the levels of the corners of a cell with the voxels `[x - 1, x]` and `[y - 1, y]` of a layer and of the
    /// one above it: corner `x + 2 y + 4 z`. The cell lies between 0 and the grid's dimensions, inclusive.
    #[inline(always)]
    pub fn corners(low: &LevelLayer, high: &LevelLayer, [x, y]: [usize; 2]) -> [i8; 8] {
        let first = y * low.width + x;
        let second = first + low.width;
        let (a, b) = (&low.levels[..], &high.levels[..]);
        [
            a[first],
            a[first + 1],
            a[second],
            a[second + 1],
            b[first],
            b[first + 1],
            b[second],
            b[second + 1],
        ]
    }
}
