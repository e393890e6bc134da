use glam::{IVec3, Quat, UVec2, Vec3};
use proptest::prelude::*;

use super::ray::{Naming, first_root};
use super::*;
use crate::scenes::{self, grid_of};
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::{NO_VOXEL, Placement};
use crate::surface::{IndexMap, PixelRect};
use crate::view::{Camera, PixelRays};

fn smooth(grid: &Grid) -> (NormalField, LevelSet) {
    let normals = NormalField::of(grid);
    let mut levels = LevelSet::whole(grid, 1 << 30).unwrap();
    levels.update(grid, &normals, &mut Vec::new());
    (normals, levels)
}

fn rays_at(grid: &Grid, radius: f32, direction: Vec3) -> PixelRays {
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    Camera::framing(radius, direction, Vec3::Y)
        .eye(UVec2::new(160, 120))
        .pixel_rays(&world_from_grid)
}

/// Returns the distances of a picture's surface points, by the shape's own signed distance: mean, standard deviation,
/// largest.
fn errors(grid: &Grid, rays: &PixelRays, distance: impl Fn(Vec3) -> f32) -> [f32; 3] {
    let (normals, levels) = smooth(grid);
    let scene = ray::LevelScene { grid, normals: &normals, levels: &levels };
    let mut cells = IndexMap::new(LevelSet::rays_of_cells(rays));
    let rays_of_cells = cells.rays;
    crate::surface::raycast::sample_exact(levels.cells(), &rays_of_cells, &mut cells);
    let mut found = Vec::new();
    for y in 0..rays.size.y {
        for x in 0..rays.size.x {
            let Some(cell) = cells.get(x, y) else { continue };
            let (cell, direction) = (levels.cells().voxel_coords(cell), rays.direction(x, y));
            let hit = scene.hit(
                Naming::Nearest,
                cells.rays.origin,
                direction,
                cell,
                &mut Default::default(),
            );
            found.extend(hit.map(|hit| distance(rays.origin + direction * hit.t)));
        }
    }
    assert!(found.len() > 1000, "{} places", found.len());
    let mean = found.iter().sum::<f32>() / found.len() as f32;
    let squares = found.iter().map(|d| (d - mean).powi(2)).sum::<f32>() / found.len() as f32;
    let largest = found.iter().fold(0f32, |most, d| most.max(d.abs()));
    [mean, squares.sqrt(), largest]
}

#[test]
fn a_ball_is_round_and_a_plane_is_flat() {
    let middle = Vec3::new(32.3, 31.7, 32.1);
    let ball = grid_of(64, |p| p.distance(middle) < 25.0);
    let rays = rays_at(&ball, 40.0, Vec3::new(0.8, 0.6, 1.0));
    let [mean, deviation, largest] = errors(&ball, &rays, |p| p.distance(middle) - 25.0);
    assert!(
        mean.abs() < 0.03 && deviation < 0.05 && largest < 0.35,
        "{mean} {deviation} {largest}"
    );
    for normal in [Vec3::new(0.12, 1.0, 0.05), Vec3::new(1.0, 1.0, 1.0), Vec3::new(0.3, 1.0, -0.7)]
    {
        let normal = normal.normalize();
        let plane = grid_of(64, |p| (p - 32.0).dot(normal) < 0.0);
        let rays =
            PixelRays { origin: Vec3::splat(32.0) + normal * 60.0, ..rays_at(&plane, 1.0, normal) };
        // Away from the grid's sides.
        let rays = PixelRays {
            corner: -normal * 60.0 - Vec3::new(12.0, 12.0, 0.0),
            step_x: Vec3::X * 0.15,
            step_y: Vec3::Y * 0.2,
            ..rays
        };
        let [mean, deviation, largest] = errors(&plane, &rays, |p| (p - 32.0).dot(normal));
        assert!(
            mean.abs() < 0.06 && deviation < 0.09 && largest < 0.35,
            "{normal}: {mean} {deviation} {largest}"
        );
    }
}

#[test]
fn faces_of_cubes_stay_in_their_planes_even_at_the_border_of_the_grid() {
    for (low, high) in [(8, 24), (0, 32)] {
        let grid = grid_of(32, |p| {
            let v = p.floor().as_ivec3();
            v.cmpge(IVec3::splat(low)).all() && v.cmplt(IVec3::splat(high)).all()
        });
        let (normals, levels) = smooth(&grid);
        let scene = ray::LevelScene { grid: &grid, normals: &normals, levels: &levels };
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let mut direction = Vec3::ZERO;
                direction[axis] = -side;
                let origin = Vec3::splat(16.2) - direction * 50.0;
                let cell =
                    crate::surface::raycast::cast(levels.cells(), in_cells(origin), direction);
                let first = cell.unwrap().voxel;
                let hit = scene
                    .hit(
                        Naming::Nearest,
                        in_cells(origin),
                        direction,
                        first,
                        &mut Default::default(),
                    )
                    .unwrap();
                let place = origin + direction * hit.t;
                let expected = if side > 0.0 { high } else { low } as f32;
                assert!((place[axis] - expected).abs() < 0.05, "{low} {axis} {side}: {place}");
                assert!(grid.get(hit.voxel.as_ivec3()));
            }
        }
    }
}

/// Asserts that every existing voxel is inside and every empty one outside, whatever the shape.
fn assert_signs(grid: &Grid, levels: &LevelSet) {
    let dims = grid.dims().as_ivec3();
    for z in -1..=dims.z {
        for y in -1..=dims.y {
            for x in -1..=dims.x {
                let v = IVec3::new(x, y, z);
                assert_eq!(levels.level(grid, v) < 0, grid.get(v), "{v}");
                let any = (0..8).any(|i| grid.get(v - 1 + corner(i)));
                assert_eq!(levels.cells().get(v), any, "cell {v}");
            }
        }
    }
}

#[test]
fn signs_are_those_of_the_voxels() {
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2);
    let wall = grid_of(40, |p| (turn * (p - 20.0)).x.abs() < 1.0);
    let mut random = scenes::Random(3);
    let noise = grid_of(24, |_| random.next_u64().is_multiple_of(3));
    let full = grid_of(24, |_| true);
    let empty = grid_of(24, |_| false);
    let one = grid_of(17, |p| p.floor() == Vec3::splat(16.0));
    for grid in [wall, noise, full, empty, one] {
        assert_signs(&grid, &smooth(&grid).1);
    }
}

#[test]
fn layers_have_the_levels_of_cells() {
    // The edge of a brick, beside one, and a grid of a single voxel.
    for (dims, seed) in [([16, 8, 24], 1), ([9, 17, 7], 2), ([1, 1, 1], 3), ([3, 8, 9], 4)] {
        let mut random = scenes::Random(seed);
        let mut grid = Grid::new(UVec3::from_array(dims), Vec3::ONE, 1 << 24).unwrap();
        for v in voxels(&grid.clone()) {
            grid.set(v, !random.next_u64().is_multiple_of(3));
        }
        let (_, levels) = smooth(&grid);
        let [mut low, mut high] = [LevelLayer::default(), LevelLayer::default()];
        for z in 0..=dims[2] as i32 {
            let all = grid.brick_dims().truncate().to_array().map(|end| 0..end);
            low.read(&levels, &grid, i64::from(z) - 1, &all);
            high.read(&levels, &grid, z.into(), &all);
            for (x, y) in (0..=dims[0]).flat_map(|x| (0..=dims[1]).map(move |y| (x, y))) {
                let here = LevelLayer::corners(&low, &high, [x as usize, y as usize]);
                let expected = levels.corners(&grid, IVec3::new(x as i32, y as i32, z));
                assert_eq!(here.map(f32::from), expected, "{dims:?} {x} {y} {z}");
            }
        }
    }
}

/// A level set that follows edits equals a new one.
#[test]
fn edits_are_followed() {
    let mut random = scenes::Random(11);
    let mut grid = scenes::cheese(72, 20, 4).unwrap();
    let mut normals = NormalField::of(&grid);
    let mut levels = LevelSet::whole(&grid, 1 << 30).unwrap();
    levels.update(&grid, &normals, &mut Vec::new());
    for round in 0..12 {
        let middle = random.voxel(grid.dims()).as_vec3();
        let (radius, exists) = (random.unit() * 9.0, round % 2 == 0);
        let mut edited = Vec::new();
        for z in 0..72 {
            for y in 0..72 {
                for x in 0..72 {
                    let v = IVec3::new(x, y, z);
                    if v.as_vec3().distance(middle) < radius && grid.get(v) != exists {
                        grid.set(v, exists);
                        edited.push(grid.brick_index(v.as_uvec3() / 8) as u32);
                    }
                }
            }
        }
        edited.sort_unstable();
        edited.dedup();
        normals.follow(&grid, Some(&edited));
        let mut changed = edited.clone();
        normals.update(&grid, &mut changed, || true);
        levels.follow(&grid, &changed);
        let mut reported = Vec::new();
        let before: Vec<i8> = voxels(&grid).map(|v| levels.level(&grid, v)).collect();
        levels.update(&grid, &normals, &mut reported);
        let (_, anew) = smooth(&grid);
        assert!(levels.cells() == anew.cells(), "round {round}");
        for (v, before) in voxels(&grid).zip(before) {
            let level = levels.level(&grid, v);
            assert_eq!(level, anew.level(&grid, v), "round {round}, {v}");
            let brick = grid.brick_index(v.as_uvec3() / 8) as u32;
            assert!(level == before || reported.contains(&brick), "round {round}, {v}");
        }
    }
}

/// A level set that was computed in portions equals one that was computed at once.
#[test]
fn portions_add_up() {
    let grid = scenes::cheese(96, 20, 4).unwrap();
    let (normals, whole) = smooth(&grid);
    let mut levels = LevelSet::whole(&grid, 1 << 30).unwrap();
    let mut portions = 0;
    while !levels.is_complete() {
        let mut asked = 0;
        levels.update_while(&grid, &normals, &mut Vec::new(), || {
            asked += 1;
            asked == 1
        });
        portions += 1;
    }
    assert_eq!(portions, 12usize.pow(3).div_ceil(PORTION));
    assert!(levels.cells() == whole.cells());
    assert!(voxels(&grid).all(|v| levels.level(&grid, v) == whole.level(&grid, v)));
}

fn voxels(grid: &Grid) -> impl Iterator<Item = IVec3> + use<> {
    let dims = grid.dims().as_ivec3();
    (0..dims.element_product())
        .map(move |i| IVec3::new(i % dims.x, i / dims.x % dims.y, i / dims.x / dims.y))
}

/// Maps name existing surface voxels near the ray, have a normal for each pixel, and their parts equal the whole.
#[test]
fn maps_name_existing_voxels_near_the_ray() {
    let grid = scenes::cheese(64, 30, 2).unwrap();
    let (normals, levels) = smooth(&grid);
    for direction in [Vec3::new(0.8, 0.6, 1.0), Vec3::X, -Vec3::Y] {
        let rays = rays_at(&grid, 40.0, direction);
        let mut sampler = LevelSampler::default();
        let mut map = IndexMap::new(rays);
        sampler.sample(&grid, &normals, &levels, &rays, &mut map);
        assert!(map.covered() > 4000);
        for (i, (&voxel, &normal)) in map.voxels.iter().zip(&map.normals).enumerate() {
            assert_eq!(voxel == NO_VOXEL, normal == u16::MAX, "pixel {i}");
            if voxel != NO_VOXEL {
                let v = grid.voxel_coords(voxel);
                assert!(grid.get(v.as_ivec3()));
                let (x, y) = (i as u32 % rays.size.x, i as u32 / rays.size.x);
                let ray = rays.direction(x, y).normalize();
                let offset = v.as_vec3() + 0.5 - rays.origin;
                let distance = (offset - ray * offset.dot(ray)).length();
                assert!(distance < 1.74, "{distance}");
            }
        }
        // A closed surface has no holes: a pixel without a voxel has at most few neighbours with one.
        let (width, lone) = (rays.size.x as usize, |i: &usize| {
            let around = [i - 1, i + 1, i - rays.size.x as usize, i + rays.size.x as usize];
            map.voxels[*i] == NO_VOXEL && around.iter().all(|j| map.voxels[*j] != NO_VOXEL)
        });
        let inner = width + 1..map.voxels.len() - width - 1;
        assert_eq!(inner.filter(lone).count(), 0, "{direction}");
        let whole = map.clone();
        map.voxels.fill(0);
        for (low, high) in [([0, 0], [70, 120]), ([70, 0], [400, 50]), ([70, 50], [160, 120])] {
            let rect = PixelRect { min: UVec2::from(low), max: UVec2::from(high) };
            sampler.sample_rect(&grid, &normals, &levels, rect, &mut map);
        }
        assert!(map == whole);
    }
}

/// On a flat face of cubes, the mean of the voxels named over many samples is the visible point, so that colours are
/// interpolated; those of sample 0 are the nearest.
#[test]
fn samples_name_voxels_by_their_share() {
    let grid = grid_of(32, |at| (at - 16.0).abs().max_element() < 8.0);
    let (normals, levels) = smooth(&grid);
    let rays = rays_at(&grid, 16.0, Vec3::Z);
    let mut sampler = LevelSampler::default();
    let mut maps = [(); 17].map(|()| IndexMap::new(rays));
    for (i, map) in (0..).zip(&mut maps) {
        sampler.sample = i;
        sampler.sample(&grid, &normals, &levels, &rays, map);
    }
    let (nearest, others) = maps.split_first().unwrap();
    let mut worst = 0f32;
    let mut count = 0;
    for i in 0..nearest.voxels.len() {
        let direction = rays.direction(i as u32 % rays.size.x, i as u32 / rays.size.x);
        // The upper face lies at a height of 24 voxels.
        let seen = rays.origin + direction * ((24.0 - rays.origin.z) / direction.z);
        if (seen.truncate() - 16.0).abs().max_element() > 4.0 {
            continue;
        }
        count += 1;
        let middle = |map: &IndexMap| grid.voxel_coords(map.voxels[i]).as_vec3() + 0.5;
        assert!((middle(nearest) - seen).truncate().abs().max_element() < 0.51, "{seen}");
        let mean = others.iter().map(middle).sum::<Vec3>() / others.len() as f32;
        worst = worst.max((mean - seen).truncate().abs().max_element());
    }
    assert!(count > 500 && worst < 0.2, "{count} pixels, {worst}");
}

proptest! {
    /// Compares the first change of sign on a path through a cell with many small steps.
    #[test]
    fn roots_are_the_first_change_of_sign(
        corners in prop::array::uniform8(-127f32..127.0),
        begin in prop::array::uniform3(0f32..1.0),
        end in prop::array::uniform3(0f32..1.0),
    ) {
        let (begin, end) = (Vec3::from(begin), Vec3::from(end));
        let at = |s: f32| {
            let p = begin.lerp(end, s);
            (0..8).map(|i| {
                let c = corner(i).as_vec3();
                let share = Vec3::select(c.cmpeq(Vec3::ONE), p, 1.0 - p);
                corners[i] * share.element_product()
            }).sum::<f32>()
        };
        let expected = (0..=2000).map(|i| i as f32 / 2000.0).find(|s| at(*s) <= 0.0);
        match (first_root(&corners, begin, end), expected) {
            (Some(found), Some(expected)) => {
                // A root that only just touches 0 may be missed.
                prop_assert!(found < expected + 2e-3 || at(expected) > -0.5, "{found} {expected}");
                prop_assert!(at(found).abs() < 1.0 || found == 0.0, "{} at {}", at(found), found);
            }
            (None, Some(s)) => prop_assert!(at(s) > -0.1, "{} at {}", at(s), s),
            (Some(s), None) => prop_assert!(at(s) < 0.1),
            (None, None) => {}
        }
    }
}

#[test]
fn the_longest_grids_have_a_smooth_surface_and_those_with_too_many_cells_for_rays_have_levels() {
    let dims = UVec3::new(4096, 24, 24);
    let middle = Vec3::new(4084.0, 12.0, 12.0);
    let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
    for i in 0..24 * 24 * 24 {
        let v = IVec3::new(4072 + i % 24, i / 24 % 24, i / 576);
        grid.set(v, (v.as_vec3() + 0.5).distance(middle) < 9.0);
    }
    let (normals, levels) = smooth(&grid);
    let eye = middle + Vec3::new(-40.0, 3.0, 60.0);
    let rays = PixelRays {
        origin: eye,
        corner: (middle - eye) / 60.0 - Vec3::new(0.12, 0.09, 0.0),
        step_x: Vec3::X * 0.004,
        step_y: Vec3::Y * 0.004,
        size: UVec2::new(60, 45),
    };
    let mut map = IndexMap::new(rays);
    LevelSampler::default().sample(&grid, &normals, &levels, &rays, &mut map);
    let seen = map.voxels.iter().filter(|&&voxel| voxel != NO_VOXEL);
    let far = seen.clone().map(|&voxel| grid.voxel_coords(voxel).as_vec3() + 0.5 - middle);
    assert!(seen.count() > 300 && far.into_iter().all(|v| (7.0..9.0).contains(&v.length())));
}

/// The smooth surface takes memory for the surface alone, whatever the size of the grid, and follows edits there.
#[test]
fn the_largest_grid_has_a_smooth_surface_within_a_budget() {
    let mut grid = Grid::of_size(UVec3::splat(MAX_AXIS_VX), Vec3::ONE).unwrap();
    let middle = IVec3::new(8100, 70, 4096);
    let ball = |radius: i32| {
        let side = -radius..=radius;
        let all = side.clone().flat_map(move |z| {
            let side = -radius..=radius;
            side.clone().flat_map(move |y| side.clone().map(move |x| IVec3::new(x, y, z)))
        });
        all.filter(move |v| v.length_squared() <= radius * radius).map(move |v| middle + v)
    };
    ball(20).for_each(|v| grid.set(v, true));
    let (normals, mut levels) = smooth(&grid);
    assert!(levels.heap_bytes() < 24 << 20, "{}", levels.heap_bytes());
    // At the surface, inside and outside.
    let level = |levels: &LevelSet, grid: &Grid, x: i32| levels.level(grid, middle + IVec3::X * x);
    assert_eq!([0, 40].map(|x| level(&levels, &grid, x)), [-FAR, FAR]);
    let at_surface = [20, 21].map(|x| f32::from(level(&levels, &grid, x)) / PackedDepth::PER_VX);
    assert!(at_surface[0] < 0.0 && at_surface[0] > -1.0, "{at_surface:?}");
    assert!(at_surface[1] > 0.0 && at_surface[1] < 1.0, "{at_surface:?}");
    // Without the ball, nothing is near anywhere.
    let mut emptied = grid.clone();
    ball(20).for_each(|v| emptied.set(v, false));
    let changed: Vec<u32> =
        grid.nonempty_bricks().map(|(b, _)| grid.brick_index(b) as u32).collect();
    let mut normals = normals;
    normals.follow(&emptied, Some(&changed));
    let mut reshaded = changed.clone();
    normals.update(&emptied, &mut reshaded, || true);
    levels.follow(&emptied, &reshaded);
    levels.update(&emptied, &normals, &mut Vec::new());
    assert_eq!([0, 20, 21].map(|x| level(&levels, &emptied, x)), [FAR; 3]);
    assert!(levels.cells().opaque_count() == 0);
    // A sculpture whose surface takes too much is refused before anything is allocated.
    let refused = LevelSet::whole(&grid, 64 << 10).unwrap_err().to_string();
    assert!(
        refused.contains("smooth surface") && refused.contains("allowed for grids"),
        "{refused}"
    );
}

#[test]
fn bricks_amid_others_of_their_kind_have_no_levels() {
    let dims = UVec3::new(150, 133, 90);
    let grid_where = |inside: &dyn Fn(UVec3) -> bool| {
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
        let voxels = (0..dims.element_product()).map(|index| grid.voxel_coords(index));
        let inside: Vec<IVec3> = voxels.filter(|v| inside(*v)).map(|v| v.as_ivec3()).collect();
        inside.into_iter().for_each(|v| grid.set(v, true));
        grid
    };
    let ball = |v: UVec3, radius: f32| (v.as_vec3() - 70.5).length() < radius;
    let grids = [
        grid_where(&|_| true),
        grid_where(&|_| false),
        grid_where(&|v| !ball(v, 30.0)),
        grid_where(&|v| ball(v, 60.0)),
        grid_where(&|v| v == UVec3::new(64, 63, 16) || v.cmpge(dims - 1).all()),
        // Up to one layer of voxels before the border, and to one of bricks.
        grid_where(&|v| v.x > 0 && v.y < 128 && v.z < 89),
    ];
    for (at, grid) in grids.iter().enumerate() {
        let normals = NormalField::of(grid);
        let near = bricks_near_surface(grid);
        for b in (0..grid.brick_count()).map(|index| grid.brick_coords(index)) {
            if Band::of(grid, &normals, b).is_some() {
                let in_leaf = near.iter().find(|(leaf, _)| *leaf == b / 8);
                let [x, y, z] = (b % 8).to_array();
                assert!(in_leaf.is_some_and(|(_, bricks)| bricks.get(x, y, z)), "grid {at}: {b}");
            }
        }
        let levels = LevelSet::whole(grid, 1 << 30).unwrap();
        let mut cells = levels.cells().emptied();
        cells.fill_bricks(|b| cells_at(grid, b.as_ivec3()));
        assert_eq!(levels.cells(), &cells, "grid {at}");
    }
    assert!(bricks_near_surface(&grids[1]).is_empty());
    // Of the full one, the two outermost layers.
    let near = bricks_near_surface(&grids[0]);
    let count: u32 = near.iter().map(|(_, bricks)| u32::from(bricks.count())).sum();
    assert_eq!(count, 19 * 17 * 12 - 15 * 13 * 8);
}

/// Samples a picture as a window does, which stops computing when a frame ends. Returns the number of frames.
fn sample_by_and_by(
    sampler: &mut LevelSampler,
    grid: &Grid,
    (normals, levels): (&mut NormalField, &mut LevelSet),
    rays: &PixelRays,
    map: &mut IndexMap,
) -> u32 {
    map.reset_with_normals(grid.dims(), *rays);
    let rect = PixelRect::of_picture(rays.size);
    for frame in 1..1000 {
        let mut portions = 0..1;
        let mut goes_on = || portions.next().is_some();
        if sampler.complete_rect(grid, (normals, levels), rect, map, &mut goes_on) {
            return frame;
        }
    }
    panic!("not complete within 1000 frames");
}

/// Pictures for which levels are computed as their rays meet them, at once or by and by, are those of complete levels:
/// from afar, near and aslant along the surface, before and after edits, and for each sample of an antialiased picture.
#[test]
fn what_a_picture_computes_on_the_way_is_what_it_shows() {
    let mut grid = scenes::cheese(150, 60, 3).unwrap();
    let mut normals = NormalField::default();
    normals.follow(&grid, None);
    let mut levels = LevelSet::new(&grid, 1 << 30).unwrap();
    let all = levels.outstanding();
    let mut sampler = LevelSampler::default();
    let aslant = PixelRays {
        origin: Vec3::new(-20.0, 151.0, 75.0),
        corner: Vec3::new(1.0, -0.06, -0.3),
        step_x: Vec3::Z * 0.004,
        step_y: Vec3::Y * -0.001,
        size: UVec2::new(160, 120),
    };
    let views = [
        aslant,
        rays_at(&grid, 70.0, Vec3::new(0.8, 0.6, 1.0)),
        rays_at(&grid, 20.0, Vec3::new(-0.1, 0.2, -1.0)),
        rays_at(&grid, 250.0, Vec3::NEG_X),
    ];
    let (mut first, mut frames) = (None, Vec::new());
    for (round, rays) in views.iter().chain(&views).enumerate() {
        let mut map = IndexMap::new(*rays);
        sampler.sample = round as u32;
        let surface = (&mut normals, &mut levels);
        if round % 2 == 1 {
            frames.push(sample_by_and_by(&mut sampler, &grid, surface, rays, &mut map));
        } else {
            sampler.sample_completing(&grid, surface, rays, &mut map);
        }
        let (whole_normals, whole) = smooth(&grid);
        let mut expected = IndexMap::new(*rays);
        let mut other = LevelSampler::default();
        other.sample = round as u32;
        other.sample(&grid, &whole_normals, &whole, rays, &mut expected);
        assert!(map.voxels == expected.voxels, "round {round}: other voxels");
        assert!(map.normals == expected.normals, "round {round}: other normals");
        let seen = map.voxels.iter().filter(|voxel| **voxel != NO_VOXEL).count();
        assert!(seen > 500, "round {round}: {seen} pixels");
        first.get_or_insert(all - levels.outstanding());
        // An edit in the middle of the picture.
        let hit = map.get(rays.size.x / 2, rays.size.y / 2);
        let middle = hit.map_or(IVec3::splat(75), |voxel| grid.voxel_coords(voxel).as_ivec3());
        let mut edited = Vec::new();
        for z in -9..=9 {
            for y in -9..=9 {
                for x in -9..=9 {
                    let v = middle + IVec3::new(x, y, z);
                    if grid.contains(v) && IVec3::new(x, y, z).length_squared() < 81 {
                        grid.set(v, round % 2 == 1);
                        edited.push(grid.brick_index(v.as_uvec3() / 8) as u32);
                    }
                }
            }
        }
        edited.sort_unstable();
        edited.dedup();
        normals.follow(&grid, Some(&edited));
        levels.follow_edits(&grid, &edited);
    }
    assert!(frames[1] > 1, "frames for each of some pictures: {frames:?}");
    let first = first.unwrap();
    assert!(first > 0 && first < all / 2, "{first} of {all} bricks for the first picture");
}
