use super::*;
use crate::scenes;
use crate::sculpture::Placement;
use crate::view::Camera;
use glam::{Quat, UVec2};
use proptest::prelude::*;

/// Traverses the grid by Amanatides and Woo from the eye, voxel by voxel, by the rules of [`ray`] but without its code.
pub(crate) fn naive(grid: &Grid, origin: Vec3, direction: Vec3) -> Option<Hit> {
    naive_walk(grid, origin, direction, |cell| grid.get(cell).then_some(cell))
}

/// Traverses the grid along a pixel. Among the bricks in `small`, the first one with a voxel is hit.
pub(crate) fn naive_pixel(
    grid: &Grid,
    small: &SmallBricks,
    rays: &PixelRays,
    x: u32,
    y: u32,
) -> Option<Hit> {
    // A ray meets a brick in several voxels.
    let mut last = None;
    naive_walk(grid, rays.origin, rays.direction(x, y), |cell| {
        let b = cell.div_euclid(IVec3::splat(8));
        if !small.contains(b) || !grid.contains(cell) {
            return grid.get(cell).then_some(cell);
        }
        if let Some((brick, found)) = last
            && brick == b
        {
            return found;
        }
        // The voxels of the brick in the order of their distances from the eye along z, then y, then x.
        let from_eye = |v: IVec3| {
            let far = rays.origin.cmpge((b * 8 + 4).as_vec3());
            let along = |axis: usize| if far.test(axis) { -v[axis] } else { v[axis] };
            (along(2), along(1), along(0))
        };
        let all = (0..512).map(|i| b * 8 + IVec3::new(i & 7, i >> 3 & 7, i >> 6));
        let found = all.filter(|v| grid.get(*v)).min_by_key(|v| from_eye(*v));
        last = Some((b, found));
        found
    })
}

fn naive_walk(
    grid: &Grid,
    origin: Vec3,
    direction: Vec3,
    mut seen: impl FnMut(IVec3) -> Option<IVec3>,
) -> Option<Hit> {
    let dir = direction.to_array().map(|d| if d.abs() < 1e-20 { 1e-20 } else { d });
    let (o, inv) = (origin.to_array(), dir.map(|d| 1.0 / d));
    let dims = grid.dims().as_ivec3().to_array();
    let mut cell: [i32; 3] = std::array::from_fn(|a| {
        if dir[a] > 0.0 { o[a].floor() as i32 } else { o[a].ceil() as i32 - 1 }
    });
    let (mut face, mut t) = (IVec3::ZERO, 0.0);
    loop {
        if let Some(voxel) = seen(IVec3::from(cell)) {
            return Some(Hit { voxel: voxel.as_uvec3(), face, t });
        }
        if (0..3).any(|a| if dir[a] > 0.0 { cell[a] >= dims[a] } else { cell[a] < 0 }) {
            return None;
        }
        let next: [f32; 3] = std::array::from_fn(|a| {
            let plane = if dir[a] > 0.0 { cell[a] + 1 } else { cell[a] };
            (plane as f32 - o[a]) * inv[a]
        });
        let axis = if next[0] <= next[1] && next[0] <= next[2] {
            0
        } else if next[1] <= next[2] {
            1
        } else {
            2
        };
        let step = if dir[axis] > 0.0 { 1 } else { -1 };
        cell[axis] += step;
        (face, t) = (IVec3::ZERO, next[axis]);
        face[axis] = -step;
    }
}

/// Returns every set of vector instructions of this processor: tests must hold for all.
pub(crate) fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![best];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_avx2().map(Level::Avx2));
        levels.extend(best.as_sse4_2().map(Level::Sse4_2));
        levels.extend(best.as_sse2().map(Level::Sse2));
    }
    levels
}

/// Checks that every pixel of a picture has the voxel that the naive walk of its ray finds: with small bricks hit as a
/// whole, and without.
fn check_picture(grid: &Grid, rays: PixelRays) -> Result<(), TestCaseError> {
    for small in [SmallBricks::new(&rays), SmallBricks::NONE] {
        check_picture_with(grid, rays, small)?;
    }
    Ok(())
}

fn check_picture_with(
    grid: &Grid,
    rays: PixelRays,
    small: SmallBricks,
) -> Result<(), TestCaseError> {
    let size = rays.size;
    let mut expected = IndexMap::new(rays);
    for y in 0..size.y {
        for x in 0..size.x {
            let hit = naive_pixel(grid, &small, &rays, x, y);
            if small == SmallBricks::new(&rays) {
                prop_assert_eq!(cast_pixel(grid, &rays, x, y), hit, "pixel {}, {}", x, y);
            }
            let voxel = hit.map_or(NO_VOXEL, |hit| grid.voxel_index(hit.voxel));
            expected.voxels[(x + y * size.x) as usize] = voxel;
        }
    }
    for level in levels() {
        let mut map = IndexMap::new(rays);
        sample_rect_at(level, grid, small, &mut map, PixelRect::of_picture(size));
        for (i, (seen, expected)) in map.voxels.iter().zip(&expected.voxels).enumerate() {
            prop_assert_eq!(seen, expected, "pixel {} of {}, {:?}", i, size, level);
        }
    }
    Ok(())
}

/// Returns a grid of blobs, plates and dust: with empty, full and mixed bricks.
fn arb_grid() -> impl Strategy<Value = Grid> {
    let dims = prop::array::uniform3(prop_oneof![1u32..20, 60u32..100]);
    let boxes = prop::collection::vec(
        (prop::array::uniform3(-4i32..100), prop::array::uniform3(1i32..30), any::<bool>()),
        0..8,
    );
    let dust = prop::collection::vec(prop::array::uniform3(0i32..100), 0..40);
    (dims, boxes, dust).prop_map(|(dims, boxes, dust)| {
        let mut grid = Grid::new(UVec3::from(dims), Vec3::ONE, 1 << 30).unwrap();
        for (low, size, exists) in boxes {
            for z in 0..size[2] {
                for y in 0..size[1] {
                    for x in 0..size[0] {
                        grid.set(IVec3::from(low) + IVec3::new(x, y, z), exists);
                    }
                }
            }
        }
        for v in dust {
            grid.set(IVec3::from(v), true);
        }
        grid
    })
}

/// Returns a coordinate in and around a grid, often exactly on a voxel plane or in its middle.
fn arb_coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![-150f32..250.0, (-150i32..250).prop_map(|v| v as f32 * 0.5), 0f32..100.0]
}

/// Returns a component of a direction: any, small integers (ties, zeros, corners), or nearly zero.
fn arb_component() -> impl Strategy<Value = f32> {
    prop_oneof![
        -1f32..1.0,
        (-2i32..3).prop_map(|v| v as f32),
        (-2i32..3).prop_map(|v| v as f32),
        -1e-6f32..1e-6,
        Just(-0.0),
    ]
}

fn arb_vec(component: impl Strategy<Value = f32>) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(component).prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn cast_is_the_naive_walk(
        grid in arb_grid(),
        rays in prop::collection::vec((arb_vec(arb_coordinate()), arb_vec(arb_component())), 100),
    ) {
        for (origin, direction) in rays {
            if direction != Vec3::ZERO {
                let expected = naive(&grid, origin, direction);
                prop_assert_eq!(cast(&grid, origin, direction), expected, "{} {}", origin, direction);
            }
        }
    }

    #[test]
    fn sample_is_the_naive_walk_of_every_pixel(
        grid in arb_grid(),
        origin in arb_vec(arb_coordinate()),
        corner in arb_vec(arb_component()),
        step_x in arb_vec(arb_component()),
        step_y in arb_vec(arb_component()),
        size in prop::array::uniform2(1u32..40),
        zoom in prop_oneof![Just(1.0f32), Just(0.03f32)],
    ) {
        let (step_x, step_y) = (step_x * zoom, step_y * zoom);
        let rays = PixelRays { origin, corner, step_x, step_y, size: UVec2::from(size) };
        let directions = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| rays.direction(x, y)));
        prop_assume!(directions.into_iter().all(|d| d != Vec3::ZERO));
        check_picture(&grid, rays)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn sample_is_the_naive_walk_for_cameras(
        grid in arb_grid(),
        eye in arb_vec(-1.5f32..1.5),
        target in arb_vec(-0.5f32..0.5),
        turn in arb_vec(-3f32..3.0),
        fov_y_deg in 3f32..120.0,
        size in prop::array::uniform2(50u32..140),
    ) {
        let reach = grid.dims().as_vec3().length();
        let camera = Camera {
            eye: eye * reach,
            target: target * reach,
            fov_y_rad: fov_y_deg.to_radians(),
            ..Camera::default()
        };
        let placement = Placement {
            rotation: Quat::from_scaled_axis(turn),
            ..Placement::default()
        };
        let world_from_grid = placement.world_from_grid(grid.dims(), Vec3::ONE);
        let rays = camera.eye(UVec2::from(size)).pixel_rays(&world_from_grid);
        check_picture(&grid, rays)?;
    }
}

#[test]
fn scenes_are_seen_as_by_the_naive_walk() {
    let scenes = [scenes::cheese(200, 120, 1), scenes::gyroid(150, 2), scenes::engine_like(128)];
    for grid in scenes.map(Result::unwrap) {
        let edge = grid.dims().x as f32;
        let world_from_grid = Placement::default().world_from_grid(grid.dims(), Vec3::ONE);
        for (direction, distance) in [
            (Vec3::new(0.8, 0.6, 1.0), 1.9),
            (Vec3::new(-0.3, 0.9, 0.1), 0.7),
            (Vec3::new(0.1, -0.2, -0.3), 0.1),
            (Vec3::new(0.0, 0.0, -1.0), 1.5),
            // Bricks are smaller than pixels in all of the picture, and in its upper part.
            (Vec3::new(0.8, 0.6, 1.0), 25.0),
            (Vec3::new(1.0, 0.1, 0.9), 12.0),
        ] {
            let eye = direction.normalize() * distance * edge;
            let up = if direction.x == 0.0 { Vec3::X } else { Vec3::Y };
            let camera = Camera { eye, up, ..Camera::default() };
            let rays = camera.eye(UVec2::new(200, 150)).pixel_rays(&world_from_grid);
            check_picture(&grid, rays).unwrap();
        }
    }
}

#[test]
fn unusable_rays_meet_nothing() {
    let mut grid = Grid::new(UVec3::splat(8), Vec3::ONE, 1 << 20).unwrap();
    grid.set(IVec3::splat(4), true);
    let inside = Vec3::splat(4.5);
    assert_eq!(cast(&grid, inside, Vec3::ZERO), None);
    assert_eq!(cast(&grid, inside, Vec3::new(f32::NAN, 1.0, 0.0)), None);
    assert_eq!(cast(&grid, Vec3::new(f32::INFINITY, 0.0, 0.0), Vec3::X), None);
    assert_eq!(cast(&grid, inside, Vec3::X).unwrap().t, 0.0);
}

#[test]
fn a_rectangle_changes_only_its_pixels() {
    let mut grid = Grid::new(UVec3::splat(8), Vec3::ONE, 1 << 20).unwrap();
    grid.fill_bricks(|_| crate::sculpture::Brick::FULL);
    let rays = PixelRays {
        origin: Vec3::new(4.0, 4.0, 20.0),
        corner: Vec3::new(-0.1, 0.1, -1.0),
        step_x: Vec3::X * 0.01,
        step_y: Vec3::Y * -0.01,
        size: UVec2::splat(20),
    };
    let mut map = IndexMap::new(rays);
    let rect = PixelRect { min: UVec2::new(3, 5), max: UVec2::new(9, 100) };
    sample_rect(&grid, &mut map, rect);
    let mut whole = IndexMap::new(rays);
    sample(&grid, &rays, &mut whole);
    assert_eq!(whole.covered(), 400);
    for y in 0..20 {
        for x in 0..20 {
            let inside = (3..9).contains(&x) && y >= 5;
            assert_eq!(map.get(x, y), whole.get(x, y).filter(|_| inside));
        }
    }
    sample_rect(&grid, &mut map, PixelRect { min: UVec2::splat(30), max: UVec2::splat(40) });
}

#[test]
fn what_stands_for_a_small_brick_is_on_the_surface() {
    let scenes = [scenes::cheese(200, 120, 1), scenes::gyroid(150, 2), scenes::engine_like(128)];
    let faces = [IVec3::X, IVec3::Y, IVec3::Z].map(|axis| [axis, -axis]);
    for grid in scenes.map(Result::unwrap) {
        let world_from_grid = Placement::default().world_from_grid(grid.dims(), Vec3::ONE);
        for direction in [Vec3::new(0.8, 0.6, 1.0), Vec3::new(-0.3, -0.9, 0.2), Vec3::X] {
            let eye = direction.normalize() * 40.0 * grid.dims().x as f32;
            let camera = Camera { eye, fov_y_rad: 0.2, ..Camera::default() };
            let rays = camera.eye(UVec2::new(140, 140)).pixel_rays(&world_from_grid);
            let mut map = IndexMap::new(rays);
            sample(&grid, &rays, &mut map);
            assert!(map.covered() > 50, "{}", map.covered());
            for number in map.voxels.iter().filter(|number| **number != NO_VOXEL) {
                let voxel = map.numbering.coords(*number).as_ivec3();
                assert!(grid.get(voxel), "{voxel}");
                let is_bare = |face: &IVec3| !grid.get(voxel + *face);
                assert!(faces.as_flattened().iter().any(is_bare), "{voxel} is buried");
            }
        }
    }
}
