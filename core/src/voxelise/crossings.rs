//! Crossings of rays through the centres of voxels with triangles.
//!
//! Corners are rounded to fractions of a voxel; everything after that is computed in integers: a ray through an edge
//! shared by two triangles crosses exactly one of them.

use glam::{I64Vec3, UVec3};
use rayon::prelude::*;

/// Fractions of a voxel that corners are rounded to.
pub const SUB_VX: i64 = 1 << 12;
/// The most triangles that a crossing can index.
pub const MOST_TRIANGLES: usize = 1 << 26;
/// Triangles handled at a time.
const PORTION: usize = 1 << 11;

/// The two axes across each axis: bits of rows run along x if that is one of them.
pub const ACROSS: [(usize, usize); 3] = [(1, 2), (0, 2), (0, 1)];

/// A crossing in 64 bits, ordered by rays and along them: the ray (24 bits), the number of voxel centres before the
/// crossing (13 bits), whether it leaves (1 bit), and the triangle (26 bits).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct MeshCrossing(u64);

impl MeshCrossing {
    fn new(ray: i64, before: i64, leaves: bool, triangle: usize) -> MeshCrossing {
        let place = (ray as u64) << 40 | (before as u64) << 27;
        MeshCrossing(place | u64::from(leaves) << 26 | triangle as u64)
    }

    /// Returns the index of the ray: `a + size_a * b` for the axes across.
    pub fn ray(self) -> usize {
        (self.0 >> 40) as usize
    }

    /// Returns the number of voxel centres before it, which is the first voxel after it.
    pub fn before(self) -> u32 {
        (self.0 >> 27 & 0x1FFF) as u32
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

/// The crossings of all rays along an axis, in order.
#[derive(Debug)]
pub struct Rays {
    pub axis: usize,
    pub crossings: Vec<MeshCrossing>,
}

impl Rays {
    /// Returns the crossings of the rays from `first` to before `end`.
    pub fn of(&self, first: usize, end: usize) -> &[MeshCrossing] {
        let at = |ray: usize| self.crossings.partition_point(|c| c.ray() < ray);
        &self.crossings[at(first)..at(end)]
    }
}

/// A mesh in its grid, in fractions of a voxel.
#[derive(Debug)]
pub struct PlacedMesh {
    pub dims: UVec3,
    pub corners: Vec<I64Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl PlacedMesh {
    /// Returns the corners of a triangle.
    pub fn triangle(&self, number: usize) -> [I64Vec3; 3] {
        self.triangles[number].map(|corner| self.corners[corner as usize])
    }

    /// Returns an upper bound of the number of crossings along all axes.
    pub(crate) fn crossings_at_most(&self) -> u64 {
        let of_triangle = |number: usize| {
            let [p, q, r] = self.triangle(number);
            let normal = (q - p).cross(r - p).abs() / 2;
            let extent = p.max(q).max(r) - p.min(q).min(r);
            let area = normal.element_sum() / (SUB_VX * SUB_VX);
            (area + 2 * (extent.element_sum() / SUB_VX) + 6) as u64
        };
        (0..self.triangles.len()).into_par_iter().map(of_triangle).sum()
    }

    /// Returns all crossings of the rays along an axis.
    pub fn cross(&self, axis: usize) -> Rays {
        let numbers: Vec<usize> = (0..self.triangles.len().div_ceil(PORTION)).collect();
        let portions = numbers.par_iter().map(|portion| {
            let mut crossings = Vec::new();
            let end = self.triangles.len().min((portion + 1) * PORTION);
            for number in portion * PORTION..end {
                self.cross_triangle(axis, number, &mut crossings);
            }
            crossings
        });
        let portions: Vec<Vec<MeshCrossing>> = portions.collect();
        let mut crossings = portions.concat();
        drop(portions);
        crossings.par_sort_unstable();
        Rays { axis, crossings }
    }

    fn cross_triangle(&self, axis: usize, number: usize, out: &mut Vec<MeshCrossing>) {
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
        let (size_a, size_b) = (i64::from(self.dims[a]), i64::from(self.dims[b]));
        let count = f64::from(self.dims[axis]);
        // Rays with centres in [low, high].
        let first = |low: i64| (low - SUB_VX / 2 + SUB_VX - 1).div_euclid(SUB_VX).max(0);
        let last = |high: i64| (high - SUB_VX / 2).div_euclid(SUB_VX);
        let rows = first(p[b].min(q[b]).min(r[b]))..=last(p[b].max(q[b]).max(r[b])).min(size_b - 1);
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
                let before = (depth - 0.5).ceil().clamp(0.0, count);
                out.push(MeshCrossing::new(i + size_a * j, before as i64, leaves, number));
            }
        }
    }
}
