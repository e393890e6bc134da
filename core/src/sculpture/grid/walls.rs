//! The outermost voxels of a grid. Reads only.

use glam::UVec3;

use super::parts::{NodeView, indices};
use super::{BRICK_EDGE_VX, Grid};
use crate::sculpture::brick::Brick;

/// Returns the number of existing voxels in the outermost layers of a grid, at its walls.
pub fn voxels_at_walls(grid: &Grid) -> u64 {
    at_walls(NodeView::root(grid), grid)
}

/// Returns the number of voxels of a node that lie at the walls. Skips children away from them, and reads only mixed
/// bricks.
fn at_walls(view: NodeView, grid: &Grid) -> u64 {
    // The voxels that are not at a wall.
    let (low, high) = (UVec3::ONE, grid.dims() - 1);
    let mut count = 0;
    for index in indices(view.full().or(view.mixed())) {
        let (min, max) = view.child_voxel_bounds(index);
        if min.cmpge(low).all() && max.cmple(high).all() {
            continue;
        }
        count += if let Some(child) = view.node(index) {
            at_walls(child, grid)
        } else if view.is_leaf() {
            let b = view.child_low(index);
            u64::from(grid.brick(b).and(&walls_of(grid, b)).count())
        } else {
            let inner = max.min(high).saturating_sub(min.max(low));
            view.child_voxels(index) - inner.as_u64vec3().element_product()
        };
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
    use crate::sculpture::region::VoxelBox;

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

    #[test]
    fn full_nodes_count_by_their_faces() {
        for dims in [UVec3::splat(64), UVec3::new(1, 700, 513), UVec3::new(1030, 2, 65)] {
            let mut grid = Grid::new(dims, Vec3::ONE, u64::MAX).unwrap();
            grid.fill_box(VoxelBox { min: IVec3::ZERO, max: dims.as_ivec3() });
            let [all, inner] = [dims, dims.saturating_sub(UVec3::splat(2))]
                .map(|d| d.as_u64vec3().element_product());
            assert_eq!(voxels_at_walls(&grid), all - inner, "{dims}");
            // A hole at a wall, and one away from all.
            let at_wall = (dims / 2).with_z(0).as_ivec3();
            grid.set(at_wall, false);
            assert_eq!(voxels_at_walls(&grid), all - inner - 1, "{dims}");
            let middle = dims.as_ivec3() / 2;
            let is_inside =
                middle.cmpgt(IVec3::ZERO).all() && (middle + 1).cmplt(dims.as_ivec3()).all();
            grid.set(middle, false);
            assert_eq!(voxels_at_walls(&grid), all - inner - 1 - u64::from(!is_inside), "{dims}");
        }
        let empty = Grid::new(UVec3::splat(4096), Vec3::ONE, u64::MAX).unwrap();
        assert_eq!(voxels_at_walls(&empty), 0);
    }
}
