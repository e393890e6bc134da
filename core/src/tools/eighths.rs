//! The voxels of a brick by halving: cubes of 8, 4 and 2 voxels that lie wholly inside or outside of a region are decided
//! as a whole, the others by their eighths. Knows no region.

use glam::UVec3;

use crate::sculpture::Brick;
use crate::sculpture::brick::BRICK_EDGE_VX;

/// Sets the voxels of an empty brick that are inside. `covers` says of the cube at a corner, in the brick, with an edge,
/// whether it is wholly inside, wholly outside, or neither; of single voxels it must know.
pub fn set_by_eighths(mask: &mut Brick, covers: impl Fn(UVec3, u32) -> Option<bool>) {
    set(mask, UVec3::ZERO, BRICK_EDGE_VX, &covers);
}

fn set(mask: &mut Brick, at: UVec3, edge: u32, covers: &impl Fn(UVec3, u32) -> Option<bool>) {
    match covers(at, edge) {
        Some(false) => {}
        Some(true) if edge == BRICK_EDGE_VX => *mask = Brick::FULL,
        Some(true) => {
            for z in at.z..at.z + edge {
                for y in at.y..at.y + edge {
                    for x in at.x..at.x + edge {
                        mask.set(x, y, z, true);
                    }
                }
            }
        }
        None => {
            let half = edge / 2;
            for eighth in 0..8u32 {
                let corner = UVec3::new(eighth & 1, eighth >> 1 & 1, eighth >> 2);
                set(mask, at + corner * half, half, covers);
            }
        }
    }
}
