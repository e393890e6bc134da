//! The positions of the vertices of a mesh, and their colours.
//!
//! All meshes that follow the voxels have the same faces; they differ in the positions of their vertices: at the
//! corners of the voxels, or on the smooth surface, as in surface nets (Gibson, "Constrained elastic surface nets",
//! 1998). Takes corners of the lattice with the octants around them; returns positions in grid coordinates.

use std::ops::Range;
use std::sync::LazyLock;

use glam::{IVec3, UVec3, Vec3, Vec3A, Vec4};

use super::contact::{CORNERS, Fan, MOST_FANS, beside, voxel_of};
use super::rows::VoxelRows;
use crate::sculpture::history::Contents;
use crate::sculpture::{Grid, Rgb};
use crate::shade::{LevelLayer, LevelSet};

/// The distance by which vertices that share a corner of the lattice are moved apart, so that a mesh without shared
/// vertices, as in an .stl file, is a manifold, too.
pub const GAP_VX: f32 = 1.0 / 64.0;

/// Places the vertices of a mesh.
pub trait VertexPlacement: Sync {
    /// The data of the voxels beside a layer of the lattice that is needed to place its vertices.
    type Layer: Default;

    /// Replaces `layer` by that of the corners of `rows` at `z`.
    fn enter(&self, layer: &mut Self::Layer, z: i32, rows: &VoxelRows);
    /// Returns the vertex of a corner with one fan.
    fn only(&self, layer: &Self::Layer, corner: IVec3, octants: u8) -> Vec3 {
        self.fan(layer, corner, octants, 0)
    }
    /// Returns the vertex of a fan of the corner at `corner`, around which `octants` exist.
    fn fan(&self, layer: &Self::Layer, corner: IVec3, octants: u8, fan: usize) -> Vec3;
    /// Returns the vertex in the middle of the pinched edge from `corner` along `axis`, on the side of the existing
    /// `octant`.
    fn middle(&self, layer: &Self::Layer, corner: IVec3, axis: usize, octant: usize) -> Vec3;
}

/// Places vertices at the corners of the voxels.
pub struct AtCorners;

impl VertexPlacement for AtCorners {
    type Layer = ();

    fn enter(&self, (): &mut (), _: i32, _: &VoxelRows) {}

    #[inline(always)]
    fn only(&self, (): &(), corner: IVec3, _: u8) -> Vec3 {
        corner.as_vec3()
    }

    #[inline(always)]
    fn fan(&self, (): &(), corner: IVec3, octants: u8, fan: usize) -> Vec3 {
        let table = &CORNERS[octants as usize];
        match table.count {
            1 => corner.as_vec3(),
            _ => corner.as_vec3() + table.fans[fan].apart * GAP_VX,
        }
    }

    fn middle(&self, (): &(), corner: IVec3, axis: usize, octant: usize) -> Vec3 {
        let mut towards = voxel_of(octant).as_vec3() + 0.5;
        towards[axis] = 0.0;
        let mut middle = corner.as_vec3() + towards.normalize() * GAP_VX;
        middle[axis] += 0.5;
        middle
    }
}

/// The data for computing a fan's vertex: the mean of the points where the surface crosses its edges.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Mean {
    /// The mean of the lower ends of the edges, relative to the centre of the first voxel around the corner.
    start: Vec3A,
    /// The weight of the four edges along each axis; 0 if an edge does not belong to the fan.
    weights: [Vec3A; 4],
}

impl Mean {
    fn of(faces: u16) -> Mean {
        let weight = 1.0 / faces.count_ones().max(1) as f32;
        let mut mean = Mean { start: Vec3A::ZERO, weights: [Vec3A::ZERO; 4] };
        for face in (0..12).filter(|face| faces >> face & 1 != 0) {
            let [low, _] = beside(face);
            mean.start += (voxel_of(low) + 1).as_vec3a() * weight;
            mean.weights[face % 4][face / 4] = weight;
        }
        mean
    }
}

/// The means of all fans of all corners.
static MEANS: LazyLock<[[Mean; MOST_FANS]; 256]> =
    LazyLock::new(|| CORNERS.each_ref().map(|corner| corner.fans.map(|fan| Mean::of(fan.faces))));

/// Places vertices on the smooth surface: at the point nearest to the mean of those where it crosses the edges of a
/// cell between voxel centres.
pub struct OnSurface<'a> {
    grid: &'a Grid,
    levels: &'a LevelSet,
    means: &'static [[Mean; MOST_FANS]; 256],
}

/// The levels of the voxels below and above a layer of the lattice.
#[derive(Default)]
pub struct LevelsBeside {
    /// The layer, and its bricks along x and y.
    place: Option<(i32, [Range<u32>; 2])>,
    low: LevelLayer,
    high: LevelLayer,
}

impl LevelsBeside {
    /// Returns the levels of the eight voxels around a corner.
    #[inline(always)]
    fn around(&self, corner: IVec3) -> [f32; 8] {
        let [x, y] = [corner.x as usize, corner.y as usize];
        LevelLayer::corners(&self.low, &self.high, [x, y]).map(f32::from)
    }
}

/// Returns the trilinear value of `levels` between the centres of eight voxels, from 0 to 1, and its gradient.
#[inline(always)]
fn trilinear(levels: &[f32; 8], at: Vec3A) -> (f32, Vec3A) {
    let &[a, b, c, d, e, f, g, h] = levels;
    let (low, high) = (Vec4::new(a, b, c, d), Vec4::new(e, f, g, h));
    let rise = high - low;
    let [a, b, c, d] = (low + rise * at.z).to_array();
    let [x, y] = [1.0 - at.x, 1.0 - at.y];
    let weights = Vec4::new(x * y, at.x * y, x * at.y, at.x * at.y);
    let gradient =
        Vec3A::new(y * (b - a) + at.y * (d - c), x * (c - a) + at.x * (d - b), weights.dot(rise));
    (weights.dot(Vec4::new(a, b, c, d)), gradient)
}

/// Returns the vertex of a fan whose edges the surface crosses at `mean` on average: one step of Newton's method from
/// there, so that the vertices of edges, corners and thin parts lie on the surface, too, and not within it.
#[inline(always)]
fn on_surface(levels: &[f32; 8], mean: Vec3A) -> Vec3A {
    let (value, gradient) = trilinear(levels, mean);
    let step = gradient * (value / gradient.length_squared().max(LEAST_GRADIENT_SQUARED));
    (mean - step).clamp(Vec3A::splat(MARGIN_VX), Vec3A::splat(1.0 - MARGIN_VX))
}

/// The distance of vertices from the sides of their cells, so that those of neighbours never coincide.
const MARGIN_VX: f32 = 1.0 / 32.0;
/// A squared gradient, in levels per voxel, below which a step along it would be arbitrary.
const LEAST_GRADIENT_SQUARED: f32 = 256.0;

/// Returns the vertex of a fan that is separated from others: the point where the surface crosses the segment from the
/// mean of its crossings to its side of the corner, or that mean if the surface joins what the mesh separates.
#[cold]
fn on_parted_surface(levels: &[f32; 8], mean: Vec3A, apart: Vec3) -> Vec3A {
    let end = Vec3A::splat(0.5) + Vec3A::from(apart) * GAP_VX;
    let [from, to] = [mean, end].map(|at| trilinear(levels, at).0);
    match from * to < 0.0 {
        true => mean.lerp(end, from / (from - to)),
        false => end,
    }
}

impl<'a> OnSurface<'a> {
    /// Returns the placement on the smooth surface of `grid`.
    pub fn new(grid: &'a Grid, levels: &'a LevelSet) -> OnSurface<'a> {
        OnSurface { grid, levels, means: &MEANS }
    }
}

impl VertexPlacement for OnSurface<'_> {
    type Layer = LevelsBeside;

    fn enter(&self, layer: &mut LevelsBeside, z: i32, rows: &VoxelRows) {
        let bricks = rows.bricks_beside(self.grid.brick_dims().truncate());
        let place = Some((z, bricks.clone()));
        if layer.place.as_ref().is_some_and(|(before, at)| before + 1 == z && *at == bricks) {
            std::mem::swap(&mut layer.low, &mut layer.high);
        } else {
            layer.low.read(self.levels, self.grid, i64::from(z) - 1, &bricks);
        }
        layer.high.read(self.levels, self.grid, z.into(), &bricks);
        layer.place = place;
    }

    #[inline(always)]
    fn fan(&self, layer: &LevelsBeside, corner: IVec3, octants: u8, fan: usize) -> Vec3 {
        let levels = layer.around(corner);
        let d = levels.map(f32::abs);
        let Mean { start, weights } = &self.means[octants as usize][fan];
        // The octants below and above the faces 0, 4 and 8 and those that follow, as in `beside`.
        let ends = [
            [[d[0], d[0], d[0]], [d[1], d[2], d[4]]],
            [[d[2], d[4], d[1]], [d[3], d[6], d[5]]],
            [[d[4], d[1], d[2]], [d[5], d[3], d[6]]],
            [[d[6], d[5], d[3]], [d[7], d[7], d[7]]],
        ];
        let mut mean = *start;
        for ([low, high], weights) in ends.into_iter().zip(weights) {
            let low = Vec3A::from_array(low);
            mean += low / (low + Vec3A::from_array(high)) * *weights;
        }
        let table = &CORNERS[octants as usize];
        let place = match table.count {
            1 => on_surface(&levels, mean),
            _ => on_parted_surface(&levels, mean, table.fans[fan].apart),
        };
        Vec3::from(corner.as_vec3a() - 0.5 + place)
    }

    fn middle(&self, layer: &LevelsBeside, corner: IVec3, axis: usize, octant: usize) -> Vec3 {
        let levels = layer.around(corner);
        let [u, v] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
        let [own, beside, other] =
            [levels[octant], levels[octant ^ u] + levels[octant ^ v], levels[octant ^ u ^ v]];
        // From the centre of its own voxel (0) towards that of the other one (1).
        let level = |t: f32| own * (1.0 - t) * (1.0 - t) + beside * t * (1.0 - t) + other * t * t;
        let (mut inside, mut outside) = (0.0, 0.5 - GAP_VX);
        if level(outside) * own < 0.0 {
            for _ in 0..16 {
                let t = 0.5 * (inside + outside);
                *(if level(t) * own < 0.0 { &mut outside } else { &mut inside }) = t;
            }
        }
        let mut middle = (voxel_of(octant) + 1).as_vec3();
        for axis in [u, v].map(|bit: usize| bit.trailing_zeros() as usize) {
            middle[axis] += if octant >> axis & 1 != 0 { -outside } else { outside };
        }
        corner.as_vec3() - 0.5 + middle
    }
}

/// Returns the colour of a vertex: the mean of the existing voxels beside its faces.
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

/// Returns the octants that exist around a corner.
pub(crate) fn octants_around(grid: &Grid, corner: IVec3) -> u8 {
    (0..8).fold(0, |octants, i| octants | u8::from(grid.get(corner + voxel_of(i))) << i)
}

/// Returns the existing octant beside the pinched edge above a corner along `axis`, with bit `side` along the second
/// axis after it.
pub(crate) fn octant_of_edge(octants: u8, axis: usize, side: usize) -> usize {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let octant = 1 << axis | side << v;
    if octants >> octant & 1 != 0 { octant } else { octant | 1 << u }
}

/// Returns the existing voxels beside the faces of a fan.
pub(crate) fn solid_of(octants: u8, fan: usize) -> u8 {
    let Fan { solid, .. } = CORNERS[octants as usize].fans[fan];
    solid
}
