//! Tests of pictures after edits, with estimated or deferred normals; in the end all are refined.

use std::collections::BTreeSet;

use glam::UVec2;

use super::*;
use crate::sculpture::{NO_VOXEL, Placement};
use crate::surface::{IndexMap, PixelRect, PixelRects, changed_pixels, raycast};
use crate::view::{Camera, PixelRays};

fn rays(grid: &Grid) -> PixelRays {
    rays_of(grid, UVec2::new(160, 120))
}

fn rays_of(grid: &Grid, size: UVec2) -> PixelRays {
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    let eye = Camera::framing(90.0, Vec3::new(0.8, 0.6, 1.0), Vec3::Y).eye(size);
    eye.pixel_rays(&world_from_grid)
}

/// Sets the voxels of a ball. Returns the bricks that it may have changed.
fn ball(grid: &mut Grid, centre: IVec3, radius_vx: i32, exists: bool) -> Vec<u32> {
    let mut changed = BTreeSet::new();
    let edge = 2 * radius_vx + 1;
    for i in 0..edge * edge * edge {
        let offset = IVec3::new(i % edge, i / edge % edge, i / (edge * edge)) - radius_vx;
        if offset.length_squared() <= radius_vx * radius_vx && grid.contains(centre + offset) {
            grid.set(centre + offset, exists);
            changed.insert(grid.brick_index((centre + offset).as_uvec3() / 8) as u32);
        }
    }
    changed.into_iter().collect()
}

/// Carves and fills in view, and calls `check` with the grid, the field, the index map, the bricks that changed and
/// those that the field reported.
fn edit(
    precision: Precision,
    mut check: impl FnMut(&Grid, &NormalField, &IndexMap, &[u32], &[u32]),
) {
    let mut grid = scenes::cheese(120, 40, 3).unwrap();
    let rays = rays(&grid);
    let mut map = IndexMap::new(rays);
    raycast::sample(&grid, &rays, &mut map);
    let mut field = NormalField::of(&grid);
    let (mut random, mut deferred) = (Random(5), Vec::new());
    for edit in 0..8 {
        let hit = raycast::cast(&grid, rays.origin, rays.direction(40 + 10 * edit, 60)).unwrap();
        let centre = hit.voxel.as_ivec3() + random.voxel(UVec3::splat(9)) - 4;
        let changed = ball(&mut grid, centre, 11, edit % 3 == 2);
        field.follow(&grid, Some(&changed));
        raycast::sample(&grid, &rays, &mut map);
        let pixels = changed_pixels(&grid, &changed, &rays, 16);
        let mut reported = Vec::new();
        field.update_seen(&grid, [(&map, pixels)], precision, &mut reported);
        assert!(!field.has_estimates());
        deferred.push(field.deferred());
        check(&grid, &field, &map, &changed, &reported);
    }
    assert!(deferred.iter().all(|count| *count > 20), "{deferred:?}");
    let mut changed = Vec::new();
    field.update_deferred(&grid, &mut changed, || true);
    assert!(field.is_complete() && changed.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(pictures(&grid, &field), pictures(&grid, &NormalField::of(&grid)));
}

/// Returns the voxels of a map, with their bricks.
fn seen<'a>(grid: &'a Grid, map: &'a IndexMap) -> impl Iterator<Item = (UVec3, usize)> {
    let voxels = map.voxels.iter().filter(|voxel| **voxel != NO_VOXEL);
    let seen = voxels.map(|&voxel| grid.voxel_coords(voxel));
    seen.map(|v| (v, grid.brick_index(v / 8)))
}

/// Returns the openness of a surface voxel.
fn openness(field: &NormalField, v: UVec3) -> Option<u8> {
    field.record(v / 8, v % 8).map(SurfaceRecord::openness)
}

#[test]
fn visible_bricks_are_up_to_date_after_edits_and_the_rest_follows() {
    edit(Precision::Refined, |grid, field, map, _, _| {
        let whole = NormalField::of(grid);
        let openness = |field: &NormalField, v: UVec3| openness(field, v);
        for (v, _) in seen(grid, map) {
            assert_eq!(field.packed(v / 8, v % 8), whole.packed(v / 8, v % 8), "{v}");
            assert_eq!(openness(field, v), openness(&whole, v), "{v}");
        }
    });
}

#[test]
fn prompt_pictures_show_first_estimates_where_bits_have_changed_and_refine_them_later() {
    let estimates_of = |grid: &Grid| {
        let mut field = NormalField::default();
        field.follow(grid, None);
        field.compute(Level::new(), grid, &nonempty(grid), Precision::Estimated, &mut Vec::new());
        field
    };
    let grid = scenes::cheese(120, 40, 3).unwrap();
    let mut before = pictures(&grid, &NormalField::of(&grid));
    let (mut estimated, mut refined) = (0, 0);
    edit(Precision::Estimated, |grid, field, map, changed, reported| {
        let (first, whole) = (estimates_of(grid), NormalField::of(grid));
        let changed: Vec<_> = changed.iter().map(|b| grid.brick_coords(*b as usize)).collect();
        let near = |brick: UVec3| {
            let distance = |b: &UVec3| (b.as_ivec3() - brick.as_ivec3()).abs().max_element();
            changed.iter().any(|b| distance(b) <= 1)
        };
        let now = pictures(grid, field);
        let openness = |field: &NormalField, v: UVec3| openness(field, v);
        for (v, brick) in seen(grid, map) {
            let shown = field.packed(v / 8, v % 8);
            let values = [&first, &whole].map(|field| field.packed(v / 8, v % 8));
            if near(v / 8) {
                assert!(values.contains(&shown), "{v}");
                let known = [&first, &whole].map(|field| openness(field, v));
                assert!(known.contains(&openness(field, v)), "{v}");
                estimated += u32::from(shown == values[0]);
            } else if shown != values[1] {
                // As it was, and still to be refined.
                assert!(field.table().is_outstanding(v / 8), "{v}");
            }
            refined += u32::from(shown == values[1]);
            let is_told = reported.contains(&(brick as u32));
            assert!(is_told || now[brick] == before[brick], "{v}");
        }
        before = now;
    });
    assert!(estimated > 1000 && refined > 1000, "{estimated} {refined}");
}

/// An edit of which nothing is visible defers more than one picture can wait for: the rest follows in portions.
#[test]
fn very_many_bricks_that_were_put_off_are_computed_in_portions() {
    let (before, grid) = (scenes::cheese(160, 40, 3).unwrap(), scenes::cheese(160, 60, 4).unwrap());
    let mut field = NormalField::of(&before);
    let all: Vec<u32> = (0..grid.brick_count() as u32).collect();
    for _ in 0..2 {
        // The second time nothing is new.
        field.follow(&grid, Some(&all));
        field.update_seen(&grid, [], Precision::Refined, &mut Vec::new());
        assert!(field.deferred() > MOST_AT_ONCE && !field.has_estimates());
    }
    let mut updates = 0;
    while !field.is_complete() {
        let mut portions = 0..2;
        field.update(&grid, &mut Vec::new(), || portions.next().is_some());
        updates += 1;
    }
    assert!(updates > 1);
    assert_eq!(pictures(&grid, &field), pictures(&grid, &NormalField::of(&grid)));
}

/// After an undo of many edits at once, of which a picture shows very many bricks, neither that picture nor those of
/// the next edits wait for more than their visible bricks; visible bricks are at least estimated, and all are refined
/// in the end.
#[test]
fn edits_after_a_change_of_very_many_visible_bricks_are_prompt() {
    let mut grid = Grid::new(UVec3::new(560, 24, 560), Vec3::ONE, 1 << 30).unwrap();
    grid.fill_bricks(|_| Brick::FULL);
    let mut field = NormalField::of(&grid);
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    let eye = Camera::framing(600.0, Vec3::Y, Vec3::Z).eye(UVec2::splat(480));
    let rays = eye.pixel_rays(&world_from_grid);
    let mut map = IndexMap::new(rays);
    let mut all = BTreeSet::new();
    for (x, z) in (0..560).flat_map(|x| (0..560).map(move |z| (x, z))) {
        grid.set(IVec3::new(x, 23, z), (x + z) % 7 < 3);
        all.insert(grid.brick_index(UVec3::new(x as u32, 23, z as u32) / 8) as u32);
    }
    let mut show = |grid: &Grid, field: &mut NormalField, changed: &[u32]| {
        field.follow(grid, Some(changed));
        raycast::sample(grid, &rays, &mut map);
        let pixels = changed_pixels(grid, changed, &rays, 16);
        let mut reported = Vec::new();
        field.update_seen(grid, [(&map, pixels)], Precision::Estimated, &mut reported);
        assert!(!field.has_estimates(), "no shader has to find normals itself");
        let shown: BTreeSet<usize> = seen(grid, &map).map(|(_, brick)| brick).collect();
        assert!(shown.iter().all(|brick| page(grid, field, *brick) != NO_PAGE));
        (shown.len(), reported.len())
    };
    let all: Vec<u32> = all.into_iter().collect();
    let (shown, _) = show(&grid, &mut field, &all);
    assert!(shown > MOST_AT_ONCE, "{shown} bricks");
    let changed = ball(&mut grid, IVec3::new(280, 23, 280), 30, false);
    let (_, computed) = show(&grid, &mut field, &changed);
    assert!((1..400).contains(&computed), "{computed} bricks");
    field.update_deferred(&grid, &mut Vec::new(), || true);
    assert!(field.is_complete());
    assert_eq!(pictures(&grid, &field), pictures(&grid, &NormalField::of(&grid)));
}

/// A single picture of an opened sculpture computes the normals that it shows and no others. Edits before the next
/// picture, and all others in the end, lose nothing of it.
#[test]
fn a_single_picture_computes_the_normals_that_it_shows() {
    let mut grid = scenes::cheese(120, 40, 3).unwrap();
    let rays = rays(&grid);
    let mut map = IndexMap::new(rays);
    let mut field = NormalField::default();
    let mut changed = None;
    for centre in [IVec3::splat(60), IVec3::new(100, 110, 80), IVec3::splat(119)] {
        raycast::sample(&grid, &rays, &mut map);
        field.follow(&grid, changed.as_deref());
        let mut reported = Vec::new();
        field.complete_seen(&grid, [&map], &mut reported, || true);
        let whole = NormalField::of(&grid);
        for (v, _) in seen(&grid, &map) {
            assert_eq!(field.packed(v / 8, v % 8), whole.packed(v / 8, v % 8), "{v}");
            assert_eq!(openness(&field, v), openness(&whole, v), "{v}");
            assert!(!field.is_estimated(v / 8));
        }
        let shown: BTreeSet<_> = seen(&grid, &map).map(|(_, brick)| brick as u32).collect();
        assert!(reported.iter().all(|brick| shown.contains(brick)));
        let [computed, all] = [&field, &whole].map(|field| page_count(&grid, field));
        assert!(computed < all / 2 && !field.is_complete(), "{computed} of {all}");
        reported.clear();
        field.complete_seen(&grid, [&map], &mut reported, || true);
        assert!(reported.is_empty(), "nothing is computed twice");
        changed = Some(ball(&mut grid, centre, 20, false));
    }
    field.follow(&grid, changed.as_deref());
    field.update(&grid, &mut Vec::new(), || true);
    assert!(field.is_complete());
    assert_eq!(pictures(&grid, &field), pictures(&grid, &NormalField::of(&grid)));
}

/// A picture whose pixels span several voxels has first estimates, of the bits as they are after edits, too; a nearer
/// one has refined normals. In the end nothing is left of the estimates.
#[test]
fn a_picture_from_afar_has_first_estimates() {
    let mut grid = scenes::cheese(120, 40, 3).unwrap();
    let [far, near] = [UVec2::new(28, 21), UVec2::new(160, 120)].map(|size| rays_of(&grid, size));
    let mut field = NormalField::default();
    let mut changed = None;
    let show = |grid: &Grid, field: &mut NormalField, rays: &PixelRays| {
        let mut map = IndexMap::new(*rays);
        raycast::sample(grid, rays, &mut map);
        field.complete_seen(grid, [&map], &mut Vec::new(), || true);
        map
    };
    for centre in [IVec3::splat(60), IVec3::new(100, 110, 80), IVec3::splat(119)] {
        field.follow(&grid, changed.as_deref());
        let map = show(&grid, &mut field, &far);
        let mut estimated = NormalField::default();
        estimated.follow(&grid, None);
        let all = nonempty(&grid);
        estimated.compute(Level::new(), &grid, &all, Precision::Estimated, &mut Vec::new());
        for (v, _) in seen(&grid, &map) {
            assert_eq!(field.packed(v / 8, v % 8), estimated.packed(v / 8, v % 8), "{v}");
            assert_eq!(openness(&field, v), openness(&estimated, v), "{v}");
        }
        let whole = NormalField::of(&grid);
        let refined = |v| whole.packed(v / 8, v % 8) == estimated.packed(v / 8, v % 8);
        assert!(!seen(&grid, &map).all(|(v, _)| refined(v)), "the two differ");
        let before = pictures(&grid, &field);
        show(&grid, &mut field, &far);
        assert_eq!(before, pictures(&grid, &field), "the same picture again");
        let mut nearer = NormalField::default();
        nearer.follow(&grid, None);
        show(&grid, &mut nearer, &far);
        let map = show(&grid, &mut nearer, &near);
        for (v, _) in seen(&grid, &map) {
            assert_eq!(nearer.packed(v / 8, v % 8), whole.packed(v / 8, v % 8), "{v}");
        }
        changed = Some(ball(&mut grid, centre, 20, false));
    }
    field.follow(&grid, changed.as_deref());
    field.update(&grid, &mut Vec::new(), || true);
    assert!(field.is_complete());
    assert_eq!(pictures(&grid, &field), pictures(&grid, &NormalField::of(&grid)));
}

/// Returns the map of a picture of a cheese from one side.
fn map_from(grid: &Grid, towards: Vec3) -> IndexMap {
    let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
    let eye = Camera::framing(90.0, towards, Vec3::Y).eye(UVec2::new(160, 120));
    let rays = eye.pixel_rays(&world_from_grid);
    let mut map = IndexMap::new(rays);
    raycast::sample(grid, &rays, &mut map);
    map
}

/// With a bound, pictures have all normals that they show, those shown longest ago give their memory to others, and a
/// copy that follows what is reported stays the same as the field. Without it, all are computed again.
#[test]
fn with_a_bound_the_normals_seen_last_are_kept() {
    let mut grid = scenes::cheese(200, 60, 3).unwrap();
    let whole = NormalField::of(&grid);
    let sides = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let maps = sides.map(|side| map_from(&grid, side));
    let bytes_of = |map: &IndexMap| {
        let mut field = NormalField::default();
        field.follow(&grid, None);
        field.complete_seen(&grid, [map], &mut Vec::new(), || true);
        (field.pages().used_bytes() + field.table().page_bytes()) as u64
    };
    let most = maps.iter().map(bytes_of).max().unwrap();
    let limit = 2 * most;
    assert!(limit < whole.heap_bytes() / 2, "{limit} of {}", whole.heap_bytes());
    let mut field = NormalField::default();
    field.set_limit(limit);
    field.follow(&grid, None);
    let mut copy: Vec<u32> = field.table().linear();
    let (mut removed, mut last_count) = (0, 0);
    for (round, map) in maps.iter().chain(&maps).enumerate() {
        let mut changed = Vec::new();
        field.complete_seen(&grid, [map], &mut changed, || true);
        field.update(&grid, &mut changed, || true);
        assert!(field.is_settled() && !field.is_complete(), "round {round}");
        for (v, _) in seen(&grid, map) {
            assert_eq!(field.packed(v / 8, v % 8), whole.packed(v / 8, v % 8), "{round} {v}");
        }
        let used = (field.pages().used_bytes() + field.table().page_bytes()) as u64;
        assert!(used <= limit + most, "round {round}: {used} of {limit}");
        // A device knows what is reported.
        let table = field.table().linear();
        changed.iter().for_each(|&brick| copy[brick as usize] = table[brick as usize]);
        assert!(copy == table, "round {round}");
        let count = page_count(&grid, &field);
        removed += usize::from(count < last_count);
        last_count = count;
    }
    assert!(removed > 2, "removed {removed} times");
    // Edits in view, and then everything without a bound.
    let changed = ball(&mut grid, IVec3::new(196, 100, 100), 20, false);
    field.follow(&grid, Some(&changed));
    assert!(!field.is_settled());
    let map = map_from(&grid, Vec3::X);
    field.update_seen(
        &grid,
        [(&map, PixelRects::of(PixelRect::of_picture(map.rays.size)))],
        Precision::Refined,
        &mut Vec::new(),
    );
    field.complete_seen(&grid, [&map], &mut Vec::new(), || true);
    let whole = NormalField::of(&grid);
    for (v, _) in seen(&grid, &map) {
        assert_eq!(field.packed(v / 8, v % 8), whole.packed(v / 8, v % 8), "{v}");
    }
    field.set_limit(u64::MAX);
    field.update(&grid, &mut Vec::new(), || true);
    assert!(field.is_complete());
    assert_eq!(pictures(&grid, &field), pictures(&grid, &whole));
}
