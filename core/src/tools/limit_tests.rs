//! Compares boxes, stacks of boxes, and solids limited to a stack and kept off a mask with their definitions, voxel by
//! voxel.

use fearless_simd::{Level, Simd, dispatch};
use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;

use super::solid::{Primitive, Solid};
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::edit_scope::{EditScope, ScopedRegion};
use crate::sculpture::region::{Region, VoxelBox};
use crate::sculpture::selection::Selection;
use crate::sculpture::{Brick, Grid};

/// Returns the voxels of a region that lie in a grid of `dims`, brick by brick.
fn voxels_of(region: &impl Region, dims: UVec3) -> Vec<IVec3> {
    dispatch!(Level::new(), simd => voxels_by(simd, region, dims))
}

fn voxels_by(simd: impl Simd, region: &impl Region, dims: UVec3) -> Vec<IVec3> {
    let mut all = Vec::new();
    let mut row = Default::default();
    let bricks = dims.map(|d| d.div_ceil(BRICK_EDGE_VX));
    for z in 0..bricks.z {
        for y in 0..bricks.y {
            let reach = region.cut_row(simd, y * BRICK_EDGE_VX, z * BRICK_EDGE_VX, &mut row);
            for x in reach.touched.start..reach.touched.end.min(bricks.x) {
                let whole = reach.whole.contains(&x);
                let mask = if whole { Brick::FULL } else { region.mask(simd, &row, &reach, x) };
                let origin = UVec3::new(x, y, z) * BRICK_EDGE_VX;
                mask.for_each(|i| {
                    let v = origin + UVec3::from(local_coords(i));
                    all.extend(v.cmplt(dims).all().then(|| v.as_ivec3()));
                });
            }
        }
    }
    all.sort_by_key(|v| (v.z, v.y, v.x));
    all
}

fn any_box() -> impl Strategy<Value = VoxelBox> {
    (prop::array::uniform3(-9i32..40), prop::array::uniform3(1i32..45)).prop_map(|(min, size)| {
        VoxelBox { min: min.into(), max: IVec3::from(min) + IVec3::from(size) }
    })
}

fn every_voxel(dims: UVec3) -> impl Iterator<Item = IVec3> {
    let dims = dims.as_ivec3();
    (0..dims.z).flat_map(move |z| {
        (0..dims.y).flat_map(move |y| (0..dims.x).map(move |x| IVec3::new(x, y, z)))
    })
}

proptest! {
    #[test]
    fn boxes_stacks_and_limits_cover_what_their_definitions_say(
        dims in prop::array::uniform3(1u32..36),
        boxes in prop::collection::vec((any_box(), any::<bool>()), 0..6),
        tool in (prop::array::uniform3(-4f32..36.0), prop::array::uniform3(2f32..30.0)),
        protected in prop::collection::vec(any_box(), 0..4),
    ) {
        let dims = UVec3::from(dims);
        let mut selection = Selection::new(dims);
        for (marker, adds) in boxes {
            selection.set_marker(marker).unwrap();
            selection.push(adds);
            let expected: Vec<_> = every_voxel(dims).filter(|v| marker.contains(*v)).collect();
            prop_assert_eq!(voxels_of(&marker, dims), expected);
        }
        let stack = selection.stack();
        let expected: Vec<_> = every_voxel(dims).filter(|v| stack.contains(*v)).collect();
        prop_assert_eq!(voxels_of(stack, dims), expected);
        let ball = Primitive {
            solid: Solid::Ellipsoid,
            centre_vx: tool.0.into(),
            half: tool.1.into(),
            rotation: glam::Quat::IDENTITY,
        };
        let region = ball.in_grid(Vec3::ONE);
        let mut mask = Grid::new(dims, Vec3::ONE, 1 << 20).unwrap();
        for v in every_voxel(dims) {
            mask.set(v, protected.iter().any(|b| b.contains(v)));
        }
        for scope in [
            EditScope { stack: Some(stack), mask: None },
            EditScope { stack: None, mask: Some(&mask) },
            EditScope { stack: Some(stack), mask: Some(&mask) },
        ] {
            let both = |v: &IVec3| scope.allows(*v) && region.contains_voxel(*v);
            let expected: Vec<_> = every_voxel(dims).filter(both).collect();
            prop_assert_eq!(voxels_of(&ScopedRegion { region: &region, scope }, dims), expected);
            let all = VoxelBox { min: IVec3::ZERO, max: dims.as_ivec3() };
            let expected: Vec<_> = every_voxel(dims).filter(|v| scope.allows(*v)).collect();
            prop_assert_eq!(voxels_of(&ScopedRegion { region: &all, scope }, dims), expected);
        }
    }
}
