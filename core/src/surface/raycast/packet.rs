//! Traces sixteen rays at once through a brick or a full cube.
//!
//! Takes the pixels of the rays and a box of voxels, returns the voxels by which they enter it, or the first existing
//! voxel of a brick on each ray. Orders crossings as `ray` defines, by the same arithmetic.

use fearless_simd::{Level, Simd, f32x16, mask32x16, prelude::*, u8x16, u8x64, u32x16};
use glam::{IVec3, Vec3};

use super::projection::TileFrame;
use super::ray::STANDSTILL;
use crate::sculpture::grid::BRICK_LEVEL;
use crate::sculpture::vectors::for_axes;
use crate::view::PixelRays;

/// Rays in a packet.
pub(super) const LANES: usize = 16;

/// Packed voxels of a brick have ten bits per coordinate, x the lowest.
const FIELD: u32 = 10;
/// Bits that are set once a coordinate leaves 0..8 on either side. A ray never comes back, and all rays of a packet
/// have left long before a coordinate could overflow its ten bits.
const GUARD: u32 = 0x3F8 | 0x3F8 << FIELD | 0x3F8 << (2 * FIELD);

/// A box of voxels, prepared for packets.
#[derive(Clone, Copy)]
pub(super) struct PacketBox {
    /// Lower and upper planes, relative to the eye.
    low: Vec3,
    high: Vec3,
    /// The lowest voxel, and one past the highest.
    corner: Vec3,
    end: Vec3,
    /// The logarithm of its longest edge, rounded up.
    level: u32,
}

impl PacketBox {
    /// Returns the part below `dims` of a cube of `2^level` voxels an edge.
    #[inline(always)]
    pub fn new(corner: IVec3, level: u32, dims: IVec3, eye: Vec3) -> PacketBox {
        let end = (corner + (1 << level)).min(dims).as_vec3();
        let corner = corner.as_vec3();
        PacketBox { low: corner - eye, high: end - eye, corner, end, level }
    }
}

/// The hits of sixteen rays: a mask of the rays that hit, and the voxels in the brick.
pub(super) struct PacketHit<S: Simd> {
    pub lanes: u32,
    pub voxels: [u32x16<S>; 3],
}

/// The rays of a packet.
struct PacketRays<S: Simd> {
    simd: S,
    eye: Vec3,
    /// The reciprocal of the direction on each axis.
    inverse: [f32x16<S>; 3],
}

/// The entry of rays into a box.
struct BoxEntry<S: Simd> {
    /// The planes of each axis that are crossed before these times come before the entry.
    before: [f32x16<S>; 3],
    /// The rays that pass through the box.
    passes: mask32x16<S>,
}

/// The voxels in which rays enter a box.
struct Entered<S: Simd> {
    /// In the box.
    voxel: [u32x16<S>; 3],
    /// The last plane crossed on each axis.
    plane: [f32x16<S>; 3],
    /// The rays that run backwards along each axis, and the step from plane to plane along the rays.
    backward: [mask32x16<S>; 3],
    step: [f32x16<S>; 3],
}

/// The rays of the first `count` of sixteen pixels (`x | y << 6` in the tile).
#[derive(Clone, Copy)]
pub(super) struct Packet<'a> {
    pub rays: &'a PixelRays,
    pub frame: &'a TileFrame,
    pub pixels: &'a [u32; LANES],
    pub count: usize,
}

/// Returns the voxels in which rays enter a box.
#[inline(always)]
pub(super) fn enter_packet<S: Simd>(simd: S, packet: Packet, within: PacketBox) -> PacketHit<S> {
    let (rays, entry, active) = pass(simd, packet, within);
    match active.any_true() {
        false => PacketHit::none(simd),
        true => {
            let voxels = rays.enter(within, &entry, within.level).voxel;
            PacketHit { lanes: active.to_bitmask() as u32, voxels }
        }
    }
}

/// Returns the first existing voxels of a brick, by its rows ([`crate::sculpture::Brick::to_rows`]), on rays.
#[inline(always)]
pub(super) fn cast_packet<S: Simd>(
    simd: S,
    packet: Packet,
    within: PacketBox,
    rows: &[u8; 64],
) -> PacketHit<S> {
    let (rays, entry, active) = pass(simd, packet, within);
    match active.any_true() {
        false => PacketHit::none(simd),
        true => rays.walk(rows, rays.enter(within, &entry, BRICK_LEVEL), active),
    }
}

/// Returns the rays of a packet, their entry into a box, and which of them pass through it.
#[inline(always)]
fn pass<S: Simd>(
    simd: S,
    Packet { rays, frame, pixels, count }: Packet,
    within: PacketBox,
) -> (PacketRays<S>, BoxEntry<S>, mask32x16<S>) {
    let rays = PacketRays::new(simd, rays, frame, u32x16::load_array_ref(simd, pixels));
    let entry = rays.entry(within);
    let active = entry.passes & mask32x16::from_bitmask(simd, (1 << count) - 1);
    (rays, entry, active)
}

impl<S: Simd> PacketHit<S> {
    #[inline(always)]
    fn none(simd: S) -> PacketHit<S> {
        PacketHit { lanes: 0, voxels: [u32x16::splat(simd, 0); 3] }
    }
}

impl<S: Simd> PacketRays<S> {
    #[inline(always)]
    fn new(simd: S, rays: &PixelRays, frame: &TileFrame, pixels: u32x16<S>) -> PacketRays<S> {
        let splat = |v: f32| f32x16::splat(simd, v);
        let x = (pixels & 63).to_float::<f32x16<S>>() + (frame.left + 0.5);
        let y = (pixels >> 6).to_float::<f32x16<S>>() + (frame.top + 0.5);
        let inverse = for_axes(
            #[inline(always)]
            |axis| {
                // As in PixelRays::direction_at and Ray::new.
                let direction =
                    splat(rays.corner[axis]) + x * rays.step_x[axis] + y * rays.step_y[axis];
                let standing = direction.abs().simd_lt(STANDSTILL);
                splat(1.0) / standing.select(splat(STANDSTILL), direction)
            },
        );
        PacketRays { simd, eye: rays.origin, inverse }
    }

    #[inline(always)]
    fn entry(&self, within: PacketBox) -> BoxEntry<S> {
        let inverse = &self.inverse;
        // The times at which the rays enter and leave the box's slab of each axis.
        let [(near_x, far_x), (near_y, far_y), (near_z, far_z)] = for_axes(
            #[inline(always)]
            |axis| {
                let (a, b) = (inverse[axis] * within.low[axis], inverse[axis] * within.high[axis]);
                (a.min(b), a.max(b))
            },
        );
        let entry = near_x.max(near_y).max(near_z.max(0.0));
        // A crossing comes before the entry if its time is less. At equal times it does so only if its axis comes
        // before that of the entry, or if it is at the start.
        let after: f32x16<S> = (entry.bitcast::<u32x16<S>>() + 1).bitcast();
        let start = entry.simd_le(0.0);
        let by_z = start | entry.simd_eq(near_z);
        let by_y = by_z | entry.simd_eq(near_y);
        let before =
            [by_y.select(after, entry), by_z.select(after, entry), start.select(after, entry)];
        let passes = far_x.simd_ge(before[0]) & far_y.simd_ge(before[1]) & far_z.simd_ge(before[2]);
        BoxEntry { before, passes }
    }

    /// Returns the voxels entered: on each axis, advanced by the number of planes crossed before the entry, which are less
    /// than `2^level`.
    #[inline(always)]
    fn enter(&self, within: PacketBox, entry: &BoxEntry<S>, level: u32) -> Entered<S> {
        let splat = |v: f32| f32x16::splat(self.simd, v);
        let (eye, inverse) = (self.eye, &self.inverse);
        let backward = for_axes(
            #[inline(always)]
            |axis| inverse[axis].simd_lt(0.0),
        );
        let step = for_axes(
            #[inline(always)]
            |axis| backward[axis].select(splat(-1.0), splat(1.0)),
        );
        let plane = for_axes(
            #[inline(always)]
            |axis| {
                let (low, high) = (within.corner[axis], within.end[axis]);
                let mut plane = backward[axis].select(splat(high), splat(low));
                for half in (0..level).rev() {
                    let next = plane + step[axis] * (1 << half) as f32;
                    let t = (next - eye[axis]) * inverse[axis];
                    plane = t.simd_lt(entry.before[axis]).select(next, plane);
                }
                plane
            },
        );
        let voxel = for_axes(
            #[inline(always)]
            |axis| {
                let back = backward[axis].select(splat(1.0), splat(0.0));
                (plane[axis] - back - within.corner[axis]).to_int::<u32x16<S>>()
            },
        );
        Entered { voxel, plane, backward, step }
    }

    /// Walks voxel by voxel to the first existing one, or out of the brick.
    #[inline(always)]
    fn walk(&self, rows: &[u8; 64], entered: Entered<S>, mut active: mask32x16<S>) -> PacketHit<S> {
        let (simd, eye, inverse) = (self.simd, self.eye, &self.inverse);
        let Entered { voxel, plane, backward, step } = entered;
        let mut voxel = voxel[0] | voxel[1] << FIELD | voxel[2] << (2 * FIELD);
        let units = for_axes(
            #[inline(always)]
            |axis| {
                let one = u32x16::splat(simd, 1 << (FIELD * axis as u32));
                backward[axis].select(u32x16::splat(simd, 0) - one, one)
            },
        );
        let mut plane = for_axes(
            #[inline(always)]
            |axis| plane[axis] + step[axis],
        );
        let zero = f32x16::splat(simd, 0.0);
        let mut hit = mask32x16::splat(simd, false);
        let mut found = voxel;
        loop {
            let t = for_axes(
                #[inline(always)]
                |axis| (plane[axis] - eye[axis]) * inverse[axis],
            );
            let row = (voxel >> FIELD & 7) | (voxel >> (2 * FIELD - 3) & 0x38);
            let bits = look_up(simd, rows, row) >> (voxel & 7);
            let exists = active & (bits & 1).simd_ne(0);
            found = exists.select(voxel, found);
            hit |= exists;
            // Finished rays advance, too: that saves a select.
            let y_first = t[1].simd_le(t[2]);
            let x_first = t[0].simd_le(t[1].min(t[2]));
            voxel += x_first.select(units[0], y_first.select(units[1], units[2]));
            active &= !exists & (voxel & GUARD).simd_eq(0);
            if !active.any_true() {
                break;
            }
            plane[0] += x_first.select(step[0], zero);
            plane[1] += y_first.select(x_first.select(zero, step[1]), zero);
            plane[2] += y_first.select(zero, x_first.select(zero, step[2]));
        }
        let voxels = [found & 7, found >> FIELD & 7, found >> (2 * FIELD) & 7];
        PacketHit { lanes: hit.to_bitmask() as u32, voxels }
    }
}

/// Returns the bytes of a table at the given indices (0..64); only the lowest byte of a result counts.
#[inline(always)]
fn look_up<S: Simd>(simd: S, table: &[u8; 64], index: u32x16<S>) -> u32x16<S> {
    #[cfg(target_arch = "x86_64")]
    if let Level::Avx512(_) = simd.level() {
        let bytes: u8x64<S> = index.bitcast();
        return u8x64::load_array_ref(simd, table).swizzle_dyn(bytes).bitcast();
    }
    #[cfg(target_arch = "x86_64")]
    if let Level::Avx2(_) = simd.level() {
        // Looks up each quarter of the table at once, then selects among the quarters.
        let bytes: u8x64<S> = (index & 15).bitcast();
        let odd = (index & 16).simd_ne(0);
        let low = odd.select(look_up_in(simd, table, 1, bytes), look_up_in(simd, table, 0, bytes));
        let high = odd.select(look_up_in(simd, table, 3, bytes), look_up_in(simd, table, 2, bytes));
        return (index & 32).simd_ne(0).select(high, low);
    }
    let index = index.to_array();
    u32x16::from_fn(simd, |lane| u32::from(table[(index[lane] & 63) as usize]))
}

/// Returns the bytes of a quarter of a table at the given indices (0..16).
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn look_up_in<S: Simd>(simd: S, table: &[u8; 64], quarter: usize, index: u8x64<S>) -> u32x16<S> {
    let quarter: &[u8; 16] = table.as_chunks().0.get(quarter).unwrap_or(&[0; 16]);
    let quarter = u8x64::block_splat(u8x16::load_array_ref(simd, quarter));
    quarter.swizzle_dyn_within_blocks(index).bitcast()
}
