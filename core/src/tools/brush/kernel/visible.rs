//! Finds the visible voxels under a footprint, whatever the ratio of voxel to pixel.
//!
//! From a footprint and a grid to the voxels that
//!
//! 1. exist and have an open face that is turned to the eye by more than a degree ([`LEAST_TURN`]), or any open face
//!    where the surface around them is turned to the eye, as a step of a slope seen edge-on is;
//! 2. have their centre projected into the outline;
//! 3. are seen: a ray of the picture meets such a face, or nothing stands between the eye and the centre of the face or
//!    of a quarter of it, or between the eye and the point [`LIFT_VX`] above its centre. So a voxel hidden by less than
//!    a voxel of its own surface counts, as the steps of an oblique slope do; one behind another part does not. Where
//!    slits or edges are narrower than half a voxel, either may be found;
//!
//! and the voxel on the central ray, so that a brush smaller than a voxel selects the one under it.
//!
//! Most voxels are decided by a depth map of the footprint: the rays of its pixels, and more between them where those
//! are farther apart than half a voxel. Voxels near depth discontinuities get rays of their own. Bricks are found by
//! traversing the blocks of the grid that lie in the cone and are not hidden. Changes nothing; knows no brush.

use glam::{DMat3, DVec3, IVec3, UVec2, UVec3, Vec3, Vec3Swizzles};
use rayon::prelude::*;

use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, local_coords};
use crate::sculpture::{Grid, NO_VOXEL};
use crate::surface::IndexMap;
use crate::surface::raycast::{self, sample};
use crate::tools::brush::footprint::{Footprint, TouchedVoxel};
use crate::view::PixelRays;

/// Height above a face of the point that may be seen instead of its centre, in voxels: still within the empty voxel
/// beside it.
pub const LIFT_VX: f32 = 0.9;
/// The sine of the least angle between a face and the ray to it.
pub const LEAST_TURN: f32 = 0.0175;

/// The least sine for the surface around a voxel, whose normal is less exact.
const STEPPED_TURN: f32 = 0.05;
/// Radius around a voxel in which its surface normal is estimated, in voxels.
const SURFACE_VX: i32 = 4;
/// The outward normals of the faces of a voxel.
const SIDES: [IVec3; 6] = [IVec3::X, IVec3::NEG_X, IVec3::Y, IVec3::NEG_Y, IVec3::Z, IVec3::NEG_Z];

/// Offset of the sample points of a face from its centre, on both axes, in voxels.
const PART_VX: f32 = 0.33;

/// Least component of a direction.
const LEAST_COMPONENT: Vec3 = Vec3::splat(1e-20);

/// Spacing of the rays of the depth map where the surface is farthest, in voxels.
const RAY_SPACING_VX: f32 = 0.5;
/// Greatest number of rays of the depth map along a side: 4 million, 16 MiB.
const MOST_RAYS: u32 = 2048;
/// Rays along a side of the first, coarse map, which estimates the distance of the surface.
const FIRST_RAYS: u32 = 48;
/// Rays along a side of a tile whose farthest depth is kept.
const TILE: usize = 16;
/// Depth behind the surrounding surface at which a voxel is hidden without a ray of its own, in voxels.
const SURELY_HIDDEN_VX: f32 = 4.0;
/// Least volume spanned by the three unit directions; below it rays span no picture.
const LEAST_VOLUME: f64 = 1e-9;
/// Bricks along an edge of a block of occupancy.
const BLOCK_BRICKS: u32 = 4;

/// Returns the voxels of `grid` under `footprint`.
pub fn under(footprint: &Footprint, grid: &Grid) -> Vec<TouchedVoxel> {
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
        touched.push(TouchedVoxel { voxel, offset: 0.0 });
    }
    touched
}

/// A footprint that projects points of the grid to its rays.
pub(super) struct Cone {
    eye: Vec3,
    /// Maps a point relative to the eye to `i s`, `j s` and `s`: i rays to the right, j down, in s lengths of the aim.
    rows: [Vec3; 3],
    lengths: [f32; 3],
    /// The length of a voxel in lengths of the aim.
    pub per_voxel: f32,
    footprint: Footprint,
}

impl Cone {
    /// Returns `None` if the rays do not span a picture.
    pub fn new(footprint: &Footprint) -> Option<Cone> {
        let Footprint { eye_vx, aim, across, down, .. } = *footprint;
        let [across, down, aim] = [across, down, aim].map(Vec3::as_dvec3);
        let matrix = DMat3::from_cols(across, down, aim);
        let volume = matrix.determinant().abs();
        // NaN yields `None`, too.
        let spans = volume > LEAST_VOLUME * across.length() * down.length() * aim.length();
        if !spans {
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

    /// Projects a point relative to the eye to rays to the right and down, and lengths of the aim.
    #[inline(always)]
    pub fn project(&self, from_eye: Vec3) -> [f32; 3] {
        let [i, j, s] = self.rows.map(|row| row.dot(from_eye));
        [i / s, j / s, s]
    }

    /// Returns the rays that a ball may cover, `min` and `max`, and its nearest depth. `None` where it is beside the
    /// outline or behind the eye. A ball around the eye covers all rays.
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

/// Casts the rays of a square around the central ray of a footprint and returns their first voxels. `step`: spacing in
/// rays of the footprint; `reach`: number of rays on each side of the central one.
pub(super) fn map_around(footprint: &Footprint, grid: &Grid, step: f32, reach: u32) -> IndexMap {
    let Footprint { eye_vx, aim, across, down, .. } = *footprint;
    let first = -(reach as f32 * step);
    let mut map = IndexMap::new(PixelRays {
        origin: eye_vx,
        corner: aim + (across + down) * (first - 0.5 * step),
        step_x: across * step,
        step_y: down * step,
        size: UVec2::splat(2 * reach + 1),
    });
    let view = map.rays;
    sample(grid, &view, &mut map);
    map
}

/// Returns the direction of a ray for the caster: no component is 0, so that no 0 is divided by 0.
#[inline(always)]
pub(super) fn direction(view: &PixelRays, x: u32, y: u32) -> Vec3 {
    let ray = view.direction(x, y);
    Vec3::select(ray.abs().cmplt(LEAST_COMPONENT), LEAST_COMPONENT, ray)
}

/// The distance of the first voxel on each ray, over the square around a footprint.
struct Depths {
    /// Position of the first ray, and the spacing, in rays of the footprint.
    first: f32,
    step: f32,
    side: usize,
    /// Depths in lengths of the aim, row by row; infinite where nothing is hit.
    depths: Vec<f32>,
    /// The voxels whose faces turned to the rays are met: bricks by ascending index.
    met: Vec<(u32, Brick)>,
    tiles: usize,
    /// The greatest depth of each tile and the rays around it.
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
        // A whole number, so that the rays of the pixels are among them.
        let rays_a_pixel = (width_vx / RAY_SPACING_VX).clamp(1.0, most).ceil();
        Depths::map(footprint, grid, rays_a_pixel.recip(), (radius * rays_a_pixel).ceil() as u32)
    }

    /// Casts the map. `step`: spacing in rays of the footprint; `reach`: number of rays on each side of the central
    /// one.
    fn map(footprint: &Footprint, grid: &Grid, step: f32, reach: u32) -> Depths {
        let eye_vx = footprint.eye_vx;
        let first = -(reach as f32 * step);
        let map = map_around(footprint, grid, step, reach);
        let view = map.rays;
        let side = view.size.x as usize;
        let mut depths = vec![f32::INFINITY; map.voxels.len()];
        let rows = depths.par_chunks_mut(side).zip(map.voxels.par_chunks(side));
        let met = rows.enumerate().flat_map_iter(|(y, (depths, voxels))| {
            let mut met: Vec<(u32, Brick)> = Vec::new();
            let pixels = depths.iter_mut().zip(voxels).zip(0..);
            for ((depth, &voxel), x) in pixels.filter(|((_, voxel), _)| **voxel != NO_VOXEL) {
                let voxel = map.numbering.coords(voxel);
                let low = voxel.as_vec3() - eye_vx;
                let ray = direction(&view, x, y as u32);
                let (a, b) = (low / ray, (low + 1.0) / ray);
                let entries = a.min(b);
                *depth = entries.max_element().max(0.0);
                let axis = entries.max_position();
                if ray[axis].abs() <= LEAST_TURN * ray.length() {
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

    /// Returns the position of a ray of the footprint in the map, in its rays.
    #[inline(always)]
    fn place(&self, ray: f32) -> f32 {
        ((ray - self.first) / self.step).clamp(0.0, (self.side - 1) as f32)
    }

    /// Returns the voxels of a brick that rays meet, by its linear index.
    fn met(&self, brick: usize) -> Brick {
        let found = self.met.binary_search_by_key(&(brick as u32), |(brick, _)| *brick);
        found.map_or(Brick::EMPTY, |at| self.met[at].1)
    }

    /// Returns the nearest and the farthest depth of the four rays around one of the footprint.
    #[inline(always)]
    fn around(&self, i: f32, j: f32) -> (f32, f32) {
        let (x, y) = (self.place(i) as usize, self.place(j) as usize);
        let (right, below) = ((x + 1).min(self.side - 1), (y + 1).min(self.side - 1));
        let at = |x: usize, y: usize| self.depths[y * self.side + x];
        let depths = [at(x, y), at(right, y), at(x, below), at(right, below)];
        let [a, b, c, d] = depths;
        (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)))
    }

    /// Returns an upper bound on the depth of a rectangle of rays of the footprint.
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

/// The traversal of the bricks in the cone.
struct Search<'a> {
    grid: &'a Grid,
    cone: &'a Cone,
    depths: &'a Depths,
}

impl Search<'_> {
    fn touched(&self) -> Vec<TouchedVoxel> {
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

    fn add_block(&self, block: UVec3, touched: &mut Vec<TouchedVoxel>) {
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

    /// Returns whether voxels of a cube of bricks may be in the outline and not behind the whole surface around.
    #[inline(always)]
    fn may_be_seen(&self, first: UVec3, bricks: u32) -> bool {
        let edge = (bricks * BRICK_EDGE_VX) as f32;
        let centre = (first * BRICK_EDGE_VX).as_vec3() + 0.5 * edge;
        // Half the diagonal, plus the distance that a point may be lifted above a face.
        let radius_vx = edge * 0.87 + 1.0;
        let Some((min, max, near)) = self.cone.ball(centre, radius_vx) else { return false };
        let hidden = self.depths.farthest(min, max) + SURELY_HIDDEN_VX * self.cone.per_voxel;
        near <= hidden
    }

    fn add_brick(&self, b: UVec3, touched: &mut Vec<TouchedVoxel>) {
        let corner = (b * BRICK_EDGE_VX).as_vec3();
        let from_eye = corner - self.cone.eye;
        let brick = self.grid.brick(b);
        let open = SIDES.map(|side| brick.and_not(&neighbours(self.grid, b, side)));
        let met = self.depths.met(self.grid.brick_index(b));
        let any = open.iter().fold(met, |any, open| any.or(open));
        let footprint = &self.cone.footprint;
        any.for_each(|local| {
            let v = Vec3::from(local_coords(local).map(|v| v as f32));
            let middle = from_eye + v + 0.5;
            let [i, j, s] = self.cone.project(middle);
            let distance = footprint.outline.distance(i, j);
            // Written so that NaN is outside.
            if !(s > 0.0 && distance <= footprint.radius) {
                return;
            }
            let voxel = (corner + v).as_ivec3();
            let is_set = |brick: &Brick| brick.words[local as usize >> 6] >> (local & 63) & 1 != 0;
            if is_set(&met) || self.is_seen(voxel, middle, open.each_ref().map(is_set)) {
                touched.push(TouchedVoxel { voxel, offset: distance / footprint.radius.max(1.0) });
            }
        });
    }

    /// Returns whether a voxel is seen by one of its open faces; `open` has one flag for each of [`SIDES`]. `middle`:
    /// the centre of the voxel, relative to the eye.
    #[inline(always)]
    fn is_seen(&self, voxel: IVec3, middle: Vec3, open: [bool; 6]) -> bool {
        let least = LEAST_TURN * middle.length();
        let normals = SIDES.map(IVec3::as_vec3);
        let turned = normals.map(|normal| -(middle + 0.5 * normal).dot(normal) > least);
        let mut doubtful = [false; 6];
        for side in (0..6).filter(|side| open[*side] && turned[*side]) {
            match self.by_depth(middle + (0.5 + LIFT_VX) * normals[side]) {
                Some(true) => return true,
                Some(false) => {
                    doubtful[side] = self.by_depth(middle + 0.5 * normals[side]) != Some(false);
                }
                None => doubtful[side] = true,
            }
        }
        let sees = |side: usize, lift_vx: f32| self.sees(middle + (0.5 + lift_vx) * normals[side]);
        let sees_part = |side: usize| {
            let (right, up) = (normals[side].yzx() * PART_VX, normals[side].zxy() * PART_VX);
            let face = middle + 0.5 * normals[side];
            [right + up, right - up, up - right, -right - up]
                .into_iter()
                .any(|p| self.sees(face + p))
        };
        let sees_any = |side| sees(side, LIFT_VX) || sees(side, 0.0) || sees_part(side);
        if (0..6).any(|side| doubtful[side] && sees_any(side)) {
            return true;
        }
        // Steps, whose faces are seen edge-on or from behind, of a surface that is turned to the eye.
        let mut stepped = [false; 6];
        for side in (0..6).filter(|side| open[*side] && !turned[*side]) {
            stepped[side] = self.by_depth(middle + (0.5 + LIFT_VX) * normals[side]) != Some(false);
        }
        stepped != [false; 6]
            && is_turned(self.grid, voxel, middle)
            && (0..6).any(|side| stepped[side] && sees(side, LIFT_VX))
    }

    /// Returns whether a point, given relative to the eye, is seen, as far as the depth map tells.
    #[inline(always)]
    fn by_depth(&self, point: Vec3) -> Option<bool> {
        let [i, j, s] = self.cone.project(point);
        let (nearest, farthest) = self.depths.around(i, j);
        if s <= nearest {
            return Some(true);
        }
        let margin = SURELY_HIDDEN_VX * self.cone.per_voxel + (farthest - nearest);
        (s > farthest + margin).then_some(false)
    }

    /// Returns whether nothing stands before a point, given relative to the eye.
    fn sees(&self, point: Vec3) -> bool {
        // Up to slightly before the point, since a face would occlude itself.
        let hit = raycast::cast(self.grid, self.cone.eye, point);
        hit.is_none_or(|hit| hit.t >= 1.0 - 1e-3 / point.length().max(1.0))
    }
}

/// Returns whether the surface around a voxel, whose centre is given relative to the eye, is turned to the eye. The
/// normal is the mean offset of the empty voxels within [`SURFACE_VX`].
pub(super) fn is_turned(grid: &Grid, voxel: IVec3, middle: Vec3) -> bool {
    let reach = -SURFACE_VX..=SURFACE_VX;
    let mut normal = IVec3::ZERO;
    for z in reach.clone() {
        for y in reach.clone() {
            for x in reach.clone() {
                let offset = IVec3::new(x, y, z);
                if offset.length_squared() <= SURFACE_VX * SURFACE_VX && !grid.get(voxel + offset) {
                    normal += offset;
                }
            }
        }
    }
    let normal = normal.as_vec3();
    -normal.dot(middle) > STEPPED_TURN * normal.length() * middle.length()
}

/// Returns the voxels of the brick `b` whose neighbour on a side exists.
fn neighbours(grid: &Grid, b: UVec3, side: IVec3) -> Brick {
    let at = b.as_ivec3() + side;
    let inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(grid.brick_dims().as_ivec3()).all();
    let own = grid.brick(b).to_rows();
    let other = if inside { grid.brick(at.as_uvec3()).to_rows() } else { [0; 8] };
    const FIRST: u64 = 0x0101_0101_0101_0101;
    const LAST: u64 = FIRST << 7;
    let rows: [u64; 8] =
        std::array::from_fn(|z| match (side.abs().max_position(), side.element_sum() > 0) {
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
