//! Changes the resolution of a sculpture: the same shape of more or fewer voxels, through the field of distances that
//! draws the smooth surface.
//!
//! A new voxel exists if the mean of the field over points in it lies inside. Colours and mask are those of the nearest
//! voxel. The size in the world stays. Takes contents; returns new ones. Knows no document.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{IVec3, UVec3, Vec3};
use rayon::prelude::*;
use thiserror::Error;

use crate::progress::Progress;
use crate::refusal::{InvalidValue, MemoryBudget, OverBudget};
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_VOXELS, Brick, local_coords};
use crate::sculpture::canvas_frame::CanvasFrame;
use crate::sculpture::grid::{LEAF_EDGE_LOG2, unflatten, uniform_in};
use crate::sculpture::history::Contents;
use crate::sculpture::material::{MAX_PAGE_BYTES, Page};
use crate::sculpture::region::{BrickBox, VoxelBox};
use crate::sculpture::{Grid, GridError, Limits, Material};
use crate::shade::level_set::CellCache;
use crate::shade::{LevelSet, SmoothField};

/// Most points along each axis at which the field is read for a voxel.
const MOST_POINTS: u32 = 4;
/// Leaves whose colours are made between two reports of the progress.
const LEAVES_AT_ONCE: usize = 256;
/// Times that the progress of a grid is reported.
const REPORTS: u64 = 200;
/// The range of the factor.
pub const FACTORS: std::ops::RangeInclusive<f32> = 0.01..=64.0;

/// A resolution.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Resolution {
    /// So many times as many voxels along each axis.
    Factor(f32),
    /// A size in voxels.
    Dims(UVec3),
}

/// Why a sculpture cannot be resampled.
#[derive(Debug, Error)]
pub enum ResampleError {
    /// The new grid, or the field, is not possible.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The colours would not fit into [`Limits::colour_bytes`].
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The factor is out of range.
    #[error(transparent)]
    Invalid(#[from] InvalidValue),
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl Resolution {
    /// Returns the new size of a grid of `dims` voxels.
    pub fn dims(&self, dims: UVec3) -> Result<UVec3, InvalidValue> {
        match *self {
            Resolution::Dims(dims) => Ok(dims),
            Resolution::Factor(factor) => {
                let rule = "must be from 0.01 to 64";
                InvalidValue::check(FACTORS.contains(&factor), "factor", rule, factor)?;
                Ok((dims.as_vec3() * factor).round().max(Vec3::ONE).as_uvec3())
            }
        }
    }
}

/// Returns the contents in another resolution.
///
/// # Errors
/// If the result or the field needs more memory than `limits` allow, or `progress` is cancelled.
pub fn resampled(
    contents: &Contents,
    to: Resolution,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, ResampleError> {
    let grid = &contents.grid;
    let dims = to.dims(grid.dims())?;
    let scale = Scale::new(grid.dims(), dims);
    let voxel_size = grid.voxel_size() * scale.old_per_new;
    let mut bits = Grid::of_size(dims, voxel_size)?;
    let mut field = SmoothField::new(grid, limits)?;
    if !field.update(grid, None, progress) {
        return Err(ResampleError::Cancelled);
    }
    progress.begin("resampling the voxels");
    let mut filling = Filling::new(&bits, limits.grid_bytes, progress);
    filling.fill(
        &mut bits,
        |b| uniform(grid, scale.around(b)),
        |b| brick_of(field.levels(), grid, &scale, b),
    )?;
    progress.end();
    let colours = colours_of(contents, &bits, &scale, (limits, progress))?;
    let mask = contents.mask.as_ref().map(|mask| {
        progress.begin("resampling the mask");
        let mut masked = bits.emptied();
        let of_brick = |b| gather(b, |v| mask.get(scale.nearest(v).as_ivec3()));
        filling.fill(&mut masked, |b| uniform(mask, scale.around(b)), of_brick)?;
        progress.end();
        Ok::<_, ResampleError>(Box::new(masked))
    });
    let mask = mask.transpose()?;
    let frame = scale.frame(&contents.frame);
    let surface = contents.surface;
    let mut result = Contents { mask, surface, frame, ..Contents::new(bits, colours) };
    result.mask.take_if(|mask| mask.opaque_count() == 0);
    Ok(result)
}

/// The ratio of two resolutions.
struct Scale {
    old: UVec3,
    old_per_new: Vec3,
    /// Points in a new voxel along each axis at which the field is read.
    points: UVec3,
}

impl Scale {
    fn new(old: UVec3, new: UVec3) -> Scale {
        let old_per_new = old.as_vec3() / new.max(UVec3::ONE).as_vec3();
        let points = old_per_new.ceil().as_uvec3().clamp(UVec3::ONE, UVec3::splat(MOST_POINTS));
        Scale { old, old_per_new, points }
    }

    /// Returns the old voxel in which the centre of a new one lies.
    fn nearest(&self, v: UVec3) -> UVec3 {
        ((v.as_vec3() + 0.5) * self.old_per_new).as_uvec3().min(self.old - 1)
    }

    /// Returns the old bricks that new ones reach, with the neighbours of their voxels.
    fn around(&self, new: BrickBox) -> BrickBox {
        let VoxelBox { min, max } = new.voxels();
        let low = min.as_vec3() * self.old_per_new - 2.0;
        let high = max.as_vec3() * self.old_per_new + 2.0;
        let last = self.old - 1;
        let [low, high] = [low.max(Vec3::ZERO), high].map(|v| v.as_uvec3().min(last));
        BrickBox { min: low / BRICK_EDGE_VX, max: high / BRICK_EDGE_VX + 1 }
    }

    /// Returns the frame in the new resolution, rounded to whole voxels.
    fn frame(&self, frame: &CanvasFrame) -> CanvasFrame {
        let home = (frame.home.as_vec3() / self.old_per_new).round().max(Vec3::ONE).as_uvec3();
        let origin = (frame.origin.as_vec3() / self.old_per_new).round().as_ivec3();
        CanvasFrame { origin, home, grows: frame.grows }
    }
}

/// Fills new grids within a limit of memory, with progress.
struct Filling<'a> {
    budget: u64,
    /// Bytes of the mixed bricks so far.
    used: AtomicU64,
    progress: &'a dyn Progress,
    /// Bricks of a grid, and those done.
    all: u64,
    done: AtomicU64,
}

impl<'a> Filling<'a> {
    fn new(grid: &Grid, budget: u64, progress: &'a dyn Progress) -> Filling<'a> {
        let all = grid.brick_count() as u64;
        Filling { budget, used: AtomicU64::new(0), progress, all, done: AtomicU64::new(0) }
    }

    /// Sets all bricks: those of a cube for which `whole` returns whether it is full or empty at once.
    fn fill(
        &mut self,
        grid: &mut Grid,
        whole: impl Fn(BrickBox) -> Option<bool> + Sync,
        brick: impl Fn(UVec3) -> Brick + Sync,
    ) -> Result<(), ResampleError> {
        self.done = AtomicU64::new(0);
        let this = &*self;
        let cube = |bricks: BrickBox| {
            if this.is_stopped() {
                return Some(false);
            }
            whole(bricks).inspect(|_| this.advance(bricks.brick_count()))
        };
        let one = |b: UVec3| {
            let made = if this.is_stopped() { Brick::EMPTY } else { brick(b) };
            if !made.is_empty() && !made.is_full() {
                this.used.fetch_add(size_of::<Brick>() as u64, Ordering::Relaxed);
            }
            this.advance(1);
            made
        };
        grid.fill_cubes(cube, one);
        if self.progress.is_cancelled() {
            return Err(ResampleError::Cancelled);
        }
        let used = self.used.load(Ordering::Relaxed);
        Ok(OverBudget::check("this needs at least", used, MemoryBudget::Grids, self.budget)?)
    }

    fn is_stopped(&self) -> bool {
        self.progress.is_cancelled() || self.used.load(Ordering::Relaxed) > self.budget
    }

    fn advance(&self, bricks: u64) {
        let before = self.done.fetch_add(bricks, Ordering::Relaxed);
        let share = |done: u64| done.saturating_mul(REPORTS) / self.all;
        if share(before) != share(before + bricks) {
            self.progress.advance((before + bricks) as f32 / self.all as f32);
        }
    }
}

/// Returns a new brick.
fn brick_of(levels: &LevelSet, grid: &Grid, scale: &Scale, b: UVec3) -> Brick {
    let mut cache = CellCache::default();
    let (points, step) = (scale.points, scale.old_per_new / scale.points.as_vec3());
    gather(b, |v| {
        let corner = v.as_vec3() * scale.old_per_new;
        let mut sum = 0.0;
        for z in 0..points.z {
            for y in 0..points.y {
                for x in 0..points.x {
                    let at = corner + (UVec3::new(x, y, z).as_vec3() + 0.5) * step;
                    sum += levels.distance_vx(grid, at, &mut cache).clamp(-1.0, 1.0);
                }
            }
        }
        sum < 0.0
    })
}

/// Returns whether all voxels of some bricks exist, or none of them; `None` if only some do, or if they exist and the
/// surface at the border of the grid lies among them.
fn uniform(grid: &Grid, bricks: BrickBox) -> Option<bool> {
    let is_inside =
        bricks.min.cmpgt(UVec3::ZERO).all() && bricks.max.cmplt(grid.brick_dims()).all();
    uniform_in(grid, bricks).filter(|exist| !exist || is_inside)
}

/// Returns a brick of the voxels for which `exists` is true.
fn gather(b: UVec3, mut exists: impl FnMut(UVec3) -> bool) -> Brick {
    let mut brick = Brick::EMPTY;
    for local in 0..BRICK_VOXELS {
        let at = UVec3::from(local_coords(local));
        if exists(b * BRICK_EDGE_VX + at) {
            brick.set(at.x, at.y, at.z, true);
        }
    }
    brick
}

/// Returns the colours of the new voxels: each that of the nearest old one that exists, or else of the nearest.
fn colours_of(
    contents: &Contents,
    bits: &Grid,
    scale: &Scale,
    (limits, progress): (&Limits, &dyn Progress),
) -> Result<Material, ResampleError> {
    let old = &contents.material;
    let mut colours = Material::for_grid(bits, old.depth(), old.base());
    if old.page_count() == 0 {
        return Ok(colours);
    }
    progress.begin("resampling the colours");
    let leaf_dims = (bits.brick_dims() + 7) >> LEAF_EDGE_LOG2;
    let bricks_of = |leaf: UVec3| {
        let min = leaf << LEAF_EDGE_LOG2;
        BrickBox { min, max: (min + 8).min(bits.brick_dims()) }
    };
    let is_painted = |leaf: &UVec3| old.is_painted_in(scale.around(bricks_of(*leaf)));
    let leaves = (0..leaf_dims.element_product()).into_par_iter();
    let leaves: Vec<UVec3> = leaves.map(|at| unflatten(at, leaf_dims)).filter(is_painted).collect();
    for (at, some) in leaves.chunks(LEAVES_AT_ONCE).enumerate() {
        if progress.is_cancelled() {
            return Err(ResampleError::Cancelled);
        }
        progress.advance((at * LEAVES_AT_ONCE) as f32 / leaves.len() as f32);
        let bricks = some.par_iter().flat_map_iter(|leaf| {
            let BrickBox { min, max } = bricks_of(*leaf);
            let size = max - min;
            (0..size.element_product()).map(move |at| min + unflatten(at, size))
        });
        let page = |b: UVec3| page_of(contents, scale, b).map(|page| (b, page));
        let pages: Vec<(UVec3, Page)> = bricks.filter_map(page).collect();
        let more = pages.iter().map(|(_, page)| page.heap_bytes() as u64).sum();
        let needed = colours.heap_bytes() + colours.bytes_for_pages(pages.len() as u64, more);
        OverBudget::check("this may need", needed, MemoryBudget::Colours, limits.colour_bytes)?;
        colours.set_pages(pages);
    }
    progress.end();
    Ok(colours)
}

/// Returns the page of a new brick; `None` if all of it has the base colour.
fn page_of(contents: &Contents, scale: &Scale, b: UVec3) -> Option<Page> {
    let material = &contents.material;
    if !material.is_painted_in(scale.around(BrickBox { min: b, max: b + 1 })) {
        return None;
    }
    let (depth, size) = (material.depth(), material.depth().bytes());
    let mut bytes = [0; MAX_PAGE_BYTES];
    let bytes = &mut bytes[..material.page_bytes()];
    let mut is_painted = false;
    for local in 0..BRICK_VOXELS {
        let v = b * BRICK_EDGE_VX + UVec3::from(local_coords(local));
        let colour = contents.rgb(nearest_existing(&contents.grid, scale.nearest(v)));
        is_painted |= colour != material.base();
        depth.write(colour, &mut bytes[local as usize * size..]);
    }
    is_painted.then(|| Page::of_bytes(bytes, depth))
}

/// Returns the existing voxel nearest to one, among it and its neighbours; if there is none, the voxel itself.
fn nearest_existing(grid: &Grid, v: UVec3) -> UVec3 {
    let v = v.as_ivec3();
    if grid.get(v) {
        return v.as_uvec3();
    }
    let steps = (-1..=1)
        .flat_map(|z| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| IVec3::new(x, y, z))));
    let existing = steps.filter(|step| grid.get(v + *step));
    existing.min_by_key(|step| step.length_squared()).map_or(v, |step| v + step).as_uvec3()
}

#[cfg(test)]
mod tests;
