//! Tests twist and pinch: which parts turn, which are gathered, and that volumes are kept.

use glam::{IVec3, UVec3, Vec3};

use super::tests::{ball, contents, differing, pulled};
use crate::sculpture::history::Contents;
use crate::tools::brush::falloff::Falloff;
use crate::tools::brush::kernel::grab::{Grab, Motion};
use crate::tools::symmetry::Symmetry;

fn moved(before: &Contents, radius: f32, motion: Motion, falloff: Falloff) -> Contents {
    let centre_vx = Vec3::new(40.0, 40.0, 40.0);
    let grab = Grab { centre_vx, radius, motion, falloff };
    pulled(before, &grab, Symmetry::default())
}

/// Returns a bar across, a slope below and a ball aside: forms that a faulty motion might swell or erode.
fn shapes() -> Contents {
    contents(UVec3::splat(80), |v| {
        let p = v.as_vec3() + 0.5 - 40.0;
        p.y.abs() < 7.0 && p.z.abs() < 9.0
            || p.dot(Vec3::new(0.3, 1.0, 0.2)) < -9.0
            || p.distance(Vec3::new(4.0, 16.0, -9.0)) < 8.0
    })
}

#[test]
fn twist_and_pinch_keep_the_volume_within_a_hundredth() {
    let before = shapes();
    let count = before.grid.opaque_count();
    let normals = [Vec3::Y, Vec3::X, Vec3::new(0.4, 1.0, -0.7)];
    for (normal, falloff) in normals.into_iter().zip(Falloff::ALL) {
        for motion in [
            Motion::Twist { normal, angle_deg: 90.0 },
            Motion::Twist { normal, angle_deg: -35.0 },
            Motion::Pinch { normal, strength: 0.4 },
            Motion::Pinch { normal, strength: -0.3 },
        ] {
            let after = moved(&before, 36.0, motion, falloff);
            assert!(differing(&after, &before) > 300, "{motion:?} {falloff:?}");
            let change = after.grid.opaque_count().abs_diff(count);
            assert!(change * 100 < count, "{motion:?} {falloff:?}: {change} of {count}");
        }
    }
}

#[test]
fn a_bar_turns_about_the_axis_counter_clockwise() {
    // Along x; a quarter turn about y maps x to -z.
    let before = contents(UVec3::splat(80), |v| {
        let p = v.as_vec3() + 0.5 - 40.0;
        p.y.abs() < 4.0 && p.z.abs() < 4.0 && (0.0..30.0).contains(&p.x)
    });
    let quarter = Motion::Twist { normal: Vec3::Y, angle_deg: 90.0 };
    let after = moved(&before, 70.0, quarter, Falloff::Flat);
    for along in [4, 12, 20, 26] {
        assert!(after.grid.get(IVec3::new(40, 40, 40 - along)), "{along}");
        assert!(!after.grid.get(IVec3::new(40 + along, 40, 40)) || along < 5, "{along}");
    }
    let back = Motion::Twist { normal: -Vec3::Y, angle_deg: 90.0 };
    let differs = differing(&moved(&after, 70.0, back, Falloff::Flat), &before);
    assert!(differs * 25 < before.grid.opaque_count(), "{differs}");
}

#[test]
fn a_ridge_that_is_pinched_is_narrower_and_higher() {
    let before = contents(UVec3::splat(80), |v| {
        let p = v.as_vec3() + 0.5 - 40.0;
        p.y < 0.0 || p.y < 8.0 && p.x.abs() < 6.0 && p.z.abs() < 6.0
    });
    let pinch = |strength| {
        let motion = Motion::Pinch { normal: Vec3::Y, strength };
        let after = moved(&before, 24.0, motion, Falloff::Smooth);
        let width = (0..80).filter(|x| after.grid.get(IVec3::new(*x, 43, 40))).count();
        let height = (40..80).filter(|y| after.grid.get(IVec3::new(40, *y, 40))).count();
        (width, height)
    };
    assert_eq!(pinch(0.0), (12, 8));
    let (width, height) = pinch(0.4);
    assert!(width < 10 && height > 9, "{width} {height}");
    let (width, height) = pinch(-0.3);
    assert!(width > 12 && height < 8, "{width} {height}");
}

#[test]
fn a_motion_by_a_part_of_a_voxel_and_back_gives_the_ball_again() {
    let before = ball(UVec3::splat(80), Vec3::new(44.3, 39.8, 40.1), 20.0);
    let count = before.grid.opaque_count();
    let normal = Vec3::new(0.2, 1.0, 0.1);
    // The clay moves by at most 0.3 voxels.
    let furthest = Falloff::Smooth.widest_twist() as f32 * 60.0;
    let angle_deg = (0.3 / furthest).to_degrees();
    let strength = 0.3 / (2.0 * furthest);
    let twist = |share: f32| Motion::Twist { normal, angle_deg: angle_deg * share };
    let pinch = |share: f32| Motion::Pinch { normal, strength: strength * share };
    for motion in [&twist as &dyn Fn(f32) -> Motion, &pinch] {
        let there = moved(&before, 60.0, motion(1.0), Falloff::Smooth);
        assert!(differing(&there, &before) > 0);
        let back = moved(&there, 60.0, motion(-1.0), Falloff::Smooth);
        let differs = differing(&back, &before);
        assert!(differs * 200 <= count, "{:?}: {differs} of {count}", motion(1.0));
    }
}
