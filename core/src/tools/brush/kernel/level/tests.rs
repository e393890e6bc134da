//! Tests smoothing at the scale of the brush: which forms go and which stay, and the effect of strength, rounding and
//! walls.

use glam::{IVec3, UVec3, Vec3};

use crate::sculpture::brick::local_coords;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{Brick, Grid};
use crate::tools::brush::footprint::{Coverage, Footprint, Outline};
use crate::tools::brush::kernel::level::Level;
use crate::tools::brush::kernel::stamp::Stamp;

const FULL: Level = Level { strength: 1.0, rounding: Level::NEAREST };

fn grid(dims: UVec3, is: impl Fn(Vec3) -> bool) -> Grid {
    let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
    for i in 0..dims.element_product() {
        let v = grid.voxel_coords(i);
        grid.set(v.as_ivec3(), is(v.as_vec3() + 0.5));
    }
    grid
}

/// Returns a brush with a radius in voxels at `target`, viewed from far away.
fn seen(target: Vec3, from: Vec3, radius: f32) -> Footprint {
    let away = from.normalize();
    let across = away.any_orthonormal_vector();
    let down = away.cross(across);
    let away = away * 600.0;
    Footprint {
        eye_vx: target + away,
        aim: -away,
        across,
        down,
        radius,
        outline: Outline::Round,
        coverage: Coverage::Visible,
    }
}

fn voxels(bricks: &ListedBricks) -> Vec<IVec3> {
    let mut voxels = Vec::new();
    for (b, mask) in bricks.bricks() {
        mask.for_each(|local| voxels.push((*b * 8 + UVec3::from(local_coords(local))).as_ivec3()));
    }
    voxels
}

/// Returns how many voxels appear and vanish.
fn changes(stamp: &Stamp) -> [usize; 2] {
    [&stamp.add, &stamp.remove].map(|bricks| voxels(bricks).len())
}

fn apply(grid: &mut Grid, stamp: &Stamp) {
    voxels(&stamp.remove).into_iter().for_each(|v| grid.set(v, false));
    voxels(&stamp.add).into_iter().for_each(|v| grid.set(v, true));
}

/// Scrubs the surroundings of `target` eight times, along and across, to both sides of the centre.
fn scrub(grid: &mut Grid, level: Level, target: Vec3, from: Vec3, radius: f32) {
    let away = from.normalize();
    let across = away.any_orthonormal_vector();
    let down = away.cross(across);
    for i in 0..8 {
        let (along, aside) = if i % 2 == 0 { (across, down) } else { (down, across) };
        let aside = aside * [0.35, -0.35, 0.9, -0.9][i / 2];
        for step in -3..=3 {
            let at = target + (along * (step as f32 * 0.35) + aside) * radius;
            let stamp = level.stamp(&seen(at, from, radius), grid);
            apply(grid, &stamp);
        }
    }
}

#[test]
fn flat_faces_are_what_they_were_however_they_are_seen() {
    let views =
        [Vec3::Y, Vec3::new(1.0, 1.0, 0.3), Vec3::new(1.0, 0.2, -0.4), Vec3::new(-0.5, 0.15, 1.0)];
    for height in [60.0, 63.0] {
        let slab = grid(UVec3::new(256, 96, 256), |p| p.y < height);
        for radius in [1.0, 3.0, 7.0, 12.0, 21.0, 27.0] {
            for from in views {
                // Only where the brush and its whole neighbourhood are on the face.
                if radius / from.normalize().y + 3.6 * radius > 128.0 {
                    continue;
                }
                let target = Vec3::new(128.0, height, 128.0);
                let stamp = FULL.stamp(&seen(target, from, radius), &slab);
                assert_eq!(changes(&stamp), [0, 0], "{height} {radius} {from}");
            }
        }
    }
    // At 45 degrees to both axes.
    let slope = grid(UVec3::splat(160), |p| p.x + p.y < 160.0);
    let steep = grid(UVec3::splat(160), |p| p.x + p.y + p.z < 240.0);
    for radius in [5.0, 9.0, 15.0] {
        let target = Vec3::splat(80.0);
        for (grid, from) in [(&slope, Vec3::new(1.0, 1.0, 0.0)), (&steep, Vec3::ONE)] {
            let stamp = FULL.stamp(&seen(target, from, radius), grid);
            assert_eq!(changes(&stamp), [0, 0], "{radius} {from}");
        }
    }
}

/// The largest brushes sample hidden space in cubes of 64 voxels.
#[test]
fn flat_faces_are_what_they_were_under_the_largest_brushes() {
    for height in [190, 193] {
        let mut slab = Grid::new(UVec3::new(512, 256, 512), Vec3::ONE, 1 << 30).unwrap();
        slab.fill_bricks(|b| Brick::below([8, (height - (b.y * 8).min(height)).min(8), 8]));
        for radius in [40.0, 46.0, 51.0] {
            for from in [Vec3::Y, Vec3::new(0.4, 1.0, 0.3)] {
                let target = Vec3::new(256.0, height as f32, 250.0);
                let stamp = FULL.stamp(&seen(target, from, radius), &slab);
                assert_eq!(changes(&stamp), [0, 0], "{height} {radius} {from}");
            }
        }
    }
}

#[test]
fn a_nub_as_large_as_the_brush_is_levelled_by_eight_scrubs() {
    let floor = 40.0;
    let top = Vec3::new(80.0, floor + 40.0, 80.0);
    let ball = |p: Vec3| p.distance(Vec3::new(80.0, floor + 10.0, 80.0)) < 20.0;
    let post = |p: Vec3| (p - top).with_y(0.0).abs().max_element() < 20.0 && p.y < top.y;
    let round = |p: Vec3| (p - top).with_y(0.0).length() < 20.0 && p.y < top.y;
    type Form<'a> = &'a dyn Fn(Vec3) -> bool;
    let nubs: [(&str, i32, Form); 3] =
        [("ball", 30, &ball), ("post", 40, &post), ("cylinder", 40, &round)];
    for (name, high, nub) in nubs {
        for from in [Vec3::Y, Vec3::new(0.7, 1.0, 0.4)] {
            let mut grid = grid(UVec3::new(160, 96, 160), |p| p.y < floor || nub(p));
            let middle = Vec3::new(80.0, floor + 0.5 * high as f32, 80.0);
            scrub(&mut grid, FULL, middle, from, 20.0);
            let left = highest(&grid) - floor as i32;
            assert!(left * 5 <= high, "{name} {from}: {left} of {high} voxels");
        }
    }
}

/// Returns the height of the highest voxel.
fn highest(grid: &Grid) -> i32 {
    let dims = grid.dims().as_ivec3();
    let layer = |y: i32| (0..dims.x * dims.z).map(move |i| IVec3::new(i % dims.x, y, i / dims.x));
    (0..dims.y).rev().find(|y| layer(*y).any(|v| grid.get(v))).map_or(0, |y| y + 1)
}

#[test]
fn balls_of_five_times_the_radius_keep_their_volume() {
    let middle = Vec3::splat(96.0);
    let mut grid = grid(UVec3::splat(192), |p| p.distance(middle) < 80.0);
    let before = grid.opaque_count() as f64;
    for radius in [6.0, 11.0, 16.0] {
        for i in 0..60 {
            // Positions all over the ball, by the golden angle.
            let y = 1.0 - (i as f32 + 0.5) / 30.0;
            let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
            let from = Vec3::new(sin * (1.0 - y * y).sqrt(), y, cos * (1.0 - y * y).sqrt());
            let stamp = FULL.stamp(&seen(middle + from * 80.0, from, radius), &grid);
            apply(&mut grid, &stamp);
        }
        let share = grid.opaque_count() as f64 / before;
        assert!((share - 1.0).abs() < 0.01, "radius {radius}: {share} of the volume");
    }
}

#[test]
fn a_ball_is_not_planed_down_while_it_is_held_in_one_place() {
    let middle = Vec3::splat(96.0);
    let mut grid = grid(UVec3::splat(192), |p| p.distance(middle) < 80.0);
    let heights: Vec<i32> = (0..30)
        .map(|_| {
            let stamp = FULL.stamp(&seen(middle + Vec3::Y * 80.0, Vec3::Y, 20.0), &grid);
            apply(&mut grid, &stamp);
            (0..192).rev().find(|y| grid.get(IVec3::new(96, *y, 96))).unwrap()
        })
        .collect();
    assert!(heights.iter().all(|height| *height >= 172), "of 175: {heights:?}");
    assert_eq!(heights[10], heights[29], "{heights:?}");
}

#[test]
fn half_the_strength_takes_less_and_none_takes_nothing() {
    let bump = |p: Vec3| p.y < 40.0 || p.distance(Vec3::new(64.0, 40.0, 64.0)) < 14.0;
    let grid = grid(UVec3::new(128, 80, 128), bump);
    let brush = seen(Vec3::new(64.0, 54.0, 64.0), Vec3::Y, 14.0);
    let removed = |strength| {
        let level = Level { strength, ..FULL };
        voxels(&level.stamp(&brush, &grid).remove).len()
    };
    let amounts = [0.0, 0.25, 0.5, 0.75, 1.0].map(removed);
    assert_eq!(amounts[0], 0);
    assert!(amounts.is_sorted_by(|a, b| a < b), "{amounts:?}");
    assert!(amounts[2] * 3 > amounts[4] && amounts[2] * 10 < amounts[4] * 9, "{amounts:?}");
}

#[test]
fn steps_shorter_than_a_voxel_add_up_where_the_rounding_differs() {
    let bump = |p: Vec3| p.y < 40.0 + 3.0 * (1.0 - (p - 64.0).with_y(0.0).length() / 12.0);
    let left = |roundings: &[f32]| {
        let mut grid = grid(UVec3::new(128, 64, 128), |p| p.y < 40.0 || bump(p));
        for i in 0..120 {
            let level = Level { strength: 0.1, rounding: roundings[i % roundings.len()] };
            let stamp = level.stamp(&seen(Vec3::new(64.0, 42.0, 64.0), Vec3::Y, 12.0), &grid);
            apply(&mut grid, &stamp);
        }
        highest(&grid) - 40
    };
    assert_eq!((left(&[0.5]), left(&[0.1, 0.7, 0.3, 0.9, 0.5])), (3, 2));
}

#[test]
fn thin_walls_are_not_pierced() {
    for thickness in [2.0, 4.0, 9.0] {
        let wall = |p: Vec3| (p.z - 64.0).abs() * 2.0 < thickness;
        let mut grid = grid(UVec3::splat(128), wall);
        let before = grid.opaque_count();
        for from in [Vec3::Z, Vec3::new(0.5, 0.3, 1.0)] {
            for _ in 0..10 {
                let stamp = FULL.stamp(&seen(Vec3::splat(64.0), from, 24.0), &grid);
                apply(&mut grid, &stamp);
            }
        }
        assert_eq!(grid.opaque_count(), before, "a wall of {thickness}");
    }
}

/// Returns a brush centred on `target` as viewed from an eye, with a radius in voxels there.
fn seen_from(eye: Vec3, target: Vec3, radius: f32) -> Footprint {
    let away = eye - target;
    Footprint { eye_vx: eye, aim: -away, ..seen(target, away, radius) }
}

/// Strokes once around the visible rim of a mug.
#[test]
fn the_rim_of_a_mug_is_rounded_and_stays_however_it_is_seen() {
    let (middle, outer, top) = (Vec3::new(64.0, 0.0, 64.0), 36.0, 96.0);
    let from_axis = |p: Vec3| (p - middle).with_y(0.0).length();
    for (thickness, radius) in [(4.0, 8.0), (4.0, 16.0), (8.0, 8.0), (12.0, 8.0)] {
        let mug = |p: Vec3| {
            let wall = from_axis(p) > outer - thickness || p.y < 8.0 + thickness;
            p.y > 8.0 && p.y < top && from_axis(p) < outer && wall
        };
        for eye in [
            Vec3::new(64.0, 384.0, 64.0),
            Vec3::new(64.0, 64.0, 384.0),
            Vec3::new(64.0, 280.0, 300.0),
        ] {
            let mut grid = grid(UVec3::splat(128), mug);
            let rim = outer - 0.5 * thickness;
            let steps = (std::f32::consts::TAU * rim / (0.5 * radius)) as i32;
            for i in 0..steps {
                let (sin, cos) = (std::f32::consts::TAU * i as f32 / steps as f32).sin_cos();
                let at = Vec3::new(64.0 + rim * sin, top, 64.0 + rim * cos);
                if eye.y > top || cos > 0.0 {
                    let stamp = FULL.stamp(&seen_from(eye, at, radius), &grid);
                    apply(&mut grid, &stamp);
                }
            }
            let height = |i: i32| {
                let (sin, cos) = (i as f32 * 0.1).sin_cos();
                let highest = |inside: i32| {
                    let from_axis = outer - 0.5 - inside as f32;
                    let [x, z] = [sin, cos].map(|v| (64.0 + from_axis * v) as i32);
                    (0..128).rev().find(|y| grid.get(IVec3::new(x, *y, z))).map_or(0, |y| y + 1)
                };
                (0..thickness as i32).map(highest).max().unwrap()
            };
            let heights: Vec<i32> = (0..62).map(height).collect();
            let lowest = top as i32 - (0.75 * radius) as i32;
            let context = format!("{thickness} {radius} {eye}: {heights:?}");
            assert!(heights.iter().all(|height| *height >= lowest), "{context}");
            // Its nearest part has lost its outer edge, and has no teeth.
            assert!(!grid.get(IVec3::new(64, 95, 99)) || thickness < radius, "{context}");
            let near = [&heights[57..], &heights[..6]].concat();
            assert!(near.windows(2).all(|pair| (pair[0] - pair[1]).abs() <= 2), "{context}");
        }
    }
}

#[test]
fn spikes_on_a_body_go() {
    for (half, high) in [(1.0, 8.0), (2.0, 16.0), (4.0, 20.0)] {
        for from in [Vec3::Y, Vec3::new(0.7, 1.0, 0.4)] {
            let spike = |p: Vec3| (p - 64.0).with_y(0.0).length() < half && p.y < 40.0 + high;
            let mut grid = grid(UVec3::new(128, 80, 128), |p| p.y < 40.0 || spike(p));
            scrub(&mut grid, FULL, Vec3::new(64.0, 40.0 + 0.5 * high, 64.0), from, 12.0);
            assert_eq!(highest(&grid), 40, "{half} {high} {from}");
        }
    }
}

#[test]
fn nothing_happens_on_full_faces_and_where_nothing_is() {
    let full = grid(UVec3::splat(96), |_| true);
    let empty = grid(UVec3::splat(96), |_| false);
    for radius in [4.0, 20.0] {
        let brush = seen(Vec3::new(48.0, 96.0, 48.0), Vec3::Y, radius);
        assert_eq!(changes(&FULL.stamp(&brush, &full)), [0, 0]);
        assert_eq!(changes(&FULL.stamp(&brush, &empty)), [0, 0]);
        // Its edges are rounded.
        let edge = seen(Vec3::new(96.0, 96.0, 48.0), Vec3::new(1.0, 1.0, 0.0), radius);
        let stamp = FULL.stamp(&edge, &full);
        assert!(stamp.add.bricks().is_empty() && !stamp.remove.bricks().is_empty());
    }
    assert_eq!(Level { strength: 1.5, ..FULL }.check().unwrap_err().field, "strength");
    assert_eq!(Level { rounding: f32::NAN, ..FULL }.check().unwrap_err().field, "rounding");
}

#[test]
fn mirrored_surfaces_are_smoothed_alike() {
    let bumps = |p: Vec3| {
        let x = (p.x - 64.0).abs();
        p.y < 40.0
            || Vec3::new(x, p.y, p.z).distance(Vec3::new(20.0, 42.0, 60.0)) < 9.0
            || Vec3::new(x, p.y, p.z).distance(Vec3::new(28.0, 38.0, 72.0)) < 12.0
    };
    let grid = grid(UVec3::new(128, 64, 128), bumps);
    let right = seen(Vec3::new(88.3, 50.0, 66.2), Vec3::new(0.4, 1.0, 0.2), 15.0);
    let mirrored = |v: Vec3| v.with_x(-v.x);
    let left = Footprint {
        eye_vx: right.eye_vx.with_x(128.0 - right.eye_vx.x),
        aim: mirrored(right.aim),
        across: mirrored(right.across),
        down: mirrored(right.down),
        ..right
    };
    let sorted = |bricks: &ListedBricks, flip: bool| {
        let mut voxels = voxels(bricks);
        voxels.iter_mut().filter(|_| flip).for_each(|v| v.x = 127 - v.x);
        voxels.sort_unstable_by_key(|v| v.to_array());
        voxels
    };
    let (right, left) = (FULL.stamp(&right, &grid), FULL.stamp(&left, &grid));
    assert!(!right.remove.bricks().is_empty() && !right.add.bricks().is_empty());
    assert_eq!(sorted(&right.remove, false), sorted(&left.remove, true));
    assert_eq!(sorted(&right.add, false), sorted(&left.add, true));
}
