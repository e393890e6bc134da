//! The visible voxels under a footprint, whatever the ratio of voxel to pixel.
//!
//! From a footprint and a grid to the voxels that
//!
//! 1. exist and have an open face that is turned to the eye, by more than a degree ([`LEAST_TURN`]);
//! 2. have their middle projected into the outline;
//! 3. are seen: a ray of the picture meets such a face, or nothing stands between the eye and its middle, or between the
//!    eye and the point [`LIFT_VX`] above its middle. So a voxel that is hidden by less than a voxel of its own surface
//!    counts, as the steps of a slope do that is seen aslant; what lies behind another part does not. Where slits or edges
//!    are narrower than half a voxel, either may be found;
//!
//! and the voxel in the very middle, so that a brush smaller than a voxel takes the one under it.
//!
//! Most voxels are decided by a depth map of the footprint: the rays of its pixels, and more between them where those are
//! farther apart than half a voxel. Voxels near its leaps get rays of their own. Bricks are found by walking the blocks of the grid that are in the cone
//! and not hidden. Changes nothing; knows no brush.

use glam::{DMat3, DVec3, IVec3, UVec2, UVec3, Vec3};
use rayon::prelude::*;

use super::footprint::{Footprint, Touch};
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, local_coords};
use crate::sculpture::{Grid, NO_VOXEL};
use crate::surface::IndexMap;
use crate::surface::raycast::{self, sample};
use crate::view::PixelRays;

/// How far above a face the point lies that may be seen instead of its middle, in voxels: still within the empty voxel
/// beside it.
pub const LIFT_VX: f32 = 0.9;
/// The sine of the least angle between a face and the ray to it.
pub const LEAST_TURN: f32 = 0.0175;

/// Distance of the rays of the depth map where the surface is farthest, in voxels.
const RAY_SPACING_VX: f32 = 0.5;
/// Most rays of the depth map along a side: 4 million, 16 MiB.
const MOST_RAYS: u32 = 2048;
/// Rays along a side of the first map, which tells how far the surface is.
const FIRST_RAYS: u32 = 48;
/// Rays along a side of a tile whose farthest depth is kept.
const TILE: usize = 16;
/// Farther behind the surface around, a voxel is hidden without a ray of its own, in voxels.
const SURELY_HIDDEN_VX: f32 = 4.0;
/// Volume of the cell of three directions of length 1 below which rays span no picture.
const LEAST_VOLUME: f64 = 1e-9;
/// Bricks along an edge of a block of occupancy.
const BLOCK_BRICKS: u32 = 4;

/// The voxels of `grid` under `footprint`.
pub fn under(footprint: &Footprint, grid: &Grid) -> Vec<Touch> {
    let middle =
        raycast::cast(grid, footprint.eye_vx, footprint.aim).map(|hit| hit.voxel.as_ivec3());
    let mut touched = match Cone::new(footprint) {
        Some(cone) => {
            let depths = Depths::new(footprint, grid);
            Search { grid, cone: &cone, depths: &depths }.touched()
        }
        // Rays that span no picture have nothing inside their outline.
        None => Vec::new(),
    };
    if let Some(voxel) = middle
        && touched.iter().all(|touch| touch.voxel != voxel)
    {
        touched.push(Touch { voxel, offset: 0.0 });
    }
    touched
}

/// A footprint that projects points of the grid to its rays.
struct Cone {
    eye: Vec3,
    /// Take a point relative to the eye to `i s`, `j s` and `s`: i rays to the right, j down, in s lengths of the aim.
    rows: [Vec3; 3],
    lengths: [f32; 3],
    /// Lengths of the aim in a voxel.
    per_voxel: f32,
    footprint: Footprint,
}

impl Cone {
    /// None if the rays do not span a picture.
    fn new(footprint: &Footprint) -> Option<Cone> {
        let Footprint { eye_vx, aim, across, down, .. } = *footprint;
        let [across, down, aim] = [across, down, aim].map(Vec3::as_dvec3);
        let matrix = DMat3::from_cols(across, down, aim);
        let volume = matrix.determinant().abs();
        if !(volume > LEAST_VOLUME * across.length() * down.length() * aim.length()) {
            return None;
        }
        let inverse = matrix.inverse();
        let rows: [DVec3; 3] = [inverse.row(0), inverse.row(1), inverse.row(2)];
        let rows = rows.map(|row| row.as_vec3());
        rows.iter().all(|row| row.is_finite()).then(|| Cone {
            eye: eye_vx,
            rows,
            lengths: rows.map(Vec3::length),
            per_voxel: aim.length().recip() as f32,
            footprint: *footprint,
        })
    }

    /// A point relative to the eye as rays to the right and down, and lengths of the aim.
    #[inline(always)]
    fn project(&self, from_eye: Vec3) -> [f32; 3] {
        let [i, j, s] = self.rows.map(|row| row.dot(from_eye));
        [i / s, j / s, s]
    }

    /// The rays that a ball may cover, `min` and `max`, and its nearest depth. None where it is beside the outline or
    /// behind the eye. A ball around the eye covers all rays.
    #[inline(always)]
    fn ball(&self, centre: Vec3, radius_vx: f32) -> Option<([f32; 2], [f32; 2], f32)> {
        let from_eye = centre - self.eye;
        let s = self.rows[2].dot(from_eye);
        let spread = radius_vx * self.lengths[2];
        let (near, far) = (s - spread, s + spread);
        if far <= 0.0 {
            return None;
        }
        let limit = self.footprint.radius;
        if near <= far * 1e-3 {
            return Some(([-limit; 2], [limit; 2], near));
        }
        let (mut min, mut max) = ([0.0; 2], [0.0; 2]);
        for axis in 0..2 {
            let at = self.rows[axis].dot(from_eye);
            let spread = radius_vx * self.lengths[axis];
            let quotient = |v: f32, least: bool| v / if (v < 0.0) == least { near } else { far };
            min[axis] = quotient(at - spread, true);
            max[axis] = quotient(at + spread, false);
            if min[axis] > limit || max[axis] < -limit {
                return None;
            }
        }
        Some((min, max, near))
    }
}

/// How far away the first voxel of each ray is, over the square around a footprint.
struct Depths {
    /// Of the first ray, and between two, in rays of the footprint.
    first: f32,
    step: f32,
    side: usize,
    /// In lengths of the aim, row by row; infinite where nothing is.
    depths: Vec<f32>,
    /// The voxels that rays meet by faces turned to them: bricks by rising index.
    met: Vec<(u32, Brick)>,
    tiles: usize,
    /// The farthest depth of each tile and the rays around it.
    farthest: Vec<f32>,
}

impl Depths {
    fn new(footprint: &Footprint, grid: &Grid) -> Depths {
        let radius = footprint.radius.max(0.0) + 1.0;
        let step = 2.0 * radius / FIRST_RAYS as f32;
        let far = Depths::map(footprint, grid, step, FIRST_RAYS / 2);
        let far = far.depths.iter().copied().filter(|depth| depth.is_finite()).fold(0.0, f32::max);
        let width_vx = footprint.across.length().max(footprint.down.length()) * far;
        let most = (MOST_RAYS as f32 / (2.0 * radius + 1.0)).max(1.0);
        // Whole, so that the rays of the pixels are among them.
        let rays_a_pixel = (width_vx / RAY_SPACING_VX).clamp(1.0, most).ceil();
        Depths::map(footprint, grid, rays_a_pixel.recip(), (radius * rays_a_pixel).ceil() as u32)
    }

    /// `step`: between two rays, in rays of the footprint; `reach`: how many on each side of the middle one.
    fn map(footprint: &Footprint, grid: &Grid, step: f32, reach: u32) -> Depths {
        let rays = 2 * reach + 1;
        let first = -(reach as f32 * step);
        let Footprint { eye_vx, aim, across, down, .. } = *footprint;
        let mut map = IndexMap::new(PixelRays {
            origin: eye_vx,
            corner: aim + (across + down) * (first - 0.5 * step),
            step_x: across * step,
            step_y: down * step,
            size: UVec2::splat(rays),
        });
        let view = map.rays;
        sample(grid, &view, &mut map);
        let side = rays as usize;
        let mut depths = vec![f32::INFINITY; map.voxels.len()];
        let rows = depths.par_chunks_mut(side).zip(map.voxels.par_chunks(side));
        let met = rows.enumerate().flat_map_iter(|(y, (depths, voxels))| {
            let mut met: Vec<(u32, Brick)> = Vec::new();
            let pixels = depths.iter_mut().zip(voxels).zip(0..);
            for ((depth, &voxel), x) in pixels.filter(|((_, voxel), _)| **voxel != NO_VOXEL) {
                let voxel = grid.voxel_coords(voxel);
                let low = voxel.as_vec3() - eye_vx;
                let way = view.direction(x, y as u32);
                let (a, b) = (low / way, (low + 1.0) / way);
                let entries = a.min(b);
                *depth = entries.max_element().max(0.0);
                let axis = entries.max_position();
                if way[axis].abs() <= LEAST_TURN * way.length() {
                    continue;
                }
                let brick = grid.brick_index(voxel / BRICK_EDGE_VX) as u32;
                if met.last().is_none_or(|(last, _)| *last != brick) {
                    met.push((brick, Brick::EMPTY));
                }
                if let (Some((_, mask)), UVec3 { x, y, z }) = (met.last_mut(), voxel & 7) {
                    mask.set(x, y, z, true);
                }
            }
            met
        });
        let mut met: Vec<(u32, Brick)> = met.collect();
        met.sort_unstable_by_key(|(brick, _)| *brick);
        met.dedup_by(|(next, mask), (brick, all)| {
            *next == *brick && {
                *all = all.or(mask);
                true
            }
        });
        let tiles = side.div_ceil(TILE);
        let tile = |index: usize| {
            let (left, top) = (index % tiles * TILE, index / tiles * TILE);
            let rows = top.saturating_sub(1)..(top + TILE + 1).min(side);
            let columns = left.saturating_sub(1)..(left + TILE + 1).min(side);
            let row = |y: usize| depths[y * side + columns.start..y * side + columns.end].iter();
            rows.flat_map(row).copied().fold(0.0, f32::max)
        };
        let farthest = (0..tiles * tiles).into_par_iter().map(tile).collect();
        Depths { first, step, side, depths, met, tiles, farthest }
    }

    /// The place of a ray of the footprint in the map, in its rays.
    #[inline(always)]
    fn place(&self, ray: f32) -> f32 {
        ((ray - self.first) / self.step).clamp(0.0, (self.side - 1) as f32)
    }

    /// The voxels of a brick that rays meet, by its linear index.
    fn met(&self, brick: usize) -> Brick {
        let found = self.met.binary_search_by_key(&(brick as u32), |(brick, _)| *brick);
        found.map_or(Brick::EMPTY, |at| self.met[at].1)
    }

    /// The nearest and the farthest depth of the four rays around one of the footprint.
    #[inline(always)]
    fn around(&self, i: f32, j: f32) -> (f32, f32) {
        let (x, y) = (self.place(i) as usize, self.place(j) as usize);
        let (right, below) = ((x + 1).min(self.side - 1), (y + 1).min(self.side - 1));
        let at = |x: usize, y: usize| self.depths[y * self.side + x];
        let depths = [at(x, y), at(right, y), at(x, below), at(right, below)];
        let [a, b, c, d] = depths;
        (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }

    /// The farthest depth of a rectangle of rays of the footprint, or of more.
    #[inline(always)]
    fn farthest(&self, min: [f32; 2], max: [f32; 2]) -> f32 {
        let low = min.map(|ray| self.place(ray) as usize / TILE);
        let high = max.map(|ray| self.place(ray) as usize / TILE);
        let mut farthest = 0f32;
        for y in low[1]..=high[1] {
            let row = &self.farthest[y * self.tiles..][..self.tiles];
            farthest = row[low[0]..=high[0]].iter().copied().fold(farthest, f32::max);
        }
        farthest
    }
}

/// The walk over the bricks in the cone.
struct Search<'a> {
    grid: &'a Grid,
    cone: &'a Cone,
    depths: &'a Depths,
}

impl Search<'_> {
    fn touched(&self) -> Vec<Touch> {
        let blocks = self.grid.occupancy_dims();
        let rows = (0..blocks.y * blocks.z).into_par_iter();
        rows.flat_map_iter(|row| {
            let mut touched = Vec::new();
            for x in 0..blocks.x {
                self.add_block(UVec3::new(x, row % blocks.y, row / blocks.y), &mut touched);
            }
            touched
        })
        .collect()
    }

    fn add_block(&self, block: UVec3, touched: &mut Vec<Touch>) {
        let mut occupied = self.grid.occupancy_word(block);
        let first = block * BLOCK_BRICKS;
        if occupied == 0 || !self.may_be_seen(first, BLOCK_BRICKS) {
            return;
        }
        while occupied != 0 {
            let bit = occupied.trailing_zeros();
            occupied &= occupied - 1;
            let b = first + UVec3::new(bit & 3, bit >> 2 & 3, bit >> 4);
            if self.may_be_seen(b, 1) {
                self.add_brick(b, touched);
            }
        }
    }

    /// Whether voxels of a cube of bricks may be in the outline, and none of them is behind all that is seen around.
    #[inline(always)]
    fn may_be_seen(&self, first: UVec3, bricks: u32) -> bool {
        let edge = (bricks * BRICK_EDGE_VX) as f32;
        let centre = (first * BRICK_EDGE_VX).as_vec3() + 0.5 * edge;
        // Half the diagonal, and what a point may be lifted above a face.
        let radius_vx = edge * 0.87 + 1.0;
        let Some((min, max, near)) = self.cone.ball(centre, radius_vx) else { return false };
        let hidden = self.depths.farthest(min, max) + SURELY_HIDDEN_VX * self.cone.per_voxel;
        near <= hidden
    }

    fn add_brick(&self, b: UVec3, touched: &mut Vec<Touch>) {
        let corner = (b * BRICK_EDGE_VX).as_vec3();
        let from_eye = corner - self.cone.eye;
        let faces = open_faces(self.grid, b, from_eye);
        let met = self.depths.met(self.grid.brick_index(b));
        let any = faces.iter().fold(met, |any, open| any.or(open));
        let footprint = &self.cone.footprint;
        any.for_each(|local| {
            let v = Vec3::from(local_coords(local).map(|v| v as f32));
            let middle = from_eye + v + 0.5;
            let [i, j, s] = self.cone.project(middle);
            let distance = footprint.outline.distance(i, j);
            // Written so that no number is outside.
            if !(s > 0.0 && distance <= footprint.radius) {
                return;
            }
            let (word, bit) = (local as usize >> 6, local & 63);
            let open = [0, 1, 2].map(|axis: usize| faces[axis].words[word] >> bit & 1 != 0);
            if met.words[word] >> bit & 1 != 0 || self.is_seen(middle, open) {
                let voxel = (corner + v).as_ivec3();
                touched.push(Touch { voxel, offset: distance / footprint.radius.max(1.0) });
            }
        });
    }

    /// Whether a voxel is seen by one of its open faces. `middle`: of the voxel, from the eye.
    #[inline(always)]
    fn is_seen(&self, middle: Vec3, open: [bool; 3]) -> bool {
        let least = LEAST_TURN * middle.length();
        let turned = |axis: usize| open[axis] && middle[axis].abs() - 0.5 > least;
        let mut doubtful = [false; 3];
        for axis in (0..3).filter(|axis| turned(*axis)) {
            let [i, j, s] = self.cone.project(above(middle, axis, LIFT_VX));
            let (nearest, farthest) = self.depths.around(i, j);
            if s <= nearest {
                return true;
            }
            let margin = SURELY_HIDDEN_VX * self.cone.per_voxel;
            doubtful[axis] = s <= farthest + margin + (farthest - nearest) || {
                let [i, j, s] = self.cone.project(above(middle, axis, 0.0));
                let (nearest, farthest) = self.depths.around(i, j);
                s <= farthest + margin + (farthest - nearest)
            };
        }
        (0..3).filter(|axis| doubtful[*axis]).any(|axis| {
            self.sees(above(middle, axis, LIFT_VX)) || self.sees(above(middle, axis, 0.0))
        })
    }

    /// Whether nothing stands before a point, given from the eye.
    fn sees(&self, point: Vec3) -> bool {
        // Up to a hair before it, since a face stands at itself.
        let hit = raycast::cast(self.grid, self.cone.eye, point);
        hit.is_none_or(|hit| hit.t >= 1.0 - 1e-3 / point.length().max(1.0))
    }
}

/// The point `lift_vx` above the face on `axis` that is turned to the eye, of a voxel whose middle is given from the eye.
#[inline(always)]
fn above(mut middle: Vec3, axis: usize, lift_vx: f32) -> Vec3 {
    middle[axis] -= (0.5 + lift_vx).copysign(middle[axis]);
    middle
}

/// For each axis the voxels of a brick with an open face that is turned to the eye. `from_eye`: its lower corner.
fn open_faces(grid: &Grid, b: UVec3, from_eye: Vec3) -> [Brick; 3] {
    let brick = grid.brick(b);
    [0, 1, 2].map(|axis: usize| {
        // Voxels below the eye show their upper face, those above it their lower one; around it neither.
        let below = (-from_eye[axis]).ceil().clamp(0.0, 8.0) as u32;
        let mut open = Brick::EMPTY;
        if below > 0 {
            open = brick.and_not(&neighbours(grid, b, axis, 1)).and(&layers(axis, below));
        }
        if below < BRICK_EDGE_VX {
            let shut = neighbours(grid, b, axis, -1).or(&layers(axis, below));
            open = open.or(&brick.and_not(&shut));
        }
        open
    })
}

/// The voxels of a brick whose coordinate on `axis` is below `end`.
fn layers(axis: usize, end: u32) -> Brick {
    let mut limit = [BRICK_EDGE_VX; 3];
    limit[axis] = end;
    Brick::below(limit)
}

/// The voxels of the brick `b` whose neighbour on `axis`, one up or down by `step`, exists.
fn neighbours(grid: &Grid, b: UVec3, axis: usize, step: i32) -> Brick {
    let mut at = b.as_ivec3();
    at[axis] += step;
    let inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(grid.brick_dims().as_ivec3()).all();
    let own = grid.brick(b).to_rows();
    let other = if inside { grid.brick(at.as_uvec3()).to_rows() } else { [0; 8] };
    const FIRST: u64 = 0x0101_0101_0101_0101;
    const LAST: u64 = FIRST << 7;
    let rows: [u64; 8] = std::array::from_fn(|z| match (axis, step > 0) {
        (0, true) => own[z] >> 1 & !LAST | (other[z] & FIRST) << 7,
        (0, false) => own[z] << 1 & !FIRST | (other[z] & LAST) >> 7,
        (1, true) => own[z] >> 8 | other[z] << 56,
        (1, false) => own[z] << 8 | other[z] >> 56,
        (_, true) => own.get(z + 1).copied().unwrap_or(other[0]),
        (_, false) => {
            if z > 0 {
                own[z - 1]
            } else {
                other[7]
            }
        }
    });
    Brick::from_rows(&rows)
}
