//! Tests solids against their definition: every voxel of every row of bricks, at awkward poses.

use fearless_simd::{Level, Simd, dispatch};
use glam::{EulerRot, IVec3, Quat, UVec3, Vec3};
use proptest::prelude::*;

use super::{PlacedSolid, Primitive, Solid, SolidRow};
use crate::sculpture::Brick;
use crate::sculpture::region::Region;
use crate::surface::raycast::tests::levels;
use crate::tools::drawn::is_place;
use crate::tools::symmetry::SymmetryTransform;

/// Compares all rows of a grid of `dims` voxels with [`PlacedSolid::contains_voxel`], with each set
/// of vector instructions.
fn check(placed: &PlacedSolid, dims: UVec3) -> Result<(), TestCaseError> {
    levels()
        .into_iter()
        .try_for_each(|level| dispatch!(level, simd => check_with(simd, placed, dims)))
}

fn check_with(simd: impl Simd, placed: &PlacedSolid, dims: UVec3) -> Result<(), TestCaseError> {
    let bricks = (dims + 7) / 8;
    let bounds = placed.bounds_vx();
    for (by, bz) in (0..bricks.z).flat_map(|z| (0..bricks.y).map(move |y| (y, z))) {
        let mut row = SolidRow::default();
        let reach = placed.cut_row(simd, by * 8, bz * 8, &mut row);
        for bx in 0..bricks.x {
            let mut naive = Brick::EMPTY;
            for (x, y, z) in (0..512).map(|i| (i % 8, i / 8 % 8, i / 64)) {
                let v = (UVec3::new(bx, by, bz) * 8 + UVec3::new(x, y, z)).as_ivec3();
                let inside = placed.contains_voxel(v);
                naive.set(x, y, z, inside);
                let bounded = v.cmpge(bounds.min).all() && v.cmplt(bounds.max).all();
                prop_assert!(bounded || !inside, "{v} is inside but not within {bounds:?}");
            }
            // Masks as an edit requests them: none beyond the touched range, but also beyond the bounds.
            let mask = match (reach.touched.contains(&bx), reach.whole.contains(&bx)) {
                (false, whole) => {
                    prop_assert!(!whole);
                    Brick::EMPTY
                }
                (true, true) => Brick::FULL,
                (true, false) => placed.mask(simd, &row, &reach, bx),
            };
            prop_assert_eq!(mask, naive, "brick {} {} {} of {:?}", bx, by, bz, placed);
        }
    }
    Ok(())
}

/// Checks that a sweep covers the voxels that the solid covers at positions along its displacement, and none that a
/// slightly larger solid does not cover there. The sweep from the other end must cover the same.
fn check_sweep(primitive: &Primitive, displacement: Vec3, size: Vec3) -> Result<(), TestCaseError> {
    let solid = primitive.solid;
    // In units of the smallest voxel edge, as are half extents.
    let displacement =
        displacement.clamp(Vec3::splat(-30.0), Vec3::splat(30.0)) / (size / size.min_element());
    let to = primitive.centre_vx + displacement;
    let swept = primitive.swept_in_grid(Some(to), size);
    let back =
        Primitive { centre_vx: to, ..*primitive }.swept_in_grid(Some(primitive.centre_vx), size);
    let stamp = |share: f32, by: f32| {
        let centre_vx = primitive.centre_vx.lerp(to, share);
        Primitive { centre_vx, half: primitive.half * by, ..*primitive }.in_grid(size)
    };
    let count = 120u16;
    let share = |i: u16| f32::from(i) / f32::from(count);
    // Between two of these a solid moves by at most half a voxel. A point inside both a slightly smaller and a slightly
    // larger torus is clearly inside; the larger one has the larger hole.
    let little = if solid == Solid::Torus { 0.002 } else { 0.0005 };
    let inner: Vec<_> = (0..=count).map(|i| stamp(share(i), 1.0 - little)).collect();
    let outer: Vec<_> = (0..=count).map(|i| stamp(share(i), 1.0 + little)).collect();
    let clearly_in =
        |v| std::iter::zip(&inner, &outer).any(|(a, b)| a.contains_voxel(v) && b.contains_voxel(v));
    let larger: Vec<_> = (0..=count).map(|i| stamp(share(i), 1.35)).collect();
    for i in 0..3000 {
        let v = IVec3::new(i % 14, i / 14 % 14, i / 196) * 2 + 1;
        let covered = swept.contains_voxel(v);
        prop_assert!(covered || !clearly_in(v), "{} is left out", v);
        // A larger torus does not contain the smaller one.
        let bounded = solid == Solid::Torus || larger.iter().any(|stamp| stamp.contains_voxel(v));
        prop_assert!(!covered || bounded, "{} is covered", v);
        if covered != back.contains_voxel(v) {
            // On the surface of both.
            let mut near = inner.iter().chain(&outer);
            prop_assert!(near.any(|stamp| stamp.contains_voxel(v)), "{}", v);
        }
    }
    Ok(())
}

fn solid() -> impl Strategy<Value = Solid> {
    prop::sample::select(&Solid::ALL[..])
}

/// Returns the 24 rotations that map axes to axes, as exactly as `f32` represents them: half turns have no rounding at
/// all.
pub(crate) fn axis_turns() -> Vec<Quat> {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut turns = Vec::new();
    for i in 0..81 {
        let signs = [i % 3, i / 3 % 3, i / 9 % 3, i / 27].map(|s| s as f32 - 1.0);
        let parts = signs.iter().filter(|s| **s != 0.0).count();
        let length = match parts {
            1 => 1.0,
            2 => half,
            4 => 0.5,
            _ => continue,
        };
        // Of q and -q, which are the same rotation, the one whose first non-zero component is positive.
        if signs.iter().find(|s| **s != 0.0) == Some(&1.0) {
            turns.push(Quat::from_array(signs.map(|s| s * length)));
        }
    }
    turns
}

/// Generates any rotation, quarter turns (whose matrices are nearly, but not quite, a permutation), axis-to-axis
/// rotations, tiny rotations and none.
pub fn rotation() -> impl Strategy<Value = Quat> {
    let any = prop::array::uniform4(-1.0f32..1.0)
        .prop_filter("a direction", |q| q.iter().map(|v| v * v).sum::<f32>() > 0.01)
        .prop_map(|q| Quat::from_array(q).normalize());
    let quarters = prop::array::uniform3(0u8..4).prop_map(|q| {
        let [x, y, z] = q.map(|v| f32::from(v) * std::f32::consts::FRAC_PI_2);
        Quat::from_euler(EulerRot::XYZ, x, y, z)
    });
    let tiny = prop::array::uniform3(-1e-6f32..1e-6)
        .prop_map(|[x, y, z]| Quat::from_euler(EulerRot::XYZ, x, y, z));
    let about_x = (-3.2f32..3.2).prop_map(Quat::from_rotation_x);
    let exact = prop::sample::select(axis_turns());
    prop_oneof![
        4 => any, 2 => quarters, 3 => exact, 1 => tiny, 1 => about_x, 2 => Just(Quat::IDENTITY),
    ]
}

/// Generates half extents from a hundredth of a voxel to a thousand times the grid.
fn half() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 0.3f32..40.0,
        2 => (1u8..60).prop_map(|v| f32::from(v) / 2.0),
        1 => 0.01f32..1.0,
        1 => (2.0f32..6.0).prop_map(|e| 10f32.powf(e)),
    ]
}

/// Generates coordinates in the grid, on voxel centres and corners, and far outside.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -10.0f32..60.0,
        3 => (-20i8..100).prop_map(|v| f32::from(v) / 2.0),
        1 => -1e6f32..1e6,
        1 => prop::sample::select(vec![-1e30f32, 1e30, 1e9, -3e9, 0.1f32.next_up()]),
    ]
}

/// Generates short and long displacements, along axes, nearly along axes, and zero.
fn displacement() -> impl Strategy<Value = Vec3> {
    let any = || {
        prop_oneof![
            3 => -40.0f32..40.0,
            1 => -1.0f32..1.0,
            2 => Just(0.0),
            1 => (-20i8..20).prop_map(f32::from),
            1 => -1e-5f32..1e-5,
            1 => prop::sample::select(vec![-1e30f32, 1e30, 1e-30, 4000.0]),
        ]
    };
    prop::array::uniform3(any()).prop_map(Vec3::from)
}

fn voxel_size() -> impl Strategy<Value = Vec3> {
    prop_oneof![
        2 => Just(Vec3::ONE),
        1 => prop::array::uniform3(0.2f32..3.0).prop_map(Vec3::from),
        1 => prop::array::uniform3(1u8..4).prop_map(|v| Vec3::from(v.map(f32::from))),
    ]
}

fn dims() -> impl Strategy<Value = UVec3> {
    prop::array::uniform3(1u32..50).prop_map(UVec3::from)
}

fn primitive() -> impl Strategy<Value = Primitive> {
    (
        solid(),
        prop::array::uniform3(coordinate()),
        prop::array::uniform3(half()),
        any::<bool>(),
        rotation(),
    )
        .prop_map(|(solid, centre, half, same, rotation)| Primitive {
            solid,
            centre_vx: centre.into(),
            half: if same { Vec3::splat(half[0]) } else { half.into() },
            rotation,
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn rows_equal_the_definition(
        primitive in primitive(),
        size in voxel_size(),
        dims in dims(),
        planes in prop::array::uniform3(prop::option::of((0u8..50).prop_map(|p| f32::from(p) / 2.0))),
    ) {
        // Images by symmetry may lie further away than their originals.
        prop_assert_eq!(primitive.check().is_ok(), is_place(primitive.centre_vx));
        check(&primitive.in_grid(size), dims)?;
        check(&primitive.image_in_grid(None, size, &SymmetryTransform::of_planes(planes)), dims)?;
    }

    #[test]
    fn rows_of_sweeps_equal_the_definition(
        primitive in primitive(),
        displacement in displacement(),
        size in voxel_size(),
        dims in dims(),
        planes in prop::array::uniform3(prop::option::of((0u8..50).prop_map(|p| f32::from(p) / 2.0))),
    ) {
        let to = Some(primitive.centre_vx + displacement);
        check(&primitive.swept_in_grid(to, size), dims)?;
        check(&primitive.image_in_grid(to, size, &SymmetryTransform::of_planes(planes)), dims)?;
    }

    #[test]
    fn a_sweep_is_the_solid_at_all_places_of_its_path(
        solid in solid(),
        half in prop::array::uniform3(1.0f32..9.0),
        from in prop::array::uniform3(0.0f32..30.0),
        displacement in displacement(),
        rotation in rotation(),
        size in voxel_size(),
    ) {
        let primitive = Primitive { solid, centre_vx: from.into(), half: half.into(), rotation };
        check_sweep(&primitive, displacement, size)?;
    }

    /// Solids so large, and so placed, that a face runs through the grid: here the rounding
    /// errors of the definition are many voxels wide.
    #[test]
    fn surfaces_of_huge_solids_equal_the_definition(
        solid in solid(),
        exponent in 3.0f64..38.0,
        towards in prop::array::uniform3(-1.0f64..1.0),
        in_grid in prop::array::uniform3(0.0f64..30.0),
        rotation in rotation(),
        flat in prop::array::uniform3(any::<bool>()),
        displacement in displacement(),
    ) {
        let half = 10f64.powf(exponent);
        let halves = flat.map(|flat| if flat { half as f32 } else { 20.0 });
        let direction = glam::DVec3::from(towards) * half.min(1e37);
        let centre = (glam::DVec3::from(in_grid) + direction).as_vec3();
        let primitive = Primitive { solid, centre_vx: centre, half: halves.into(), rotation };
        prop_assume!(primitive.centre_vx.is_finite() && primitive.half.is_finite());
        check(&primitive.in_grid(Vec3::ONE), UVec3::new(40, 20, 20))?;
        let to = Some(primitive.centre_vx + displacement);
        check(&primitive.swept_in_grid(to, Vec3::ONE), UVec3::new(40, 20, 20))?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    /// Rows as long as a grid allows, where `f32` has the fewest digits left.
    #[test]
    fn the_longest_rows_equal_the_definition(
        primitive in primitive(),
        centre_x in -100.0f32..4200.0,
        half_x in prop_oneof![0.5f32..30.0, 100.0f32..5000.0],
        displacement in displacement(),
    ) {
        let mut primitive = primitive;
        primitive.centre_vx.x = centre_x;
        primitive.half.x = half_x;
        check(&primitive.in_grid(Vec3::ONE), UVec3::new(4096, 9, 3))?;
        let to = Some(primitive.centre_vx + displacement);
        check(&primitive.swept_in_grid(to, Vec3::ONE), UVec3::new(4096, 9, 3))?;
    }
}

#[test]
fn there_are_24_turns_from_axes_to_axes() {
    let turns = axis_turns();
    assert_eq!(turns.len(), 24);
    for (i, turn) in turns.iter().enumerate() {
        assert!(turn.is_normalized());
        assert!(turns[..i].iter().all(|other| other.angle_between(*turn) > 1.0));
    }
}

#[test]
fn a_radius_that_reaches_voxel_centres_exactly_includes_them() {
    // 3-4-5 and 1-4-8 = 9 give many centres at distance exactly `radius`.
    for radius in [5.0f32, 9.0, 13.0, 15.0] {
        for solid in Solid::ALL {
            let primitive = Primitive {
                solid,
                centre_vx: Vec3::splat(20.5),
                half: Vec3::splat(radius),
                rotation: Quat::IDENTITY,
            };
            let placed = primitive.in_grid(Vec3::ONE);
            check(&placed, UVec3::splat(41)).unwrap();
            // A torus has nothing on its axis: the outermost point of its tube.
            let out = if solid == Solid::Torus { IVec3::X } else { IVec3::NEG_Y };
            let base = IVec3::splat(20) + out * radius as i32;
            assert!(placed.contains_voxel(base), "{solid:?} {radius}");
            assert!(!placed.contains_voxel(base + out), "{solid:?} {radius}");
        }
    }
}

#[test]
fn extremes_of_f32_are_refused_or_equal_the_definition() {
    let ends = [f32::MIN_POSITIVE, 1e-45, 1.0, 3e38, f32::MAX];
    for (i, half) in ends.into_iter().enumerate() {
        for (step, other) in ends.into_iter().enumerate() {
            for centre in [0.0, 8.5, 1e-45, f32::MAX, -f32::MAX, 3e9] {
                for size in [Vec3::ONE, Vec3::new(1e-45, 1.0, 3e38)] {
                    let primitive = Primitive {
                        solid: Solid::ALL[(i + step) % Solid::ALL.len()],
                        centre_vx: Vec3::new(centre, 8.5, 8.0),
                        half: Vec3::new(half, other, 4.0),
                        rotation: Quat::from_euler(EulerRot::XYZ, 0.3, centre.signum(), 2.0),
                    };
                    check(&primitive.in_grid(size), UVec3::splat(17)).unwrap();
                    let to = Some(Vec3::new(8.0, other, -half));
                    check(&primitive.swept_in_grid(to, size), UVec3::splat(17)).unwrap();
                }
            }
        }
    }
}

/// Where a surface runs along a row within the rounding errors of the definition, its voxels need not be contiguous.
/// Such rows exist; they are detected and still exact.
#[test]
fn rows_torn_by_rounding_are_tested_voxel_by_voxel() {
    let mut torn = 0;
    for step in 0..60 {
        // A ball so large that it is flat, and touches the grid where 1 is within its rounding.
        let radius = 2f32.powi(46 + step % 12);
        let turn = step as f32 * 0.1;
        let primitive = Primitive {
            solid: Solid::Ellipsoid,
            centre_vx: Vec3::new(50.3, 8.5, radius),
            half: Vec3::splat(radius),
            rotation: Quat::from_euler(EulerRot::XYZ, turn, 1.0 - turn, 2.0 * turn),
        };
        let placed = primitive.in_grid(Vec3::ONE);
        let mut row = SolidRow::default();
        dispatch!(Level::new(), simd => placed.cut_row(simd, 0, 0, &mut row));
        if row.is_torn() {
            torn += 1;
            check(&placed, UVec3::new(100, 16, 16)).unwrap();
        }
    }
    assert!(torn > 0, "no row was torn, so this test shows nothing");
}

#[test]
fn sweeps_that_once_were_wrong_are_right() {
    let torus = Primitive {
        solid: Solid::Torus,
        centre_vx: Vec3::new(0.0, 0.0, 22.896_418),
        half: Vec3::new(6.767_872, 1.0, 6.350_303_6),
        rotation: Quat::from_xyzw(0.0, 0.667_564_33, 0.744_552_14, 0.0),
    };
    check_sweep(&torus, Vec3::ZERO, Vec3::ONE).unwrap();
    let pyramid = Primitive {
        solid: Solid::Pyramid,
        centre_vx: Vec3::new(0.0, 29.328_65, 5.124_209),
        half: Vec3::new(1.0, 2.102_545_5, 1.0),
        rotation: Quat::from_xyzw(0.5, 0.5, -0.5, -0.5),
    };
    let displacement = Vec3::new(11.694_734, -34.801_655, 0.0);
    check_sweep(&pyramid, displacement, Vec3::new(0.648_593_3, 1.971_095_6, 0.2)).unwrap();
    // So far away that the sweep ends where it begins, in `f32`.
    let far = Primitive {
        solid: Solid::Ellipsoid,
        centre_vx: Vec3::new(-1e30, 0.0, 0.0),
        half: Vec3::splat(0.3),
        rotation: Quat::from_xyzw(0.0, -0.399_275_96, -0.322_756_7, 0.858_141_5),
    };
    let to = Some(far.centre_vx + Vec3::X * 1e30);
    check(&far.swept_in_grid(to, Vec3::ONE), UVec3::ONE).unwrap();
    let image = far.image_in_grid(to, Vec3::ONE, &SymmetryTransform::of_planes([None; 3]));
    check(&image, UVec3::ONE).unwrap();
}
