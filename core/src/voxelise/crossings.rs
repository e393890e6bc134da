//! Crossings of rays through the centres of voxels with triangles, by slabs of 64 rays.
//!
//! Corners are rounded to fractions of a voxel; everything after that is computed in integers: a ray through an edge
//! shared by two triangles crosses exactly one of them. A slab is computed when it is needed and not kept.

use std::ops::Range;

use glam::{I64Vec3, UVec3};
use rayon::prelude::*;

use crate::sculpture::grid::LEAF_EDGE_VX;

/// Fractions of a voxel that corners are rounded to.
pub const SUB_VX: i64 = 1 << 12;
/// The most triangles that a crossing can index.
pub const MOST_TRIANGLES: usize = 1 << 26;
/// Triangles handled at a time.
const PORTION: usize = 1 << 6;

/// The two axes across each axis: a ray has a place `a` on the first, which runs along x if that is one of them, and `b`
/// on the second. A slab holds the rays of 64 places `b`.
pub const ACROSS: [(usize, usize); 3] = [(1, 2), (0, 2), (0, 1)];

/// A crossing in 64 bits, ordered by rays and along them: `b` in the slab (6 bits) and `a` of the ray (13 bits), the
/// number of voxel centres before the crossing (14 bits), whether it leaves (1 bit), and the triangle (26 bits).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct MeshCrossing(u64);

const RAY_SHIFT: u32 = 41;
const BEFORE_SHIFT: u32 = 27;
const A_BITS: u32 = 13;

impl MeshCrossing {
    fn new([a, b]: [u32; 2], before: u32, leaves: bool, triangle: usize) -> MeshCrossing {
        let ray = (b % LEAF_EDGE_VX) << A_BITS | a;
        let place = u64::from(ray) << RAY_SHIFT | u64::from(before) << BEFORE_SHIFT;
        MeshCrossing(place | u64::from(leaves) << 26 | triangle as u64)
    }

    /// Returns the number of the ray in its slab.
    fn ray(self) -> u32 {
        (self.0 >> RAY_SHIFT) as u32
    }

    /// Returns the number of voxel centres before it, which is the first voxel after it.
    pub fn before(self) -> u32 {
        (self.0 >> BEFORE_SHIFT & 0x3FFF) as u32
    }

    /// Returns the voxels before and after it, of `count` along the ray.
    pub fn sides(self, count: u32) -> impl Iterator<Item = u32> {
        let after = self.before();
        after.checked_sub(1).into_iter().chain(Some(after).filter(|after| *after < count))
    }

    /// Returns 1 or -1, by the direction in which the surface is crossed.
    pub fn step(self) -> i32 {
        if self.0 >> 26 & 1 != 0 { -1 } else { 1 }
    }

    pub fn triangle(self) -> usize {
        (self.0 & (MOST_TRIANGLES as u64 - 1)) as usize
    }
}

/// The crossings of the rays of a slab, in order.
#[derive(Debug)]
pub struct RaySlab {
    pub axis: usize,
    /// The lowest `b`.
    first: u32,
    crossings: Vec<MeshCrossing>,
}

/// A ray with its crossings, in order.
pub struct MeshRay<'a> {
    /// Its places across.
    pub a: u32,
    pub b: u32,
    pub crossings: &'a [MeshCrossing],
}

impl RaySlab {
    /// Returns all rays with crossings.
    pub fn rays(&self) -> impl Iterator<Item = MeshRay<'_>> {
        self.of(&self.crossings)
    }

    /// Returns the rays at places `a`, at the place `b` in the slab.
    pub fn rays_of(&self, a: Range<u32>, b: u32) -> impl Iterator<Item = MeshRay<'_>> {
        let row = b << A_BITS;
        let at = |ray: u32| self.crossings.partition_point(|c| c.ray() < ray);
        self.of(&self.crossings[at(row | a.start)..at(row + a.end)])
    }

    fn of<'a>(&'a self, crossings: &'a [MeshCrossing]) -> impl Iterator<Item = MeshRay<'a>> {
        crossings.chunk_by(|x, y| x.ray() == y.ray()).map(|crossings| {
            let ray = crossings[0].ray();
            let a = ray & ((1 << A_BITS) - 1);
            MeshRay { a, b: self.first + (ray >> A_BITS), crossings }
        })
    }

    /// Returns the voxel at a position along a ray.
    pub fn voxel(&self, ray: &MeshRay, along: u32) -> UVec3 {
        let (a, b) = ACROSS[self.axis];
        let mut v = UVec3::ZERO;
        (v[a], v[b], v[self.axis]) = (ray.a, ray.b, along);
        v
    }
}

/// A mesh in its grid, in fractions of a voxel.
#[derive(Debug)]
pub struct PlacedMesh {
    pub dims: UVec3,
    pub corners: Vec<I64Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// The triangles that meet each slab of an axis, and at most how many crossings a slab has.
#[derive(Debug)]
pub struct TriangleSlabs {
    axis: usize,
    /// Where the triangles of each slab begin, and the end of the last.
    starts: Vec<usize>,
    numbers: Vec<u32>,
    most_crossings: u64,
    /// An upper bound of the crossings of all slabs.
    pub all_crossings: u64,
}

impl TriangleSlabs {
    /// Returns the number of slabs.
    pub fn count(&self) -> u32 {
        self.starts.len() as u32 - 1
    }

    /// Returns an upper bound of the bytes of the list and of a slab while it is made.
    pub fn bytes(&self) -> u64 {
        // Once in portions and once in order.
        self.numbers.len() as u64 * 4 + 2 * self.most_crossings * size_of::<MeshCrossing>() as u64
    }
}

impl PlacedMesh {
    /// Returns the corners of a triangle.
    pub fn triangle(&self, number: usize) -> [I64Vec3; 3] {
        self.triangles[number].map(|corner| self.corners[corner as usize])
    }

    /// Returns the triangles by the slabs of an axis.
    pub fn slabs(&self, axis: usize) -> TriangleSlabs {
        let (a, b) = ACROSS[axis];
        let count = self.dims[b].div_ceil(LEAF_EDGE_VX) as usize;
        // The slabs of a triangle, and the most places that it has on each axis across in one of them.
        let of = |number: usize| {
            let [p, q, r] = self.triangle(number);
            let (low, high) = (p.min(q).min(r), p.max(q).max(r));
            let slab = |at: i64| (at / SUB_VX / i64::from(LEAF_EDGE_VX)).clamp(0, count as i64 - 1);
            let places = |axis: usize| ((high[axis] - low[axis]) / SUB_VX + 2) as u64;
            let crossings = places(a) * places(b).min(u64::from(LEAF_EDGE_VX));
            (slab(low[b]) as usize..slab(high[b]) as usize + 1, crossings)
        };
        let all_crossings = |number: usize| {
            let [p, q, r] = self.triangle(number);
            let area = ((q - p).cross(r - p).abs() / 2)[axis] / (SUB_VX * SUB_VX);
            let extent = p.max(q).max(r) - p.min(q).min(r);
            (area + 2 * ((extent[a] + extent[b]) / SUB_VX) + 6) as u64
        };
        let all_crossings = (0..self.triangles.len()).map(all_crossings).sum();
        let mut ends = vec![0; count + 1];
        let mut crossings = vec![0u64; count];
        for number in 0..self.triangles.len() {
            let (slabs, most) = of(number);
            for slab in slabs {
                ends[slab + 1] += 1;
                crossings[slab] += most;
            }
        }
        for slab in 0..count {
            ends[slab + 1] += ends[slab];
        }
        let starts = ends.clone();
        let mut numbers = vec![0; starts[count]];
        for number in 0..self.triangles.len() {
            for slab in of(number).0 {
                numbers[ends[slab]] = number as u32;
                ends[slab] += 1;
            }
        }
        let most_crossings = crossings.into_iter().max().unwrap_or(0);
        TriangleSlabs { axis, starts, numbers, most_crossings, all_crossings }
    }

    /// Returns the crossings of the rays of a slab.
    pub fn cross(&self, slabs: &TriangleSlabs, slab: u32) -> RaySlab {
        let axis = slabs.axis;
        let first = slab * LEAF_EDGE_VX;
        let end = (first + LEAF_EDGE_VX).min(self.dims[ACROSS[axis].1]);
        let numbers = &slabs.numbers[slabs.starts[slab as usize]..slabs.starts[slab as usize + 1]];
        let portions = numbers.par_chunks(PORTION).map(|numbers| {
            let mut crossings = Vec::new();
            for number in numbers {
                self.cross_triangle(axis, *number as usize, first..end, &mut crossings);
            }
            crossings
        });
        let portions: Vec<Vec<MeshCrossing>> = portions.collect();
        let mut crossings = portions.concat();
        drop(portions);
        crossings.par_sort_unstable();
        RaySlab { axis, first, crossings }
    }

    /// Adds the crossings of a triangle with the rays at places `within` on the second axis.
    fn cross_triangle(
        &self,
        axis: usize,
        number: usize,
        within: Range<u32>,
        out: &mut Vec<MeshCrossing>,
    ) {
        let (a, b) = ACROSS[axis];
        let [p, mut q, mut r] = self.triangle(number);
        let area = (q[a] - p[a]) * (r[b] - p[b]) - (q[b] - p[b]) * (r[a] - p[a]);
        if area == 0 {
            return;
        }
        let leaves = area < 0;
        if leaves {
            std::mem::swap(&mut q, &mut r);
        }
        let area = area.abs() as f64;
        let size_a = i64::from(self.dims[a]);
        let (least_b, end_b) = (i64::from(within.start), i64::from(within.end));
        let count = f64::from(self.dims[axis]);
        // Rays with centres in [low, high].
        let first = |low: i64| (low - SUB_VX / 2 + SUB_VX - 1).div_euclid(SUB_VX).max(least_b);
        let last = |high: i64| (high - SUB_VX / 2).div_euclid(SUB_VX).min(end_b - 1);
        let rows = first(p[b].min(q[b]).min(r[b]))..=last(p[b].max(q[b]).max(r[b]));
        let edges = [(p, q), (q, r), (r, p)];
        for j in rows {
            let at_b = j * SUB_VX + SUB_VX / 2;
            // Edge functions at the centre of the ray i: constant + slope * i, at least `least` inside.
            let lines = edges.map(|(from, to)| {
                let (da, db) = (to[a] - from[a], to[b] - from[b]);
                let constant = da * (at_b - from[b]) - db * (SUB_VX / 2 - from[a]);
                let owns = db > 0 || db == 0 && da < 0;
                (constant, -db * SUB_VX, if owns { 0 } else { 1 })
            });
            let (mut low, mut high) = (0, size_a - 1);
            for (constant, slope, least) in lines {
                if slope > 0 {
                    low = low.max((least - constant + slope - 1).div_euclid(slope));
                } else if slope < 0 {
                    high = high.min((constant - least).div_euclid(-slope));
                } else if constant < least {
                    high = -1;
                }
            }
            for i in low..=high {
                // The edge opposite a corner gives its weight.
                let weight = |(constant, slope, _): (i64, i64, i64)| (constant + slope * i) as f64;
                let depth = (weight(lines[1]) * p[axis] as f64
                    + weight(lines[2]) * q[axis] as f64
                    + weight(lines[0]) * r[axis] as f64)
                    / (area * SUB_VX as f64);
                let before = (depth - 0.5).ceil().clamp(0.0, count) as u32;
                out.push(MeshCrossing::new([i as u32, j as u32], before, leaves, number));
            }
        }
    }
}
