//! Room that is hidden close behind the visible surface.
//!
//! From the rays of a footprint and a grid to bits. A wall that is thinner than a brush would be no more than a
//! small part of the brush's neighbourhood, and be smoothed away; with what it hides it is half of it, as a thick one is.
//! Changes nothing; knows no brush.

use glam::{IVec3, UVec2, UVec3, Vec3};

use super::footprint::Footprint;
use super::visible::Cone;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, BrickKind, WORD_EDGE_VX};
use crate::sculpture::{Grid, NO_VOXEL};
use crate::surface::IndexMap;
use crate::surface::raycast::sample;
use crate::view::PixelRays;

/// How far behind the first voxel of a ray its own surface may be, in voxels.
const STAIR_VX: f32 = 0.9;
/// Most rays on each side of the middle one.
const MOST_RAYS: f32 = 256.0;
/// Farthest rays from the middle one, in rays of the footprint.
const MOST_SPREAD: f32 = 1e6;
/// Least component of a direction.
const LEAST_WAY: Vec3 = Vec3::splat(1e-20);
/// Half the diagonal of a cube, in its edges, with some room.
const RADIUS_OF_CUBE: f32 = 0.875;
/// Edge of the blocks that are looked at before their bricks, in bricks.
const BLOCK: i32 = 4;

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
    pub fn is(&self, at: Vec3, nearer: f32) -> bool {
        let [i, j, s] = self.project(at);
        let (x, y) = (self.place(i), self.place(j));
        let (right, below) = ((x + 1).min(self.side - 1), (y + 1).min(self.side - 1));
        let at = |x: usize, y: usize| self.depths[y * self.side + x];
        let deepest = at(x, y).max(at(right, y)).max(at(x, below).max(at(right, below)));
        s > deepest + self.from + nearer && s < deepest + self.to
    }

    /// How much of a cube of voxels may be such room.
    #[inline(always)]
    fn share(&self, first: IVec3, edge: i32) -> HiddenShare {
        let radius = edge as f32 * RADIUS_OF_CUBE;
        let [i, j, s] = self.project(first.as_vec3() + 0.5 * edge as f32);
        let spread = radius * self.cone.per_voxel;
        if s <= 2.0 * spread {
            return if s > -spread { HiddenShare::Some } else { HiddenShare::None };
        }
        // Wider than it is, for rays that are not square.
        let rays = 2.0 * radius / (self.ray_vx * s);
        let (low_x, high_x) = (self.place(i - rays), (self.place(i + rays) + 1).min(self.side - 1));
        let (low_y, high_y) = (self.place(j - rays), (self.place(j + rays) + 1).min(self.side - 1));
        let (mut nearest, mut farthest) = (f32::INFINITY, f32::NEG_INFINITY);
        for y in low_y..=high_y {
            for d in &self.depths[y * self.side..][low_x..=high_x] {
                nearest = nearest.min(*d);
                farthest = farthest.max(*d);
            }
        }
        let (near, far) = (s - spread, s + spread);
        if far <= nearest + self.from || near >= farthest + self.to {
            HiddenShare::None
        } else if near > farthest + self.from && far < nearest + self.to {
            HiddenShare::All
        } else {
            HiddenShare::Some
        }
    }

    /// The hidden room of a brick, among its voxels that do not exist. `group`: the edge of the cubes of voxels that are
    /// looked at together, 1, 2 or 4.
    #[inline(always)]
    pub fn brick(&self, b: IVec3, exist: &Brick, group: u32) -> Brick {
        let first = (b * BRICK_EDGE_VX as i32).as_vec3();
        // The farthest voxel of a cube is half its diagonal less half a voxel's away from its middle.
        let nearer = 0.5 * 3f32.sqrt() * (group - 1) as f32 * self.cone.per_voxel;
        // The first voxels of the cubes in a word, and the voxels of the first.
        let (starts, one): (u64, u64) = match group {
            1 => (u64::MAX, 1),
            2 => (0x0505_0000_0505, 0x0033_0033),
            _ => (1, u64::MAX),
        };
        let mut hidden = Brick::EMPTY;
        for (word, bits) in (0u32..).zip(&mut hidden.words) {
            let corner = first + corner_of(word) * WORD_EDGE_VX as f32;
            let mut left = starts;
            while left != 0 {
                let shift = left.trailing_zeros();
                left &= left - 1;
                if exist.words[word as usize] >> shift & one == one {
                    continue;
                }
                let at = UVec3::new(shift & 3, shift >> 2 & 3, shift >> 4).as_vec3();
                if self.is(corner + at + 0.5 * group as f32, nearer) {
                    *bits |= one << shift;
                }
            }
        }
        hidden.and_not(exist)
    }

    /// The shares of all bricks from `first` to `end` (exclusive).
    pub fn shares(&self, first: IVec3, end: IVec3) -> Shares<'_> {
        let block = IVec3::splat(BLOCK);
        let first = first.div_euclid(block);
        let size = (end - 1).div_euclid(block) + 1 - first;
        let edge = BLOCK * BRICK_EDGE_VX as i32;
        let of = |i: i32| {
            let at = IVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y);
            self.share((first + at) * edge, edge)
        };
        let blocks = (0..size.max(IVec3::ZERO).element_product()).map(of).collect();
        Shares { hidden: self, first, size, blocks }
    }

    /// Adds the hidden room around a grid to a block of its voxels.
    pub fn fill(&self, block: &mut BitBlock, grid: &Grid) {
        let edge = BRICK_EDGE_VX as i32;
        let (first, size) = (block.origin() / edge, block.size().as_ivec3() / edge);
        let shares = self.shares(first, first + size);
        for i in 0..size.element_product() {
            let b = first + IVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y);
            let brick = match brick_of(grid, b) {
                None => &Brick::EMPTY,
                Some((BrickKind::Full, _)) => continue,
                Some((_, brick)) => brick,
            };
            match shares.of(b) {
                HiddenShare::None => {}
                HiddenShare::All => block.put_brick(b, &Brick::FULL),
                HiddenShare::Some => block.put_brick(b, &self.brick(b, brick, 1)),
            }
        }
    }
}

/// How much of each brick may be hidden room.
pub struct Shares<'a> {
    pub hidden: &'a Hidden,
    /// In blocks.
    first: IVec3,
    size: IVec3,
    blocks: Vec<HiddenShare>,
}

impl Shares<'_> {
    /// Of a brick, which must be one of these.
    #[inline(always)]
    pub fn of(&self, b: IVec3) -> HiddenShare {
        let at = b.div_euclid(IVec3::splat(BLOCK)) - self.first;
        match self.blocks[(at.x + self.size.x * (at.y + self.size.y * at.z)) as usize] {
            HiddenShare::Some => {
                let edge = BRICK_EDGE_VX as i32;
                self.hidden.share(b * edge, edge)
            }
            share => share,
        }
    }
}

/// How much of a cube of voxels may be hidden room, as far as its bounds tell.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HiddenShare {
    None,
    Some,
    /// All that does not exist.
    All,
}

/// The place of a word in its brick, in words.
#[inline(always)]
fn corner_of(word: u32) -> Vec3 {
    UVec3::new(word & 1, word >> 1 & 1, word >> 2).as_vec3()
}

/// A brick at coordinates that may be outside the grid, and its kind. None if nothing exists in it.
#[inline(always)]
pub fn brick_of(grid: &Grid, b: IVec3) -> Option<(BrickKind, &Brick)> {
    let outside = b.cmplt(IVec3::ZERO).any() || b.cmpge(grid.brick_dims().as_ivec3()).any();
    let index = (!outside).then(|| grid.brick_index(b.as_uvec3()))?;
    let kind = grid.brick_kind(index);
    (kind != BrickKind::Empty).then(|| (kind, grid.brick(b.as_uvec3())))
}
