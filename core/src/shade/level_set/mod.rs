//! The smooth surface of a sculpture: the zero set of a field of signed distances.
//!
//! Every voxel near the surface has a level: the distance of its centre from the surface, negative inside, in units of
//! [`PackedDepth::PER_VX`] of a voxel. Between the centres of eight voxels the field is trilinear, and the surface is
//! where it is 0. A surface voxel's level is its depth in the [`NormalField`]; `band` gives the voxels beside it the
//! distance from the planes of surface voxels next to them. An existing voxel is always inside and an empty one outside
//! (constrained smoothing: Gibson, "Constrained elastic surface nets", 1998), so nothing vanishes, and a mesh of the
//! zero set has the voxels' topology.
//!
//! A *cell* is the cube between the centres of eight voxels. Cell `c` has the voxels `c - 1` to `c`. Cells with any
//! existing voxel are stored as a grid of their own, one voxel larger than the sculpture, in which `ray` finds the
//! first cells of a ray. `sample` makes index maps.
//!
//! Takes a grid and its normals, and follows their changes; knows no document. The levels of the whole surface can be
//! computed ahead ([`LevelSet::update`]), or those that the rays of a picture meet ([`LevelSet::complete`]). Levels do not
//! depend on the order in which bricks are computed, nor on threads.

mod band;
mod layer;
mod light_ray;
mod ray;
mod sample;
mod stale;
#[cfg(test)]
mod tests;
mod thin;

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;

use self::band::{Band, cells_at};
use self::stale::StaleBricks;
use super::NormalField;
use super::normal_field::{PackedDepth, REACH_BRICKS, for_each_around, sort_from};
use super::per_leaf::{PerBrick, PerLeaf};
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_VOXELS, Brick, BrickKind, local_coords};
use crate::sculpture::brick_set::{BrickSet, for_each_in};
use crate::sculpture::grid::{LEAF_EDGE_LOG2, unflatten, uniform_in};
use crate::sculpture::region::BrickBox;
use crate::sculpture::{Grid, GridError};
use crate::view::PixelRays;

pub use self::layer::LevelLayer;
pub use self::light_ray::BEYOND_VOXELS_VX;
pub use self::ray::{CellCache, SurfaceHit};
pub use self::sample::LevelSampler;

/// The level of points far outside; its negative is the level of points far inside.
pub const FAR: i8 = 127;
/// The smallest level outside; its negative is the largest inside.
const LEAST: i8 = 3;

/// The entry of a brick without a page: all its voxels are far from the surface.
pub const NO_PAGE: u32 = u32::MAX;

/// About the bricks that are computed at once, so that memory stays bounded and the time can be checked in between.
const PORTION: usize = 1024;
/// The same for bricks of pictures, whose normals may have to be computed, too.
const SEEN_PORTION: usize = 256;

/// Bytes for each brick near the surface: its levels, its page, and the bits of its cells.
const BRICK_BYTES: usize = size_of::<PageLevels>() + size_of::<u32>() + size_of::<Brick>();

/// The levels of the voxels of a brick: `x + 8 y + 64 z`.
pub type PageLevels = [i8; BRICK_VOXELS as usize];

/// The smooth surface of one grid.
#[derive(Debug)]
pub struct LevelSet {
    /// The page of each brick.
    table: PerBrick,
    pages: Vec<PageLevels>,
    free: Vec<u32>,
    /// Cells with an existing voxel.
    cells: Grid,
    /// Bricks whose levels may be out of date.
    stale: StaleBricks,
    /// Bricks whose cells have changed since the last update.
    recut: Vec<u32>,
}

impl LevelSet {
    /// Returns the cells of a grid and a place for its levels, all of which are outstanding. An error if the cells need
    /// more than `budget_bytes`.
    pub fn new(grid: &Grid, budget_bytes: u64) -> Result<LevelSet, GridError> {
        let what = format!("the cells of the smooth surface of {} voxels need about", grid.dims());
        OverBudget::check(what, grid.heap_bytes(), MemoryBudget::Grids, budget_bytes)?;
        let mut cells = grid.of_cells();
        let voxels_of = |cells: BrickBox| BrickBox {
            min: cells.min.saturating_sub(UVec3::ONE),
            max: cells.max.min(grid.brick_dims()),
        };
        cells.fill_cubes(
            |cells| uniform_in(grid, voxels_of(cells)),
            |b| cells_at(grid, b.as_ivec3()),
        );
        let dims = grid.brick_dims();
        let mut stale = StaleBricks::none_of(dims);
        for (leaf, bricks) in bricks_near_surface(grid) {
            stale.insert_in(leaf, &bricks);
        }
        let table = PerLeaf::new(dims, &[[NO_PAGE; 512]]);
        let (pages, free, recut) = (Vec::new(), Vec::new(), Vec::new());
        Ok(LevelSet { table, pages, free, cells, stale, recut })
    }

    /// Performs [`LevelSet::new`] for a surface that will be computed as a whole. An error if its levels need more than
    /// `budget_bytes`.
    pub fn whole(grid: &Grid, budget_bytes: u64) -> Result<LevelSet, GridError> {
        let levels = LevelSet::new(grid, budget_bytes)?;
        levels.check_whole(grid, budget_bytes)?;
        Ok(levels)
    }

    /// Returns an error if all levels together need more than `budget_bytes`.
    pub fn check_whole(&self, grid: &Grid, budget_bytes: u64) -> Result<(), OverBudget> {
        let what = format!("the smooth surface of {} voxels needs", grid.dims());
        let bricks = self.pages.len() - self.free.len() + self.stale.len();
        OverBudget::check(what, (bricks * BRICK_BYTES) as u64, MemoryBudget::Grids, budget_bytes)
    }

    /// Returns whether the levels are those of a grid of this size.
    pub fn fits(&self, grid: &Grid) -> bool {
        self.cells.dims() == grid.dims() + 1
    }

    /// Notes that voxels of bricks (linear indices) have changed, perhaps with their normals. Updates the cells.
    pub fn follow(&mut self, grid: &Grid, changed: &[u32]) {
        self.follow_within(grid, changed, 1);
    }

    /// Notes that voxels of bricks have changed, and with them the normals around them.
    pub fn follow_edits(&mut self, grid: &Grid, edited: &[u32]) {
        self.follow_within(grid, edited, 1 + REACH_BRICKS);
    }

    /// Notes that normals or depths of bricks have changed. Returns the bricks whose levels may differ.
    pub fn follow_normals(&mut self, grid: &Grid, changed: &[u32]) -> BrickSet {
        self.mark_around(grid, changed, 1)
    }

    /// Marks the levels within so many bricks of others as out of date. Returns their bricks.
    fn mark_around(&mut self, grid: &Grid, changed: &[u32], reach: u32) -> BrickSet {
        let coords = changed.iter().map(|&index| grid.brick_coords(index as usize));
        let around = around(grid, coords, reach);
        for (leaf, mask) in around.leaves() {
            self.stale.insert_in(leaf.coords(), &mask);
        }
        around
    }

    fn follow_within(&mut self, grid: &Grid, changed: &[u32], reach: u32) {
        let around = self.mark_around(grid, changed, reach);
        let mut bricks = Vec::new();
        for (leaf, mask) in around.leaves() {
            for_each_in(leaf, &mask, |b| bricks.push(grid.brick_index(b) as u32));
        }
        let places = bricks.iter().flat_map(|&index| {
            self.cell_bricks(grid, index).map(move |place| (index, place)).collect::<Vec<_>>()
        });
        let places: Vec<(u32, u32)> = places.collect();
        let cells = &self.cells;
        let made: Vec<(u32, u32, Brick)> = places
            .into_par_iter()
            .filter_map(|(index, place)| {
                let now = cells_at(grid, cells.brick_coords(place as usize).as_ivec3());
                (now != *cells.brick_at(place as usize)).then_some((index, place, now))
            })
            .collect();
        for (index, place, now) in made {
            self.cells.set_brick(place as usize, now);
            self.recut.push(index);
        }
    }

    /// Computes the outstanding levels, on all cores. Appends the bricks whose levels or cells differ from before, in
    /// ascending order. `grid` and `normals` must be those of the last noted changes.
    pub fn update(&mut self, grid: &Grid, normals: &NormalField, changed: &mut Vec<u32>) {
        self.update_while(grid, normals, changed, || true);
    }

    /// Performs [`LevelSet::update`], but only while `goes_on` returns true. The rest remains outstanding.
    pub fn update_while(
        &mut self,
        grid: &Grid,
        normals: &NormalField,
        changed: &mut Vec<u32>,
        mut goes_on: impl FnMut() -> bool,
    ) {
        let first = self.report_recut(changed);
        while !self.stale.is_empty() && goes_on() {
            let portion = self.stale.take_first(PORTION);
            self.compute(grid, normals, &portion, changed);
        }
        sort_from(changed, first);
    }

    /// Computes those of `wanted` that are outstanding, and the normals that they are made of, in portions, until
    /// `goes_on` returns false after one. Returns whether none is left. Reports bricks as [`LevelSet::update`] does.
    pub fn complete(
        &mut self,
        grid: &Grid,
        normals: &mut NormalField,
        wanted: &BrickSet,
        changed: &mut Vec<u32>,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> bool {
        let first = self.report_recut(changed);
        let bricks = self.stale.take(wanted);
        let mut rest = &*bricks;
        while !rest.is_empty() {
            let (portion, later) = rest.split_at(rest.len().min(SEEN_PORTION));
            let sources = around(grid, portion.iter().copied(), 1);
            normals.complete_bricks(grid, &sources, &mut Vec::new());
            self.compute(grid, normals, portion, changed);
            rest = later;
            if !goes_on() {
                break;
            }
        }
        let mut left = BrickSet::default();
        rest.iter().for_each(|b| left.insert(*b));
        for (leaf, bricks) in left.leaves() {
            self.stale.insert_in(leaf.coords(), &bricks);
        }
        sort_from(changed, first);
        rest.is_empty()
    }

    /// Appends the bricks whose cells have changed. Returns the former length of `changed`.
    fn report_recut(&mut self, changed: &mut Vec<u32>) -> usize {
        let first = changed.len();
        changed.append(&mut self.recut);
        first
    }

    /// Computes the levels of bricks.
    fn compute(
        &mut self,
        grid: &Grid,
        normals: &NormalField,
        bricks: &[UVec3],
        changed: &mut Vec<u32>,
    ) {
        let compute = |b: &UVec3| Band::of(grid, normals, *b).map(|band| band.levels());
        let levels: Vec<Option<PageLevels>> = bricks.par_iter().map(compute).collect();
        for (&b, levels) in bricks.iter().zip(&levels) {
            if self.store(b, levels.as_ref()) {
                changed.push(grid.brick_index(b) as u32);
            }
        }
    }

    /// Returns whether any level at the corners of a cell is outstanding; their bricks are added to `outstanding`.
    pub(super) fn is_outstanding(
        &self,
        grid: &Grid,
        cell: IVec3,
        outstanding: &mut Vec<UVec3>,
    ) -> bool {
        if self.stale.is_empty() {
            return false;
        }
        let last = grid.dims().as_ivec3() - 1;
        let brick = |v: IVec3| v.clamp(IVec3::ZERO, last).as_uvec3() / BRICK_EDGE_VX;
        let (low, high) = (brick(cell - 1), brick(cell));
        let before = outstanding.len();
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let b = UVec3::new(x, y, z);
                    if self.stale.contains(b) {
                        outstanding.push(b);
                    }
                }
            }
        }
        outstanding.len() > before
    }

    /// Returns the number of bricks whose levels are to be computed.
    pub(crate) fn outstanding(&self) -> usize {
        self.stale.len()
    }

    /// Returns whether nothing is outstanding.
    pub fn is_complete(&self) -> bool {
        self.stale.is_empty()
    }

    /// Stores the levels of a brick. Returns whether they differ.
    fn store(&mut self, b: UVec3, levels: Option<&PageLevels>) -> bool {
        let page = self.page(b);
        match levels {
            None if page == NO_PAGE => false,
            None => {
                self.free.push(page);
                *self.table.own_at(b) = NO_PAGE;
                true
            }
            Some(levels) => {
                let is_new = page == NO_PAGE;
                let page = if is_new { self.new_page(b) } else { page };
                let stored = &mut self.pages[page as usize];
                let differs = is_new || stored != levels;
                if differs {
                    *stored = *levels;
                }
                differs
            }
        }
    }

    /// Returns a page that belongs to the brick at `b` from now on.
    fn new_page(&mut self, b: UVec3) -> u32 {
        let page = self.free.pop().unwrap_or_else(|| {
            self.pages.push([0; BRICK_VOXELS as usize]);
            self.pages.len() as u32 - 1
        });
        *self.table.own_at(b) = page;
        page
    }

    /// Returns the level of a voxel of `grid`, or of one outside: there a voxel at the border continues by one voxel.
    #[inline(always)]
    pub fn level(&self, grid: &Grid, v: IVec3) -> i8 {
        let inside = v.clamp(IVec3::ZERO, grid.dims().as_ivec3() - 1);
        let level = self.level_inside(grid, inside.as_uvec3());
        if inside == v { level } else { beyond(level) }
    }

    #[inline(always)]
    fn level_inside(&self, grid: &Grid, v: UVec3) -> i8 {
        let b = v / BRICK_EDGE_VX;
        match self.page(b) {
            NO_PAGE => self.far(grid, b),
            page => {
                let UVec3 { x, y, z } = v % BRICK_EDGE_VX;
                self.pages[page as usize][place(x, y, z)]
            }
        }
    }

    /// Returns the level of a brick without a page.
    #[inline(always)]
    fn far(&self, grid: &Grid, b: UVec3) -> i8 {
        if grid.kind(b) == BrickKind::Full { -FAR } else { FAR }
    }

    /// Returns the levels of the corners of a cell: corner `x + 2 y + 4 z`.
    #[inline(always)]
    pub fn corners(&self, grid: &Grid, cell: IVec3) -> [f32; 8] {
        let low = cell - 1;
        let local = low & 7;
        let mut levels = [0.0; 8];
        let inside = low.cmpge(IVec3::ZERO).all() && cell.cmplt(grid.dims().as_ivec3()).all();
        if inside && local.max_element() < 7 {
            let b = low.as_uvec3() / BRICK_EDGE_VX;
            return match self.page(b) {
                NO_PAGE => [self.far(grid, b).into(); 8],
                page => {
                    let page = &self.pages[page as usize];
                    let first = place(local.x as u32, local.y as u32, local.z as u32);
                    for (i, level) in levels.iter_mut().enumerate() {
                        *level = page[first + (i & 1) + 8 * (i >> 1 & 1) + 64 * (i >> 2)].into();
                    }
                    levels
                }
            };
        }
        for (i, level) in levels.iter_mut().enumerate() {
            *level = self.level(grid, low + corner(i)).into();
        }
        levels
    }

    /// Returns the page of the brick at `b`; [`NO_PAGE`] where all voxels are far inside (a full brick) or outside.
    #[inline(always)]
    pub fn page(&self, b: UVec3) -> u32 {
        self.table.at_entry(self.table.entry(b)).unwrap_or(NO_PAGE)
    }

    /// Returns the levels of bricks, by page.
    pub fn pages(&self) -> &[PageLevels] {
        &self.pages
    }

    /// Returns the bricks of [`LevelSet::cells`], by linear index, that depend on the voxels of a brick of `grid` and
    /// the one before it along each axis: its own, and at the grid's end those beyond.
    pub fn cell_bricks(&self, grid: &Grid, index: u32) -> impl Iterator<Item = u32> {
        let b = grid.brick_coords(index as usize);
        let at_end = b.cmpeq(grid.brick_dims() - 1);
        let (cells, end) = (&self.cells, self.cells.brick_dims());
        (0..8u32).filter_map(move |i| {
            let beyond = UVec3::new(i & 1, i >> 1 & 1, i >> 2);
            let at = b + beyond;
            let is_there = !(beyond.cmpeq(UVec3::ONE) & !at_end).any() && at.cmplt(end).all();
            is_there.then(|| cells.brick_index(at) as u32)
        })
    }

    /// Returns the cells with an existing voxel. Their coordinates are those of the grid plus one half.
    pub fn cells(&self) -> &Grid {
        &self.cells
    }

    /// Returns the rays of a picture in the coordinates of [`LevelSet::cells`].
    pub fn rays_of_cells(rays: &PixelRays) -> PixelRays {
        PixelRays { origin: in_cells(rays.origin), ..*rays }
    }

    /// Returns whether a voxel of `grid` covers more than a pixel in the picture of `rays`, at least where the grid is
    /// nearest to the eye: otherwise the smooth surface cannot be distinguished from the voxels.
    pub fn shows(grid: &Grid, rays: &PixelRays) -> bool {
        let middle = rays.direction_at(rays.size.x as f32 * 0.5, rays.size.y as f32 * 0.5);
        let nearest = rays.origin.clamp(Vec3::ZERO, grid.dims().as_vec3());
        let distance = (nearest - rays.origin).dot(middle) / middle.length_squared();
        rays.step_x.length().max(rays.step_y.length()) * distance.max(0.0) < 1.0
    }

    /// Returns the memory in use, in bytes.
    pub fn heap_bytes(&self) -> u64 {
        let pages = size_of_val(&*self.pages) + self.table.heap_bytes() + self.stale.heap_bytes();
        pages as u64 + self.cells.heap_bytes()
    }
}

/// Returns the bricks that may have voxels near the surface: all but those amid others of their kind.
fn bricks_near_surface(grid: &Grid) -> Vec<(UVec3, Brick)> {
    let dims = grid.brick_dims();
    let is_far = |bricks: BrickBox| {
        let min = bricks.min.saturating_sub(UVec3::ONE);
        let max = (bricks.max + 1).min(dims);
        // At the border of the grid, full bricks have a surface.
        let is_inside = min.cmpgt(UVec3::ZERO).all() && max.cmplt(dims).all();
        uniform_in(grid, BrickBox { min, max }).is_some_and(|exist| !exist || is_inside)
    };
    let leaf_dims = (dims + 7) >> LEAF_EDGE_LOG2;
    let in_leaf = |at: u32| {
        let leaf = unflatten(at, leaf_dims);
        let low = leaf << LEAF_EDGE_LOG2;
        if is_far(BrickBox { min: low, max: (low + 8).min(dims) }) {
            return None;
        }
        let mut near = Brick::EMPTY;
        Brick::FULL.for_each(|index| {
            let local = UVec3::from(local_coords(index));
            let b = low + local;
            if b.cmplt(dims).all() && !is_far(BrickBox { min: b, max: b + 1 }) {
                near.set(local.x, local.y, local.z, true);
            }
        });
        (!near.is_empty()).then_some((leaf, near))
    };
    (0..leaf_dims.element_product()).into_par_iter().filter_map(in_leaf).collect()
}

/// Returns bricks and those within so many of them on every axis.
fn around(grid: &Grid, bricks: impl Iterator<Item = UVec3>, reach: u32) -> BrickSet {
    let mut around = BrickSet::default();
    for b in bricks {
        for_each_around(grid, b, reach, |b| around.insert(b));
    }
    around
}

/// Returns the level beyond the grid's border at a voxel with this level.
#[inline(always)]
fn beyond(level: i8) -> i8 {
    match level {
        ..0 => (i32::from(level) + PackedDepth::PER_VX as i32).max(LEAST.into()) as i8,
        _ => FAR,
    }
}

/// Returns the index of a voxel in [`PageLevels`].
#[inline(always)]
fn place(x: u32, y: u32, z: u32) -> usize {
    (x | y << 3 | z << 6) as usize
}

/// Returns the offset of a corner of a cell from its first.
#[inline(always)]
fn corner(i: usize) -> IVec3 {
    IVec3::new(i as i32 & 1, i as i32 >> 1 & 1, i as i32 >> 2)
}

/// Converts grid coordinates to coordinates of cells.
#[inline(always)]
fn in_cells(point: Vec3) -> Vec3 {
    point + 0.5
}
