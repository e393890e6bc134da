//! Overhangs: voxels with no voxel below them whose surface leans too far out from the vertical.
//!
//! The slope is that of the smooth normal ([`NormalField`]), which is rounded at edges; so ledges that are wider than
//! the angle allows need support, too. In plates of a single layer, whose normal belongs to neither side, a voxel needs
//! support unless one of the nine voxels below it exists. Two kinds of voxels need none: those in the lowest layer,
//! which lie on the bed, and those of a bridge, which are connected along x or z, without a gap, to voxels that rest on
//! others at both ends. Takes a grid, returns the voxels that need support; knows no document.

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use super::CheckOptions;
use crate::progress::Progress;
use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, local_coords};
use crate::sculpture::brick_set::LeafKey;
use crate::sculpture::grid::{LEAF_EDGE_LOG2, indices, surface_leaves};
use crate::sculpture::region::ListedBricks;
use crate::shade::NormalField;

/// The approximate accuracy of normals of curved surfaces; a slope at exactly the angle needs no support.
const TOLERANCE_DEG: f32 = 5.0;
/// Widest ledges that are measured.
const WIDEST_VX: i32 = 8;
/// Bricks between two reports of progress.
const PORTION: usize = 1 << 14;

/// Returns the voxels of `grid` that need support; those in the layer `bed_y` lie on the bed. `None` if cancelled.
pub(crate) fn overhangs(
    grid: &Grid,
    options: &CheckOptions,
    bed_y: u32,
    progress: &dyn Progress,
) -> Option<ListedBricks> {
    progress.begin("looking for overhangs");
    let candidates = facing_down(grid, bed_y);
    let steepest = (options.overhang_deg + TOLERANCE_DEG).to_radians();
    let mut found = Vec::new();
    // Ceilings are the steepest overhangs.
    if steepest < std::f32::consts::FRAC_PI_2 && !candidates.is_empty() {
        let normals = normals(grid, progress)?;
        let voxel_mm = options.voxel_mm_of(grid);
        let rule = Rule {
            grid,
            normals: &normals,
            voxel_mm,
            least_down: steepest.sin(),
            ledge_vx: Some(steepest.tan() as i32 + 1).filter(|vx| *vx <= WIDEST_VX),
            bridge_vx: [options.bridge_mm / voxel_mm.x, options.bridge_mm / voxel_mm.z],
        };
        for (i, portion) in candidates.chunks(PORTION).enumerate() {
            if progress.is_cancelled() {
                return None;
            }
            progress.advance((i * PORTION) as f32 / candidates.len() as f32);
            let of_brick = |(b, down): &(UVec3, Brick)| (*b, rule.unsupported(*b, down));
            let bricks = portion.par_iter().map(of_brick).filter(|(_, mask)| !mask.is_empty());
            found.par_extend(bricks);
        }
    }
    progress.end();
    Some(ListedBricks::new(found))
}

/// Returns the normals of all surfaces. `None` if cancelled.
fn normals(grid: &Grid, progress: &dyn Progress) -> Option<NormalField> {
    let mut field = NormalField::default();
    field.follow(grid, None);
    field.update(grid, &mut Vec::new(), || !progress.is_cancelled());
    field.is_complete().then_some(field)
}

/// Returns the voxels above the layer `bed_y` that have none below them.
fn facing_down(grid: &Grid, bed_y: u32) -> Vec<(UVec3, Brick)> {
    let of_brick = |b: UVec3| {
        let below = match b.y {
            0 => Brick::EMPTY,
            _ => *grid.brick(b - UVec3::Y),
        };
        let mut down = grid.brick(b).to_rows();
        for (rows, below) in down.iter_mut().zip(below.to_rows()) {
            *rows &= !(*rows << 8 | below >> 56);
            if bed_y / BRICK_EDGE_VX == b.y {
                *rows &= !(0xFF << (8 * (bed_y % BRICK_EDGE_VX)));
            }
        }
        Some((b, Brick::from_rows(&down))).filter(|(_, mask)| !mask.is_empty())
    };
    // A brick among full ones has no such voxel.
    let of_leaf = |leaf: UVec3| {
        let near = indices(grid.bricks_near_surface(LeafKey::of(leaf)));
        let low = leaf << LEAF_EDGE_LOG2;
        near.filter_map(move |index| of_brick(low + UVec3::from(local_coords(index))))
    };
    let leaves = surface_leaves(grid).into_par_iter();
    let mut bricks: Vec<(UVec3, Brick)> = leaves.flat_map_iter(of_leaf).collect();
    bricks.par_sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
    bricks
}

struct Rule<'a> {
    grid: &'a Grid,
    normals: &'a NormalField,
    voxel_mm: Vec3,
    /// The downward component of a unit normal from which on a surface needs support.
    least_down: f32,
    /// Distance from a voxel on a ledge that is too wide to the nearest one that rests on others; `None` if it is too
    /// far.
    ledge_vx: Option<i32>,
    /// The longest bridges along x and z, in voxels.
    bridge_vx: [f32; 2],
}

impl Rule<'_> {
    fn unsupported(&self, b: UVec3, down: &Brick) -> Brick {
        let mut mask = Brick::EMPTY;
        down.for_each(|local| {
            let [x, y, z] = local_coords(local);
            let v = b * BRICK_EDGE_VX + UVec3::new(x, y, z);
            if self.leans_too_far(v) && !self.is_bridge(v.as_ivec3()) {
                mask.set(x, y, z, true);
            }
        });
        mask
    }

    fn leans_too_far(&self, v: UVec3) -> bool {
        let signed = v.as_ivec3();
        let hangs = |reach: i32| {
            let below = signed - IVec3::Y;
            let mut around =
                (-reach..=reach).flat_map(|z| (-reach..=reach).map(move |x| IVec3::new(x, 0, z)));
            !around.any(|offset| self.grid.get(below + offset))
        };
        let normal = self.normals.normal(v);
        match normal.filter(|_| self.grid.get(signed + IVec3::Y)) {
            // Normals of stretched voxels shrink where these grow.
            Some(normal) => {
                -(normal / self.voxel_mm).normalize_or_zero().y > self.least_down
                    || self.ledge_vx.is_some_and(hangs)
            }
            None => hangs(1),
        }
    }

    fn is_bridge(&self, v: IVec3) -> bool {
        [IVec3::X, IVec3::Z].into_iter().zip(self.bridge_vx).any(|(step, longest)| {
            let longest = longest as i32;
            let end = |step: IVec3| {
                let rests = |i: &i32| self.grid.get(v + step * *i - IVec3::Y);
                let mut hanging = (1..=longest).take_while(|i| self.grid.get(v + step * *i));
                hanging.find(rests)
            };
            match (end(step), end(-step)) {
                (Some(ahead), Some(behind)) => ahead + behind - 1 <= longest,
                _ => false,
            }
        })
    }
}
