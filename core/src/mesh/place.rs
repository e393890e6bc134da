//! Where the vertices of a mesh lie, and their colours.
//!
//! All meshes that follow the voxels have the same faces; they differ in where their vertices are: at the corners
//! of the voxels, or on the smooth surface, as in surface nets (Gibson, "Constrained elastic surface nets", 1998).
//! Takes corners of the lattice with the octants around them; gives positions in grid coordinates.

use glam::{IVec3, UVec3, Vec3};

use super::contact::{CORNERS, Corner, Fan, beside, voxel_of};
use crate::sculpture::history::Contents;
use crate::sculpture::{Grid, Rgb};
use crate::shade::LevelSet;

/// How far vertices that share a corner of the lattice are moved apart, so that a mesh without shared vertices, as
/// in an .stl file, is a manifold, too.
pub const GAP_VX: f32 = 1.0 / 64.0;

/// Places the vertices of a mesh.
pub trait Place: Sync {
    /// The vertex of a corner with one fan.
    fn only(&self, corner: IVec3, octants: u8) -> Vec3 {
        self.fan(corner, octants, 0)
    }
    /// The vertex of a fan of the corner at `corner`, around which `octants` exist.
    fn fan(&self, corner: IVec3, octants: u8, fan: usize) -> Vec3;
    /// The vertex in the middle of the pinched edge from `corner` along `axis`, on the side of the existing `octant`.
    fn middle(&self, corner: IVec3, axis: usize, octant: usize) -> Vec3;
}

/// At the corners of the voxels.
pub struct AtCorners;

impl Place for AtCorners {
    #[inline(always)]
    fn only(&self, corner: IVec3, _: u8) -> Vec3 {
        corner.as_vec3()
    }

    #[inline(always)]
    fn fan(&self, corner: IVec3, octants: u8, fan: usize) -> Vec3 {
        let table = &CORNERS[octants as usize];
        match table.count {
            1 => corner.as_vec3(),
            _ => corner.as_vec3() + table.fans[fan].apart * GAP_VX,
        }
    }

    fn middle(&self, corner: IVec3, axis: usize, octant: usize) -> Vec3 {
        let mut towards = voxel_of(octant).as_vec3() + 0.5;
        towards[axis] = 0.0;
        let mut middle = corner.as_vec3() + towards.normalize() * GAP_VX;
        middle[axis] += 0.5;
        middle
    }
}

/// The edge of a cell that crosses a face: its octants, and where it begins and leads.
#[derive(Clone, Copy)]
struct Edge {
    low: u8,
    high: u8,
    start: Vec3,
    step: Vec3,
}

/// The edges across the twelve faces; the last four are no faces.
const EDGES: [Edge; 16] = {
    let mut edges = [Edge { low: 0, high: 0, start: Vec3::ZERO, step: Vec3::ZERO }; 16];
    let mut face = 0;
    while face < 12 {
        let [low, high] = beside(face);
        let start = Vec3::new((low & 1) as f32, (low >> 1 & 1) as f32, (low >> 2) as f32);
        let step = [Vec3::X, Vec3::Y, Vec3::Z][face / 4];
        edges[face] = Edge { low: low as u8, high: high as u8, start, step };
        face += 1;
    }
    edges
};

/// On the smooth surface: in the mean of the places where it crosses the edges of a cell between voxel centres.
pub struct OnSurface<'a> {
    /// The voxels.
    pub grid: &'a Grid,
    /// Their smooth surface.
    pub levels: &'a LevelSet,
    corners: &'static [Corner; 256],
}

impl<'a> OnSurface<'a> {
    /// On the smooth surface of `grid`.
    pub fn new(grid: &'a Grid, levels: &'a LevelSet) -> OnSurface<'a> {
        OnSurface { grid, levels, corners: &CORNERS }
    }

    /// How far the surface is from octant `from` on the way to `to`, as a share of it.
    #[inline(always)]
    fn share(levels: &[f32; 8], from: usize, to: usize) -> f32 {
        let (a, b) = (levels[from].abs(), levels[to].abs());
        a / (a + b)
    }
}

impl Place for OnSurface<'_> {
    #[inline(always)]
    fn fan(&self, corner: IVec3, octants: u8, fan: usize) -> Vec3 {
        let levels = self.levels.corners(self.grid, corner);
        let faces = self.corners[octants as usize].fans[fan].faces;
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        let mut rest = faces;
        while rest != 0 {
            let Edge { low, high, start, step } = &EDGES[rest.trailing_zeros() as usize % 16];
            rest &= rest - 1;
            let (a, b) = (levels[*low as usize % 8].abs(), levels[*high as usize % 8].abs());
            sum += *start + *step * (a / (a + b));
            count += 1.0;
        }
        corner.as_vec3() - 0.5 + sum / count
    }

    fn middle(&self, corner: IVec3, axis: usize, octant: usize) -> Vec3 {
        let levels = self.levels.corners(self.grid, corner);
        let mut middle = (voxel_of(octant) + 1).as_vec3();
        for other in [(axis + 1) % 3, (axis + 2) % 3] {
            let share = Self::share(&levels, octant, octant ^ 1 << other);
            let step = if octant >> other & 1 != 0 { -share } else { share };
            middle[other] += 0.5 * step;
        }
        corner.as_vec3() - 0.5 + middle
    }
}

/// The colour of a vertex: the mean of the existing voxels beside its faces.
pub fn colour(contents: &Contents, corner: IVec3, solid: u8) -> Rgb {
    let mut sum = [0u32; 3];
    let count = solid.count_ones();
    for octant in (0..8).filter(|octant| solid >> octant & 1 != 0) {
        let voxel: UVec3 = (corner + voxel_of(octant)).as_uvec3();
        let Rgb(rgb) = contents.rgb(voxel);
        sum.iter_mut().zip(rgb).for_each(|(sum, channel)| *sum += u32::from(channel));
    }
    Rgb(sum.map(|sum| ((sum + count / 2) / count.max(1)) as u8))
}

/// The octants that exist around a corner.
pub fn octants_around(grid: &Grid, corner: IVec3) -> u8 {
    (0..8).fold(0, |octants, i| octants | u8::from(grid.get(corner + voxel_of(i))) << i)
}

/// The existing octant beside the pinched edge above a corner along `axis`, with bit `side` along the second axis
/// after it.
pub fn octant_of_edge(octants: u8, axis: usize, side: usize) -> usize {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let octant = 1 << axis | side << v;
    if octants >> octant & 1 != 0 { octant } else { octant | 1 << u }
}

/// The existing voxels beside the faces of a fan.
pub fn solid_of(octants: u8, fan: usize) -> u8 {
    let Fan { solid, .. } = CORNERS[octants as usize].fans[fan];
    solid
}
