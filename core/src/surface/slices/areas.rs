//! The areas of a slab: groups bricks that need drawing into rectangles.

use glam::{UVec2, UVec3};
use rayon::prelude::*;

use super::exposure::Exposure;

/// Fixed cost of drawing an area, in bricks.
const AREA_COST_BRICKS: u32 = 32;

/// A rectangle of bricks, as thick as the slab, `max` exclusive. Its axes are the two after the slab's axis in cyclic
/// order x, y, z.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SliceArea {
    /// Lowest brick.
    pub min: UVec2,
    /// One past the highest brick.
    pub max: UVec2,
}

/// The areas of one slab.
pub type SlabAreas = Vec<SliceArea>;

/// Returns the brick coordinates from the index of a layer of bricks and coordinates in it.
pub(super) fn brick_of(axis: usize, layer: u32, uv: UVec2) -> UVec3 {
    let mut b = UVec3::ZERO;
    b[axis] = layer;
    b[(axis + 1) % 3] = uv.x;
    b[(axis + 2) % 3] = uv.y;
    b
}

/// Returns the size of a slab across `axis`, in bricks.
pub(super) fn slab_size(axis: usize, brick_dims: UVec3) -> UVec2 {
    UVec2::new(brick_dims[(axis + 1) % 3], brick_dims[(axis + 2) % 3])
}

/// Rebuilds the stale slabs.
pub(super) fn rebuild(
    exposure: &Exposure,
    axis: usize,
    slab_bricks: u32,
    slabs: &mut [SlabAreas],
    stale: &mut [bool],
) {
    slabs.par_iter_mut().zip(stale).enumerate().filter(|(_, (_, stale))| **stale).for_each(
        |(slab, (areas, stale))| {
            *stale = false;
            areas.clear();
            let brick_dims = exposure.brick_dims();
            let first = slab as u32 * slab_bricks;
            let end = (first + slab_bricks).min(brick_dims[axis]);
            let sums = SummedAreaTable::new(slab_size(axis, brick_dims), |uv| {
                (first..end).any(|layer| exposure.get(brick_of(axis, layer, uv)))
            });
            divide(&sums, SliceArea { min: UVec2::ZERO, max: sums.size }, areas);
        },
    );
}

/// A summed-area table (Crow 1984) of the bricks that need drawing, so that any rectangle is counted with four lookups.
struct SummedAreaTable {
    size: UVec2,
    counts: Vec<u32>,
}

impl SummedAreaTable {
    fn new(size: UVec2, needs_drawing: impl Fn(UVec2) -> bool) -> SummedAreaTable {
        let stride = size.x as usize + 1;
        let mut counts = vec![0; stride * (size.y as usize + 1)];
        for y in 0..size.y {
            let mut row = 0;
            for x in 0..size.x {
                row += u32::from(needs_drawing(UVec2::new(x, y)));
                let i = (y as usize + 1) * stride + x as usize + 1;
                counts[i] = counts[i - stride] + row;
            }
        }
        SummedAreaTable { size, counts }
    }

    fn at(&self, x: u32, y: u32) -> u32 {
        self.counts[(y * (self.size.x + 1) + x) as usize]
    }

    fn count(&self, area: SliceArea) -> u32 {
        let SliceArea { min, max } = area;
        self.at(max.x, max.y) + self.at(min.x, min.y)
            - self.at(min.x, max.y)
            - self.at(max.x, min.y)
    }

    /// Returns the smallest rectangle in `area` with the same count, which must not be 0.
    fn trim(&self, mut area: SliceArea, count: u32) -> SliceArea {
        for axis in 0..2 {
            let with = |area: SliceArea, low: u32, high: u32| {
                let mut part = area;
                part.min[axis] = low;
                part.max[axis] = high;
                part
            };
            let (mut low, mut high) = (area.min[axis], area.max[axis]);
            while self.count(with(area, low + 1, high)) == count {
                low += 1;
            }
            while self.count(with(area, low, high - 1)) == count {
                high -= 1;
            }
            area = with(area, low, high);
        }
        area
    }
}

/// Appends the cheapest areas found for the bricks in `area`. Returns their cost in bricks.
fn divide(sums: &SummedAreaTable, area: SliceArea, areas: &mut SlabAreas) -> u32 {
    let count = sums.count(area);
    if count == 0 {
        return 0;
    }
    let area = sums.trim(area, count);
    let bricks = (area.max - area.min).element_product();
    let whole = AREA_COST_BRICKS + bricks;
    // At best, two parts leave out all that need not be drawn.
    if 2 * AREA_COST_BRICKS + count < whole {
        let (axis, at) = best_split(sums, area);
        let (mut low, mut high) = (area, area);
        low.max[axis] = at;
        high.min[axis] = at;
        let before = areas.len();
        let parts = divide(sums, low, areas) + divide(sums, high, areas);
        if parts < whole {
            return parts;
        }
        areas.truncate(before);
    }
    areas.push(area);
    whole
}

/// Returns the best split of a rectangle: at the sharpest edge of its contents, as in Berger and Rigoutsos, "An
/// algorithm for point clustering and grid generation" (1991). That is the strongest change of sign in the second
/// difference of the counts per row or column; if there is none, the middle of the longer axis.
fn best_split(sums: &SummedAreaTable, area: SliceArea) -> (usize, u32) {
    let size = area.max - area.min;
    let longer = usize::from(size.y > size.x);
    let mut best = (longer, area.min[longer] + size[longer] / 2);
    let mut best_strength = 0;
    for axis in [longer, 1 - longer] {
        let line = |i: i32| {
            let mut line = area;
            line.min[axis] = area.min[axis].saturating_add_signed(i);
            line.max[axis] = line.min[axis] + 1;
            sums.count(line) as i32
        };
        let middle = size[axis] as i32 / 2;
        let (mut before, mut here) = (0, line(0));
        let mut bend_before = 0;
        for i in 0..size[axis] as i32 {
            let next = if i + 1 < size[axis] as i32 { line(i + 1) } else { 0 };
            let bend = before - 2 * here + next;
            // Between i - 1 and i. Of equal edges, the one nearest to the middle is used.
            let strength = 2 * (bend - bend_before).abs() + i32::from(i == middle);
            if i > 0 && bend_before.signum() * bend.signum() < 0 && strength > best_strength {
                best_strength = strength;
                best = (axis, area.min[axis] + i as u32);
            }
            (before, here, bend_before) = (here, next, bend);
        }
    }
    best
}
