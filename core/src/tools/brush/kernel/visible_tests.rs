//! Tests the voxels that a footprint selects, against a plain definition, and against the picture that a user sees: no
//! visible voxel under the outline is left out, and none behind the visible surface is selected, at every ratio of
//! voxel to ray and from every side.

use std::collections::{HashMap, HashSet};

use glam::{DMat3, DVec3, IVec3, UVec3, Vec3, Vec3Swizzles};
use proptest::prelude::*;

use super::visible::{LEAST_TURN, is_turned};
use crate::sculpture::Grid;
use crate::surface::raycast;
use crate::tools::brush::footprint::{Coverage, Footprint, Outline};

fn grid(dims: UVec3, exists: impl Fn(IVec3) -> bool) -> Grid {
    let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
    for v in voxels(dims).filter(|v| exists(*v)) {
        grid.set(v, true);
    }
    grid
}

fn voxels(dims: UVec3) -> impl Iterator<Item = IVec3> {
    let UVec3 { x, y, z } = dims;
    (0..z).flat_map(move |z| {
        (0..y).flat_map(move |y| (0..x).map(move |x| UVec3::new(x, y, z).as_ivec3()))
    })
}

/// Returns the sculpture: flat faces, stairs, a ball, thin bars, walls one behind the other, dust.
fn scene(kind: usize, dims: UVec3) -> Grid {
    let size = dims.as_vec3();
    grid(dims, |v| {
        let p = v.as_vec3() + 0.5;
        match kind {
            0 => p.y < 0.6 * size.y,
            1 => p.y < 0.3 * p.x + 0.1 * p.z + 0.2 * size.y,
            2 => (p - 0.5 * size).length() < 0.45 * size.min_element(),
            3 => v.x % 9 == 0 && v.z % 7 == 0 || v.y == 5 && v.z % 5 == 0,
            4 => v.z % 16 < 2 && v.y > v.z / 4,
            _ => (v.x * 7919 + v.y * 104_729 + v.z * 1_299_709) as u32 % 97 < 9,
        }
    })
}

/// Returns a footprint of `radius` rays, `spacing_vx` voxels apart at the target, from `away` voxels in the direction
/// `from`.
fn looking(target: Vec3, from: Vec3, away: f32, spacing_vx: f32, radius: f32) -> Footprint {
    let from = from.normalize();
    let across = from.any_orthonormal_vector();
    Footprint {
        eye_vx: target + from * away,
        aim: -from,
        across: across * (spacing_vx / away),
        down: from.cross(across) * (spacing_vx / away),
        radius,
        outline: Outline::Round,
        coverage: Coverage::Visible,
    }
}

/// Keeps rays from running exactly along the edges of voxels, where rounding decides.
const OFFSET: Vec3 = Vec3::new(0.37, 0.21, 0.43);

/// Returns the distance of a voxel's centre from the central ray, in rays; infinite behind the eye.
fn distance(footprint: &Footprint, v: IVec3) -> f64 {
    let [across, down, aim] = [footprint.across, footprint.down, footprint.aim].map(Vec3::as_dvec3);
    let from_eye = v.as_dvec3() + 0.5 - footprint.eye_vx.as_dvec3();
    let DVec3 { x, y, z } = DMat3::from_cols(across, down, aim).inverse() * from_eye;
    if z <= 0.0 { f64::INFINITY } else { (x / z).hypot(y / z) }
}

/// Returns the centres of the open faces of a voxel that face the eye, relative to the eye, with their normals; of all
/// open faces where its surface faces the eye.
fn turned_faces(grid: &Grid, eye: Vec3, v: IVec3) -> impl Iterator<Item = (Vec3, Vec3)> {
    let middle = v.as_vec3() + 0.5 - eye;
    let normals = [IVec3::X, IVec3::Y, IVec3::Z].into_iter().flat_map(|n| [n, -n]);
    let stepped = is_turned(grid, v, middle);
    normals.filter(move |n| grid.get(v) && !grid.get(v + n)).filter_map(move |n| {
        let normal = n.as_vec3();
        let face = middle + 0.5 * normal;
        (stepped || -face.dot(normal) > LEAST_TURN * middle.length()).then_some((face, normal))
    })
}

fn is_free(grid: &Grid, eye: Vec3, to: Vec3) -> bool {
    raycast::cast(grid, eye, to).is_none_or(|hit| hit.t >= 1.0 - 1e-3 / to.length().max(1.0))
}

/// Returns whether the slit through which the eye sees a point is at least half a voxel wide. Through narrower ones, as
/// between dust and a face seen edge-on, a voxel may be found or not.
fn is_half_a_voxel_wide(grid: &Grid, eye: Vec3, to: Vec3) -> bool {
    let right = 0.26 * to.normalize().any_orthonormal_vector();
    let up = 0.26 * to.normalize().cross(right).normalize();
    // Before the voxel itself.
    let before = to - to.normalize();
    [right + up, right - up, up - right, -right - up, right, -right, up, -up]
        .into_iter()
        .all(|aside| is_free(grid, eye, before + aside))
}

/// Returns whether the eye sees a point within a voxel and a half of the centre of a voxel, on each axis.
fn is_near_what_is_seen(grid: &Grid, eye: Vec3, v: IVec3) -> bool {
    let middle = v.as_vec3() + 0.5 - eye;
    let steps = (0..729).map(|i| IVec3::new(i % 9, i / 9 % 9, i / 81) - 4);
    steps.into_iter().any(|step| is_free(grid, eye, middle + 0.351 * step.as_vec3()))
}

/// Checks the definition of the module, voxel by voxel, except for those within a hundredth of a ray of the outline. A
/// voxel seen with a whole face is selected; a selected voxel is seen somewhere over one of its faces.
fn check(grid: &Grid, footprint: &Footprint, has_surface: bool) -> Result<usize, TestCaseError> {
    let eye = footprint.eye_vx;
    let touched = footprint.touched(grid);
    let taken: HashSet<IVec3> = touched.iter().map(|touch| touch.voxel).collect();
    prop_assert_eq!(taken.len(), touched.len(), "each once");
    let middle = raycast::cast(grid, eye, footprint.aim).map(|hit| hit.voxel.as_ivec3());
    prop_assert!(middle.is_none_or(|v| taken.contains(&v)));
    for v in voxels(grid.dims()).filter(|v| grid.get(*v) && Some(*v) != middle) {
        let away = distance(footprint, v);
        if (away - f64::from(footprint.radius)).abs() < 0.01 {
            continue;
        }
        let inside = away < f64::from(footprint.radius);
        let mut faces = turned_faces(grid, eye, v);
        let seen = inside
            && faces.any(|(face, normal)| {
                let corners = [(0, 0), (-1, -1), (1, -1), (-1, 1), (1, 1)];
                let points = corners.map(|(i, j)| {
                    face + 0.45 * (normal.yzx() * i as f32 + normal.zxy() * j as f32)
                });
                points.iter().all(|point| is_free(grid, eye, *point * (1.0 - 1e-5)))
                    && (has_surface || is_half_a_voxel_wide(grid, eye, face))
            });
        prop_assert!(taken.contains(&v) || !seen, "{} at {} rays is left", v, away);
        // Through bars and dust, a ray may meet a surface of which only a strip is visible.
        let near = inside && (!has_surface || is_near_what_is_seen(grid, eye, v));
        prop_assert!(near || !taken.contains(&v), "{} at {} rays is hidden", v, away);
    }
    Ok(taken.len())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_footprint_takes_what_the_definition_says(
        kind in 0usize..6,
        from in prop::array::uniform3(-1f32..1.0),
        target in prop::array::uniform3(0f32..44.0),
        away in 4f32..400.0,
        spacing in 0.02f32..6.0,
        radius in 0f32..24.0,
    ) {
        let from = Vec3::from(from);
        // No wider than a wide-angle lens.
        prop_assume!(from.length() > 0.1 && radius * spacing < 1.5 * away);
        let grid = scene(kind, UVec3::new(44, 41, 38));
        let footprint = looking(target.into(), from, away, spacing, radius);
        check(&grid, &footprint, ![3, 5].contains(&kind))?;
    }
}

/// Returns the directions from which users view a face that points up: from straight above to five degrees above it.
fn slants() -> impl Iterator<Item = Vec3> {
    [0f32, 45.0, 80.0, 85.0].into_iter().flat_map(|degrees| {
        let slant = degrees.to_radians();
        [0f32, 0.6, std::f32::consts::FRAC_PI_2].map(|turn| {
            let level = Vec3::new(turn.cos(), 0.0, turn.sin());
            level * slant.sin() + Vec3::Y * slant.cos()
        })
    })
}

/// Checks that along rays far denser than those of the footprint, every voxel that is met and whose centre is inside is
/// selected.
fn leaves_nothing(grid: &Grid, footprint: &Footprint, fineness: i32, is_flat: bool) {
    let taken: HashSet<IVec3> = footprint.touched(grid).iter().map(|t| t.voxel).collect();
    let reach = footprint.radius as i32 * fineness;
    // A voxel of which the eye sees at least half a face turned to it; on a flat face, any voxel.
    let spacing_vx =
        footprint.across.length() * (footprint.eye_vx - Vec3::new(48.0, 32.0, 48.0)).length();
    let half = 0.5 * (fineness as f32 / spacing_vx).powi(2);
    let many = if is_flat { 1 } else { half.ceil() as u32 };
    let mut seen: HashMap<IVec3, u32> = HashMap::new();
    for j in -reach..=reach {
        for i in -reach..=reach {
            let shown = i % fineness == 0 && j % fineness == 0;
            let (i, j) = (i as f32 / fineness as f32, j as f32 / fineness as f32);
            let ray = footprint.aim + footprint.across * i + footprint.down * j;
            let Some(hit) = raycast::cast(grid, footprint.eye_vx, ray) else { continue };
            let v = hit.voxel.as_ivec3();
            let turned = ray.normalize().dot(hit.face.as_vec3()).abs() > LEAST_TURN;
            if turned
                && distance(footprint, v) < f64::from(footprint.radius - 1.0)
                && !taken.contains(&v)
            {
                *seen.entry(v).or_default() += if shown { many } else { 1 };
            }
        }
    }
    let left: Vec<_> = seen.iter().filter(|(_, count)| **count >= many).collect();
    assert!(left.is_empty(), "{} of {} left: {left:?}, {footprint:?}", left.len(), taken.len());
    assert!(!is_flat || !taken.is_empty());
}

#[test]
fn nothing_visible_is_left_from_any_side_at_any_distance() {
    let dims = UVec3::new(96, 64, 96);
    for kind in 0..6 {
        let grid = scene(kind, dims);
        for from in slants() {
            for (spacing, fineness) in [(0.1f32, 1), (0.7, 6), (2.0, 16), (5.0, 24)] {
                let radius = (20.0 / spacing).clamp(4.0, 16.0);
                leaves_nothing(
                    &grid,
                    &looking(dims.as_vec3() * 0.5 + OFFSET, from, 300.0, spacing, radius),
                    fineness,
                    kind == 0,
                );
            }
        }
    }
}

#[test]
fn a_large_plate_is_covered_wholly_where_a_voxel_is_smaller_than_a_ray() {
    // Flat, so that it needs little memory.
    let dims = UVec3::new(1600, 8, 1600);
    let mut plate = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
    plate.fill_bricks(|_| crate::sculpture::Brick::FULL);
    let target = Vec3::new(800.0, 8.0, 800.0);
    for from in slants() {
        let footprint = looking(target, from, 4000.0, 4.0, 20.0);
        let taken: HashSet<IVec3> = footprint.touched(&plate).iter().map(|t| t.voxel).collect();
        for (x, z) in (0..1600).flat_map(|x| (0..1600).map(move |z| (x, z))) {
            let v = IVec3::new(x, 7, z);
            let away = distance(&footprint, v);
            assert!(away > 19.9 || taken.contains(&v), "{v} is left, from {from}");
            assert!(away < 20.1 || !taken.contains(&v), "{v} is outside, from {from}");
        }
        assert!(
            taken.iter().all(|v| v.y == 7 || [0, 1599].contains(&v.x) || [0, 1599].contains(&v.z))
        );
    }
}

/// Nothing behind the visible surface is selected: the eye is visible from a point within a voxel and a half of each
/// selected voxel.
#[test]
fn nothing_behind_the_visible_surface_is_taken() {
    let dims = UVec3::new(64, 64, 64);
    for kind in [0, 1, 2, 4] {
        let grid = scene(kind, dims);
        for from in slants() {
            for (away, spacing, radius) in
                [(200.0, 0.3, 24.0), (200.0, 3.0, 8.0), (5000.0, 1.0, 24.0)]
            {
                let footprint = looking(dims.as_vec3() * 0.5 + OFFSET, from, away, spacing, radius);
                for touch in footprint.touched(&grid) {
                    let seen = is_near_what_is_seen(&grid, footprint.eye_vx, touch.voxel);
                    assert!(seen, "{} of scene {kind} under {footprint:?}", touch.voxel);
                }
            }
        }
    }
    // Two walls, the nearer with a slit: of the farther one only the part seen through the slit.
    let walls = grid(UVec3::new(64, 64, 40), |v| v.z < 4 || v.z > 30 && v.x.abs_diff(32) > 2);
    let touched = looking(Vec3::new(32.0, 32.0, 40.0), Vec3::Z, 500.0, 1.0, 20.0).touched(&walls);
    assert!(touched.iter().any(|t| t.voxel.z == 3));
    assert!(touched.iter().filter(|t| t.voxel.z < 4).all(|t| t.voxel.x.abs_diff(32) <= 4));
}

#[test]
fn a_brush_smaller_than_a_voxel_takes_the_one_under_it() {
    let grid = scene(0, UVec3::new(44, 41, 38));
    // A corner of a voxel, whose centre is far outside.
    let target = Vec3::new(20.1, 25.0, 20.1);
    let touched = looking(target, Vec3::Y, 10.0, 0.02, 3.0).touched(&grid);
    assert_eq!(touched.iter().map(|t| t.voxel).collect::<Vec<_>>(), [IVec3::new(20, 24, 20)]);
    // A radius of 0, and rays that span no picture.
    let point = looking(target, Vec3::Y, 10.0, 2.0, 0.0);
    assert_eq!(point.touched(&grid).len(), 1);
    let flat = Footprint { down: point.across, radius: 8.0, ..point };
    assert_eq!(flat.touched(&grid).len(), 1);
    // From inside the stone.
    let inside = looking(Vec3::splat(10.0), Vec3::Y, 4.0, 0.5, 8.0);
    assert_eq!(inside.touched(&grid).len(), 1);
    // Beside everything.
    let beside = looking(Vec3::new(-300.0, 10.0, 10.0), Vec3::Y, 10.0, 1.0, 8.0);
    assert!(beside.touched(&grid).is_empty());
}

#[test]
fn the_steps_of_a_ball_are_taken_up_to_twelve_degrees_before_its_horizon() {
    let dims = UVec3::splat(112);
    let ball = grid(dims, |v| (v.as_vec3() + 0.5 - 56.0).length() < 55.0);
    let footprint = looking(Vec3::splat(56.0), Vec3::new(0.0, 0.1, 1.0), 3000.0, 2.0, 40.0);
    let taken: HashSet<IVec3> = footprint.touched(&ball).iter().map(|t| t.voxel).collect();
    for v in voxels(dims).filter(|v| ball.get(*v)) {
        let is_surface =
            [IVec3::X, IVec3::Y, IVec3::Z].iter().any(|n| !ball.get(v + n) || !ball.get(v - n));
        let normal = (v.as_vec3() + 0.5 - 56.0).normalize();
        let turn = -normal.dot(footprint.aim);
        assert!(!is_surface || turn < 0.2 || taken.contains(&v), "{v}, turned {turn}");
        assert!(turn > -0.25 || !taken.contains(&v), "{v} behind the horizon, turned {turn}");
    }
}

#[test]
fn a_wall_that_is_seen_edge_on_is_not_taken_down_to_its_foot() {
    let tower = grid(UVec3::new(64, 120, 64), |v| v.x < 32);
    let touched =
        looking(Vec3::new(32.0, 120.0, 32.0), Vec3::Y, 40_000.0, 0.5, 20.0).touched(&tower);
    assert!(touched.iter().all(|t| t.voxel.y >= 117), "the edge, which is turned to the eye");
    assert!(!touched.is_empty());
}
