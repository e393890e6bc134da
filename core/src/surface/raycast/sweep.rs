//! Samples a tile: visits the cubes of the grid that are visible in it, front to back, until every pixel has its voxel.
//!
//! Every ray visits the eight children of a cube in an order consistent with an octree's front-to-back traversal from
//! the eye. A brick is therefore cast at once for all pixels that may see it and have no voxel yet, and the first voxel
//! found for a pixel is the first on its ray.

use fearless_simd::{Level, Simd, dispatch, mask32x16, prelude::*, u32x16};
use glam::{IVec3, UVec3};

use super::packet::{LANES, Packet, PacketBox, PacketHit, cast_packet, enter_packet};
use super::projection::{MAX_LEVEL, Projection, TileFrame, TileRect};
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::grid::{BRICK_LEVEL, OctreeBrick, OctreeCube};
use crate::sculpture::{Brick, Grid, NO_VOXEL};
use crate::surface::index_map::PixelRect;
use crate::surface::numbering::{BrickNumbers, VoxelNamer, VoxelNumbering};
use crate::surface::small_bricks::{SmallBricks, full_stand_in, stand_in};
use crate::surface::tiles::{TILE_EDGE_PX, Tile};
use crate::view::PixelRays;

const TILE_PIXELS: usize = (TILE_EDGE_PX * TILE_EDGE_PX) as usize;

/// Size of the stack: up to seven siblings per level, and the eight of the last.
const STACK: usize = 8 * (MAX_LEVEL - BRICK_LEVEL as usize);

/// The data that all tiles of a picture share.
pub(super) struct Sweep<'a> {
    pub grid: &'a Grid,
    pub rays: PixelRays,
    pub projection: Projection,
    /// The bricks that are hit as a whole.
    pub small: SmallBricks,
    /// The vector instructions to use.
    pub level: Level,
}

/// A cube on the stack, with the pixels in which it may be visible.
#[derive(Clone, Copy)]
struct Cube<'a> {
    of: OctreeCube<'a>,
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

    #[inline(always)]
    fn packet_box(&self, low: IVec3, level: u32) -> PacketBox {
        PacketBox::new(low, level, self.grid.dims().as_ivec3(), self.rays.origin)
    }

    /// Returns the child of a cube on the side of the eye of all three middle planes.
    #[inline(always)]
    fn nearest_child(&self, cube: &OctreeCube) -> usize {
        let middle = cube.low + (1 << (cube.level - 1));
        (0..3).fold(0, |child, axis| {
            child | usize::from(self.rays.origin[axis] >= middle[axis] as f32) << axis
        })
    }
}

impl<S: Simd> TileSweep<'_, S> {
    /// Visits the cubes that may be visible in the pixels of `whole`, the nearest first.
    #[inline(always)]
    fn visit_cubes(&mut self, whole: TileRect) {
        let (simd, sweep) = (self.simd, self.sweep);
        let root = Cube { of: OctreeCube::around(sweep.grid), rect: whole };
        let mut stack = [root; STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let Cube { of: cube, rect } = stack[waiting];
            if !self.canvas.any_open(rect) {
                continue;
            }
            if cube.is_full() {
                self.cast_full(cube.low, cube.level, rect);
                continue;
            }
            let level = cube.level as usize - 1;
            let low = cube.low.to_array();
            let (visible, rects) = sweep.projection.children(simd, low, level, &self.frame);
            let occupied = visible & cube.occupied_children();
            let children = Children { occupied, nearest: sweep.nearest_child(&cube), rects };
            if level > BRICK_LEVEL as usize {
                // The nearest is pushed last and so comes first.
                for turn in (0..8).rev() {
                    let child = turn ^ children.nearest;
                    if children.occupied >> child & 1 != 0 {
                        let rect = children.rects[child];
                        stack[waiting] = Cube { of: cube.child(child), rect };
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
    fn cast_bricks(&mut self, cube: &OctreeCube, children: &Children) {
        // Fetched before the first is used, so that their cache misses overlap.
        let mut bricks = [Brick::EMPTY; 8];
        let (mut wanted, mut full) = (0, 0);
        for (child, brick) in bricks.iter_mut().enumerate() {
            let occupied = children.occupied >> child & 1 != 0;
            if occupied && self.canvas.any_open(children.rects[child]) {
                wanted |= 1 << child;
                match cube.brick(child) {
                    OctreeBrick::Full => full |= 1 << child,
                    OctreeBrick::Mixed(mixed) => *brick = *mixed,
                }
            }
        }
        for turn in 0..8 {
            let child = turn ^ children.nearest;
            let (low, rect) = (cube.child_low(child), children.rects[child]);
            if wanted >> child & 1 == 0 {
                continue;
            } else if full >> child & 1 != 0 {
                self.cast_full(low, BRICK_LEVEL, rect);
            } else if self.sweep.small.contains(low >> BRICK_LEVEL) {
                self.cast_small(&bricks[child], low, rect);
            } else {
                self.cast_brick(&bricks[child], low, rect);
            }
        }
    }

    /// Casts a cube without a gap for the open pixels of a rectangle.
    #[inline(always)]
    fn cast_full(&mut self, low: IVec3, level: u32, rect: TileRect) {
        let (dims, eye) = (self.sweep.grid.dims().as_ivec3(), self.sweep.rays.origin);
        let small = self.sweep.small;
        let mut namer = VoxelNamer::new(self.numbering);
        self.enter(low, level, rect, |entered| {
            let voxel = low.as_uvec3() + entered;
            let brick = voxel.as_ivec3() >> BRICK_LEVEL;
            if !small.contains(brick) {
                return namer.number(voxel);
            }
            let low = brick << BRICK_LEVEL;
            namer.number(low.as_uvec3() + full_stand_in(low, dims, eye))
        });
    }

    /// Casts a brick smaller than a pixel for the open pixels of a rectangle.
    #[inline(always)]
    fn cast_small(&mut self, brick: &Brick, low: IVec3, rect: TileRect) {
        let voxel = low.as_uvec3() + stand_in(brick, low, self.sweep.rays.origin);
        let mut namer = VoxelNamer::new(self.numbering);
        self.enter(low, BRICK_LEVEL, rect, |_| namer.number(voxel));
    }

    /// Gives the open pixels of a rectangle that see a cube the numbers of the voxels by which their rays enter it,
    /// relative to its lowest.
    #[inline(always)]
    fn enter(
        &mut self,
        low: IVec3,
        level: u32,
        rect: TileRect,
        mut number: impl FnMut(UVec3) -> u32,
    ) {
        let within = self.sweep.packet_box(low, level);
        let simd = self.simd;
        self.for_packets(
            rect,
            #[inline(always)]
            |packet| {
                let hit = enter_packet(simd, packet, within);
                let [x, y, z] = hit.voxels.map(|axis| axis.to_array());
                let mut numbers = [NO_VOXEL; LANES];
                for_bits(hit.lanes, |lane| {
                    numbers[lane] = number(UVec3::new(x[lane], y[lane], z[lane]));
                });
                (hit.lanes, numbers)
            },
        );
    }

    /// Casts a brick for the open pixels of a rectangle.
    #[inline(always)]
    fn cast_brick(&mut self, brick: &Brick, low: IVec3, rect: TileRect) {
        let within = self.sweep.packet_box(low, BRICK_LEVEL);
        let rows = bytemuck::cast(brick.to_rows());
        let (simd, numbering) = (self.simd, self.numbering);
        let mut numbers = None;
        self.for_packets(
            rect,
            #[inline(always)]
            |packet| {
                let PacketHit { lanes, voxels } = cast_packet(simd, packet, within, &rows);
                if lanes == 0 {
                    return (0, [NO_VOXEL; LANES]);
                }
                // A brick that no pixel shows takes no slot.
                let numbers = numbers
                    .get_or_insert_with(|| numbering.of_brick(low.as_uvec3() / BRICK_EDGE_VX));
                let [x, y, z] = voxels;
                let indices = match *numbers {
                    Some(BrickNumbers { first, row, slice }) => x + y * row + z * slice + first,
                    None => u32x16::splat(simd, NO_VOXEL),
                };
                (lanes, indices.to_array())
            },
        );
    }

    /// Calls `cast` with the open pixels of a rectangle, in packets. It returns which of them are hit, and their numbers.
    #[inline(always)]
    fn for_packets(&mut self, rect: TileRect, mut cast: impl FnMut(Packet) -> (u32, [u32; LANES])) {
        let canvas = &mut *self.canvas;
        let count = canvas.queue_open(self.simd, rect);
        for first in (0..count).step_by(LANES) {
            let mut pixels = [0; LANES];
            pixels.copy_from_slice(&canvas.queue[first..first + LANES]);
            let (rays, frame) = (&self.sweep.rays, &self.frame);
            let count = (count - first).min(LANES);
            let (hit, numbers) = cast(Packet { rays, frame, pixels: &pixels, count });
            for_bits(hit, |lane| {
                let pixel = pixels[lane] as usize & (TILE_PIXELS - 1);
                canvas.voxels[pixel] = numbers[lane];
                canvas.open[pixel >> 6] &= !(1 << (pixel & 63));
            });
        }
    }
}

/// Calls `f` with the lanes of the set bits.
#[inline(always)]
fn for_bits(mut bits: u32, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize & (LANES - 1));
        bits &= bits - 1;
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
