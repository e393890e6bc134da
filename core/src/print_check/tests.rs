//! Tests solids with known faults.

use glam::{IVec3, UVec3};
use proptest::prelude::*;

use super::*;
use crate::progress::ProgressReport;

const EDGE: u32 = 48;
const ROOM: u64 = 1 << 28;

/// Returns a grid of the voxels for which `exists` is true. It gets the centre of each voxel, relative to that of the
/// grid.
fn grid(exists: impl Fn(Vec3) -> bool) -> Grid {
    let mut grid = Grid::new(UVec3::splat(EDGE), Vec3::ONE, ROOM).unwrap();
    for index in 0..EDGE.pow(3) {
        let v = grid.voxel_coords(index).as_ivec3();
        if exists(v.as_vec3() + 0.5 - EDGE as f32 * 0.5) {
            grid.set(v, true);
        }
    }
    grid
}

fn checked(grid: &Grid, options: &CheckOptions) -> Checked {
    let checked = check(grid, options, ROOM, &()).unwrap();
    for finding in &checked.findings {
        let marked = finding.marked.bricks().iter().map(|(_, mask)| u64::from(mask.count()));
        assert_eq!(marked.sum::<u64>(), finding.voxels, "{:?}", finding.kind);
        let listed: u64 = finding.places.iter().map(|place| place.voxels).sum();
        assert!(finding.count > MOST_PLACES || listed == finding.voxels);
        assert!(finding.places.is_sorted_by_key(|place| std::cmp::Reverse(place.voxels)));
    }
    checked
}

fn overhang_of(grid: &Grid, options: &CheckOptions) -> Vec<Vec3> {
    let checked = checked(grid, options);
    let finding = checked.finding(FaultKind::Overhangs);
    let voxels = finding.map(|finding| places::voxels(&finding.marked).collect::<Vec<_>>());
    let middle = |v: UVec3| v.as_vec3() + 0.5 - EDGE as f32 * 0.5;
    voxels.unwrap_or_default().into_iter().map(middle).collect()
}

fn kinds(checked: &Checked) -> Vec<FaultKind> {
    checked.findings.iter().map(|finding| finding.kind).collect()
}

#[test]
fn a_cube_is_printable_and_has_its_size() {
    let cube = grid(|p| p.abs().max_element() < 10.0);
    let options = CheckOptions { voxel_mm: Some(0.5), ..Default::default() };
    let found = checked(&cube, &options);
    assert_eq!((found.findings.len(), found.is_printable()), (0, true));
    assert_eq!((found.size_mm, found.contact_mm2), (Vec3::splat(10.0), 100.0));
    assert_eq!(found.voxel_mm, Vec3::splat(0.5));
    let empty = checked(&grid(|_| false), &options);
    assert_eq!((empty.size_mm, empty.is_printable()), (Vec3::ZERO, false), "nothing to print");
    assert_eq!(checked(&grid(|_| true), &options).findings, []);
}

#[test]
fn a_print_fits_upright_or_turned_by_a_quarter() {
    let plank = grid(|p| p.x.abs() < 20.0 && p.y.abs() < 4.0 && p.z.abs() < 10.0);
    let fits = |bed_mm: [f32; 3]| {
        let found = checked(&plank, &CheckOptions { bed_mm: bed_mm.into(), ..Default::default() });
        assert_eq!(found.is_printable(), found.fits);
        found.fits
    };
    assert!(fits([40.0, 8.0, 20.0]) && fits([20.0, 8.0, 40.0]));
    assert!(!fits([39.0, 8.0, 20.0]) && !fits([20.0, 7.0, 40.0]) && !fits([39.0, 100.0, 39.0]));
}

#[test]
fn each_fault_is_found_with_the_command_that_repairs_it() {
    let faulty = grid(|p| {
        let body = p.abs().max_element() < 12.0 && p.length() > 5.0;
        let island = (p - Vec3::new(18.0, 10.0, 18.0)).abs().max_element() < 2.0;
        let fin = p.x.abs() < 1.0 && p.z.abs() < 8.0 && p.y > 0.0 && p.y < 22.0;
        body || island || fin && p.y > 11.0
    });
    let options = CheckOptions { wall_mm: 4.0, ..Default::default() };
    let found = checked(&faulty, &options);
    assert_eq!(kinds(&found), FaultKind::ALL);
    assert!(!found.is_printable());
    let finding = |kind| found.finding(kind).unwrap();
    let island = finding(FaultKind::Islands);
    assert_eq!((island.count, island.voxels), (1, 64));
    assert_eq!(island.places[0].bounds.min, IVec3::new(40, 32, 40));
    assert_eq!(finding(FaultKind::Cavities).count, 1);
    assert_eq!(finding(FaultKind::ThinWalls).count, 1);
    // Below the island; the ceiling of the cavity need not be checked here.
    let below =
        |place: &FaultLocation| place.voxels == 16 && place.bounds.min == IVec3::new(40, 32, 40);
    assert!(finding(FaultKind::Overhangs).places.iter().any(below));
    let lines = |kind| finding(kind).repairs.iter().map(|repair| repair.verb()).collect::<Vec<_>>();
    assert_eq!(lines(FaultKind::Islands), ["remove-islands"]);
    assert_eq!(lines(FaultKind::Cavities), ["fill-cavities", "drain"]);
    assert_eq!(lines(FaultKind::ThinWalls), ["thicken"]);
    assert!(lines(FaultKind::Overhangs).is_empty());
    // The first repairs of all findings together leave nothing but overhangs.
    let mut repaired = faulty;
    for repair in found.findings.iter().filter_map(|finding| finding.repairs.first()) {
        let plan = repair.plan(&repaired, ROOM, &()).unwrap();
        for (b, mask) in plan.remove.bricks() {
            let index = repaired.brick_index(*b);
            repaired.set_brick(index, repaired.brick_at(index).and_not(mask));
        }
        for (b, mask) in plan.add.bricks() {
            let index = repaired.brick_index(*b);
            repaired.set_brick(index, repaired.brick_at(index).or(mask));
        }
    }
    let left = checked(&repaired, &options);
    assert!(left.is_printable(), "{:?}", kinds(&left));
}

#[test]
fn a_largest_piece_in_the_air_is_found_and_stays() {
    let hanging = grid(|p| p.abs().max_element() < 8.0 || p.y < -22.0 && p.x.abs() < 3.0);
    let found = checked(&hanging, &CheckOptions::default());
    let island = found.finding(FaultKind::Islands).unwrap();
    assert_eq!((island.count, island.voxels), (1, 16 * 16 * 16));
    let keep = Keep::Largest;
    assert_eq!(island.repairs, [Repair::RemoveIslands { keep, smaller_vx: None }]);
}

#[test]
fn a_ball_needs_support_below_its_steep_part() {
    let ball = grid(|p| p.length() < 20.0);
    let found = overhang_of(&ball, &CheckOptions::default());
    // The angle between the normal and the direction down.
    let angle = |p: &Vec3| (-p.y / p.length()).acos().to_degrees();
    assert!(found.iter().all(|p| p.y < 0.0 && angle(p) < 45.0));
    // All whose surface leans by more than 54 degrees, except those on the bed and above its first voxels.
    let steep = |p: &Vec3| {
        let faces_down = p.length() < 20.0 && (*p - Vec3::Y).length() >= 20.0;
        faces_down && p.y > -19.0 && angle(p) < 36.0
    };
    let all = (0..EDGE.pow(3)).map(|i| ball.voxel_coords(i).as_vec3() + 0.5 - EDGE as f32 * 0.5);
    let (mut count, mut missed) = (0, 0);
    for p in all.filter(steep) {
        count += 1;
        missed += u32::from(!found.contains(&p));
    }
    assert!(count > 300 && missed == 0, "{missed} of {count}");
}

#[test]
fn cones_on_their_tip_need_support_from_their_angle_on() {
    // With a radius of 10 voxels at the bed.
    let cone = |deg: f32| {
        let slope = deg.to_radians().tan();
        grid(|p| p.x.hypot(p.z) < 6.0 + (p.y + 12.0) * slope && p.y > -12.0 && p.y < -2.0)
    };
    let count = |deg, overhang_deg| {
        let options = CheckOptions { overhang_deg, ..Default::default() };
        let found = overhang_of(&cone(deg), &options);
        // Without the rims.
        found.iter().filter(|p| p.y > -10.0 && p.y < -4.0).count()
    };
    assert_eq!(count(30.0, 45.0), 0);
    assert_eq!(count(45.0, 52.0), 0);
    assert!(count(60.0, 45.0) > 300);
    assert_eq!(count(60.0, 70.0), 0);
    assert!(count(45.0, 30.0) > 150);
    assert_eq!(count(60.0, 90.0), 0);
    // On their base they need none.
    let upright = grid(|p| p.y.abs() < 10.0 && p.x.hypot(p.z) < 10.0 - p.y);
    assert_eq!(overhang_of(&upright, &CheckOptions::default()), []);
}

#[test]
fn the_arms_of_a_t_need_support_and_a_short_bridge_does_not() {
    let post = |p: Vec3| p.x.abs() < 4.0 && p.y.abs() < 12.0;
    let tee = grid(|p| p.z.abs() < 4.0 && (post(p) || p.x.abs() < 16.0 && p.y > 6.0 && p.y < 12.0));
    let found = overhang_of(&tee, &CheckOptions::default());
    assert!(found.iter().all(|p| p.y == 6.5 && p.x.abs() > 4.0));
    // Some of the voxels beside the post may lean less.
    assert!(found.len() >= 10 * 8 * 2 && found.len() <= 12 * 8 * 2, "{}", found.len());
    let thin =
        grid(|p| p.z.abs() < 4.0 && (post(p) || p.x.abs() < 16.0 && p.y > 11.0 && p.y < 12.0));
    assert_eq!(overhang_of(&thin, &CheckOptions::default()).len(), 11 * 8 * 2, "beside the post");
    // A gate of 8 voxels between two posts.
    let gate = grid(|p| p.abs().max_element() < 14.0 && !(p.x.abs() < 4.0 && p.y < 6.0));
    let over = |bridge_mm| {
        let options = CheckOptions { bridge_mm, ..Default::default() };
        overhang_of(&gate, &options).len()
    };
    assert!(over(7.0) > 100);
    assert_eq!(over(8.0), 0);
}

#[test]
fn options_out_of_range_are_named() {
    let cube = grid(|p| p.abs().max_element() < 4.0);
    let options = CheckOptions::default();
    let cases = [
        (CheckOptions { wall_mm: 0.0, ..options }, "walls"),
        (CheckOptions { wall_mm: f32::NAN, ..options }, "walls"),
        (CheckOptions { wall_mm: 65.0, ..options }, "more than 64 voxels"),
        (CheckOptions { overhang_deg: 91.0, ..options }, "overhangs"),
        (CheckOptions { overhang_deg: f32::NAN, ..options }, "overhangs"),
        (CheckOptions { bridge_mm: -1.0, ..options }, "bridges"),
        (CheckOptions { bed_mm: Vec3::new(1.0, f32::INFINITY, 1.0), ..options }, "bed"),
        (CheckOptions { voxel_mm: Some(0.0), ..options }, "voxel"),
        (CheckOptions { voxel_mm: Some(1e-30), ..options }, "more than 64 voxels"),
    ];
    for (options, word) in cases {
        let error = check(&cube, &options, ROOM, &()).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
    let error = check(&cube, &options, 100, &()).unwrap_err().to_string();
    assert!(error.contains("allowed for grids"), "{error}");
    let cancelled = ProgressReport::default();
    cancelled.cancel();
    assert_eq!(check(&cube, &options, ROOM, &cancelled), Err(CheckError::Cancelled));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Mirroring a sculpture along x or z preserves the number of voxels of each kind; any sculpture is checked without
    /// a panic.
    #[test]
    fn findings_are_mirrored_with_the_sculpture(
        boxes in prop::collection::vec((prop::array::uniform3(-24i32..20), prop::array::uniform3(1i32..20)), 0..6),
        wall_mm in 0.5f32..6.0, overhang_deg in 0f32..90.0,
    ) {
        let inside = |p: Vec3| boxes.iter().any(|(low, size)| {
            let (low, size) = (IVec3::from(*low).as_vec3(), IVec3::from(*size).as_vec3());
            p.cmpgt(low).all() && p.cmplt(low + size).all()
        });
        let options = CheckOptions { wall_mm, overhang_deg, ..Default::default() };
        let own = checked(&grid(inside), &options);
        let mirrored = checked(&grid(|p| inside(p * Vec3::new(-1.0, 1.0, 1.0))), &options);
        for kind in [FaultKind::Islands, FaultKind::Cavities] {
            let count = |checked: &Checked| checked.finding(kind).map(|f| (f.count, f.voxels));
            prop_assert_eq!(count(&own), count(&mirrored));
        }
        prop_assert_eq!((own.size_mm, own.contact_mm2), (mirrored.size_mm, mirrored.contact_mm2));
    }
}
