//! Room that is hidden close behind the visible surface, and how much of a neighbourhood exists with and without it.
//!
//! From the rays of a footprint and a grid to bits and counts. A wall that is thinner than a brush would be no more than a
//! small part of the brush's neighbourhood, and be smoothed away; with what it hides it is half of it, as a thick one is.
//! Changes nothing; knows no brush.

use glam::{IVec3, UVec2, UVec3, Vec3};
use rayon::prelude::*;

use super::footprint::Footprint;
use super::level_field::Cells;
use super::visible::Cone;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::{Grid, NO_VOXEL};
use crate::surface::IndexMap;
use crate::surface::raycast::sample;
use crate::view::PixelRays;

/// How far behind the first voxel of a ray its own surface may be, in voxels.
const STAIR_VX: f32 = 0.9;
/// Layers of voxels that are counted together, about.
const LAYERS: i32 = 32;
/// Most rays on each side of the middle one.
const MOST_RAYS: f32 = 256.0;
/// Farthest rays from the middle one, in rays of the footprint.
const MOST_SPREAD: f32 = 1e6;
/// Least component of a direction.
const LEAST_WAY: Vec3 = Vec3::splat(1e-20);
/// Edge of the smallest cells for which hidden room is not looked at voxel by voxel.
const FINE_CELLS_VX: i32 = 5;
/// How far a voxel may be from the middle of the eight that are looked at together.
const PAIR_VX: f32 = 0.87;
/// Half the diagonal of a brick, in voxels.
const BRICK_RADIUS_VX: f32 = 7.0;

/// The first surface on each ray of a square around a footprint.
pub struct Hidden {
    cone: Cone,
    eye_vx: Vec3,
    /// Voxels between two rays of the footprint at a depth of 1, the fewest and the most.
    ray_vx: f32,
    /// Rays of the footprint before the first of the map, and between two.
    first: f32,
    step: f32,
    side: usize,
    /// Of the entry into the first voxel, in lengths of the aim, row by row; infinite where nothing is.
    depths: Vec<f32>,
    /// How far behind it room is hidden, from and to.
    from: f32,
    to: f32,
}

impl Hidden {
    /// `at`: the depth of the middle, in lengths of the aim; `around_vx`: how far the neighbourhood goes beyond the
    /// footprint there; `spacing_vx`: between two rays there; `behind_vx`: how far hidden room counts.
    pub fn new(
        footprint: &Footprint,
        cone: Cone,
        grid: &Grid,
        at: f32,
        [around_vx, spacing_vx, behind_vx]: [f32; 3],
    ) -> Hidden {
        let Footprint { eye_vx, aim, across, down, radius, .. } = *footprint;
        let ray_vx = across.length().min(down.length());
        let wanted = (radius + around_vx / (ray_vx * at)).min(MOST_SPREAD);
        let step = (spacing_vx / (ray_vx * at)).max(wanted / MOST_RAYS);
        let reach = (wanted / step).ceil().clamp(1.0, MOST_RAYS);
        let first = -reach * step;
        let side = 2 * reach as u32 + 1;
        let mut map = IndexMap::new(PixelRays {
            origin: eye_vx,
            corner: aim + (across + down) * (first - 0.5 * step),
            step_x: across * step,
            step_y: down * step,
            size: UVec2::splat(side),
        });
        let view = map.rays;
        sample(grid, &view, &mut map);
        let depth = |(i, voxel): (usize, &u32)| match *voxel {
            NO_VOXEL => f32::INFINITY,
            voxel => {
                let way = view.direction(i as u32 % side, i as u32 / side);
                let way = Vec3::select(way.abs().cmplt(LEAST_WAY), LEAST_WAY, way);
                let low = grid.voxel_coords(voxel).as_vec3() - eye_vx;
                (low / way).min((low + 1.0) / way).max_element().max(0.0)
            }
        };
        let depths = map.voxels.iter().enumerate().map(depth).collect();
        let (from, to) = (STAIR_VX * cone.per_voxel, behind_vx * cone.per_voxel);
        Hidden { cone, eye_vx, ray_vx, first, step, side: side as usize, depths, from, to }
    }

    /// A place of the grid as rays to the right and down, and lengths of the aim.
    #[inline(always)]
    pub fn project(&self, at: Vec3) -> [f32; 3] {
        self.cone.project(at - self.eye_vx)
    }

    /// The ray of the map before one of the footprint.
    #[inline(always)]
    fn place(&self, ray: f32) -> usize {
        ((ray - self.first) / self.step).clamp(0.0, (self.side - 1) as f32) as usize
    }

    /// Whether room is hidden close behind the surface. `nearer`: how much of what is behind it does not count, in lengths of
    /// the aim.
    #[inline(always)]
    fn is(&self, at: Vec3, nearer: f32) -> bool {
        let [i, j, s] = self.project(at);
        let (x, y) = (self.place(i), self.place(j));
        let (right, below) = ((x + 1).min(self.side - 1), (y + 1).min(self.side - 1));
        let at = |x: usize, y: usize| self.depths[y * self.side + x];
        let deepest = at(x, y).max(at(right, y)).max(at(x, below).max(at(right, below)));
        s > deepest + self.from + nearer && s < deepest + self.to
    }

    /// Whether a brick may have such room.
    fn may_be(&self, first: IVec3) -> bool {
        let [i, j, s] = self.project(first.as_vec3() + 0.5 * BRICK_EDGE_VX as f32);
        let spread = BRICK_RADIUS_VX * self.cone.per_voxel;
        if s <= 2.0 * spread {
            return s > -spread;
        }
        // Wider than it is, for rays that are not square.
        let rays = 2.0 * BRICK_RADIUS_VX / (self.ray_vx * s);
        let (low_x, high_x) = (self.place(i - rays), (self.place(i + rays) + 1).min(self.side - 1));
        let (low_y, high_y) = (self.place(j - rays), (self.place(j + rays) + 1).min(self.side - 1));
        (low_y..=high_y).any(|y| {
            let row = &self.depths[y * self.side..][low_x..=high_x];
            row.iter().any(|d| s + spread > d + self.from && s - spread < d + self.to)
        })
    }

    /// The hidden room among the voxels of a block that do not exist. `fine`: each voxel is looked at by itself, and not
    /// eight together.
    pub fn of(&self, block: &BitBlock, fine: bool) -> BitBlock {
        let edge = BRICK_EDGE_VX as i32;
        let (origin, bricks) = (block.origin(), block.size().as_ivec3() / edge);
        let place = |b: IVec3| (b.x + bricks.x * (b.y + bricks.y * b.z)) as usize;
        let all = 0..bricks.element_product();
        let may_be: Vec<bool> = all
            .map(|i| IVec3::new(i % bricks.x, i / bricks.x % bricks.y, i / bricks.x / bricks.y))
            .map(|b| self.may_be(origin + b * edge) && !is_full(block, b * edge))
            .collect();
        let (side, nearer) = if fine { (1, 0.0) } else { (2, PAIR_VX * self.cone.per_voxel) };
        let mask = (1u64 << side) - 1;
        // Rows that are looked at together follow each other in y and in z.
        let mut looked: Vec<Vec<u64>> = vec![Vec::new(); (bricks.y * edge / side) as usize];
        block.map_rows(|y, z, out| {
            let Some(row) = block.row(y, z) else { return };
            let hidden = &mut looked[(y / side) as usize];
            if y % side == 0 && z % side == 0 {
                hidden.clear();
                hidden.resize(row.len(), 0);
                for x in (0..bricks.x).filter(|x| may_be[place(IVec3::new(*x, y / edge, z / edge))])
                {
                    let (word, shift) = ((x * edge / 64) as usize, (x * edge % 64) as u32);
                    for bit in (0..edge).step_by(side as usize) {
                        if fine && row[word] >> (shift + bit as u32) & 1 != 0 {
                            continue;
                        }
                        let first = origin + IVec3::new(x * edge + bit, y, z);
                        if self.is(first.as_vec3() + 0.5 * side as f32, nearer) {
                            hidden[word] |= mask << (shift + bit as u32);
                        }
                    }
                }
            }
            for ((out, hidden), exist) in out.iter_mut().zip(&*hidden).zip(row) {
                *out = hidden & !exist;
            }
        })
    }
}

/// Whether all voxels of a brick of a block exist. `first`: its first one, counted from the origin.
fn is_full(block: &BitBlock, first: IVec3) -> bool {
    let edge = BRICK_EDGE_VX as i32;
    let (word, shift) = ((first.x / 64) as usize, (first.x % 64) as u32);
    (0..edge * edge).all(|i| {
        let row = block.row(first.y + i % edge, first.z + i / edge);
        row.is_some_and(|row| row[word] >> shift & 0xFF == 0xFF)
    })
}

/// How many voxels of each cell exist, and how many exist or are hidden.
pub fn counts(grid: &Grid, cells: &Cells, hidden: &Hidden) -> (Vec<f64>, Vec<f64>) {
    let UVec3 { x: width, y: height, z: depth } = cells.counted;
    let layer = (width * height) as usize;
    let layers = (LAYERS / cells.edge.z).max(1);
    let fine = cells.edge.min_element() < FINE_CELLS_VX;
    let mut both = vec![[0u32; 2]; layer * depth as usize];
    both.par_chunks_mut((layer * layers as usize).max(1)).enumerate().for_each(|(i, out)| {
        let voxels = cells.voxels();
        let low = voxels.min.with_z(voxels.min.z + i as i32 * layers * cells.edge.z);
        let deep = (out.len() / layer.max(1)) as i32 * cells.edge.z;
        let block = BitBlock::of_grid(grid, low, voxels.max.with_z(low.z + deep));
        let filled = hidden.of(&block, fine).zip(&block, |a, b| a | b);
        let corner = low - block.origin();
        for z in 0..deep {
            for y in 0..height as i32 * cells.edge.y {
                let (at_y, at_z) = (corner.y + y, corner.z + z);
                let (Some(a), Some(b)) = (block.row(at_y, at_z), filled.row(at_y, at_z)) else {
                    continue;
                };
                if b.iter().all(|word| *word == 0) {
                    continue;
                }
                let row = (y / cells.edge.y) as usize * width as usize;
                let row = &mut out[(z / cells.edge.z) as usize * layer + row..][..width as usize];
                for (x, [clay, all]) in (0..).zip(row) {
                    let at = (corner.x + x * cells.edge.x) as usize;
                    *clay += ones(a, at, cells.edge.x as u32);
                    *all += ones(b, at, cells.edge.x as u32);
                }
            }
        }
    });
    both.iter().map(|[clay, all]| (f64::from(*clay), f64::from(*all))).unzip()
}

/// How many of `len` bits (less than 64) from one on are set.
#[inline(always)]
fn ones(row: &[u64], at: usize, len: u32) -> u32 {
    let (word, shift) = (at / 64, at as u32 % 64);
    let mut bits = row[word] >> shift;
    if shift + len > 64 {
        bits |= row.get(word + 1).copied().unwrap_or(0) << (64 - shift);
    }
    (bits & ((1 << len) - 1)).count_ones()
}
