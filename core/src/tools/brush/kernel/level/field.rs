//! Computes the filled share of the neighbourhood of a point, at a scale given by a radius: the field whose level set
//! at one half is a smoothed surface.
//!
//! From counts of voxels in cubes (*cells*) to shares at any voxel, by the kernel 2 B - B B, where B is two box filters
//! on each axis. The second moments of the kernel vanish, so that it removes forms smaller than the radius and shrinks
//! larger ones half as much as the mean by B would (G. Taubin, A signal processing approach to fair surface design,
//! 1995). Shares relative to the largest nearby detect the ends of thin forms ([`Smoothed::ends`]). Sums are integers,
//! so that mirrored input gives bitwise mirrored output. Knows no grid.

use std::ops::Range;

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use crate::sculpture::region::VoxelBox;

/// Standard deviation of B, in radii.
const DEVIATION: f32 = 0.7;
/// Density of 2 B - B B at its centre across a plane, times the radius: the gradient of shares at the surface.
const DENSITY: f32 = 0.74;
/// Smallest radius for which voxels are counted in cells, in voxel edges.
const COUNTED: f32 = 8.0;
/// Edge of a cell as a share of the radius, from that radius on.
const CELL: f32 = 1.0 / 5.0;
/// The share by B that counts as solid: 1.7 radii below a plane, 0.992.
const WHOLE: f32 = 0.99;
/// Least share of the neighbourhood of the thinnest forms: less counts as nothing.
const THINNEST: f32 = 0.02;

/// The layout of the cells of a field: cells around a central voxel, of an odd number of voxels on each axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CellGrid {
    /// Voxels along the edges of a cell.
    pub edge: IVec3,
    /// The first voxel of the first cell that is counted.
    pub first: IVec3,
    /// The cells that are counted.
    pub counted: UVec3,
    /// Reach of a box filter to each side, in cells.
    reach: IVec3,
}

impl CellGrid {
    /// Lays out cells for the voxels of `bounds`, one of them centred on `middle`. `radius`: in units in which a voxel
    /// is `edges` long.
    pub fn new(bounds: VoxelBox, middle: IVec3, radius: f32, edges: Vec3) -> CellGrid {
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
        CellGrid { edge, first: corner + low * edge, counted, reach }
    }

    /// Returns the voxels that are counted.
    pub fn voxels(&self) -> VoxelBox {
        let size = self.counted.as_ivec3() * self.edge;
        VoxelBox { min: self.first, max: self.first + size }
    }

    /// Returns the number of cells in the boxes of B.
    fn taps(&self) -> f64 {
        (2 * self.reach + 1).as_dvec3().element_product().powi(2)
    }
}

/// Returns the nearest odd number, at least 1.
fn odd(v: f32) -> i32 {
    2 * ((v - 1.0) * 0.5).round().max(0.0) as i32 + 1
}

/// Counts of voxels, smoothed by B.
pub struct Smoothed<'a> {
    cells: &'a CellGrid,
    /// Sums over the boxes of B, of `size` cells.
    sums: Vec<f64>,
    size: UVec3,
    /// The share of the neighbourhood that a sum of 1 represents.
    share: f64,
    radius: f32,
}

impl<'a> Smoothed<'a> {
    /// Smooths counts by B. `counts`: the number of existing voxels in each cell, x fastest, then y, then z.
    pub fn new(cells: &'a CellGrid, counts: Vec<f64>, radius: f32) -> Smoothed<'a> {
        let (sums, size) = twice_boxed(counts, cells.counted, cells.reach.as_uvec3());
        let share = 1.0 / (f64::from(cells.edge.element_product()) * cells.taps());
        Smoothed { cells, sums, size, share, radius }
    }

    /// Returns the shares by 2 B - B B, at the cells that have two boxes around them.
    pub fn level(&self) -> FillField {
        let Smoothed { cells, share, radius, .. } = *self;
        let (twice, size) = twice_boxed(self.sums.clone(), self.size, cells.reach.as_uvec3());
        let of_twice = share / cells.taps();
        let mut shares = vec![0.0; twice.len()];
        let width = size.x.max(1) as usize;
        let rows = shares.chunks_mut(width).zip(twice.chunks(width));
        for ((out, twice), start) in rows.zip(self.starts(size)) {
            for ((out, once), twice) in out.iter_mut().zip(&self.sums[start..]).zip(twice) {
                *out = (2.0 * once * share - twice * of_twice) as f32;
            }
        }
        let first = cells.first + 4 * cells.reach * cells.edge;
        FillField { edge: cells.edge, first, size, shares, radius }
    }

    /// Returns the shares of `level` relative to the largest within 1.7 radii, if that is less than 1. At the end of a
    /// wall or a post, however thin, the share is half of that inside it.
    pub fn ends(&self, level: &FillField) -> FillField {
        let of_all = (self.share as f32) / WHOLE;
        let mut largest: Vec<f32> = self.sums.iter().map(|sum| *sum as f32 * of_all).collect();
        let width = level.size.x.max(1) as usize;
        for (shares, start) in level.shares.chunks(width).zip(self.starts(level.size)) {
            let largest = &mut largest[start..][..width];
            largest.iter_mut().zip(shares).for_each(|(most, share)| *most = most.max(*share));
        }
        let mut size = self.size;
        let mut inner = 1;
        for axis in 0..3 {
            let beyond = 4 * self.cells.reach[axis] as u32;
            largest = largest_of(&largest, inner, size[axis] as usize, beyond as usize + 1);
            size[axis] -= beyond;
            inner *= size[axis] as usize;
        }
        let shares = level.shares.iter().zip(largest);
        let shares = shares.map(|(share, largest)| share / largest.clamp(THINNEST, 1.0));
        FillField { shares: shares.collect(), ..*level }
    }

    /// Returns the starts of the rows of a field of `size` among the sums.
    fn starts(&self, size: UVec3) -> impl Iterator<Item = usize> {
        let margin = 2 * self.cells.reach.as_uvec3();
        let all = self.size;
        (0..size.y * size.z).map(move |row| {
            let (y, z) = (row % size.y + margin.y, row / size.y + margin.z);
            (margin.x + all.x * (y + all.y * z)) as usize
        })
    }
}

/// Filled shares of the neighbourhood at cell centres.
pub struct FillField {
    edge: IVec3,
    /// The first voxel of the first cell.
    first: IVec3,
    size: UVec3,
    shares: Vec<f32>,
    radius: f32,
}

impl FillField {
    /// Raises each share to at least that of `other`.
    pub(crate) fn raise_to(&mut self, other: &FillField) {
        let shares = self.shares.iter_mut().zip(&other.shares);
        shares.for_each(|(share, other)| *share = share.max(*other));
    }

    /// Lowers each share to at most that of `other`.
    pub(crate) fn lower_to(&mut self, other: &FillField) {
        let shares = self.shares.iter_mut().zip(&other.shares);
        shares.for_each(|(share, other)| *share = share.min(*other));
    }

    /// Returns the positions of voxels along an axis, of `len` from `v` on. All of them must lie between cell centres.
    pub fn places(&self, axis: usize, v: i32, len: u32) -> CellPlaces {
        let places: Vec<_> = (v..).take(len as usize).map(|v| self.place(v, axis)).collect();
        let first = places.first().map_or(0, |(cell, _)| *cell as usize);
        let cells = places.last().map_or(0, |(cell, _)| *cell as usize + 2 - first);
        CellPlaces { first, cells, places }
    }

    /// Returns the extreme share (`f32::max` or `f32::min`) at the eight cell centres around each cube of voxels
    /// between them, along x, for the cells `y` and `z` of the spans of their axes.
    pub(crate) fn extremes(
        &self,
        [along_x, along_y, along_z]: &[CellPlaces; 3],
        (y, z): (usize, usize),
        extreme: fn(f32, f32) -> f32,
        out: &mut Vec<f32>,
    ) {
        let (y, z) = (along_y.first + y, along_z.first + z);
        let rows = [(y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1)];
        let rows = rows.map(|(y, z)| self.row(along_x, y, z));
        let column = |x: usize| {
            let [a, b, c, d] = rows.map(|row| row[x]);
            extreme(extreme(a, b), extreme(c, d))
        };
        out.clear();
        out.extend((1..along_x.cells).map(|x| extreme(column(x - 1), column(x))));
    }

    /// Writes the shares at the centres of the cells around a row of voxels to `out`.
    pub fn cells(&self, along_x: &CellPlaces, y: i32, z: i32, out: &mut Vec<f32>) {
        let (y, y_share) = self.place(y, 1);
        let (z, z_share) = self.place(z, 2);
        let (y, z) = (y as usize, z as usize);
        let rows = [(y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1)];
        let rows = rows.map(|(y, z)| self.row(along_x, y, z));
        out.clear();
        out.extend((0..along_x.cells).map(|x| {
            let [a, b, c, d] = rows.map(|row| row[x]);
            between(between(a, b, y_share), between(c, d, y_share), z_share)
        }));
    }

    /// Returns the shares at the centres of a row of cells.
    #[inline(always)]
    fn row(&self, along_x: &CellPlaces, y: usize, z: usize) -> &[f32] {
        let [width, height] = [self.size.x, self.size.y].map(|size| size as usize);
        &self.shares[(y + height * z) * width + along_x.first..][..along_x.cells]
    }

    /// Returns the approximate distance of the smoothed surface from a point with this share, positive where less than
    /// half is filled.
    #[inline(always)]
    pub fn outside(&self, share: f32) -> f32 {
        (0.5 - share) * self.radius / DENSITY
    }

    /// Returns the cell before the centre of a voxel on an axis, and the fraction of the distance from there to the
    /// next.
    #[inline(always)]
    fn place(&self, v: i32, axis: usize) -> (u32, f32) {
        let edge = self.edge[axis];
        let halves = 2 * (v - self.first[axis]) + 1 - edge;
        let cell = halves.div_euclid(2 * edge);
        (cell as u32, (halves - 2 * edge * cell) as f32 / (2 * edge) as f32)
    }
}

/// The positions of voxels along an axis among the cells.
pub struct CellPlaces {
    /// The cells that are needed.
    first: usize,
    cells: usize,
    /// The cell before the centre of each voxel, and the fraction of the distance from there to the next.
    places: Vec<(u32, f32)>,
}

impl CellPlaces {
    /// Returns each cell, counted from the first that is needed, with the voxels between its centre and the next.
    pub(crate) fn spans(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        let mut end = 0;
        self.places.chunk_by(|(a, _), (b, _)| a == b).map(move |span| {
            let start = end;
            end += span.len();
            (span[0].0 as usize - self.first, start..end)
        })
    }

    /// Returns the share at a voxel of the row, interpolated from the cells around it.
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

/// Returns the sums over boxes that reach `reach` cells to each side, twice on each axis, where they are complete.
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

/// Returns the sums of each `n` successive blocks of `inner` numbers, in lines of `len` such blocks.
fn boxed(sums: &[f64], inner: usize, len: usize, n: usize) -> Vec<f64> {
    let lines = sums.len() / (inner * len).max(1);
    let left = len + 1 - n;
    let mut out = vec![0.0; lines * left * inner];
    // A single line is split so that several threads have work.
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

/// Returns the maximum of each `n` successive blocks of `inner` numbers, in lines of `len` such blocks.
fn largest_of(values: &[f32], inner: usize, len: usize, n: usize) -> Vec<f32> {
    let left = (len + 1 - n) * inner;
    let lines = values.len() / (inner * len).max(1);
    let mut out = vec![f32::NEG_INFINITY; lines * left];
    let lines = values.par_chunks((inner * len).max(1));
    out.par_chunks_mut(left.max(1)).zip(lines).for_each(|(out, line)| {
        for block in 0..n {
            let values = &line[block * inner..];
            out.iter_mut().zip(values).for_each(|(most, v)| *most = most.max(*v));
        }
    });
    out
}
