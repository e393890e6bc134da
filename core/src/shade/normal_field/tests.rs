//! Compares the field with its definition, with analytic surfaces, and after edits with a new one.

use glam::{IVec3, Mat3, Quat, UVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::scenes::{self, Random};
use crate::sculpture::Brick;
use crate::shade::occlusion::OpennessTables;

mod naive;
mod openness;
mod seen;

/// Returns a grid of the voxels whose centres are in a solid.
fn grid_of(edge_vx: u32, inside: impl Fn(Vec3) -> bool + Sync) -> Grid {
    let mut grid = Grid::new(UVec3::splat(edge_vx), Vec3::ONE, 1 << 30).unwrap();
    grid.fill_bricks(|b| {
        let mut brick = Brick::EMPTY;
        for i in 0..512 {
            let [x, y, z] = crate::sculpture::brick::local_coords(i);
            brick.set(x, y, z, inside((b * 8 + UVec3::new(x, y, z)).as_vec3() + 0.5));
        }
        brick
    });
    grid
}

/// Returns all surface voxels with their normals.
fn surface(grid: &Grid, field: &NormalField) -> Vec<(UVec3, Option<Vec3>)> {
    let mut all = Vec::new();
    for (b, brick) in grid.nonempty_bricks() {
        brick.for_each(|i| {
            let v = b * 8 + UVec3::from(crate::sculpture::brick::local_coords(i));
            let at = v.as_ivec3();
            let axes = [IVec3::X, IVec3::Y, IVec3::Z];
            if axes.iter().any(|&axis| !grid.get(at - axis) || !grid.get(at + axis)) {
                all.push((v, field.normal(v)));
            }
        });
    }
    all
}

/// Returns the mean and the 99th percentile.
fn spread(mut errors: Vec<f32>) -> (f32, f32) {
    errors.sort_by(f32::total_cmp);
    let mean = errors.iter().sum::<f32>() / errors.len() as f32;
    (mean, errors[errors.len() * 99 / 100])
}

fn direction(random: &mut Random) -> Vec3 {
    loop {
        let v = Vec3::new(random.unit(), random.unit(), random.unit()) * 2.0 - 1.0;
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

#[test]
fn balls_and_planes_have_normals_within_a_degree() {
    let mut random = Random(1);
    for radius in [16.0f32, 40.0] {
        let mut errors = Vec::new();
        for _ in 0..3 {
            let edge = 2 * radius as u32 + 8;
            let centre = Vec3::splat(edge as f32 / 2.0)
                + Vec3::new(random.unit(), random.unit(), random.unit());
            let grid = grid_of(edge, |p| p.distance(centre) <= radius);
            for (v, normal) in surface(&grid, &NormalField::of(&grid)) {
                let out = v.as_vec3() + 0.5 - centre;
                errors.push(normal.unwrap().angle_between(out).to_degrees());
            }
        }
        let (mean, most) = spread(errors);
        assert!(mean <= 1.0 && most <= 3.0, "radius {radius}: {mean} {most}");
    }
    let mut errors = Vec::new();
    for _ in 0..12 {
        let out = direction(&mut random);
        let at = Vec3::splat(32.0) + random.unit();
        let grid = grid_of(64, |p| (p - at).dot(out) <= 0.0);
        for (v, normal) in surface(&grid, &NormalField::of(&grid)) {
            if v.cmpge(UVec3::splat(18)).all() && v.cmplt(UVec3::splat(46)).all() {
                errors.push(normal.unwrap().angle_between(out).to_degrees());
            }
        }
    }
    let (mean, most) = spread(errors);
    assert!(mean <= 1.0 && most <= 3.0, "planes: {mean} {most}");
}

#[test]
fn the_faces_of_cubes_are_flat_up_to_two_voxels_from_their_edges() {
    let mut random = Random(2);
    let (mut far, mut near) = (Vec::new(), Vec::new());
    for turn in 0..4 {
        let axes = match turn {
            0 => Mat3::IDENTITY,
            _ => Mat3::from_quat(Quat::from_rotation_arc(
                direction(&mut random),
                direction(&mut random),
            )),
        };
        let (centre, half) = (Vec3::splat(32.0) + random.unit(), 15.3);
        let grid = grid_of(64, |p| (axes.transpose() * (p - centre)).abs().max_element() <= half);
        for (v, normal) in surface(&grid, &NormalField::of(&grid)) {
            let local = axes.transpose() * (v.as_vec3() + 0.5 - centre);
            let face = local.abs().max_position();
            let mut out = Vec3::ZERO;
            out[face] = local[face].signum();
            let error = normal.unwrap().angle_between(axes * out).to_degrees();
            let mut others = local.abs();
            others[face] = 0.0;
            match half - others.max_element() {
                3.0.. => far.push(error),
                2.0.. => near.push(error),
                _ => {}
            }
        }
    }
    let ((mean, most), (near_mean, _)) = (spread(far), spread(near));
    assert!(mean <= 1.0 && most <= 3.0, "faces: {mean} {most}");
    assert!(near_mean <= 3.0, "beside edges: {near_mean}");
}

#[test]
fn both_sides_of_thin_walls_and_wires_face_outwards() {
    let mut random = Random(3);
    for turn in 0..8 {
        let out = if turn < 3 { Vec3::AXES[turn] } else { direction(&mut random) };
        let centre = Vec3::splat(24.0) + Vec3::new(random.unit(), random.unit(), random.unit());
        for wire in [false, true] {
            let across = |p: Vec3| match wire {
                true => (p - centre).reject_from_normalized(out),
                false => (p - centre).project_onto_normalized(out),
            };
            let grid = grid_of(48, |p| across(p).length() <= if wire { 1.6 } else { 1.0 });
            for (v, normal) in surface(&grid, &NormalField::of(&grid)) {
                let off = across(v.as_vec3() + 0.5);
                let inner = v.cmpge(UVec3::splat(12)).all() && v.cmplt(UVec3::splat(36)).all();
                if inner && off.length() > 0.5 {
                    let normal = normal.unwrap();
                    assert!(normal.dot(off) > 0.0, "{v} of {out}: {normal} {off}");
                }
            }
        }
    }
}

#[test]
fn a_face_along_the_axes_has_its_exact_normal_and_borders_of_the_grid_are_faces() {
    let grid = scenes::solid_cube(32).unwrap();
    let field = NormalField::of(&grid);
    for axis in 0..3 {
        for (at, sign) in [(0, -1.0), (31, 1.0)] {
            let mut v = UVec3::new(15, 16, 17);
            v[axis] = at;
            assert_eq!(field.normal(v), Some(Vec3::AXES[axis] * sign));
        }
    }
    assert_eq!(field.normal(UVec3::splat(16)), None);
    let mut one = Grid::new(UVec3::splat(9), Vec3::ONE, 1 << 20).unwrap();
    one.set(IVec3::splat(4), true);
    assert_eq!(NormalField::of(&one).normal(UVec3::splat(4)), None, "no side is outside");
}

#[test]
fn the_field_is_its_definition() {
    let mut random = Random(4);
    let noise = grid_of(21, |p| (p.x * 7.0 + p.y * 13.0 + p.z * 29.0).sin() > 0.3);
    let thin = grid_of(24, |p| (p.x - p.y * 0.7).abs() < 1.0 || (p.z - 11.0).abs() < 1.0);
    for grid in [scenes::cheese(40, 12, 5).unwrap(), noise, thin] {
        let field = NormalField::of(&grid);
        let surface = surface(&grid, &field);
        let voxels: Vec<_> = surface.iter().map(|(v, _)| *v).collect();
        let expected = naive::normals(&grid, &voxels);
        let mut errors = Vec::new();
        for ((v, found), expected) in surface.iter().zip(&expected) {
            let expected = expected.as_vec3();
            match found {
                None => assert!(expected.length() < 0.5, "{v}: none, not {expected}"),
                Some(found) if expected.length() < 0.5 => {
                    panic!("{v}: {found}, where there is none")
                }
                Some(found) => errors.push(found.angle_between(expected).to_degrees()),
            }
        }
        let (mean, most) = spread(errors.clone());
        let worst = errors.into_iter().fold(0.0, f32::max);
        // The errors that packing causes; a table step at its very edge may add a little.
        assert!(mean < 0.4 && most < 1.0 && worst < 3.0, "{mean} {most} {worst}");
        let _ = random.unit();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The field that follows edits, whatever they are and however far apart, equals a new one.
    #[test]
    fn a_field_that_follows_edits_is_that_of_the_grid(
        dims in prop::array::uniform3(1u32..90),
        edits in prop::collection::vec(
            (prop::array::uniform3(any::<prop::sample::Index>()), 0u32..14, any::<bool>(), any::<bool>()),
            1..8,
        ),
    ) {
        let dims = UVec3::from(dims);
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
        let mut field = NormalField::of(&grid);
        for (at, radius, exists, at_once) in edits {
            let centre = IVec3::from_array(std::array::from_fn(|i| at[i].index(dims[i] as usize) as i32));
            let mut changed = std::collections::BTreeSet::new();
            let r = radius as i32;
            for offset in (-r..=r).flat_map(|z| (-r..=r).flat_map(move |y| (-r..=r).map(move |x| IVec3::new(x, y, z)))) {
                let v = centre + offset;
                if offset.length_squared() <= r * r && grid.contains(v) {
                    grid.set(v, exists);
                    changed.insert(grid.brick_index(v.as_uvec3() / 8) as u32);
                }
            }
            let changed: Vec<u32> = changed.into_iter().collect();
            field.follow(&grid, Some(&changed));
            if at_once {
                let before = pictures(&grid, &field);
                let mut differs = Vec::new();
                field.update(&grid, &mut differs, || true);
                prop_assert!(differs.windows(2).all(|pair| pair[0] < pair[1]));
                let after = pictures(&grid, &field);
                for (index, (before, after)) in before.iter().zip(&after).enumerate() {
                    if before != after {
                        prop_assert!(differs.contains(&(index as u32)));
                    }
                }
            }
        }
        field.update(&grid, &mut Vec::new(), || true);
        prop_assert!(field.is_complete());
        let whole = NormalField::of(&grid);
        prop_assert_eq!(pictures(&grid, &field), pictures(&grid, &whole));
        let mut tables = OpennessTables::default();
        for brick in 0..grid.brick_count() {
            for local in (0..512).map(|i| UVec3::from(crate::sculpture::brick::local_coords(i))) {
                let record = field.record(grid.brick_coords(brick), local);
                prop_assert_eq!(record, whole.record(grid.brick_coords(brick), local));
                let Some(record) = record else { continue };
                let filled = tables.filled(&grid, 8 * grid.brick_coords(brick) + local);
                let expected = filled.openness_at(record.depth().vx());
                // Rounded in another order.
                prop_assert!(record.openness().abs_diff(expected) <= 1);
            }
        }
    }
}

/// Returns the packed normals of all voxels, by brick.
fn pictures(grid: &Grid, field: &NormalField) -> Vec<Vec<PackedNormal>> {
    let local = |i: u32| UVec3::from(crate::sculpture::brick::local_coords(i));
    let page = |b: UVec3| (0..512).map(|i| field.packed(b, local(i))).collect();
    (0..grid.brick_count()).map(|index| page(grid.brick_coords(index))).collect()
}

/// Returns the page of the brick of a linear index.
fn page(grid: &Grid, field: &NormalField, index: usize) -> u32 {
    field.table().page(grid.brick_coords(index))
}

fn page_count(grid: &Grid, field: &NormalField) -> usize {
    (0..grid.brick_count()).filter(|index| page(grid, field, *index) != NO_PAGE).count()
}

/// Returns the linear indices of all bricks with voxels.
fn nonempty(grid: &Grid) -> Vec<u32> {
    grid.nonempty_bricks().map(|(b, _)| grid.brick_index(b) as u32).collect()
}

#[test]
fn work_in_portions_ends_where_work_at_once_does() {
    let before = scenes::cheese(300, 60, 7).unwrap();
    let mut grid = scenes::cheese(300, 60, 7).unwrap();
    let mut field = NormalField::default();
    let mut changed = Vec::new();
    // Opened, and edited all over: the previous normals are gone at once.
    for edited in [false, true] {
        let all: Vec<u32> = (0..grid.brick_count() as u32).collect();
        if edited {
            let other = scenes::cheese(300, 90, 8).unwrap();
            grid.fill_bricks(|b| *other.brick(b));
        }
        field.follow(&grid, edited.then_some(&all));
        changed.clear();
        let mut portions = 0;
        while !field.is_complete() {
            let mut once = portions > 0;
            field.update(&grid, &mut changed, || std::mem::take(&mut once));
            if edited && portions == 0 {
                let differ = |index: &usize| before.brick_at(*index) != grid.brick_at(*index);
                let mut differing = (0..grid.brick_count()).filter(differ);
                assert!(differing.all(|index| page(&grid, &field, index) == NO_PAGE));
            }
            portions += 1;
        }
        assert!(portions > 4, "{portions}");
    }
    let whole = NormalField::of(&grid);
    assert_eq!(pictures(&grid, &field), pictures(&grid, &whole));
}

#[test]
fn normals_do_not_depend_on_the_vector_instructions() {
    let grid = scenes::cheese(96, 30, 3).unwrap();
    let of = |level: Level| {
        let mut field = NormalField::default();
        field.follow(&grid, None);
        field.compute(level, &grid, &nonempty(&grid), Precision::Refined, &mut Vec::new());
        pictures(&grid, &field)
    };
    let expected = of(Level::new());
    for level in crate::surface::raycast::tests::levels() {
        assert!(of(level) == expected, "{level:?}");
    }
}

#[test]
fn an_edit_of_colours_changes_no_normal_and_another_size_begins_anew() {
    let grid = scenes::cheese(64, 20, 3).unwrap();
    let mut field = NormalField::of(&grid);
    field.follow(&grid, Some(&[1, 5, 9]));
    assert!(field.is_complete());
    let other = scenes::solid_cube(40).unwrap();
    field.follow(&other, Some(&[0]));
    let mut changed = Vec::new();
    field.update(&other, &mut changed, || true);
    assert_eq!(pictures(&other, &field), pictures(&other, &NormalField::of(&other)));
    let empty = Grid::new(UVec3::splat(40), Vec3::ONE, 1 << 20).unwrap();
    field.follow(&empty, None);
    assert_eq!(page_count(&empty, &field), 0);
}
