//! Samples a tile: visits the cubes of the grid that are visible in it, front to back, until every pixel has its voxel.
//!
//! Every ray visits the eight children of a cube in an order consistent with an octree's front-to-back traversal from
//! the eye. A brick is therefore cast at once for all pixels that may see it and have no voxel yet, and the first voxel
//! found for a pixel is the first on its ray.

use fearless_simd::{Level, Simd, dispatch, mask32x16, prelude::*, u32x16};
use glam::{IVec3, UVec3};

use super::packet::{LANES, PacketBrick, cast_packet};
use super::projection::{MAX_LEVEL, Projection, TileFrame, TileRect};
use crate::sculpture::{Brick, Grid, NO_VOXEL};
use crate::surface::index_map::PixelRect;
use crate::surface::numbering::{BrickNumbers, VoxelNumbering};
use crate::surface::tiles::{TILE_EDGE_PX, Tile};
use crate::view::PixelRays;

const TILE_PIXELS: usize = (TILE_EDGE_PX * TILE_EDGE_PX) as usize;

/// Logarithms of the edges of a brick and of a block of 4^3 bricks.
const BRICK: usize = 3;
const BLOCK: usize = 5;

/// Size of the stack: up to seven siblings per level, and the eight of the last.
const STACK: usize = 8 * (MAX_LEVEL - BRICK);

/// The data that all tiles of a picture share.
pub(super) struct Sweep<'a> {
    pub grid: &'a Grid,
    pub rays: PixelRays,
    pub projection: Projection,
    /// The vector instructions to use.
    pub level: Level,
}

/// A cube on the stack, with the pixels in which it may be visible.
#[derive(Clone, Copy, Default)]
struct Cube {
    low: [i32; 3],
    level: u8,
    rect: TileRect,
}

/// The pixels of a tile.
struct Canvas {
    /// A bit for each pixel that has no voxel yet, a word per row.
    open: [u64; TILE_EDGE_PX as usize],
    voxels: [u32; TILE_PIXELS],
    /// The open pixels of a rectangle, padded to whole packets.
    queue: [u32; TILE_PIXELS + LANES],
}

/// The visible children of a cube and their rectangles.
struct Children {
    /// The non-empty ones: a bit each.
    occupied: u32,
    /// The one to visit first: the others follow in the order of `turn ^ nearest`.
    nearest: usize,
    rects: [TileRect; 8],
}

/// A tile that is being sampled.
struct TileSweep<'a, S: Simd> {
    simd: S,
    sweep: &'a Sweep<'a>,
    numbering: &'a VoxelNumbering,
    frame: TileFrame,
    canvas: &'a mut Canvas,
}

impl Sweep<'_> {
    /// Samples a tile.
    pub fn run(&self, tile: Tile, numbering: &VoxelNumbering) {
        dispatch!(self.level, simd => self.run_with(simd, tile, numbering));
    }

    #[inline(always)]
    fn run_with<S: Simd>(&self, simd: S, mut tile: Tile, numbering: &VoxelNumbering) {
        let PixelRect { min, max } = tile.rect;
        let size = max - min;
        let frame = TileFrame {
            left: min.x as f32,
            top: min.y as f32,
            width: size.x as f32,
            height: size.y as f32,
        };
        let mut canvas = Canvas {
            open: [0; TILE_EDGE_PX as usize],
            voxels: [NO_VOXEL; TILE_PIXELS],
            queue: [0; TILE_PIXELS + LANES],
        };
        canvas.open[..size.y as usize].fill(u64::MAX >> (TILE_EDGE_PX - size.x));

        let whole = TileRect { x0: 0, x1: size.x - 1, y0: 0, y1: size.y - 1 };
        TileSweep { simd, sweep: self, numbering, frame, canvas: &mut canvas }.visit_cubes(whole);
        for y in 0..size.y {
            let from = (y * TILE_EDGE_PX) as usize;
            tile.row(y).copy_from_slice(&canvas.voxels[from..from + size.x as usize]);
        }
    }

    /// Returns the non-empty children of a cube; if they are larger than an occupancy word, all children inside the
    /// grid.
    #[inline(always)]
    fn occupied_children(&self, cube: &Cube) -> u32 {
        let grid = self.grid;
        let level = cube.level as usize;
        let low = cube.low;
        if level > BLOCK {
            let dims = grid.dims().as_ivec3();
            let half = 1 << (level - 1);
            return (0..8).fold(0, |mask, child| {
                let at: [i32; 3] =
                    std::array::from_fn(|axis| low[axis] + (child >> axis & 1) * half);
                let inside = at[0] < dims.x && at[1] < dims.y && at[2] < dims.z;
                let occupied = inside
                    && (level - 1 > BLOCK || {
                        let brick = IVec3::from(at).as_uvec3() / 8;
                        grid.occupancy_around(brick).0 != 0
                    });
                mask | u32::from(occupied) << child
            });
        }
        let (bricks, bit) = grid.occupancy_around(IVec3::from(low).as_uvec3() / 8);
        if level == BLOCK {
            // Eighths of 2^3 bricks.
            const EIGHTH: u64 = 0x0033_0033;
            (0..8).fold(0, |mask, child| {
                let shift = (child & 1) * 2 + (child >> 1 & 1) * 8 + (child >> 2) * 32;
                mask | u32::from(bricks >> shift & EIGHTH != 0) << child
            })
        } else {
            let eight = (bricks >> bit) as u32;
            eight & 3 | (eight >> 4 & 3) << 2 | (eight >> 16 & 3) << 4 | (eight >> 20 & 3) << 6
        }
    }

    /// Returns the child of a cube on the side of the eye of all three middle planes.
    #[inline(always)]
    fn nearest_child(&self, cube: &Cube) -> usize {
        let half = 1 << (cube.level - 1);
        (0..3).fold(0, |child, axis| {
            let beyond = self.rays.origin[axis] >= (cube.low[axis] + half) as f32;
            child | usize::from(beyond) << axis
        })
    }
}

impl<S: Simd> TileSweep<'_, S> {
    /// Visits the cubes that may be visible in the pixels of `whole`, the nearest first.
    #[inline(always)]
    fn visit_cubes(&mut self, whole: TileRect) {
        let (simd, sweep) = (self.simd, self.sweep);
        let longest = sweep.grid.dims().max_element();
        let root_level = (longest.next_power_of_two().ilog2() as u8).max(BLOCK as u8);
        let mut stack = [Cube::default(); STACK];
        stack[0] = Cube { low: [0; 3], level: root_level, rect: whole };
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let cube = stack[waiting];
            if !self.canvas.any_open(cube.rect) {
                continue;
            }
            let level = cube.level as usize - 1;
            let (visible, rects) = sweep.projection.children(simd, cube.low, level, &self.frame);
            let occupied = visible & sweep.occupied_children(&cube);
            let children = Children { occupied, nearest: sweep.nearest_child(&cube), rects };
            let child_low = |child: usize| -> [i32; 3] {
                std::array::from_fn(|axis| cube.low[axis] + ((child as i32 >> axis & 1) << level))
            };
            if level > BRICK {
                // The nearest is pushed last and so comes first.
                for turn in (0..8).rev() {
                    let child = turn ^ children.nearest;
                    if children.occupied >> child & 1 != 0 {
                        let rect = children.rects[child];
                        stack[waiting] = Cube { low: child_low(child), level: level as u8, rect };
                        waiting += 1;
                    }
                }
            } else {
                self.cast_bricks(&cube, &children);
            }
        }
    }

    /// Casts the occupied bricks of a cube of 2^3.
    #[inline(always)]
    fn cast_bricks(&mut self, cube: &Cube, children: &Children) {
        let grid = self.sweep.grid;
        let corners: [UVec3; 8] = std::array::from_fn(|child| {
            let child = child as i32;
            let at = IVec3::new(child & 1, child >> 1 & 1, child >> 2) * 8;
            (IVec3::from(cube.low) + at).as_uvec3()
        });
        // Fetched before the first is used, so that their cache misses overlap.
        let mut bricks = [Brick::EMPTY; 8];
        let mut wanted = 0;
        for child in 0..8 {
            let occupied = children.occupied >> child & 1 != 0;
            if occupied && self.canvas.any_open(children.rects[child]) {
                bricks[child] = *grid.brick(corners[child] / 8);
                wanted |= 1 << child;
            }
        }
        for turn in 0..8 {
            let child = turn ^ children.nearest;
            if wanted >> child & 1 != 0 {
                self.cast_brick(&bricks[child], corners[child], children.rects[child]);
            }
        }
    }

    /// Casts a brick for the open pixels of a rectangle.
    #[inline(always)]
    fn cast_brick(&mut self, brick: &Brick, corner: UVec3, rect: TileRect) {
        let (rays, numbering) = (&self.sweep.rays, self.numbering);
        let canvas = &mut *self.canvas;
        let count = canvas.queue_open(self.simd, rect);
        let brick = PacketBrick::new(brick, corner.as_ivec3(), rays.origin);
        let mut numbers = None;
        for first in (0..count).step_by(LANES) {
            let mut pixels = [0; LANES];
            pixels.copy_from_slice(&canvas.queue[first..first + LANES]);
            let lanes = (count - first).min(LANES);
            let hit = cast_packet(self.simd, rays, &self.frame, &brick, &pixels, lanes);
            let mut rest = hit.lanes;
            if rest == 0 {
                continue;
            }
            // A brick that no pixel shows takes no slot.
            let numbers = numbers.get_or_insert_with(|| numbering.of_brick(corner / 8));
            let [x, y, z] = hit.voxels;
            let indices = match *numbers {
                Some(BrickNumbers { first, row, slice }) => x + y * row + z * slice + first,
                None => u32x16::splat(self.simd, NO_VOXEL),
            };
            let indices = indices.to_array();
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize & (LANES - 1);
                rest &= rest - 1;
                let pixel = pixels[lane] as usize & (TILE_PIXELS - 1);
                canvas.voxels[pixel] = indices[lane];
                canvas.open[pixel >> 6] &= !(1 << (pixel & 63));
            }
        }
    }
}

impl Canvas {
    #[inline(always)]
    fn columns(rect: TileRect) -> u64 {
        u64::MAX >> (TILE_EDGE_PX - 1 - (rect.x1 - rect.x0)) << rect.x0
    }

    #[inline(always)]
    fn any_open(&self, rect: TileRect) -> bool {
        let columns = Self::columns(rect);
        self.open[rect.y0 as usize..=rect.y1 as usize].iter().any(|row| row & columns != 0)
    }

    /// Queues the open pixels of a rectangle. Returns their number.
    #[inline(always)]
    fn queue_open<S: Simd>(&mut self, simd: S, rect: TileRect) -> usize {
        let columns = Self::columns(rect);
        let in_turn = u32x16::load_array(simd, std::array::from_fn(|lane| lane as u32));
        let mut count = 0;
        for y in rect.y0..=rect.y1 {
            let mut row = (self.open[y as usize & 63] & columns) >> rect.x0;
            let mut first = y << 6 | rect.x0;
            while row != 0 {
                let open = mask32x16::from_bitmask(simd, row & 0xFFFF);
                let pixels = (in_turn + first).compress(open);
                pixels.store_slice(&mut self.queue[count..count + LANES]);
                count += (row & 0xFFFF).count_ones() as usize;
                row >>= LANES;
                first += LANES as u32;
            }
        }
        count
    }
}
