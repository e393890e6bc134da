//! The outermost voxels of a grid. Reads only.

use glam::UVec3;

use super::{BRICK_EDGE_VX, Grid};
use crate::sculpture::brick::{Brick, BrickKind};

/// Returns the number of existing voxels in the outermost layers of a grid, at its walls.
pub fn voxels_at_walls(grid: &Grid) -> u64 {
    let last = grid.brick_dims() - 1;
    let mut count = 0;
    for z in 0..=last.z {
        for y in 0..=last.y {
            let whole = z == 0 || z == last.z || y == 0 || y == last.y;
            let step = if whole { 1 } else { last.x.max(1) };
            for x in (0..=last.x).step_by(step as usize) {
                let b = UVec3::new(x, y, z);
                if grid.brick_kind(grid.brick_index(b)) != BrickKind::Empty {
                    count += u64::from(grid.brick(b).and(&walls_of(grid, b)).count());
                }
            }
        }
    }
    count
}

/// Returns the voxels of the brick at `b` that lie in an outermost layer.
fn walls_of(grid: &Grid, b: UVec3) -> Brick {
    let (dims, last) = (grid.dims().to_array(), (grid.brick_dims() - 1).to_array());
    let mut walls = Brick::EMPTY;
    for (axis, b) in b.to_array().into_iter().enumerate() {
        // The voxels below `end` on this axis.
        let below = |end: u32| {
            let mut limit = [BRICK_EDGE_VX; 3];
            limit[axis] = end;
            Brick::below(limit)
        };
        if b == 0 {
            walls = walls.or(&below(1));
        }
        if b == last[axis] {
            let end = dims[axis] - b * BRICK_EDGE_VX;
            walls = walls.or(&below(end).and_not(&below(end - 1)));
        }
    }
    walls
}

#[cfg(test)]
mod tests {
    use glam::{IVec3, Vec3};

    use super::*;

    #[test]
    fn voxels_at_walls_are_those_without_a_neighbour_inside() {
        for dims in [UVec3::new(1, 9, 24), UVec3::splat(8), UVec3::new(17, 5, 33)] {
            let mut grid = Grid::new(dims, Vec3::ONE, u64::MAX).unwrap();
            let mut expected = 0;
            for z in 0..dims.z {
                for y in 0..dims.y {
                    for x in 0..dims.x {
                        let v = UVec3::new(x, y, z);
                        if (x * 7 + y * 3 + z) % 4 == 0 {
                            grid.set(v.as_ivec3(), true);
                            let inside = v.cmpgt(UVec3::ZERO).all() && (v + 1).cmplt(dims).all();
                            expected += u64::from(!inside);
                        }
                    }
                }
            }
            assert_eq!(voxels_at_walls(&grid), expected, "{dims}");
            assert!(!grid.contains(IVec3::NEG_ONE));
        }
    }
}
