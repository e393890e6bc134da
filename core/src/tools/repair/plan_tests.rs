//! Tests repaired sculptures: which voxels are removed, which are added, and that nothing is left to repair.

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::progress::ProgressReport;

const EDGE: u32 = 32;
const ROOM: u64 = 1 << 26;

fn grid(exists: impl Fn(IVec3) -> bool) -> Grid {
    let mut grid = Grid::new(UVec3::splat(EDGE), Vec3::ONE, ROOM).unwrap();
    for index in 0..EDGE.pow(3) {
        let v = grid.voxel_coords(index).as_ivec3();
        if exists(v) {
            grid.set(v, true);
        }
    }
    grid
}

fn within(v: IVec3, low: [i32; 3], high: [i32; 3]) -> bool {
    v.cmpge(IVec3::from(low)).all() && v.cmplt(IVec3::from(high)).all()
}

fn repaired(grid: &Grid, repair: Repair) -> Grid {
    let plan = repair.plan(grid, ROOM, &()).unwrap();
    let mut after = grid.clone();
    for (b, mask) in plan.remove.bricks() {
        let index = after.brick_index(*b);
        assert_eq!(mask.and_not(after.brick_at(index)).count(), 0, "only what exists goes");
        after.set_brick(index, after.brick_at(index).and_not(mask));
    }
    for (b, mask) in plan.add.bricks() {
        let index = after.brick_index(*b);
        assert_eq!(mask.and(after.brick_at(index)).count(), 0, "only what is empty comes");
        after.set_brick(index, after.brick_at(index).or(mask));
    }
    after
}

fn cavities(grid: &Grid) -> usize {
    let found = pieces(grid, PiecesOf::Empty, ROOM, &()).unwrap();
    (0..found.list().len()).filter(|piece| !found.reaches_border(*piece as u32)).count()
}

/// Returns a body of 8^3 voxels, a post of 8 and a stone of 64 beside it, dust in the air.
fn scene() -> Grid {
    grid(|v| {
        within(v, [4, 3, 4], [12, 11, 12])
            || within(v, [20, 3, 20], [21, 11, 21])
            || within(v, [20, 8, 4], [24, 12, 8])
            || v == IVec3::new(30, 30, 30)
    })
}

#[test]
fn islands_go_and_the_largest_piece_stays() {
    let removed = |keep, smaller_vx| {
        let before = scene();
        let after = repaired(&before, Repair::RemoveIslands { keep, smaller_vx });
        assert!(after.get(IVec3::new(8, 8, 8)));
        before.opaque_count() - after.opaque_count()
    };
    assert_eq!(removed(Keep::Standing, None), 64 + 1);
    assert_eq!(removed(Keep::Standing, Some(64)), 1);
    assert_eq!(removed(Keep::Largest, None), 64 + 1 + 8);
    assert_eq!(removed(Keep::Largest, Some(9)), 1 + 8);
    assert_eq!(removed(Keep::Largest, Some(0)), 0);
    // The largest piece stays even where only dust lies on the bed.
    let hanging = grid(|v| within(v, [4, 8, 4], [12, 16, 12]) || v == IVec3::ZERO);
    let keep = |keep| repaired(&hanging, Repair::RemoveIslands { keep, smaller_vx: None });
    assert_eq!(keep(Keep::Standing), hanging);
    assert_eq!(keep(Keep::Largest).opaque_count(), 512);
}

#[test]
fn cavities_are_filled_by_size() {
    let hollow = grid(|v| {
        within(v, [2, 2, 2], [30, 30, 30])
            && !within(v, [4, 4, 4], [9, 9, 9])
            && v != IVec3::splat(20)
            // A shaft to the outside is no cavity.
            && !within(v, [15, 10, 15], [16, 32, 16])
    });
    assert_eq!(cavities(&hollow), 2);
    let fill = |smaller_vx| repaired(&hollow, Repair::FillCavities { smaller_vx });
    assert_eq!(fill(None).opaque_count() - hollow.opaque_count(), 125 + 1);
    assert_eq!(fill(Some(125)).opaque_count() - hollow.opaque_count(), 1);
    assert_eq!(cavities(&fill(None)), 0);
}

#[test]
fn a_hole_is_round_and_takes_the_way_that_is_asked_for() {
    // Five voxels below the cavity, three beside it.
    let hollow =
        grid(|v| within(v, [2, 2, 2], [30, 30, 30]) && !within(v, [5, 7, 10], [12, 15, 20]));
    let drilled = |diameter_vx, toward| {
        let after = repaired(&hollow, Repair::Drain { diameter_vx, toward });
        assert_eq!(cavities(&after), 0);
        (hollow.opaque_count() - after.opaque_count(), after)
    };
    assert_eq!(drilled(1.0, Toward::Down).0, 5);
    assert_eq!(drilled(1.0, Toward::Nearest).0, 3);
    // Thirteen voxels lie within two of the centre.
    let (gone, after) = drilled(4.0, Toward::Nearest);
    assert_eq!(gone, 13 * 3);
    assert!(!after.get(IVec3::new(3, 10, 14)) && !after.get(IVec3::new(3, 10, 16)));
    assert!(after.get(IVec3::new(3, 12, 16)), "round, in the middle of the cavity");
}

#[test]
fn lengths_out_of_range_are_refused() {
    let solid = grid(|_| true);
    for length in [0.0, -1.0, f32::NAN, f32::INFINITY, 64.5, 1e30] {
        let thicken = Repair::Thicken { to_vx: length };
        let drain = Repair::Drain { diameter_vx: length, toward: Toward::Down };
        for repair in [thicken, drain] {
            let error = repair.plan(&solid, ROOM, &()).unwrap_err();
            assert!(matches!(error, RepairError::Invalid(_)), "{repair:?}");
        }
    }
}

#[test]
fn too_little_memory_and_cancellation_are_errors() {
    let cancelled = ProgressReport::default();
    cancelled.cancel();
    let all = [
        Repair::RemoveIslands { keep: Keep::Standing, smaller_vx: None },
        Repair::FillCavities { smaller_vx: None },
        Repair::Thicken { to_vx: 3.0 },
        Repair::Drain { diameter_vx: 3.0, toward: Toward::Nearest },
    ];
    for repair in all {
        let error = repair.plan(&scene(), 100, &()).unwrap_err();
        assert!(error.to_string().contains("allowed for grids"), "{error}");
        assert_eq!(repair.plan(&scene(), ROOM, &cancelled), Err(RepairError::Cancelled));
        assert_eq!(repair.plan(&grid(|_| false), ROOM, &()), Ok(RepairPlan::default()));
        assert_eq!(repair.plan(&grid(|_| true), ROOM, &()), Ok(RepairPlan::default()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn whatever_is_drained_or_filled_has_no_cavity(
        balls in prop::collection::vec((prop::array::uniform3(0i32..32), 1i32..7), 0..6),
        diameter_vx in 0.5f32..5.0,
    ) {
        let solid = grid(|v| balls.iter().all(|(c, r)| (v - IVec3::from(*c)).length_squared() > r * r));
        for toward in Toward::ALL {
            prop_assert_eq!(cavities(&repaired(&solid, Repair::Drain { diameter_vx, toward })), 0);
        }
        let filled = repaired(&solid, Repair::FillCavities { smaller_vx: None });
        prop_assert_eq!(cavities(&filled), 0);
    }

    #[test]
    fn whatever_is_left_hangs_together(
        boxes in prop::collection::vec((prop::array::uniform3(0i32..28), 1i32..8), 1..7),
    ) {
        let solid = grid(|v| boxes.iter().any(|(c, n)| within(v, *c, c.map(|c| c + n))));
        let repair = Repair::RemoveIslands { keep: Keep::Largest, smaller_vx: None };
        let left = repaired(&solid, repair);
        prop_assert_eq!(pieces(&left, PiecesOf::Solid, ROOM, &()).unwrap().list().len(), 1);
    }
}
