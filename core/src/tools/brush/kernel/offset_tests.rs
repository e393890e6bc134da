//! Tests brushes that move the surface: how far, on which side, and which parts stay.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;

use super::offset::{Offset, OffsetProfile, OffsetTarget};
use crate::sculpture::Grid;
use crate::sculpture::brick::local_coords;
use crate::tools::brush::falloff::Falloff;
use crate::tools::symmetry::{Parity, Symmetry};

fn grid(dims: UVec3, voxel_size: Vec3, exists: impl Fn(IVec3) -> bool) -> Grid {
    let mut grid = Grid::new(dims, voxel_size, 1 << 30).unwrap();
    for v in voxels(dims) {
        grid.set(v, exists(v));
    }
    grid
}

fn voxels(dims: UVec3) -> impl Iterator<Item = IVec3> {
    let [x, y, z] = dims.as_ivec3().to_array();
    (0..x * y * z).map(move |i| IVec3::new(i % x, i / x % y, i / x / y))
}

fn cube(edge: u32, exists: impl Fn(IVec3) -> bool) -> Grid {
    grid(UVec3::splat(edge), Vec3::ONE, exists)
}

fn used(before: &Grid, offset: &Offset, symmetry: Symmetry) -> Grid {
    let stamp = offset.stamp(before, &symmetry);
    let mut after = before.clone();
    for (bricks, exists) in [(&stamp.remove, false), (&stamp.add, true)] {
        for (b, mask) in bricks.bricks() {
            mask.for_each(|local| {
                let v = (*b * 8 + UVec3::from(local_coords(local))).as_ivec3();
                assert!(after.contains(v) && before.get(v) != exists, "{v} {exists}");
                after.set(v, exists);
            });
        }
    }
    after
}

fn brush(target: OffsetTarget, centre_vx: [f32; 3], radius: f32) -> Offset {
    Offset { target, centre_vx: centre_vx.into(), radius, falloff: Falloff::Flat }
}

/// A plane by its normal, and the share of the distance to it.
type Plane = (Vec3, f32);

fn plane(normal: [f32; 3], strength: f32) -> Plane {
    (Vec3::from(normal).normalize_or(Vec3::Y), strength)
}

fn to_plane((normal, strength): Plane, [lowers, raises]: [bool; 2]) -> OffsetTarget {
    OffsetTarget::Plane { normal, strength, lowers, raises }
}

fn flatten(plane: Plane) -> OffsetTarget {
    to_plane(plane, [true, true])
}

fn scrape(plane: Plane) -> OffsetTarget {
    to_plane(plane, [true, false])
}

fn fill(plane: Plane) -> OffsetTarget {
    to_plane(plane, [false, true])
}

fn drawn(normal: Vec3, height: f32, profile: OffsetProfile) -> OffsetTarget {
    OffsetTarget::Drawn { normal: normal.normalize_or(Vec3::Y), height, profile }
}

/// Returns the height of the column of clay at x, z, if it has no gaps.
fn height(grid: &Grid, x: i32, z: i32) -> i32 {
    let dims = grid.dims().as_ivec3();
    let top = (0..dims.y).rev().find(|y| grid.get(IVec3::new(x, *y, z))).map_or(0, |y| y + 1);
    assert!((0..top).all(|y| grid.get(IVec3::new(x, y, z))), "a gap at {x}, {z}");
    top
}

#[test]
fn a_flat_face_rises_by_the_height_and_sinks_by_it() {
    let before = cube(48, |v| v.y < 24);
    for by in [5, -5] {
        let deform = brush(OffsetTarget::Along(by as f32), [24.0, 24.0, 24.0], 16.0);
        let after = used(&before, &deform, Symmetry::default());
        assert_eq!(height(&after, 24, 24), 24 + by);
        assert_eq!(height(&after, 24, 5), 24);
        // It decreases monotonically.
        let heights: Vec<i32> =
            (24..42).map(|x| (height(&after, x, 24) - 24) * by.signum()).collect();
        assert!(heights.windows(2).all(|pair| pair[1] <= pair[0]), "{heights:?}");
        assert_eq!(heights[17], 0);
    }
    // Voxels twice as high: half as many.
    let before = grid(UVec3::new(48, 32, 48), Vec3::new(1.0, 2.0, 1.0), |v| v.y < 12);
    let deform = brush(OffsetTarget::Along(6.0), [24.0, 12.0, 24.0], 16.0);
    assert_eq!(height(&used(&before, &deform, Symmetry::default()), 24, 24), 15);
}

#[test]
fn a_ball_grows_and_shrinks_as_a_ball() {
    let centre = Vec3::splat(40.3);
    let ball = |radius: f32| cube(80, |v| (v.as_vec3() + 0.5).distance(centre) <= radius);
    let before = ball(18.0);
    for by in [4.0, -4.0, 2.5] {
        // Wide and flat, so that all of the ball moves equally far.
        let deform = brush(OffsetTarget::Along(by), centre.to_array(), 60.0);
        let after = used(&before, &deform, Symmetry::default());
        // The steps of a round surface account for up to half a voxel.
        let volume = after.opaque_count() as f64;
        let radius = (volume * 0.75 / std::f64::consts::PI).cbrt();
        let meant = f64::from(18.0 + by);
        assert!((radius - meant).abs() < 0.5, "by {by}: a radius of {radius}, not {meant}");
    }
}

/// Returns ground with a bump of four voxels and a pit of four.
fn uneven() -> Grid {
    cube(64, |v| {
        let beside = |x: i32| (v.x - x).abs().max((v.z - 32).abs());
        v.y < 24 && !(beside(40) < 3 && v.y >= 20) || v.y < 28 && beside(24) < 3
    })
}

#[test]
fn flatten_scrape_and_fill_reach_the_plane_from_their_sides() {
    let before = uneven();
    let up = plane([0.0, 2.0, 0.0], 1.0);
    let at = [32.0, 24.0, 32.0];
    let cases = [
        (flatten(up), 24, 24),
        (scrape(up), 24, 20),
        (fill(up), 28, 24),
        (flatten(plane([0.0, 1.0, 0.0], 0.5)), 26, 22),
    ];
    for (kind, bump, pit) in cases {
        let after = used(&before, &brush(kind, at, 24.0), Symmetry::default());
        let found = [height(&after, 24, 32), height(&after, 40, 32), height(&after, 32, 32)];
        assert_eq!(found, [bump, pit, 24], "{kind:?}");
    }
}

#[test]
fn nothing_is_filled_behind_a_wall() {
    let before = cube(48, |v| (20..24).contains(&v.y));
    let up = plane([0.0, 1.0, 0.0], 1.0);
    for kind in [fill(up), flatten(up)] {
        let after = used(&before, &brush(kind, [24.0, 24.0, 24.0], 16.0), Symmetry::default());
        assert!(after == before, "{kind:?}");
    }
}

/// Ground with a wall on it whose side is parallel to the direction.
#[test]
fn draw_moves_all_of_the_surface_in_one_direction() {
    let before = cube(64, |v| v.y < 24 || v.y < 32 && v.x > 40);
    for by in [6, -6] {
        let up = drawn(Vec3::Y * 3.0, by as f32, OffsetProfile::Falloff);
        let at = [32.0, 24.0, 32.0];
        let after = used(&before, &brush(up, at, 28.0), Symmetry::default());
        for (x, z) in [(32, 32), (24, 32), (32, 40)] {
            assert_eq!(height(&after, x, z), 24 + by, "{x} {z}");
        }
        // The wall stays in place and keeps its height over the ground.
        assert_eq!(height(&after, 41, 32), 32 + by);
        assert_eq!(height(&after, 40, 32), 24 + by);
        assert_eq!(height(&after, 3, 32), 24);
    }
    // The ground does not show through a thin wall above it, and the wall is not raised as a floating sheet.
    let thin = cube(48, |v| v.y == 24 || v.y < 12);
    let up = drawn(Vec3::Y, 5.0, OffsetProfile::Falloff);
    let after = used(&thin, &brush(up, [24.0, 25.0, 24.0], 12.0), Symmetry::default());
    assert!((24..30).all(|y| after.get(IVec3::new(24, y, 24))));
    assert!((12..24).all(|y| !after.get(IVec3::new(24, y, 24))));
}

#[test]
fn draw_lowers_a_full_grid_from_its_border() {
    let before = cube(43, |_| true);
    for (axis, end) in [(0, 0), (1, 43), (2, 43)] {
        let mut at = Vec3::splat(21.5);
        at[axis] = end as f32;
        let mut normal = Vec3::ZERO;
        normal[axis] = if end == 0 { -1.0 } else { 1.0 };
        let deform = brush(drawn(normal, -5.0, OffsetProfile::Falloff), at.to_array(), 16.0);
        let after = used(&before, &deform, Symmetry::default());
        let depth = |beside: i32| {
            let mut v = IVec3::splat(21 + beside);
            let in_clay = |i: &i32| {
                v[axis] = if end == 0 { *i } else { 42 - *i };
                after.get(v)
            };
            (0..43).find(in_clay)
        };
        assert_eq!((depth(0), depth(3)), (Some(5), Some(5)), "{axis}");
        assert_eq!(depth(14), Some(0), "{axis}");
    }
}

/// A slope is raised by the requested height and stays as smooth as it was.
#[test]
fn draw_raises_a_slope_along_its_normal() {
    let normal = Vec3::new(1.0, 2.0, -0.5).normalize();
    let slope = |up: f32| move |v: IVec3| (v.as_vec3() + 0.5 - 32.0).dot(normal) < up;
    let before = cube(64, slope(0.0));
    let up = drawn(normal, 5.5, OffsetProfile::Falloff);
    let after = used(&before, &brush(up, [32.0; 3], 28.0), Symmetry::default());
    let meant = cube(64, slope(5.5));
    let near = |v: &IVec3| (v.as_vec3() + 0.5 - 32.0).length() < 11.0;
    let differ = |a: &Grid, b: &Grid| {
        voxels(UVec3::splat(64)).filter(near).filter(|v| a.get(*v) != b.get(*v)).count()
    };
    let (off, moved) = (differ(&after, &meant), differ(&after, &before));
    assert!(off * 20 < moved, "{off} of {moved}");
}

#[test]
fn a_crease_is_narrower_than_what_draw_digs() {
    let before = cube(64, |v| v.y < 32);
    let down = |profile| drawn(Vec3::Y, -8.0, profile);
    let depths = |kind| {
        let brush = Offset { falloff: Falloff::Sharp, ..brush(kind, [32.0, 32.0, 32.0], 20.0) };
        let after = used(&before, &brush, Symmetry::default());
        (32..54).map(|x| 32 - height(&after, x, 32)).collect::<Vec<i32>>()
    };
    let (dug, creased) =
        (depths(down(OffsetProfile::Falloff)), depths(down(OffsetProfile::Squared)));
    assert!(creased[0] >= 7 && dug[0] >= 7, "{creased:?} {dug:?}");
    assert!(creased.iter().zip(&dug).all(|(crease, dug)| crease <= dug), "{creased:?} {dug:?}");
    assert!(creased.iter().sum::<i32>() * 3 < dug.iter().sum::<i32>() * 2, "{creased:?} {dug:?}");
}

fn any_deform() -> impl Strategy<Value = Offset> {
    let number = || prop_oneof![3 => -1.0f32..1.0, 1 => Just(0.0f32)];
    let plane = (prop::array::uniform3(number()), 0.0f32..=1.0).prop_map(|(normal, strength)| {
        (Vec3::from(normal).try_normalize().unwrap_or(Vec3::Y), strength)
    });
    let brush = (0..6, -8.0f32..8.0, plane).prop_map(|(kind, height, plane)| match kind {
        0 => OffsetTarget::Along(height),
        1 => flatten(plane),
        2 => scrape(plane),
        3 => drawn(plane.0, height, OffsetProfile::Falloff),
        4 => drawn(plane.0, height, OffsetProfile::Squared),
        _ => fill(plane),
    });
    let place = prop::array::uniform3(prop_oneof![4 => -6.0f32..40.0, 1 => Just(16.5f32)]);
    let falloff = prop::sample::select(&Falloff::ALL[..]);
    (brush, place, prop_oneof![0.5f32..20.0, Just(8.0)], falloff).prop_map(
        |(target, centre, radius, falloff)| Offset {
            target,
            centre_vx: centre.into(),
            radius,
            falloff,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    /// Nothing changes beyond the ball. Brushes that may only add or only remove do so; strength 0 does nothing; an
    /// empty grid stays empty, and a full one is lowered from the border at most.
    #[test]
    fn only_the_meant_side_of_what_is_in_the_ball_changes(
        deform in any_deform(), seed in 0u32..1000, kind in 0u8..4, flat in 1.0f32..2.0,
    ) {
        let noise = |v: IVec3| {
            ((v.x * 7 + v.y * 131 + v.z * 1741) as u32 + seed).wrapping_mul(2_654_435_761) >> 30 == 0
        };
        let size = Vec3::new(1.0, flat, 1.0);
        let before = grid(UVec3::new(34, 30, 33), size, |v| match kind {
            0 => false,
            1 => true,
            2 => v.y < 14,
            _ => noise(v),
        });
        let after = used(&before, &deform, Symmetry::default());
        if kind == 0 {
            prop_assert_eq!(after.opaque_count(), 0);
        }
        let (adds, removes) = match deform.target {
            OffsetTarget::Along(height) | OffsetTarget::Drawn { height, .. } => {
                (height > 0.0, height < 0.0)
            }
            OffsetTarget::Plane { raises, lowers, .. } => (raises, lowers),
        };
        for v in voxels(before.dims()) {
            let (was, is) = (before.get(v), after.get(v));
            let p = (v.as_vec3() + 0.5 - deform.centre_vx) * size;
            prop_assert!(was == is || p.length() <= deform.radius + 1e-3, "{}", v);
            prop_assert!(was == is || if is { adds } else { removes }, "{}", v);
        }
        let target = match deform.target {
            OffsetTarget::Along(_) => OffsetTarget::Along(0.0),
            OffsetTarget::Drawn { normal, profile, .. } => {
                OffsetTarget::Drawn { normal, profile, height: 0.0 }
            }
            OffsetTarget::Plane { normal, lowers, raises, .. } => {
                OffsetTarget::Plane { normal, lowers, raises, strength: 0.0 }
            }
        };
        let still = Offset { target, ..deform };
        prop_assert!(used(&before, &still, Symmetry::default()) == before);
    }

    /// With a mirror plane the result is symmetric to the voxel.
    #[test]
    fn mirrored_brushes_give_mirrored_clay(
        deform in any_deform(), axis in 0usize..3, seed in 0u32..1000,
    ) {
        let dims = IVec3::new(32, 30, 34);
        let flip = |mut v: IVec3| { v[axis] = dims[axis] - 1 - v[axis]; v };
        let blob = |v: IVec3| {
            let v = v / 3;
            ((v.x * 7 + v.y * 131 + v.z * 1741) as u32 + seed).wrapping_mul(2_654_435_761) >> 30 != 0
        };
        let before = grid(dims.as_uvec3(), Vec3::ONE, |v| blob(v) && blob(flip(v)));
        let mut symmetry = Symmetry::default();
        symmetry.axes[axis] = Some(Parity::Even);
        let stamp = deform.stamp(&before, &symmetry);
        let mut after = before.clone();
        for (bricks, exists) in [(&stamp.remove, false), (&stamp.add, true)] {
            for (b, mask) in bricks.bricks() {
                mask.for_each(|local| {
                    after.set((*b * 8 + UVec3::from(local_coords(local))).as_ivec3(), exists);
                });
            }
        }
        for v in voxels(dims.as_uvec3()) {
            prop_assert_eq!(after.get(v), after.get(flip(v)), "{}", v);
        }
    }
}
