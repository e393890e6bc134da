//! Finds drain holes: for each cavity the straight, axis-aligned path to the outside that crosses the fewest voxels.
//!
//! From the empty pieces of a grid to the voxels to remove; changes nothing.

use std::collections::BTreeMap;

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use crate::progress::Progress;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{Brick, Grid};
use crate::tools::pieces::Pieces;

/// The direction of drain holes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Toward {
    /// Down, out of the print's underside or its lowest opening.
    #[default]
    Down,
    /// Along the axis on which the hole is shortest.
    Nearest,
}

impl Toward {
    /// All directions, in the order in which interfaces offer them.
    pub const ALL: [Toward; 2] = [Toward::Down, Toward::Nearest];

    /// Returns the name in the text form.
    pub const fn name(self) -> &'static str {
        match self {
            Toward::Down => "down",
            Toward::Nearest => "nearest",
        }
    }
}

/// An axis-aligned path from a voxel of a cavity to the first voxel outside.
#[derive(Clone, Copy, PartialEq, Debug)]
struct DrainPath {
    from: IVec3,
    /// Unit vector.
    step: IVec3,
    length_vx: i32,
    /// Number of voxels to be removed along it.
    through: i32,
    /// Squared distance from the centre of the cavity, so that of equal paths the middle one is taken.
    aside: f32,
}

/// Returns the voxels of a round hole of `diameter_vx` (in voxel edges along x) for each cavity of `empty`. `None` if
/// cancelled.
pub fn holes(
    grid: &Grid,
    empty: &Pieces,
    diameter_vx: f32,
    toward: Toward,
    progress: &dyn Progress,
) -> Option<ListedBricks> {
    let cavities = 0..empty.list().len() as u32;
    let cavities: Vec<u32> = cavities.filter(|piece| !empty.reaches_border(*piece)).collect();
    let steps: &[IVec3] = match toward {
        Toward::Down => &[IVec3::NEG_Y],
        // Down first: of equal paths the first is taken.
        Toward::Nearest => {
            &[IVec3::NEG_Y, IVec3::NEG_X, IVec3::X, IVec3::NEG_Z, IVec3::Z, IVec3::Y]
        }
    };
    progress.begin("drilling holes");
    let paths: Vec<Option<DrainPath>> = cavities
        .par_iter()
        .map(|&cavity| {
            let all = steps.iter().filter(|_| !progress.is_cancelled());
            let paths = all.filter_map(|&step| shortest(grid, empty, cavity, step));
            paths.reduce(|a, b| if b.through < a.through { b } else { a })
        })
        .collect();
    progress.end();
    if progress.is_cancelled() {
        return None;
    }
    let mut bricks = BTreeMap::new();
    for path in paths.into_iter().flatten() {
        drill(grid, path, diameter_vx, &mut bricks);
    }
    let listed = bricks.into_iter().map(|([z, y, x], mask)| (UVec3::new(x, y, z), mask));
    Some(ListedBricks::new(listed.collect()))
}

/// Returns the path out of a cavity in the direction `step` that crosses the fewest voxels.
fn shortest(grid: &Grid, empty: &Pieces, cavity: u32, step: IVec3) -> Option<DrainPath> {
    let (low, high) = empty.list()[cavity as usize].bounds();
    let (low, high) = (low.as_ivec3(), high.as_ivec3());
    let middle = (low + high).as_vec3() * 0.5;
    let along = step.abs();
    // A column begins where the cavity ends in this direction.
    let last = if step.element_sum() > 0 { high - 1 } else { low };
    let (first, end) = (low * (1 - along) + last * along, high * (1 - along) + (last + 1) * along);
    let mut best: Option<DrainPath> = None;
    for (z, y) in (first.z..end.z).flat_map(|z| (first.y..end.y).map(move |y| (z, y))) {
        for x in first.x..end.x {
            let outer = IVec3::new(x, y, z);
            let depth = ((high - low) * along).element_sum();
            let is_cavity = |v: &IVec3| !grid.get(*v) && empty.at(*v) == Some(cavity);
            let Some(from) = (0..depth).map(|i| outer - step * i).find(is_cavity) else {
                continue;
            };
            let aside = ((from.as_vec3() + 0.5 - middle) * (1 - along).as_vec3()).length_squared();
            let (mut at, mut length_vx, mut through) = (from, 0, 0);
            loop {
                at += step;
                length_vx += 1;
                if grid.get(at) {
                    through += 1;
                    if best.is_some_and(|best| through > best.through) {
                        break;
                    }
                } else if empty.at(at).is_none_or(|piece| empty.reaches_border(piece)) {
                    let better = |best: DrainPath| (through, aside) < (best.through, best.aside);
                    if best.is_none_or(better) {
                        best = Some(DrainPath { from, step, length_vx, through, aside });
                    }
                    break;
                }
            }
        }
    }
    best
}

/// Adds the voxels of the hole along a path.
fn drill(grid: &Grid, path: DrainPath, diameter_vx: f32, bricks: &mut BTreeMap<[u32; 3], Brick>) {
    let DrainPath { from, step, length_vx, .. } = path;
    let stretch = grid.voxel_size() / grid.voxel_size().x;
    let across = 1 - step.abs();
    let limit = 0.25 * diameter_vx * diameter_vx;
    // No voxel of a hole is further away than the grid is long.
    let longest = grid.dims().as_ivec3();
    let reach = (Vec3::splat(0.5 * diameter_vx) / stretch).as_ivec3().min(longest) * across;
    for (z, y) in (-reach.z..=reach.z).flat_map(|z| (-reach.y..=reach.y).map(move |y| (z, y))) {
        for x in -reach.x..=reach.x {
            let offset = IVec3::new(x, y, z);
            if (offset.as_vec3() * stretch).length_squared() > limit && offset != IVec3::ZERO {
                continue;
            }
            for v in (0..=length_vx).map(|i| from + offset + step * i).filter(|v| grid.get(*v)) {
                let v = v.as_uvec3();
                let UVec3 { x, y, z } = v / BRICK_EDGE_VX;
                let local = v % BRICK_EDGE_VX;
                let brick = bricks.entry([z, y, x]).or_insert(Brick::EMPTY);
                brick.set(local.x, local.y, local.z, true);
            }
        }
    }
}
