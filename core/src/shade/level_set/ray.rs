//! Intersects a ray with the smooth surface.
//!
//! A ray goes from cell to cell. Within a cell the field along it is a cubic polynomial: a change of sign is searched
//! between its extrema, and the root refined (Marmitt, Kleer, Wald, Friedrich and Slusallek, "Fast and accurate
//! ray-voxel intersection techniques for iso-surface ray tracing", 2004). shaders/level_set.wgsl is the twin of this
//! file.

use glam::{IVec3, UVec3, Vec3};

use super::{LevelSet, corner};
use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::shade::NormalField;
use crate::shade::normal_field::{NO_PAGE, PackedNormal};
use crate::surface::raycast;

/// The most cells that a ray examines; a ray along a rough surface passes through many. Beyond them, no surface is
/// found.
const MOST_CELLS: u32 = 1024;
/// The least length of a ray in an empty cell, in voxels, from which the ray caster searches for the next existing
/// cell.
const LEAST_SEGMENT_VX: f32 = 0.02;
/// Steps of the search for a root: far below a hundredth of a voxel.
const ROOT_STEPS: u32 = 6;
/// Added to the weight of each corner, so that a point in a corner of the cell has a normal, too.
const LEAST_SHARE: f32 = 1e-3;

/// A point on the smooth surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SurfaceHit {
    /// The existing voxel nearest to the point, among the corners of its cell.
    pub voxel: UVec3,
    /// Points out of the surface; none if no corner of the cell has one.
    pub normal: PackedNormal,
    /// The distance along the ray, in lengths of its direction.
    pub t: f32,
}

/// Selects the existing corner of a cell that is reported for a point on the surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Naming {
    Nearest,
    /// Selects the nearer ones more often, by a number from 0 to 1: in the mean of many, colours are interpolated.
    ByShare(f32),
}

/// The scene that a ray is traced through.
#[derive(Clone, Copy)]
pub(super) struct LevelScene<'a> {
    pub grid: &'a Grid,
    pub normals: &'a NormalField,
    pub levels: &'a LevelSet,
}

/// A cell with the values at its corners.
#[derive(Clone)]
struct Cell {
    at: IVec3,
    levels: [f32; 8],
    /// Some of the levels are not known yet.
    is_outstanding: bool,
    /// 0 if there is none; valid for the existing corners, once requested.
    normals: [Vec3; 8],
    has_normals: bool,
}

/// The cells that were examined last: adjacent pixels examine the same ones. The cache does not affect results.
#[derive(Clone)]
pub struct CellCache {
    cells: Vec<Cell>,
    /// Bricks whose levels were needed and are outstanding.
    pub(super) outstanding: Vec<UVec3>,
}

const CACHED_CELLS: usize = 1 << 9;

impl Default for CellCache {
    fn default() -> CellCache {
        let nothing = Cell {
            at: IVec3::MIN,
            levels: [0.0; 8],
            is_outstanding: false,
            normals: [Vec3::ZERO; 8],
            has_normals: false,
        };
        CellCache { cells: vec![nothing; CACHED_CELLS], outstanding: Vec::new() }
    }
}

impl CellCache {
    #[inline(always)]
    fn slot(&mut self, at: IVec3) -> &mut Cell {
        let hash = (at.x as usize) ^ (at.y as usize) << 3 ^ (at.z as usize) << 6;
        let hash = hash ^ hash >> 9;
        &mut self.cells[hash % CACHED_CELLS]
    }

    /// Returns a cell with its levels.
    #[inline(always)]
    fn cell(&mut self, grid: &Grid, levels: &LevelSet, at: IVec3) -> &mut Cell {
        let known = self.slot(at);
        if known.at != at || known.is_outstanding {
            let is_outstanding = levels.is_outstanding(grid, at, &mut self.outstanding);
            let known = self.slot(at);
            known.levels = levels.corners(grid, at);
            (known.at, known.is_outstanding, known.has_normals) = (at, is_outstanding, false);
        }
        self.slot(at)
    }

    /// Returns the levels of the corners of a cell.
    #[inline(always)]
    pub(super) fn levels(&mut self, grid: &Grid, levels: &LevelSet, at: IVec3) -> &[f32; 8] {
        &self.cell(grid, levels, at).levels
    }
}

impl LevelScene<'_> {
    /// Returns the first point on the surface along a ray in coordinates of cells. `first` is its first existing cell.
    #[inline(always)]
    pub fn hit(
        &self,
        naming: Naming,
        origin: Vec3,
        direction: Vec3,
        first: UVec3,
        cache: &mut CellCache,
    ) -> Option<SurfaceHit> {
        let cells = self.levels.cells();
        let dims = cells.dims().as_ivec3();
        let inverse = direction.recip();
        let step = IVec3::select(direction.cmplt(Vec3::ZERO), IVec3::NEG_ONE, IVec3::ONE);
        let long_enough = LEAST_SEGMENT_VX / direction.length();
        let mut cell = first.as_ivec3();
        for _ in 0..MOST_CELLS {
            let low = cell.as_vec3();
            // A ray within a plane of an axis crosses none of its planes: NaN and infinities are ignored.
            let (a, b) = ((low - origin) * inverse, (low + 1.0 - origin) * inverse);
            let from = a.min(b).max_element().max(0.0);
            let leaves = a.max(b);
            let to = leaves.min_element().max(from);
            if cells.get(cell) {
                let known = cache.cell(self.grid, self.levels, cell);
                let place = |t: f32| (origin + direction * t - low).clamp(Vec3::ZERO, Vec3::ONE);
                let (begin, end) = (place(from), place(to));
                if let Some(share) = first_root(&known.levels, begin, end) {
                    let t = from + (to - from) * share;
                    return Some(self.shown(naming, known, begin.lerp(end, share), t));
                }
            } else if to - from > long_enough {
                // From well within the empty cell: rounding must not lead back to the previous one.
                let middle = origin + direction * (0.5 * (from + to));
                cell = raycast::cast(cells, middle, direction)?.voxel.as_ivec3();
                continue;
            }
            let axis = if leaves.x <= leaves.y && leaves.x <= leaves.z {
                0
            } else if leaves.y <= leaves.z {
                1
            } else {
                2
            };
            cell[axis] += step[axis];
            if cell[axis] < 0 || cell[axis] >= dims[axis] {
                return None;
            }
        }
        None
    }

    /// Returns the voxel and the normal at a point of a cell.
    #[inline(always)]
    fn shown(&self, naming: Naming, cell: &mut Cell, place: Vec3, t: f32) -> SurfaceHit {
        let voxel = |i: usize| cell.at - 1 + corner(i);
        if !cell.has_normals {
            for i in 0..8 {
                let normal = (cell.levels[i] < 0.0).then(|| self.normal(voxel(i).as_uvec3()));
                cell.normals[i] = normal.flatten().unwrap_or(Vec3::ZERO);
            }
            cell.has_normals = true;
        }
        let mut normal = Vec3::ZERO;
        // While normals are incomplete, any existing corner is accepted.
        let (mut named, mut most) = (0, -1.0);
        // The weights of the corners with normals: the voxels of the surface.
        let mut shares = [0.0; 8];
        for (i, of_surface) in shares.iter_mut().enumerate() {
            let own = cell.normals[i];
            let known = if own == Vec3::ZERO { 0.0 } else { 1.0 };
            let share = share(place, corner(i)) + LEAST_SHARE;
            normal += own * share;
            *of_surface = share * known;
            if cell.levels[i] < 0.0 && share + known > most {
                (named, most) = (i, share + known);
            }
        }
        if let Naming::ByShare(number) = naming {
            named = by_share(&shares, number).unwrap_or(named);
        }
        let voxel = voxel(named).max(IVec3::ZERO).as_uvec3();
        SurfaceHit { voxel, normal: PackedNormal::pack(normal), t }
    }

    #[inline(always)]
    fn normal(&self, voxel: UVec3) -> Option<Vec3> {
        let page = self.normals.table().page(voxel / BRICK_EDGE_VX);
        if page == NO_PAGE {
            return None;
        }
        Some(self.normals.plane(page, voxel % BRICK_EDGE_VX)?.0)
    }
}

/// Returns the index of the weight in which `number` lies, from 0 to 1 of the sum of `shares`; `None` if the sum is 0.
#[inline(always)]
fn by_share(shares: &[f32; 8], number: f32) -> Option<usize> {
    let mut rest = number * shares.iter().sum::<f32>();
    let mut last = None;
    for (i, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
        last = Some(i);
        rest -= share;
        if rest < 0.0 {
            break;
        }
    }
    last
}

/// Returns the weight of a corner at a point of a cell.
#[inline(always)]
fn share(place: Vec3, corner: IVec3) -> f32 {
    let shares = Vec3::select(corner.cmpeq(IVec3::ONE), place, 1.0 - place);
    shares.x * shares.y * shares.z
}

#[inline(always)]
pub(super) fn trilinear(corners: &[f32; 8], place: Vec3) -> f32 {
    let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
    let [c0, c1, c2, c3, c4, c5, c6, c7] = *corners;
    let (x, y) = (place.x, place.y);
    let low = mix(mix(c0, c1, x), mix(c2, c3, x), y);
    let high = mix(mix(c4, c5, x), mix(c6, c7, x), y);
    mix(low, high, place.z)
}

/// Returns the first point between `begin` and `end` in a cell, as a fraction of the segment, at which the field is 0
/// or less.
#[inline(always)]
pub(super) fn first_root(corners: &[f32; 8], begin: Vec3, end: Vec3) -> Option<f32> {
    if corners.iter().all(|&level| level > 0.0) {
        return None;
    }
    let [f0, f1, f2, f3] =
        [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|s| trilinear(corners, begin.lerp(end, s)));
    if f0 <= 0.0 {
        return Some(0.0);
    }
    // The polynomial through the four values.
    let cubic = 4.5 * (f3 - f0) + 13.5 * (f1 - f2);
    let square = 9.0 * f0 - 22.5 * f1 + 18.0 * f2 - 4.5 * f3;
    let linear = -5.5 * f0 + 9.0 * f1 - 4.5 * f2 + f3;
    let value = |s: f32| ((cubic * s + square) * s + linear) * s + f0;
    let mut ends = extrema(3.0 * cubic, 2.0 * square, linear);
    ends.sort_unstable_by(f32::total_cmp);
    let (mut low, mut at_low) = (0.0, f0);
    for high in [ends[0], ends[1], 1.0] {
        if high <= low || high > 1.0 {
            continue;
        }
        let at_high = value(high);
        if at_high <= 0.0 {
            return Some(root([low, high], [at_low, at_high], value));
        }
        (low, at_low) = (high, at_high);
    }
    None
}

/// Returns the roots of `a s^2 + b s + c`; 2 if there are none.
#[inline(always)]
fn extrema(a: f32, b: f32, c: f32) -> [f32; 2] {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return [2.0; 2];
    }
    // Without cancellation (Press et al., "Numerical Recipes", 5.6).
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    [q / a, c / q].map(|root| if root.is_finite() { root } else { 2.0 })
}

/// Returns the root between two points with values of different signs: regula falsi with Illinois steps.
#[inline(always)]
fn root(places: [f32; 2], values: [f32; 2], value: impl Fn(f32) -> f32) -> f32 {
    let ([mut low, mut high], [mut at_low, mut at_high]) = (places, values);
    let mut middle = high;
    let mut side = 0;
    for _ in 0..ROOT_STEPS {
        middle = low + (high - low) * (at_low / (at_low - at_high));
        let at_middle = value(middle);
        if at_middle > 0.0 {
            (low, at_low) = (middle, at_middle);
            if side == 1 {
                at_high *= 0.5;
            }
            side = 1;
        } else {
            (high, at_high) = (middle, at_middle);
            if side == -1 {
                at_low *= 0.5;
            }
            side = -1;
        }
    }
    middle
}
