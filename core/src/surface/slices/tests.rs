use super::*;
use crate::sculpture::Brick;
use crate::view::{Camera, PixelRays};
use glam::{Affine3A, IVec3, UVec2, Vec3};
use proptest::prelude::*;

/// Returns a grid of boxes, so that there are empty, full, buried and mixed bricks.
fn arb_grid() -> impl Strategy<Value = Grid> {
    let boxes = prop::collection::vec(
        (prop::array::uniform3(0i32..50), prop::array::uniform3(1i32..50), any::<bool>()),
        0..7,
    );
    (prop::array::uniform3(1u32..50), any::<bool>(), boxes).prop_map(|(dims, full, boxes)| {
        let mut grid = Grid::new(UVec3::from(dims), Vec3::ONE, 1 << 30).unwrap();
        if full {
            grid.fill_bricks(|_| Brick::FULL);
        }
        for edit in boxes {
            set_box(&mut grid, edit);
        }
        grid
    })
}

type BoxEdit = ([i32; 3], [i32; 3], bool);

/// Sets a box of voxels. Returns the bricks that changed.
fn set_box(grid: &mut Grid, (low, size, exists): BoxEdit) -> Vec<u32> {
    let before = grid.clone();
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                grid.set(IVec3::from(low) + IVec3::new(x, y, z), exists);
            }
        }
    }
    let differs = |&i: &u32| before.brick_at(i as usize) != grid.brick_at(i as usize);
    (0..grid.brick_count() as u32).filter(differs).collect()
}

const AROUND: [IVec3; 6] = [IVec3::X, IVec3::NEG_X, IVec3::Y, IVec3::NEG_Y, IVec3::Z, IVec3::NEG_Z];

/// Returns whether the brick holds a voxel beside an empty one.
fn naive_exposed(grid: &Grid, b: UVec3) -> bool {
    (0..512).any(|i| {
        let local = UVec3::from(crate::sculpture::brick::local_coords(i));
        let v = (b * 8 + local).as_ivec3();
        grid.get(v) && AROUND.iter().any(|&a| !grid.get(v + a))
    })
}

fn check_areas(areas: &mut SliceAreas, grid: &Grid) -> Result<(), TestCaseError> {
    let brick_dims = grid.brick_dims();
    let slab_bricks = areas.slab_vx() / 8;
    for axis in 0..3 {
        let mut times_drawn = vec![0; grid.brick_count()];
        for (slab, areas) in areas.along(axis).iter().enumerate() {
            let first = slab as u32 * slab_bricks;
            for layer in first..(first + slab_bricks).min(brick_dims[axis]) {
                for area in areas {
                    for v in area.min.y..area.max.y {
                        for u in area.min.x..area.max.x {
                            let b = areas::brick_of(axis, layer, UVec2::new(u, v));
                            prop_assert!(b.cmplt(brick_dims).all());
                            times_drawn[grid.brick_index(b)] += 1;
                        }
                    }
                }
            }
        }
        for (index, times) in times_drawn.into_iter().enumerate() {
            let exposed = naive_exposed(grid, grid.brick_coords(index));
            prop_assert!(times <= 1, "brick {index} is in two areas across axis {axis}");
            prop_assert!(!exposed || times == 1, "brick {index} is in no area");
            prop_assert_eq!(areas.is_exposed(grid.brick_coords(index)), exposed);
        }
    }
    Ok(())
}

fn arb_rays() -> impl Strategy<Value = PixelRays> {
    let coordinate = || -60f32..110.0;
    (
        prop::array::uniform3(coordinate()),
        prop::array::uniform3(0f32..50.0),
        10f32..150.0,
        0f32..6.3,
    )
        .prop_map(|(eye, target, fov, turn)| {
            let camera = Camera {
                eye: Vec3::from(eye),
                target: Vec3::from(target) + Vec3::splat(1e-3),
                up: Vec3::new(turn.sin(), 0.3, turn.cos()),
                fov_y_rad: fov.to_radians(),
                near: 0.1,
            };
            camera.eye(UVec2::new(12, 9)).pixel_rays(&Affine3A::IDENTITY)
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn every_visible_brick_is_in_one_area_and_stays_so_under_edits(
        mut grid in arb_grid(),
        edits in prop::collection::vec(
            (prop::array::uniform3(0i32..50), prop::array::uniform3(1i32..20), any::<bool>()),
            0..5,
        ),
        slab_bricks in 1u32..4,
    ) {
        let mut areas = SliceAreas::with_slab_bricks(slab_bricks);
        areas.update(&grid, None);
        check_areas(&mut areas, &grid)?;
        for edit in edits {
            let changed = set_box(&mut grid, edit);
            areas.update(&grid, Some(&changed));
            check_areas(&mut areas, &grid)?;
        }
    }

    /// Any voxel that a ray meets must be drawn for its pixel, by a layer and an area that the ray passes, and no layer
    /// of a lower rank may hold a voxel that the ray meets later.
    #[test]
    fn layers_come_in_the_order_of_the_rays_and_hold_what_they_meet(
        grid in arb_grid(),
        rays in arb_rays(),
        (slab_bricks, thickness) in
            prop::sample::select(vec![(1u32, 1u32), (1, 2), (1, 4), (1, 8), (2, 4), (2, 16), (3, 24)]),
    ) {
        let mut areas = SliceAreas::with_slab_bricks(slab_bricks);
        areas.update(&grid, None);
        let axis = facing_axis(&rays, grid.dims());
        let layers = SliceLayers::new(&rays, grid.dims(), axis, thickness, areas.slab_vx());
        let mut drawn = Vec::new();
        layers.for_each(areas.along(axis), |rect| drawn.push(rect));
        for y in 0..rays.size.y {
            for x in 0..rays.size.x {
                let direction = rays.direction(x, y);
                let Some(hit) = crate::surface::raycast::cast(&grid, rays.origin, direction) else {
                    continue;
                };
                let holds = |r: &LayerRect| {
                    let (u, v) = (hit.voxel[(axis + 1) % 3], hit.voxel[(axis + 2) % 3]);
                    let uv = UVec2::new(u, v);
                    (r.layer.first..r.layer.end).contains(&hit.voxel[axis])
                        && r.rect.is_none_or(|a| uv.cmpge(a.min).all() && uv.cmplt(a.max).all())
                };
                let Some(own) = drawn.iter().find(|&r| holds(r)) else {
                    return Err(TestCaseError::fail(format!("{} not drawn", hit.voxel)));
                };
                // Layers met before it have lower ranks, layers beyond it higher ones.
                let eye = rays.origin[axis];
                for other in &drawn {
                    let same_side = |l: &SliceLayer| (l.first as f32 + 0.5 > eye) == (direction[axis] > 0.0);
                    if other.rect.is_some() && own.rect.is_some() && same_side(&other.layer) {
                        let farther = (other.layer.first > own.layer.first) == (direction[axis] > 0.0);
                        if other.layer.first != own.layer.first {
                            prop_assert_eq!(other.layer.rank > own.layer.rank, farther);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_inside_of_a_solid_is_not_drawn() {
    let mut grid = Grid::new(UVec3::new(256, 253, 70), Vec3::ONE, 1 << 30).unwrap();
    grid.fill_bricks(|_| Brick::FULL);
    let mut areas = SliceAreas::with_slab_bricks(1);
    areas.update(&grid, None);
    assert!(!areas.is_exposed(UVec3::splat(3)));
    let middle = &areas.along(2)[4];
    assert!(middle.iter().all(|a| {
        let size = a.max - a.min;
        size.x == 1 || size.y == 1
    }));
    let drawn: u32 = middle.iter().map(|a| (a.max - a.min).element_product()).sum();
    assert_eq!(drawn, 124, "the rim of 32 by 32 bricks");
}

#[test]
fn a_change_within_a_brick_rebuilds_nothing() {
    let mut grid = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 30).unwrap();
    grid.set(IVec3::splat(12), true);
    let mut areas = SliceAreas::default();
    areas.update(&grid, None);
    areas.along(0);
    grid.set(IVec3::splat(13), true);
    let brick = grid.brick_index(UVec3::ONE) as u32;
    areas.update(&grid, Some(&[brick]));
    assert!(areas.axes[0].as_ref().is_some_and(|a| !a.stale.contains(&true)));
}
