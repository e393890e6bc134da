//! Finds the empty space hidden close behind the visible surface.
//!
//! From the rays of a footprint and a grid to bits. A wall thinner than the brush would fill only a small part of the
//! brush's neighbourhood, and be smoothed away. Together with the space that it hides it fills half of it, as a thick
//! wall does. Changes nothing; knows no brush.

use fearless_simd::{Level, dispatch};
use glam::{IVec3, UVec3, Vec3};

use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, BrickKind, WORD_EDGE_VX};
use crate::sculpture::{Grid, NO_VOXEL};
use crate::tools::brush::footprint::Footprint;
use crate::tools::brush::kernel::visible::{Cone, direction, map_around};

/// Greatest distance of a ray's own surface behind its first voxel, in voxels.
const STAIR_VX: f32 = 0.9;
/// Greatest number of rays on each side of the central one.
const MOST_RAYS: f32 = 256.0;
/// Greatest distance of rays from the central one, in rays of the footprint.
const MOST_SPREAD: f32 = 1e6;
/// Half the diagonal of a cube, in its edges, with a margin.
const RADIUS_OF_CUBE: f32 = 0.875;
/// Number of rows and columns of rays whose depths are combined.
const WINDOW: usize = 3;
/// Edge of the blocks that are tested before their bricks, in bricks.
const BLOCK: i32 = 4;

/// A depth map of the first surface, over a square around a footprint.
pub struct Hidden {
    cone: Cone,
    eye_vx: Vec3,
    /// Distance between two rays of the footprint at a depth of 1 in voxels, the least and the greatest.
    ray_vx: f32,
    /// Position of the first ray of the map in rays of the footprint, and rays of the map for one of the footprint.
    first: f32,
    per_step: f32,
    side: usize,
    /// The last ray of a row of the map.
    last: f32,
    /// For each ray, the largest entry depth into the first voxels among it and its neighbours to the right and below,
    /// in lengths of the aim; infinite where nothing is hit.
    deepest: Vec<f32>,
    /// The least and the greatest depth of windows of rows and columns, from each ray on.
    bounds: Vec<[f32; 2]>,
    /// The range of distances behind the surface in which space is hidden.
    from: f32,
    to: f32,
}

impl Hidden {
    /// Casts the depth map. `at`: the depth of the centre, in lengths of the aim; `around_vx`: how far the
    /// neighbourhood extends beyond the footprint there; `spacing_vx`: distance between two rays there; `behind_vx`:
    /// depth to which hidden space counts.
    pub fn new(
        footprint: &Footprint,
        cone: Cone,
        grid: &Grid,
        at: f32,
        [around_vx, spacing_vx, behind_vx]: [f32; 3],
    ) -> Hidden {
        let Footprint { eye_vx, across, down, radius, .. } = *footprint;
        let ray_vx = across.length().min(down.length());
        let wanted = (radius + around_vx / (ray_vx * at)).min(MOST_SPREAD);
        let step = (spacing_vx / (ray_vx * at)).max(wanted / MOST_RAYS);
        let reach = (wanted / step).ceil().clamp(1.0, MOST_RAYS);
        let first = -reach * step;
        let map = map_around(footprint, grid, step, reach as u32);
        let view = map.rays;
        let side = view.size.x;
        let depth = |(i, voxel): (usize, &u32)| match *voxel {
            NO_VOXEL => f32::INFINITY,
            voxel => {
                let ray = direction(&view, i as u32 % side, i as u32 / side);
                let low = map.numbering.coords(voxel).as_vec3() - eye_vx;
                (low / ray).min((low + 1.0) / ray).max_element().max(0.0)
            }
        };
        let depths: Vec<f32> = map.voxels.iter().enumerate().map(depth).collect();
        let side = side as usize;
        let deepest = windows(&depths, side, 2).into_iter().map(|[_, deepest]| deepest).collect();
        let bounds = windows(&depths, side, WINDOW);
        let (from, to) = (STAIR_VX * cone.per_voxel, behind_vx * cone.per_voxel);
        Hidden {
            cone,
            eye_vx,
            ray_vx,
            first,
            per_step: step.recip(),
            side,
            last: (side - 1) as f32,
            deepest,
            bounds,
            from,
            to,
        }
    }

    /// Projects a point of the grid to rays to the right and down, and lengths of the aim.
    #[inline(always)]
    pub fn project(&self, at: Vec3) -> [f32; 3] {
        self.cone.project(at - self.eye_vx)
    }

    /// Returns the ray of the map before one of the footprint; the first for NaN.
    #[inline(always)]
    fn place(&self, ray: f32) -> u32 {
        ((ray - self.first) * self.per_step).max(0.0).min(self.last) as u32
    }

    /// Returns the rays of the map around a range of rays of the footprint.
    #[inline(always)]
    fn places(&self, low: f32, high: f32) -> (usize, usize) {
        (self.place(low) as usize, (self.place(high) as usize + 1).min(self.side - 1))
    }

    /// Returns whether a point is hidden close behind the surface. `nearer`: depth behind the surface that does not
    /// count, in lengths of the aim.
    #[cfg(test)]
    pub fn is(&self, at: Vec3, nearer: f32) -> bool {
        let [i, j, s] = self.project(at);
        self.is_behind(self.ray(i, j), s, nearer)
    }

    /// Returns a ray of the map, by its position among those of the footprint.
    #[inline(always)]
    fn ray(&self, i: f32, j: f32) -> u32 {
        self.place(j) * self.side as u32 + self.place(i)
    }

    /// Returns whether a point at a depth on a ray of the map is hidden close behind the surface.
    #[inline(always)]
    fn is_behind(&self, ray: u32, depth: f32, nearer: f32) -> bool {
        let deepest = self.deepest[ray as usize];
        (depth > deepest + self.from + nearer) & (depth < deepest + self.to)
    }

    /// Returns which cubes of voxels of a word, `edge` voxels wide, are hidden, judged by their centres: a bit for the
    /// first voxel of each. `first`: the corner of the word. `nearer`: depth behind the surface that does not count, in
    /// lengths of the aim. `LAYER`: the number of cubes in one layer, which are computed together.
    #[inline(always)]
    fn of_word<const LAYER: usize>(&self, first: Vec3, edge: u32, nearer: f32) -> u64 {
        let across = WORD_EDGE_VX / edge;
        let mut bits = 0;
        for z in 0..across {
            let mut rays = [(0, 0.0); LAYER];
            for (i, ray) in (0..).zip(&mut rays) {
                let at = UVec3::new(i % across, i / across, z).as_vec3();
                let [i, j, s] = self.project(first + (at + 0.5) * edge as f32);
                *ray = (self.ray(i, j), s);
            }
            for (i, (ray, s)) in (0..).zip(rays) {
                let shift = edge * (i % across + WORD_EDGE_VX * (i / across + WORD_EDGE_VX * z));
                bits |= u64::from(self.is_behind(ray, s, nearer)) << shift;
            }
        }
        bits
    }

    /// Returns how much of a cube of voxels may be hidden space.
    #[inline(always)]
    fn share(&self, first: IVec3, edge: i32) -> HiddenShare {
        let radius = edge as f32 * RADIUS_OF_CUBE;
        let [i, j, s] = self.project(first.as_vec3() + 0.5 * edge as f32);
        let spread = radius * self.cone.per_voxel;
        if s <= 2.0 * spread {
            return if s > -spread { HiddenShare::Some } else { HiddenShare::None };
        }
        // Wider than needed, for rays that are not square.
        let rays = 2.0 * radius / (self.ray_vx * s);
        let (low_x, high_x) = self.places(i - rays, i + rays);
        let (low_y, high_y) = self.places(j - rays, j + rays);
        let (mut nearest, mut farthest) = (f32::INFINITY, f32::NEG_INFINITY);
        for y in (low_y..=high_y).step_by(WINDOW) {
            let row =
                &self.bounds[y.min((high_y + 1).saturating_sub(WINDOW)) * self.side..][..self.side];
            for x in (low_x..=high_x).step_by(WINDOW) {
                let [least, most] = row[x.min((high_x + 1).saturating_sub(WINDOW))];
                nearest = if least < nearest { least } else { nearest };
                farthest = if most > farthest { most } else { farthest };
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

    /// Returns the hidden space of a brick, among its empty voxels. `group`: the edge of the cubes of voxels that are
    /// tested together, 1, 2 or 4.
    #[inline(always)]
    pub fn brick(&self, b: IVec3, exist: &Brick, group: u32) -> Brick {
        let (edge, word_edge) = (BRICK_EDGE_VX as i32, WORD_EDGE_VX as i32);
        // The farthest voxel centre of a cube is half the cube's diagonal less half a voxel's away from the cube's
        // centre.
        let nearer = 0.5 * 3f32.sqrt() * (group - 1) as f32 * self.cone.per_voxel;
        let mut hidden = Brick::EMPTY;
        for (word, bits) in (0u32..).zip(&mut hidden.words) {
            let exist = exist.words[word as usize];
            if exist == u64::MAX {
                continue;
            }
            let corner = b * edge + corner_of(word) * word_edge;
            let share = match group {
                WORD_EDGE_VX => HiddenShare::Some,
                _ => self.share(corner, word_edge),
            };
            match share {
                HiddenShare::None => continue,
                HiddenShare::Some => {}
                HiddenShare::All => {
                    *bits = !exist;
                    continue;
                }
            }
            let corner = corner.as_vec3();
            *bits = match group {
                1 => self.of_word::<16>(corner, 1, nearer),
                2 => self.of_word::<4>(corner, 2, nearer) * 0x0033_0033,
                _ => self.of_word::<1>(corner, 4, nearer) * u64::MAX,
            };
        }
        hidden.and_not(exist)
    }

    /// Returns the shares of all bricks from `first` to `end` (exclusive).
    pub fn shares(&self, first: IVec3, end: IVec3) -> HiddenShares<'_> {
        let block = IVec3::splat(BLOCK);
        let first = first.div_euclid(block);
        let size = (end - 1).div_euclid(block) + 1 - first;
        let edge = BLOCK * BRICK_EDGE_VX as i32;
        let of = |i: i32| {
            let at = IVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y);
            self.share((first + at) * edge, edge)
        };
        let blocks = (0..size.max(IVec3::ZERO).element_product()).map(of).collect();
        HiddenShares { hidden: self, first, size, blocks }
    }

    /// Adds the hidden space around a grid to a block of its voxels.
    pub fn fill(&self, block: &mut BitBlock, grid: &Grid) {
        let edge = BRICK_EDGE_VX as i32;
        let (first, size) = (block.origin() / edge, block.size().as_ivec3() / edge);
        let shares = self.shares(first, first + size);
        dispatch!(Level::new(), _simd => shares.fill(block, grid));
    }
}

/// How much of each brick may be hidden space.
pub struct HiddenShares<'a> {
    pub hidden: &'a Hidden,
    /// The first block, in blocks.
    first: IVec3,
    size: IVec3,
    blocks: Vec<HiddenShare>,
}

impl HiddenShares<'_> {
    /// Returns the share of a brick, which must be one of these.
    #[inline(always)]
    pub fn of(&self, b: IVec3) -> HiddenShare {
        let at = (b >> BLOCK.trailing_zeros()) - self.first;
        match self.blocks[(at.x + self.size.x * (at.y + self.size.y * at.z)) as usize] {
            HiddenShare::Some => {
                let edge = BRICK_EDGE_VX as i32;
                self.hidden.share(b * edge, edge)
            }
            share => share,
        }
    }

    /// Adds the hidden space of these bricks to a block that consists of them.
    #[inline(always)]
    fn fill(&self, block: &mut BitBlock, grid: &Grid) {
        let edge = BRICK_EDGE_VX as i32;
        let (first, size) = (block.origin() / edge, block.size().as_ivec3() / edge);
        for i in 0..size.element_product() {
            let b = first + IVec3::new(i % size.x, i / size.x % size.y, i / size.x / size.y);
            let brick = match brick_of(grid, b) {
                None => &Brick::EMPTY,
                Some((BrickKind::Full, _)) => continue,
                Some((_, brick)) => brick,
            };
            match self.of(b) {
                HiddenShare::None => {}
                HiddenShare::All => block.put_brick(b, &Brick::FULL),
                HiddenShare::Some => block.put_brick(b, &self.hidden.brick(b, brick, 1)),
            }
        }
    }
}

/// How much of a cube of voxels may be hidden space, as far as its bounds tell.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HiddenShare {
    None,
    Some,
    /// All empty voxels.
    All,
}

/// Returns the least and the greatest value of `n` rows and columns, from each on, of a square of values.
fn windows(values: &[f32], side: usize, n: usize) -> Vec<[f32; 2]> {
    let mut bounds: Vec<_> = values.iter().map(|v| [*v; 2]).collect();
    for stride in [1, side] {
        let join = |i: usize| {
            let left = side - i / stride % side;
            let some = bounds[i..].iter().step_by(stride).take(n.min(left));
            some.fold([f32::INFINITY, f32::NEG_INFINITY], |[least, most], [low, high]| {
                [least.min(*low), most.max(*high)]
            })
        };
        bounds = (0..bounds.len()).map(join).collect();
    }
    bounds
}

/// Returns the position of a word in its brick, in words.
#[inline(always)]
fn corner_of(word: u32) -> IVec3 {
    UVec3::new(word & 1, word >> 1 & 1, word >> 2).as_ivec3()
}

/// Returns a brick at coordinates that may be outside the grid, and its kind. `None` if it is empty.
#[inline(always)]
pub(crate) fn brick_of(grid: &Grid, b: IVec3) -> Option<(BrickKind, &Brick)> {
    let outside = b.cmplt(IVec3::ZERO).any() || b.cmpge(grid.brick_dims().as_ivec3()).any();
    let index = (!outside).then(|| grid.brick_index(b.as_uvec3()))?;
    let kind = grid.brick_kind(index);
    (kind != BrickKind::Empty).then(|| (kind, grid.brick(b.as_uvec3())))
}
