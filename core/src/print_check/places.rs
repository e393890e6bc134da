//! Groups faulty voxels into places: voxels that are near each other form one place.
//!
//! Takes masks, returns a [`Finding`].

use glam::{IVec3, UVec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::{CheckError, FaultKind, FaultLocation, Finding, MOST_PLACES};
use crate::progress::Progress;
use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, local_coords};
use crate::sculpture::grid::{GridPart, for_each_part};
use crate::sculpture::region::{BrickBox, ListedBricks, Region, VoxelBox};
use crate::tools::pieces::{PiecesOf, pieces};
use crate::tools::repair::Repair;

/// Overhangs of fewer voxels are the roughness of a surface.
const LEAST_OVERHANG: u64 = 4;

/// Returns a finding of `places`; `None` if there are none.
pub fn finding(
    kind: FaultKind,
    mut places: Vec<FaultLocation>,
    repairs: Vec<Repair>,
    marked: impl FnOnce() -> ListedBricks,
) -> Option<Finding> {
    if places.is_empty() {
        return None;
    }
    let (count, voxels) = (places.len(), places.iter().map(|place| place.voxels).sum());
    places.sort_by_key(|place| std::cmp::Reverse(place.voxels));
    places.truncate(MOST_PLACES);
    Some(Finding { kind, count, voxels, places, marked: marked(), repairs })
}

/// Returns the finding of the voxels `marked`, with those within about two voxels of each other in one place.
pub(crate) fn gathered(
    grid: &Grid,
    kind: FaultKind,
    marked: ListedBricks,
    repairs: Vec<Repair>,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<Option<Finding>, CheckError> {
    if marked.bricks().is_empty() {
        return Ok(None);
    }
    // The cells of 2^3 voxels that hold a marked one, and those around them: connected cells form one place.
    let bounds = marked.bounds_vx();
    let corner = bounds.min.max(IVec3::ZERO).as_uvec3() / 2;
    let dims = (bounds.max.as_uvec3() / 2 - corner).max(UVec3::ONE);
    let mut cells = Grid::new(dims, glam::Vec3::ONE, budget_bytes)?;
    let mut masks: FxHashMap<UVec3, Brick> = FxHashMap::default();
    // Most cells lie in the same brick as the last one.
    let mut last = (UVec3::ZERO, Brick::EMPTY);
    let mut add = |(b, mask): (UVec3, Brick)| {
        let all = masks.entry(b).or_default();
        *all = all.or(&mask);
    };
    for v in voxels(&marked) {
        let cell = (v / 2 - corner).as_ivec3();
        for offset in [IVec3::ZERO, IVec3::X, IVec3::Y, IVec3::Z] {
            let at = cell + offset;
            if cells.contains(at) {
                let (b, local) = (at.as_uvec3() / BRICK_EDGE_VX, at.as_uvec3() % BRICK_EDGE_VX);
                if b != last.0 {
                    add(std::mem::replace(&mut last, (b, Brick::EMPTY)));
                }
                last.1.set(local.x, local.y, local.z, true);
            }
        }
    }
    add(last);
    masks.iter().for_each(|(b, mask)| cells.put_brick(*b, mask));
    let found = pieces(&cells, PiecesOf::Solid, budget_bytes, progress).map_err(check_error)?;
    let none = VoxelBox { min: IVec3::MAX, max: IVec3::MIN };
    let mut places = vec![FaultLocation { voxels: 0, bounds: none }; found.list().len()];
    let place_of = |v: UVec3| found.at((v / 2 - corner).as_ivec3()).map(|piece| piece as usize);
    for v in voxels(&marked) {
        let Some(piece) = place_of(v) else { continue };
        let place = &mut places[piece];
        place.voxels += 1;
        place.bounds.min = place.bounds.min.min(v.as_ivec3());
        place.bounds.max = place.bounds.max.max(v.as_ivec3() + 1);
    }
    let least = if kind == FaultKind::Overhangs { LEAST_OVERHANG } else { 1 };
    let is_kept: Vec<bool> = places.iter().map(|place| place.voxels >= least).collect();
    places.retain(|place| place.voxels >= least);
    let kept = || {
        let of_brick = |(b, mask): &(UVec3, Brick)| {
            let mut kept = Brick::EMPTY;
            mask.for_each(|local| {
                let [x, y, z] = local_coords(local);
                let v = *b * BRICK_EDGE_VX + UVec3::new(x, y, z);
                if place_of(v).is_some_and(|piece| is_kept[piece]) {
                    kept.set(x, y, z, true);
                }
            });
            (*b, kept)
        };
        let kept = marked.bricks().par_iter().map(of_brick);
        ListedBricks::new(kept.filter(|(_, mask)| !mask.is_empty()).collect())
    };
    debug_assert!(bounds.max.cmple((grid.brick_dims() * BRICK_EDGE_VX).as_ivec3()).all());
    Ok(finding(kind, places, repairs, kept))
}

fn check_error(error: crate::tools::pieces::PiecesError) -> CheckError {
    CheckError::from(crate::tools::repair::RepairError::from(error))
}

/// Returns the voxels of `marked`.
pub fn voxels(marked: &ListedBricks) -> impl Iterator<Item = UVec3> {
    marked.bricks().iter().flat_map(|(b, mask)| {
        let mut inside = Vec::with_capacity(mask.count().into());
        mask.for_each(|local| inside.push(*b * BRICK_EDGE_VX + UVec3::from(local_coords(local))));
        inside
    })
}

/// Returns the number of voxels in the layer `y` of a grid.
pub(crate) fn count_in_layer(grid: &Grid, y: u32) -> u64 {
    let (row, dims) = (y / BRICK_EDGE_VX, grid.brick_dims());
    let layer = BrickBox { min: UVec3::new(0, row, 0), max: UVec3::new(dims.x, row + 1, dims.z) };
    let in_brick = |brick: &Brick| -> u32 {
        let rows = brick.to_rows();
        rows.iter().map(|rows| (rows >> (8 * (y % BRICK_EDGE_VX)) & 0xFF).count_ones()).sum()
    };
    let mut count = 0;
    for_each_part(grid, layer, &mut |part| match part {
        GridPart::Uniform { is_full: false, .. } => {}
        GridPart::Uniform { bricks, .. } => {
            let end = (bricks.max * BRICK_EDGE_VX).min(grid.dims());
            let size = (end - bricks.min * BRICK_EDGE_VX).as_u64vec3();
            count += size.x * size.z;
        }
        GridPart::Mixed(_, brick) => count += u64::from(in_brick(brick)),
    });
    count
}
