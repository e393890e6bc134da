//! Tests solids of known thickness.

use glam::{Mat3, Quat};
use proptest::prelude::*;

use super::*;

const EDGE: u32 = 40;

fn grid(exists: impl Fn(Vec3) -> bool) -> Grid {
    let mut grid = Grid::new(UVec3::splat(EDGE), Vec3::ONE, 1 << 24).unwrap();
    for index in 0..EDGE.pow(3) {
        let v = grid.voxel_coords(index).as_ivec3();
        if exists(v.as_vec3() + 0.5 - EDGE as f32 * 0.5) {
            grid.set(v, true);
        }
    }
    grid
}

fn thin_count(grid: &Grid, thickness: f32) -> u64 {
    let thickness = Thickness::new(thickness, grid.voxel_size()).unwrap();
    let thin = thickness.thin(grid, &()).unwrap();
    thin.bricks().iter().map(|(_, mask)| u64::from(mask.count())).sum()
}

/// Returns a grid of the voxels that are thin.
fn thin_voxels(grid: &Grid, thickness: &Thickness) -> Grid {
    let mut thin = grid.emptied();
    let listed = thickness.thin(grid, &()).unwrap();
    listed.bricks().iter().for_each(|(b, mask)| thin.put_brick(*b, mask));
    thin
}

fn thickened(mut grid: Grid, thickness: f32) -> Grid {
    let added = Thickness::new(thickness, grid.voxel_size()).unwrap().thicken(&grid, &()).unwrap();
    for (b, mask) in added.bricks(grid.brick_dims()) {
        let index = grid.brick_index(b);
        assert_eq!(mask.and(grid.brick(b)).count() + mask.and_not(&grid.valid_mask(b)).count(), 0);
        grid.set_brick(index, mask.or(grid.brick(b)));
    }
    grid
}

/// Returns a slab of `count` layers along an axis, from the layer `first` on.
fn slab(axis: usize, first: f32, count: u32) -> Grid {
    grid(|p| p[axis] > first && p[axis] < first + count as f32 && p.abs().max_element() < 16.0)
}

#[test]
fn slabs_are_thin_below_the_thickness_exactly() {
    for axis in 0..3 {
        for count in 1..=6 {
            let slab = slab(axis, -3.0, count);
            for wanted in [0.7, 1.0, 2.0, 2.4, 3.0, 3.1, 4.0, 5.0, 5.5, 6.0, 7.0] {
                let thin = thin_count(&slab, wanted);
                let expected = if (count as f32) < wanted { slab.opaque_count() } else { 0 };
                assert_eq!(thin, expected, "axis {axis}, {count} voxels, wanted {wanted}");
            }
        }
    }
}

#[test]
fn thick_bodies_with_edges_corners_and_curves_have_no_thin_walls() {
    let solids = [
        grid(|p| p.abs().max_element() < 12.0),
        grid(|p| p.length() < 13.0),
        grid(|p| p.x.hypot(p.z) < 11.0 && p.y.abs() < 10.0),
        // A hole, a notch and a step leave walls of eight voxels and more.
        grid(|p| p.abs().max_element() < 16.0 && p.x.hypot(p.y) > 7.0),
        grid(|p| p.abs().max_element() < 16.0 && (p.x < -4.0 || p.y < 2.0)),
    ];
    for (i, solid) in solids.iter().enumerate() {
        for wanted in [1.0, 2.0, 3.0, 4.5, 6.0, 8.0] {
            assert_eq!(thin_count(solid, wanted), 0, "solid {i}, wanted {wanted}");
        }
    }
}

#[test]
fn wires_and_fins_are_thin_and_what_carries_them_is_not() {
    let wire = grid(|p| p.x.abs() < 1.0 && p.z.abs() < 1.0);
    assert_eq!(thin_count(&wire, 2.0), 0);
    assert_eq!(thin_count(&wire, 3.0), wire.opaque_count());
    let on_a_cube = grid(|p| {
        let fin = p.x.abs() < 1.0 && p.y >= 4.0 && p.y < 14.0 && p.z.abs() < 8.0;
        fin || p.y < 4.0 && p.abs().max_element() < 14.0
    });
    let thickness = Thickness::new(4.0, Vec3::ONE).unwrap();
    let thin = thin_voxels(&on_a_cube, &thickness);
    // All of the fin except its foot: the cap of a ball in the cube is two voxels wide, too, and the tolerance counts
    // from there.
    assert_eq!(thin.opaque_count(), 2 * 16 * (10 - 1 - u64::from(thickness.tolerance)));
    assert!(!thin.get(IVec3::new(20, 10, 20)) && thin.get(IVec3::new(20, 33, 20)));
}

#[test]
fn flat_voxels_are_measured_in_their_own_unit() {
    let mut grid = Grid::new(UVec3::new(24, 24, 24), Vec3::new(1.0, 0.25, 1.0), 1 << 24).unwrap();
    for (x, z) in (0..24).flat_map(|x| (0..24).map(move |z| (x, z))) {
        (8..12).for_each(|y| grid.set(IVec3::new(x, y, z), true));
    }
    assert_eq!(thin_count(&grid, 1.0), 0);
    assert_eq!(thin_count(&grid, 1.2), grid.opaque_count());
}

#[test]
fn nothing_and_everything_have_no_thin_walls() {
    assert_eq!(thin_count(&grid(|_| false), 3.0), 0);
    assert_eq!(thin_count(&grid(|_| true), 3.0), 0);
    let empty = Thickness::new(3.0, Vec3::ONE).unwrap().thicken(&grid(|_| false), &()).unwrap();
    assert_eq!(empty.count(), 0);
}

#[test]
fn thickened_slabs_are_as_thick_as_wanted_or_a_voxel_thicker() {
    for count in 1..=4 {
        for wanted in 2..=6 {
            let before = slab(0, -2.0, count);
            let after = thickened(before.clone(), wanted as f32);
            let through =
                |grid: &Grid| (0..40).filter(|x| grid.get(IVec3::new(*x, 20, 20))).count();
            let expected = if count >= wanted { count..=count } else { wanted..=wanted + 1 };
            assert!(expected.contains(&(through(&after) as u32)), "{count} to {wanted}");
            assert_eq!(thin_count(&after, wanted as f32), 0);
            if count >= wanted {
                assert_eq!(after, before);
            }
        }
    }
}

#[test]
fn walls_at_the_border_grow_inwards_and_nothing_grows_below_the_bed() {
    let wall = grid(|p| p.x < -19.0);
    let after = thickened(wall, 4.0);
    assert_eq!(thin_count(&after, 4.0), 0);
    assert!((0..4).all(|x| after.get(IVec3::new(x, 20, 20))));
    let plate = thickened(slab(1, -10.0, 1), 5.0);
    assert_eq!(plate.opaque_bounds().unwrap().0.y, 10);
    assert_eq!(thin_count(&plate, 5.0), 0);
}

/// A case found by [`whatever_was_thickened_is_thick`]: balls cut off by the bed left three voxels thin.
#[test]
fn bits_on_the_bed_become_thick() {
    let bits = [
        ([22.93717, 12.0, 12.7807], [19.993093, 13.818813, 16.275314], 4.845193),
        ([1.0, 1.0, 1.0], [39.0, 2.0, 39.0], 5.0),
        ([0.5, 0.5, 0.5], [0.5, 0.5, 0.5], 6.0),
    ];
    for (a, b, wanted) in bits {
        let solid = grid(|p| {
            [a, b].map(Vec3::from).into_iter().any(|centre: Vec3| {
                let d = p + EDGE as f32 * 0.5 - centre;
                d.length() < 0.6 || d.abs().max_element() < 6.0 && d.abs().min_element() < 0.6
            })
        });
        assert_eq!(thin_count(&thickened(solid, wanted), wanted), 0, "{a:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// At any rotation, two voxels more or less than wanted decide: across some slopes a digital ball is up to 1.6
    /// voxels thinner than it should be, where its outermost voxels just miss the surface.
    #[test]
    fn sloping_walls_are_measured_to_two_voxels(
        turn in prop::array::uniform3(-3.2f32..3.2), wanted in 3f32..7.0, at in -1f32..1.0,
    ) {
        let turn = Mat3::from_quat(Quat::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]));
        let across = turn.x_axis;
        let wall = |half: f32| grid(|p| (p.dot(across) + at).abs() < half && p.length() < 18.0);
        let thick = wall(0.5 * (wanted + 1.5));
        let inner = |grid: &Grid| -> u64 {
            let thin = thin_voxels(grid, &Thickness::new(wanted, Vec3::ONE).unwrap());
            let mut count = 0;
            for index in 0..EDGE.pow(3) {
                let v = grid.voxel_coords(index).as_ivec3();
                let p = v.as_vec3() + 0.5 - EDGE as f32 * 0.5;
                // Its rim is an edge that may be sharp.
                count += u64::from(p.length() < 12.0 && thin.get(v));
            }
            count
        };
        prop_assert_eq!(inner(&thick), 0);
        let thin = wall(0.5 * (wanted - 2.0));
        let there = grid(|p| (p.dot(across) + at).abs() < 0.5 * (wanted - 2.0) && p.length() < 12.0);
        prop_assert_eq!(inner(&thin), there.opaque_count());
    }

    /// Boxes at any rotation: neither edges nor corners nor the steps of their faces are thin.
    #[test]
    fn turned_boxes_have_no_thin_walls(turn in prop::array::uniform3(-3.2f32..3.2), wanted in 2f32..6.0) {
        let turn = Quat::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]);
        let turned = grid(|p| (turn * p).abs().max_element() < 10.0);
        prop_assert_eq!(thin_count(&turned, wanted), 0);
    }

    #[test]
    fn whatever_was_thickened_is_thick(
        seeds in prop::collection::vec((prop::array::uniform3(0f32..40.0), 0.5f32..4.0), 1..5), wanted in 2f32..5.0,
    ) {
        let solid = grid(|p| seeds.iter().any(|(c, r)| {
            let d = p + EDGE as f32 * 0.5 - Vec3::from(*c);
            d.length() < *r || d.abs().max_element() < 6.0 && d.abs().min_element() < 0.6
        }));
        prop_assert_eq!(thin_count(&thickened(solid, wanted), wanted), 0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn tiles_find_what_a_single_block_finds(
        dims in prop::array::uniform3(1u32..150),
        flat in 0usize..4,
        boxes in prop::collection::vec((prop::array::uniform3(0u32..150), prop::array::uniform3(1u32..40)), 0..8),
        filled: bool,
        wanted in 1.0f32..9.0,
    ) {
        let mut dims = UVec3::from(dims);
        if flat < 3 {
            dims[flat] = 5;
            dims[(flat + 1) % 3] = 400;
        }
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
        let (low, high) = (dims / 5, dims * 4 / 5);
        let in_box = |v: UVec3| {
            let hit = |(low, size): &([u32; 3], [u32; 3])| {
                v.cmpge(UVec3::from(*low)).all() && v.cmplt(UVec3::from(*low) + UVec3::from(*size)).all()
            };
            boxes.iter().filter(|cuboid| hit(cuboid)).count() % 2 == 1
        };
        for index in 0..grid.dims().element_product() {
            let v = grid.voxel_coords(index);
            let inside = filled && v.cmpge(low).all() && v.cmple(high).all();
            if inside != in_box(v) {
                grid.set(v.as_ivec3(), true);
            }
        }
        let thickness = Thickness::new(wanted, Vec3::ONE).unwrap();
        let (min, max) = grid.opaque_bounds().unwrap_or_default();
        let solid = BitBlock::of_grid(&grid, min.as_ivec3(), max.as_ivec3());
        let whole = thickness.thin_of(&solid, &()).unwrap();
        let whole = ListedBricks::new(whole.bricks(grid.brick_dims()));
        for most_leaves in [1, 2, 8] {
            prop_assert_eq!(&thickness.thin_by_tiles(&grid, most_leaves, &()).unwrap(), &whole);
        }
    }
}
