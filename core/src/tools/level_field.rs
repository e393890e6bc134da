//! How much of the neighbourhood of a place exists, on a scale given by a radius: the field whose half is a smoothed surface.
//!
//! From counts of voxels in cubes (*cells*) to shares at any voxel, by the kernel 2 B - B B, where B is two boxes on each
//! axis: its second moments vanish, so that it takes away what is smaller than the radius and lets what is larger shrink half
//! as much as the mean by B would (G. Taubin, A signal processing approach to fair surface design, 1995). Sums are whole
//! numbers, so that what is mirrored is the same to the bit. Knows no grid.

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use crate::sculpture::region::VoxelBox;

/// Standard deviation of B, in radii.
const DEVIATION: f32 = 0.7;
/// Density of 2 B - B B at its middle across a plane, times the radius: how fast shares change at the surface.
const DENSITY: f32 = 0.74;
/// Smallest radius for which voxels are counted in cells, in edges of a voxel.
const COUNTED: f32 = 8.0;
/// Edge of a cell as a share of the radius, from there on.
const CELL: f32 = 1.0 / 5.0;

/// Where the cells of a field are: cells around a middle voxel, of an odd number of voxels on each axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cells {
    /// Voxels along the edges of a cell.
    pub edge: IVec3,
    /// The first voxel of the first cell that is counted.
    pub first: IVec3,
    /// The cells that are counted.
    pub counted: UVec3,
    /// Half a box less its middle, in cells.
    reach: IVec3,
}

impl Cells {
    /// The cells for the voxels of `bounds`, one of them with `middle` in its middle. `radius`: in units in which a
    /// voxel is `edges` long.
    pub fn new(bounds: VoxelBox, middle: IVec3, radius: f32, edges: Vec3) -> Cells {
        let of_axis = |axis: usize| {
            let radius_vx = radius / edges[axis];
            let edge = match radius_vx < COUNTED {
                true => 1,
                false => odd(radius_vx * CELL).max(3),
            };
            // Two boxes of n cells have the variance (n^2 - 1) / 6.
            let deviation = DEVIATION * radius_vx / edge as f32;
            (edge, odd((6.0 * deviation * deviation + 1.0).sqrt()) / 2)
        };
        let axes = [0, 1, 2].map(of_axis);
        let edge = IVec3::from(axes.map(|(edge, _)| edge));
        let reach = IVec3::from(axes.map(|(_, reach)| reach));
        let corner = middle - edge / 2;
        let cell = |v: IVec3| (v - corner).div_euclid(edge);
        let (low, high) = (cell(bounds.min) - 1 - 4 * reach, cell(bounds.max - 1) + 1 + 4 * reach);
        let counted = (high - low + 1).max(IVec3::ZERO).as_uvec3();
        Cells { edge, first: corner + low * edge, counted, reach }
    }

    /// The voxels that are counted.
    pub fn voxels(&self) -> VoxelBox {
        let size = self.counted.as_ivec3() * self.edge;
        VoxelBox { min: self.first, max: self.first + size }
    }
}

/// The nearest odd number, at least 1.
fn odd(v: f32) -> i32 {
    2 * ((v - 1.0) * 0.5).round().max(0.0) as i32 + 1
}

/// Shares of the neighbourhood that exist, at the middles of cells.
pub struct Field {
    edge: IVec3,
    /// The first voxel of the first cell.
    first: IVec3,
    size: UVec3,
    shares: Vec<f32>,
    radius: f32,
}

impl Field {
    /// `counts`: the voxels that exist in each cell, x fastest, then y, then z.
    pub fn new(cells: &Cells, counts: Vec<f64>, radius: f32) -> Field {
        let reach = cells.reach.as_uvec3();
        let (once, size) = twice_boxed(counts, cells.counted, reach);
        let (two, inner) = twice_boxed(once.clone(), size, reach);
        let taps = (2 * cells.reach + 1).as_dvec3().element_product().powi(2);
        let volume = f64::from(cells.edge.element_product()) * taps;
        let (of_once, of_two) = (1.0 / volume, 1.0 / (volume * taps));
        let margin = 2 * reach;
        let mut shares = vec![0.0; two.len()];
        let rows =
            shares.chunks_mut(inner.x.max(1) as usize).zip(two.chunks(inner.x.max(1) as usize));
        for (row, (out, two)) in rows.enumerate() {
            let (y, z) = (row as u32 % inner.y, row as u32 / inner.y);
            let start = margin.x + size.x * (y + margin.y + size.y * (z + margin.z));
            let once = &once[start as usize..][..out.len()];
            for ((out, once), two) in out.iter_mut().zip(once).zip(two) {
                *out = (2.0 * once * of_once - two * of_two) as f32;
            }
        }
        let first = cells.first + 4 * cells.reach * cells.edge;
        Field { edge: cells.edge, first, size: inner, shares, radius }
    }

    /// The places of a row of voxels from `x` on. All of them must lie between middles of cells.
    pub fn columns(&self, x: i32, width: usize) -> Columns {
        let places: Vec<_> = (x..).take(width).map(|x| self.place(x, 0)).collect();
        let first = places.first().map_or(0, |(cell, _)| *cell as usize);
        let cells = places.last().map_or(0, |(cell, _)| *cell as usize + 2 - first);
        Columns { first, cells, places }
    }

    /// The shares at the middles of the cells around a row of voxels.
    pub fn cells(&self, columns: &Columns, y: i32, z: i32, out: &mut Vec<f32>) {
        let (y, y_share) = self.place(y, 1);
        let (z, z_share) = self.place(z, 2);
        let width = self.size.x as usize;
        let row = |y: u32, z: u32| {
            let start = (y + self.size.y * z) as usize * width + columns.first;
            &self.shares[start..start + columns.cells]
        };
        let rows = [row(y, z), row(y + 1, z), row(y, z + 1), row(y + 1, z + 1)];
        out.clear();
        out.extend((0..columns.cells).map(|x| {
            let [a, b, c, d] = rows.map(|row| row[x]);
            between(between(a, b, y_share), between(c, d, y_share), z_share)
        }));
    }

    /// How far the smoothed surface is from where the share is this, about: above 0 where less than half exists.
    #[inline(always)]
    pub fn outside(&self, share: f32) -> f32 {
        (0.5 - share) * self.radius / DENSITY
    }

    /// The cell before the middle of a voxel on an axis, and how far the voxel is from there to the next.
    #[inline(always)]
    fn place(&self, v: i32, axis: usize) -> (u32, f32) {
        let edge = self.edge[axis];
        let halves = 2 * (v - self.first[axis]) + 1 - edge;
        let cell = halves.div_euclid(2 * edge);
        (cell as u32, (halves - 2 * edge * cell) as f32 / (2 * edge) as f32)
    }
}

/// Where the voxels of a row lie among the cells.
pub struct Columns {
    /// The cells that are needed.
    first: usize,
    cells: usize,
    /// The cell before the middle of each voxel, and how far it is from there to the next.
    places: Vec<(u32, f32)>,
}

impl Columns {
    /// The share at a voxel of the row, from those at the cells around it.
    #[inline(always)]
    pub fn share(&self, cells: &[f32], x: usize) -> f32 {
        let (cell, share) = self.places[x];
        let cell = cell as usize - self.first;
        between(cells[cell], cells[cell + 1], share)
    }
}

#[inline(always)]
fn between(a: f32, b: f32, share: f32) -> f32 {
    a + (b - a) * share
}

/// The sums over boxes that reach `reach` cells to each side, twice on each axis, where they are complete.
fn twice_boxed(counts: Vec<f64>, size: UVec3, reach: UVec3) -> (Vec<f64>, UVec3) {
    let (mut sums, mut size) = (counts, size);
    for axis in 0..3 {
        for _ in 0..2 {
            let inner = match axis {
                0 => 1,
                1 => size.x,
                _ => size.x * size.y,
            };
            sums = boxed(&sums, inner as usize, size[axis] as usize, 2 * reach[axis] as usize + 1);
            size[axis] -= 2 * reach[axis];
        }
    }
    (sums, size)
}

/// Sums of `n` blocks of `inner` numbers each, in lines of `len` such blocks.
fn boxed(sums: &[f64], inner: usize, len: usize, n: usize) -> Vec<f64> {
    let lines = sums.len() / (inner * len).max(1);
    let left = len + 1 - n;
    let mut out = vec![0.0; lines * left * inner];
    // A single line is cut, so that several threads have something to do.
    let piece = if lines == 1 { left.div_ceil(8) } else { left };
    out.par_chunks_mut((piece * inner).max(1)).enumerate().for_each(|(i, out)| {
        let (line, from) = if lines == 1 { (0, i * piece) } else { (i, 0) };
        let line = &sums[line * len * inner..][..len * inner];
        let blocks = out.len() / inner;
        for k in 0..blocks {
            let (before, here) = out.split_at_mut(k * inner);
            let here = &mut here[..inner];
            let at = |block: usize| &line[block * inner..][..inner];
            match k {
                0 => (from..from + n).for_each(|block| {
                    here.iter_mut().zip(at(block)).for_each(|(sum, v)| *sum += v);
                }),
                _ => {
                    let before = &before[(k - 1) * inner..];
                    let (gone, come) = (at(from + k - 1), at(from + k + n - 1));
                    for x in 0..inner {
                        here[x] = before[x] - gone[x] + come[x];
                    }
                }
            }
        }
    });
    out
}
