//! Tests pulls at clay: which parts move, which stay, and that pulling back restores the clay.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;

use crate::sculpture::history::Contents;
use crate::sculpture::{ColourDepth, Grid, Material, Rgb};
use crate::tools::brush::falloff::Falloff;
use crate::tools::brush::kernel::grab::{Grab, Motion};
use crate::tools::brush::limits::{MAX_PULL_VX, MIN_RADIUS};
use crate::tools::symmetry::{Parity, Symmetry};

const RED: Rgb = Rgb::new(200, 20, 10);

pub fn contents(dims: UVec3, exists: impl Fn(UVec3) -> bool) -> Contents {
    let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
    for z in 0..dims.z {
        for y in 0..dims.y {
            for x in 0..dims.x {
                let v = UVec3::new(x, y, z);
                grid.set(v.as_ivec3(), exists(v));
            }
        }
    }
    let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
    Contents::new(grid, material)
}

pub fn ball(dims: UVec3, centre: Vec3, radius: f32) -> Contents {
    contents(dims, |v| (v.as_vec3() + 0.5).distance(centre) <= radius)
}

fn paint(contents: &mut Contents, v: UVec3, colour: Rgb) {
    let brick = contents.grid.brick_index(v / 8);
    let mut mask = crate::sculpture::Brick::EMPTY;
    mask.set(v.x % 8, v.y % 8, v.z % 8, true);
    contents.material.paint(contents.grid.brick_coords(brick), &mask, colour);
}

/// Returns the contents after a pull, changed without a document.
pub fn pulled(before: &Contents, grab: &Grab, symmetry: Symmetry) -> Contents {
    let pulled = grab.pulled(before, &symmetry);
    let mut after = before.clone();
    let mut each = |bricks: &[(UVec3, crate::sculpture::Brick)],
                    f: &mut dyn FnMut(&mut Contents, UVec3)| {
        for (b, mask) in bricks {
            for local in 0..512u32 {
                let [x, y, z] = crate::sculpture::brick::local_coords(local);
                if mask.get(x, y, z) {
                    f(&mut after, *b * 8 + UVec3::new(x, y, z));
                }
            }
        }
    };
    each(pulled.stamp.remove.bricks(), &mut |after, v| {
        assert!(after.grid.get(v.as_ivec3()), "{v} is removed but was not there");
        after.grid.set(v.as_ivec3(), false);
    });
    each(pulled.stamp.add.bricks(), &mut |after, v| {
        assert!(!after.grid.get(v.as_ivec3()), "{v} is added but was there");
        after.grid.set(v.as_ivec3(), true);
        paint(after, v, Rgb::STONE);
    });
    each(pulled.stamp.paint.bricks(), &mut |after, v| {
        let colour = pulled.colour(v).unwrap();
        assert!(after.grid.get(v.as_ivec3()), "{v} is painted but is not there");
        paint(after, v, colour);
    });
    after
}

pub fn differing(a: &Contents, b: &Contents) -> u64 {
    let bricks = 0..a.grid.brick_count();
    let pairs = bricks.map(|i| (a.grid.brick_at(i), b.grid.brick_at(i)));
    pairs.map(|(a, b)| u64::from(a.and_not(b).count()) + u64::from(b.and_not(a).count())).sum()
}

/// Returns the centroid of all voxels.
fn middle(contents: &Contents) -> Vec3 {
    let mut sum = glam::DVec3::ZERO;
    for i in 0..contents.grid.dims().element_product() {
        let v = contents.grid.voxel_coords(i);
        if contents.grid.get(v.as_ivec3()) {
            sum += v.as_dvec3() + 0.5;
        }
    }
    (sum / contents.grid.opaque_count() as f64).as_vec3()
}

/// Returns a pull in which the whole ball of clay moves as one.
fn carry(centre_vx: Vec3, by_vx: Vec3) -> Grab {
    Grab { centre_vx, radius: 60.0, motion: Motion::Pull { by_vx }, falloff: Falloff::Flat }
}

#[test]
fn a_ball_that_is_moved_by_a_part_of_a_voxel_and_back_is_the_ball() {
    let centre = Vec3::new(40.3, 39.8, 40.1);
    let before = ball(UVec3::splat(80), centre, 20.0);
    let count = before.grid.opaque_count();
    for by in [Vec3::X * 0.3, Vec3::new(0.2, -0.3, 0.1), Vec3::new(0.0, 0.5, 0.5), Vec3::Z * 1.7] {
        let there = pulled(&before, &carry(centre, by), Symmetry::default());
        let moved = middle(&there) - middle(&before);
        assert!((moved - by).length() < 0.1, "by {by}: {moved}");
        assert!(differing(&there, &before) > 0, "{by}");
        let change = there.grid.opaque_count().abs_diff(count);
        assert!(change * 100 <= count, "by {by}: {change} voxels of {count}");
        let back = pulled(&there, &carry(centre + by, -by), Symmetry::default());
        let differs = differing(&back, &before);
        assert!(differs * 200 <= count, "by {by}: {differs} of {count} voxels differ");
    }
}

#[test]
fn a_long_pull_neither_tears_nor_folds() {
    // A block pulled upwards by four times the radius of the ball: one horn, connected.
    let before = contents(UVec3::new(64, 96, 64), |v| v.y < 24);
    let grab = Grab {
        centre_vx: Vec3::new(32.0, 24.0, 32.0),
        radius: 14.0,
        motion: Motion::Pull { by_vx: Vec3::Y * 56.0 },
        falloff: Falloff::Smooth,
    };
    let after = pulled(&before, &grab, Symmetry::default());
    // Every layer holds a disc about the axis, narrower the higher it is.
    let width =
        |y: u32| (0..64).filter(|x| after.grid.get(glam::IVec3::new(*x, y as i32, 32))).count();
    let widths: Vec<usize> = (24..78).map(width).collect();
    assert!(widths.iter().all(|width| *width > 0), "{widths:?}");
    assert!(widths.windows(2).all(|pair| pair[1] <= pair[0] + 1), "{widths:?}");
    assert!(widths[0] > widths[53]);
    // The clay beyond the ball stays.
    assert!(
        after.grid.get(glam::IVec3::new(2, 20, 2)) && !after.grid.get(glam::IVec3::new(2, 30, 2))
    );
}

#[test]
fn colours_go_along() {
    let mut before = contents(UVec3::splat(48), |v| v.y < 20);
    // The upper layers are red.
    for b in 0..before.grid.brick_count() {
        if before.grid.brick_coords(b).y == 2 {
            before.material.paint(before.grid.brick_coords(b), &crate::sculpture::Brick::FULL, RED);
        }
    }
    let grab = Grab {
        centre_vx: Vec3::new(24.0, 20.0, 24.0),
        radius: 12.0,
        motion: Motion::Pull { by_vx: Vec3::Y * 10.0 },
        falloff: Falloff::Flat,
    };
    let after = pulled(&before, &grab, Symmetry::default());
    // The red layer was four voxels thick; below it comes the clay that was below it.
    for (y, colour) in [(29, RED), (28, RED), (27, RED), (25, Rgb::STONE), (22, Rgb::STONE)] {
        assert_eq!(after.colour(glam::IVec3::new(24, y, 24)), Some(colour), "at {y}");
    }
    assert_eq!(after.colour(glam::IVec3::new(2, 19, 2)), Some(RED));
}

fn grab() -> impl Strategy<Value = Grab> {
    (
        prop::array::uniform3(prop_oneof![4 => -6.0f32..40.0, 1 => Just(16.5f32)]),
        prop_oneof![0.5f32..20.0, Just(8.0)],
        prop::array::uniform3(
            prop_oneof![3 => -12.0f32..12.0, 1 => Just(0.0f32), 1 => -60.0f32..60.0],
        ),
        prop::sample::select(&Falloff::ALL[..]),
        (0..4, -1.0f32..1.0),
    )
        .prop_map(|(centre, radius, by, falloff, (kind, share))| {
            let normal = Vec3::from(by).try_normalize().unwrap_or(Vec3::Y);
            let motion = match kind {
                0 => Motion::Twist { normal, angle_deg: share * 180.0 },
                1 => Motion::Pinch { normal, strength: share },
                _ => Motion::Pull { by_vx: by.into() },
            };
            Grab { centre_vx: centre.into(), radius, motion, falloff }
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Nothing changes beyond the balls along the pull, whatever is there. An empty grid stays empty; a full one
    /// changes only where empty space enters from beyond the border.
    #[test]
    fn only_what_is_within_reach_changes(grab in grab(), seed in 0u32..1000, kind in 0u8..3) {
        let noise = |v: UVec3| (v.x * 7 + v.y * 131 + v.z * 1741 + seed).wrapping_mul(2654435761) >> 30 == 0;
        let before = contents(UVec3::new(34, 30, 33), |v| match kind { 0 => false, 1 => true, _ => noise(v) });
        let after = pulled(&before, &grab, Symmetry::default());
        if kind == 0 {
            prop_assert_eq!(after.grid.opaque_count(), 0);
        }
        for i in 0..before.grid.dims().element_product() {
            let v = before.grid.voxel_coords(i);
            let p = v.as_vec3() + 0.5 - grab.centre_vx;
            let by = if let Motion::Pull { by_vx } = grab.motion { by_vx } else { Vec3::ZERO };
            let along = (p.dot(by) / by.length_squared().max(1e-9)).clamp(0.0, 1.0);
            if (p - by * along).length() > grab.radius + 1e-3 {
                prop_assert_eq!(after.grid.get(v.as_ivec3()), before.grid.get(v.as_ivec3()), "{}", v);
            }
        }
        let motion = match grab.motion {
            Motion::Pull { .. } => Motion::Pull { by_vx: Vec3::ZERO },
            Motion::Twist { normal, .. } => Motion::Twist { normal, angle_deg: 0.0 },
            Motion::Pinch { normal, .. } => Motion::Pinch { normal, strength: 0.0 },
        };
        let still = Grab { motion, ..grab };
        prop_assert_eq!(differing(&pulled(&before, &still, Symmetry::default()), &before), 0);
    }

    /// With a mirror plane the result is symmetric to the voxel.
    #[test]
    fn mirrored_pulls_give_mirrored_clay(grab in grab(), axis in 0usize..3, seed in 0u32..1000) {
        let dims = UVec3::new(32, 30, 34);
        let flip = |mut v: UVec3| { v[axis] = dims[axis] - 1 - v[axis]; v };
        let noise = |v: UVec3| {
            let mut v = v / 3;
            v[axis] = v[axis].min(flip(v * 3)[axis] / 3);
            (v.x * 7 + v.y * 131 + v.z * 1741 + seed).wrapping_mul(2654435761) >> 30 != 0
        };
        let before = contents(dims, |v| noise(v) && noise(flip(v)));
        let mut symmetry = Symmetry::default();
        symmetry.axes[axis] = Some(Parity::Even);
        let after = pulled(&before, &grab, symmetry);
        for i in 0..dims.element_product() {
            let v = before.grid.voxel_coords(i);
            prop_assert_eq!(after.grid.get(v.as_ivec3()), after.grid.get(flip(v).as_ivec3()), "{}", v);
        }
    }
}

/// Bricks are skipped depending on their surroundings. This must not show: the same clay elsewhere in its bricks gives
/// the same result.
#[test]
fn a_pull_does_the_same_wherever_the_clay_lies_in_its_bricks() {
    let shape = |v: IVec3| {
        let p = v.as_vec3() + 0.5;
        let noise =
            (v.x * 7 + v.y * 131 + v.z * 1741).wrapping_mul(0x9E37_79B1u32 as i32) >> 27 == 1;
        let block = v.cmpge(IVec3::splat(6)).all() && v.cmplt(IVec3::new(50, 34, 50)).all();
        block && p.distance(Vec3::new(20.0, 20.0, 22.0)) > 8.0 && !(v.x > 40 && noise)
    };
    let pull = |x, y, z| Motion::Pull { by_vx: Vec3::new(x, y, z) };
    let normal = Vec3::new(0.5, 2.0, -1.0);
    let twist = Motion::Twist { normal, angle_deg: 75.0 };
    let pinch = Motion::Pinch { normal, strength: 0.6 };
    let grabs = [
        (Vec3::new(28.5, 34.0, 27.25), 14.0, pull(0.5, 11.25, -3.0), Falloff::Smooth),
        (Vec3::new(28.0, 28.0, 28.0), 19.5, pull(-9.0, -0.25, 0.75), Falloff::Flat),
        (Vec3::new(44.0, 30.0, 40.0), 12.0, pull(7.0, 6.0, 5.0), Falloff::Sharp),
        (Vec3::new(28.0, 31.0, 28.5), 19.5, twist, Falloff::Flat),
        (Vec3::new(28.5, 32.0, 27.25), 19.0, pinch, Falloff::Smooth),
    ];
    for (centre_vx, radius, motion, falloff) in grabs {
        let after = |shift: IVec3| {
            let mut before = contents(UVec3::splat(72), |v| shape(v.as_ivec3() - shift));
            for (i, red) in (0..12u8).map(|i| (i32::from(i), Rgb::new(200 + i, 20, 10))) {
                paint(&mut before, (IVec3::new(22 + i, 33, 20 + i) + shift).as_uvec3(), red);
            }
            let grab = Grab { centre_vx: centre_vx + shift.as_vec3(), radius, motion, falloff };
            pulled(&before, &grab, Symmetry::default())
        };
        let here = after(IVec3::ZERO);
        assert!(differing(&here, &contents(UVec3::splat(72), |v| shape(v.as_ivec3()))) > 500);
        for shift in [IVec3::new(3, 5, 1), IVec3::new(4, 4, 4), IVec3::new(7, 0, 2)] {
            let there = after(shift);
            for i in 0..64u32.pow(3) {
                let v = IVec3::new((i & 63) as i32, (i >> 6 & 63) as i32, (i >> 12) as i32);
                assert_eq!(here.grid.get(v), there.grid.get(v + shift), "{v} {shift}");
                let [a, b] = [(&here, v), (&there, v + shift)].map(|(c, v)| c.rgb(v.as_uvec3()));
                assert!(!here.grid.get(v) || a == b, "{v} {shift}");
            }
        }
    }
}

#[test]
fn a_pull_takes_a_bounded_number_of_steps() {
    let by_vx = Vec3::splat(MAX_PULL_VX);
    let longest = Grab {
        radius: MIN_RADIUS,
        motion: Motion::Pull { by_vx },
        falloff: Falloff::Flat,
        ..carry(Vec3::splat(8.0), Vec3::X)
    };
    assert!(longest.check_steps(Vec3::ONE, by_vx).is_ok());
    for size in [
        Vec3::new(1.0, 1e-3, 1.0),
        Vec3::new(1.0, 1.0, 1e30),
        Vec3::splat(f32::MAX) * Vec3::new(1.0, 1e-30, 1.0),
    ] {
        assert!(longest.check_steps(size, by_vx).is_err(), "{size}");
    }
}
