//! Smooths by a level set at the scale of the brush: forms smaller than the brush go, larger ones stay.
//!
//! From a grid, a footprint and a strength to the voxels that appear and vanish. The smoothed surface is where half of
//! the neighbourhood is filled (`field`). The surface moves towards it in proportion to the strength, less towards the
//! rim of the footprint, and by at most half a radius. Space hidden close behind the surface counts as filled, so that
//! walls keep their thickness; added clay must be surrounded by real clay, too. At the ends of walls and posts, half of
//! the filled share farther in is enough, so that they are rounded and stay. Changes nothing itself.

mod counts;
mod field;
mod hidden;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::ops::Range;

use fearless_simd::{Level as Simd, dispatch};
use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use self::counts::counts;
use self::field::{CellGrid, CellPlaces, FillField, Smoothed};
use self::hidden::Hidden;
use super::distance::Distances;
use super::filter::shifted;
use super::visible::Cone;
use crate::refusal::InvalidValue;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::region::{ListedBricks, VoxelBox};
use crate::sculpture::{Brick, Grid};
use crate::tools::brush::footprint::Footprint;
use crate::tools::brush::kernel::stamp::Stamp;

/// Range of smoothing radii, in units of the smallest voxel edge; larger brushes smooth with the largest.
pub const RADII: std::ops::RangeInclusive<f32> = 2.0..=64.0;
/// Greatest distance that the surface moves in one use, in radii.
const FURTHEST: f32 = 0.5;
/// The surface stays where the smoothed surface is no farther away than this, in units of the smallest edge, so that
/// flat faces are preserved.
const STAYS: f32 = 0.25;
/// More than the rounding error of sums, in the same units.
const ROUNDED: f32 = 1e-3;
/// Depth behind the surface to which hidden space counts as clay, in radii: enough for half a neighbourhood of an
/// oblique surface.
const BEHIND: f32 = 2.0;
/// Share of the radius from which the strength decreases to the rim.
const PLATEAU: f32 = 0.75;
/// Greatest depth at which it works relative to the centre of the brush, in its radii.
const DEPTH: f32 = 2.0;
/// Edge of the cubes that are computed together, in voxels.
const TILE_VX: i32 = 64;

/// Parameters of smoothing.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Level {
    /// Share of the distance to the smoothed surface, 0 to 1.
    pub strength: f32,
    /// Distance that the surface must have moved towards the next voxel for it to change, 0 to 1. Where it differs from
    /// use to use, steps shorter than a voxel add up.
    pub rounding: f32,
}

impl Level {
    /// The usual rounding: to the nearest voxel.
    pub const NEAREST: f32 = 0.5;

    /// Returns an error that names the first invalid field, if there is one.
    pub fn check(&self) -> Result<(), InvalidValue> {
        InvalidValue::check_share("strength", self.strength)?;
        InvalidValue::check_share("rounding", self.rounding)
    }

    /// Returns the voxels that smoothing changes in `grid` under a footprint.
    pub fn stamp(&self, footprint: &Footprint, grid: &Grid) -> Stamp {
        let Some(work) = SmoothingRun::new(*self, footprint, grid) else { return Stamp::default() };
        let found: Vec<_> =
            work.tiles.par_iter().with_max_len(1).map(|tile| work.tile(*tile)).collect();
        // Tiles share no bricks.
        let listed = |part: fn(&VoxelChanges) -> &Vec<Listed>| {
            let mut bricks: Vec<_> = found.iter().flat_map(part).copied().collect();
            bricks.sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
            ListedBricks::new(bricks)
        };
        Stamp {
            add: listed(|(add, _)| add),
            remove: listed(|(_, remove)| remove),
            ..Stamp::default()
        }
    }
}

/// Voxels of a brick.
type Listed = (UVec3, Brick);
/// The voxels to add, and those to remove.
type VoxelChanges = (Vec<Listed>, Vec<Listed>);

/// One use of the brush.
struct SmoothingRun<'a> {
    grid: &'a Grid,
    level: Level,
    footprint: &'a Footprint,
    /// Voxel edges in units of the smallest.
    edges: Vec3,
    /// The smoothing radius in these units.
    radius: f32,
    hidden: Hidden,
    /// The box in which voxels may change.
    bounds: VoxelBox,
    tiles: Vec<IVec3>,
    /// The share of the neighbourhood by which voxels are added, and that by which they stay.
    to_add: FillField,
    to_stay: FillField,
}

/// A voxel that may change.
struct VoxelCandidate {
    voxel: IVec3,
    /// Distance of the smoothed surface beyond it.
    beyond: f32,
    /// The strength with which it is smoothed.
    strength: f32,
    /// It stays if it is farther from the surface than this.
    limit: f32,
}

/// The voxels on the other side of the smoothed surface.
#[derive(Default)]
struct Candidates {
    to_add: Vec<VoxelCandidate>,
    to_remove: Vec<VoxelCandidate>,
}

/// Shares of both fields along a row of cells.
#[derive(Default)]
struct FieldShares {
    adding: Vec<f32>,
    staying: Vec<f32>,
}

/// A row of voxels in whose spans candidates are sought.
struct RowOfVoxels<'a> {
    first: IVec3,
    block: &'a BitBlock,
    along_x: &'a CellPlaces,
    /// The cells along x, each with its voxels of the row.
    spans: &'a [(usize, Range<usize>)],
}

impl<'a> SmoothingRun<'a> {
    /// Returns `None` where the footprint meets nothing.
    fn new(level: Level, footprint: &'a Footprint, grid: &'a Grid) -> Option<SmoothingRun<'a>> {
        let cone = Cone::new(footprint)?;
        let edges = grid.voxel_size() / grid.voxel_size().min_element();
        let touched = footprint.touched(grid);
        let middle = touched.iter().min_by(|a, b| a.offset.total_cmp(&b.offset))?.voxel;
        let depth = |v: IVec3| cone.project(v.as_vec3() + 0.5 - footprint.eye_vx)[2];
        let at = depth(middle);
        let ray = (footprint.across * edges).length().max((footprint.down * edges).length());
        let whole = footprint.radius * ray * at;
        let usable = at > 0.0 && whole.is_finite();
        let radius = usable.then(|| whole.clamp(*RADII.start(), *RADII.end()))?;
        let deepest = DEPTH * whole.max(radius) * cone.per_voxel;
        let near = touched.iter().map(|touch| touch.voxel);
        let near = near.filter(|v| (depth(*v) - at).abs() <= deepest);
        let (bounds, tiles) = around(near, (radius * FURTHEST / edges).ceil().as_ivec3(), grid);
        if bounds.is_empty() {
            return None;
        }
        let cells = CellGrid::new(bounds, middle, radius, edges);
        let margin = (bounds.min - cells.voxels().min).max_element() as f32;
        let spacing = cells.edge.min_element() as f32;
        let behind = BEHIND * radius / edges.min_element();
        let hidden = Hidden::new(footprint, cone, grid, at, [margin, spacing, behind]);
        let (clay, filled) = counts(grid, &cells, &hidden);
        let of_clay = || {
            let clay = Smoothed::new(&cells, clay, radius);
            let level = clay.level();
            let ends = clay.ends(&level);
            (level, ends)
        };
        let of_filled = || Smoothed::new(&cells, filled, radius).level();
        let ((mut to_add, ends), mut to_stay) = rayon::join(of_clay, of_filled);
        to_add.lower_to(&to_stay);
        to_stay.raise_to(&ends);
        Some(SmoothingRun {
            grid,
            level,
            footprint,
            edges,
            radius,
            hidden,
            bounds,
            tiles,
            to_add,
            to_stay,
        })
    }

    /// Returns the bricks added to and removed from a tile.
    fn tile(&self, tile: IVec3) -> VoxelChanges {
        let first = tile * TILE_VX;
        let bounds = VoxelBox { min: first, max: first + TILE_VX }.intersect(self.bounds);
        if bounds.is_empty() {
            return Default::default();
        }
        let Candidates { to_add, to_remove } =
            dispatch!(Simd::new(), _simd => self.candidates(bounds));
        let bricks = |voxels: Option<BitBlock>| {
            voxels.map_or_else(Vec::new, |voxels| voxels.bricks(self.grid.brick_dims()))
        };
        (bricks(self.reached(&to_add, true)), bricks(self.reached(&to_remove, false)))
    }

    /// Returns the voxels on the other side of the smoothed surface.
    #[inline(always)]
    fn candidates(&self, bounds: VoxelBox) -> Candidates {
        let size = bounds.size();
        let along = [0, 1, 2].map(|axis| self.to_add.places(axis, bounds.min[axis], size[axis]));
        let [along_x, along_y, along_z] = &along;
        let mut shares = FieldShares::default();
        let mut found = Candidates::default();
        let mut spans = Vec::new();
        let mut block = None;
        for (cell_z, span_z) in along_z.spans() {
            for (cell_y, span_y) in along_y.spans() {
                let FieldShares { adding, staying } = &mut shares;
                self.to_add.extremes(&along, (cell_y, cell_z), f32::max, adding);
                self.to_stay.extremes(&along, (cell_y, cell_z), f32::min, staying);
                spans.clear();
                spans.extend(along_x.spans().filter(|(cell, _)| {
                    let added = -self.to_add.outside(adding[*cell]);
                    let gone = self.to_stay.outside(staying[*cell]);
                    added.max(gone) > STAYS - ROUNDED
                }));
                if spans.is_empty() {
                    continue;
                }
                let block = block
                    .get_or_insert_with(|| BitBlock::of_grid(self.grid, bounds.min, bounds.max));
                for (z, y) in span_z.clone().flat_map(|z| span_y.clone().map(move |y| (z, y))) {
                    let first = bounds.min + IVec3::new(0, y as i32, z as i32);
                    let row = RowOfVoxels { first, block, along_x, spans: &spans };
                    self.add_row(&row, &mut shares, &mut found);
                }
            }
        }
        found
    }

    /// Adds the candidates of a row of voxels.
    #[inline(always)]
    fn add_row(
        &self,
        &RowOfVoxels { first, block, along_x, spans }: &RowOfVoxels,
        FieldShares { adding, staying }: &mut FieldShares,
        found: &mut Candidates,
    ) {
        let local = first - block.origin();
        let Some(row) = block.row(local.y, local.z) else { return };
        self.to_add.cells(along_x, first.y, first.z, adding);
        self.to_stay.cells(along_x, first.y, first.z, staying);
        for (cell, span) in spans {
            // Between cell centres, shares do not exceed the range at the centres.
            let most = adding[*cell].max(adding[cell + 1]);
            let least = staying[*cell].min(staying[cell + 1]);
            let start = local.x as usize + span.start;
            let all = u64::MAX >> (64 - span.len());
            let bits = shifted(row, start / 64, (start % 64) as i32) & all;
            let may_add = -self.to_add.outside(most) > STAYS;
            let may_go = self.to_stay.outside(least) > STAYS;
            let mut left = if may_go { bits } else { 0 } | if may_add { all & !bits } else { 0 };
            while left != 0 {
                let bit = left.trailing_zeros() as usize;
                left &= left - 1;
                let x = span.start + bit;
                let (beyond, list) = if bits >> bit & 1 != 0 {
                    (self.to_stay.outside(along_x.share(staying, x)), &mut found.to_remove)
                } else {
                    (-self.to_add.outside(along_x.share(adding, x)), &mut found.to_add)
                };
                if beyond > STAYS {
                    list.extend(self.candidate(first + IVec3::X * x as i32, beyond));
                }
            }
        }
    }

    /// Returns a voxel with the smoothed surface at a distance beyond it. `None` if it stays wherever the surface is.
    #[inline(always)]
    fn candidate(&self, voxel: IVec3, beyond: f32) -> Option<VoxelCandidate> {
        let [i, j, s] = self.hidden.project(voxel.as_vec3() + 0.5);
        let Footprint { outline, radius, .. } = *self.footprint;
        let radius = radius.max(0.5);
        if outline.is_beyond(i, j, radius) {
            return None;
        }
        let offset = outline.distance(i, j) / radius;
        let left = ((1.0 - offset) / (1.0 - PLATEAU)).clamp(0.0, 1.0);
        let strength = self.level.strength * left * left * (3.0 - 2.0 * left);
        let most = strength / (1.0 - strength).max(1e-6) * beyond;
        let limit = (most + Level::NEAREST - self.level.rounding).min(FURTHEST * self.radius);
        let may = s > 0.0 && strength > 0.0 && limit >= 0.5;
        may.then_some(VoxelCandidate { voxel, beyond, strength, limit })
    }

    /// Returns whether a voxel at a distance from the surface changes.
    fn changes(&self, candidate: &VoxelCandidate, away: f32) -> bool {
        let VoxelCandidate { beyond, strength, limit, .. } = *candidate;
        // The voxel changes once the surface has passed its centre, or has been rounded there.
        let rounding = Level::NEAREST + (self.level.rounding - Level::NEAREST) * (1.0 - strength);
        let needed = away - 0.5 + rounding;
        away <= limit && strength * (away + beyond) >= needed
    }

    /// Returns the candidates near enough to clay (`to_clay`) or to visible space. `None` if there are none.
    fn reached(&self, candidates: &[VoxelCandidate], to_clay: bool) -> Option<BitBlock> {
        let min = candidates.iter().map(|c| c.voxel).reduce(IVec3::min)?;
        let max = candidates.iter().map(|c| c.voxel).reduce(IVec3::max)? + 1;
        let furthest = candidates.iter().map(|c| c.limit).fold(0.5, f32::max);
        let reach = furthest + 1.0;
        let steps = (Vec3::splat(reach) / self.edges).ceil().as_ivec3();
        let mut block = BitBlock::of_grid(self.grid, min - steps, max + steps);
        if !to_clay {
            self.hidden.fill(&mut block, self.grid);
        }
        let distances = Distances::new(&block, to_clay, VoxelBox { min, max }, reach, self.edges);
        let mut reached = BitBlock::empty(min, max);
        for candidate in candidates {
            let v = candidate.voxel;
            if self.changes(candidate, distances.near(v).sqrt() - 0.5) {
                reached.set_span(v.x, v.x, v.y, v.z);
            }
        }
        Some(reached)
    }
}

/// Returns the box of the voxels up to `reach` from the given ones, and the tiles that contain them.
fn around(
    voxels: impl Iterator<Item = IVec3>,
    reach: IVec3,
    grid: &Grid,
) -> (VoxelBox, Vec<IVec3>) {
    let all = VoxelBox::of_grid(grid);
    let mut bounds = VoxelBox { min: IVec3::MAX, max: IVec3::MIN };
    let mut tiles = BTreeSet::new();
    let tile = |v: IVec3| v.div_euclid(IVec3::splat(TILE_VX));
    let mut last = None;
    for v in voxels {
        let near = VoxelBox { min: v - reach, max: v + reach + 1 }.intersect(all);
        bounds.min = bounds.min.min(near.min);
        bounds.max = bounds.max.max(near.max);
        let (low, high) = (tile(near.min), tile(near.max - 1));
        if last.replace((low, high)) == Some((low, high)) {
            continue;
        }
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                tiles.extend((low.x..=high.x).map(|x| [z, y, x]));
            }
        }
    }
    (bounds, tiles.into_iter().map(|[z, y, x]| IVec3::new(x, y, z)).collect())
}
