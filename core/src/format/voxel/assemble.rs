//! Converts a [`Model`] to a sculpture: measures its voxels in one pass, checks the memory, and writes them in another.
//!
//! The current brick is cached with its colours, since neighbours in a file mostly are neighbours in the grid.

use glam::{I64Vec3, UVec3, Vec3};

use super::model::Model;
use crate::format::budget::check_colour_budget;
use crate::format::options::{Colouring, ImportOptions, MeshSize};
use crate::format::volume::Samples;
use crate::format::{FormatError, go_on};
use crate::progress::Progress;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use crate::sculpture::history::Contents;
use crate::sculpture::material::Page;
use crate::sculpture::orient::Reorientation;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};

/// Number of voxels between two checks for cancellation.
const PORTION: u64 = 1 << 18;
/// Greatest number of voxels read, including coincident ones, so that nested copies terminate.
const MOST_VOXELS: u64 = 1 << 32;

/// Returns the colour depth of a sculpture made from a model, which has colours but no densities.
pub fn colour_depth(options: &ImportOptions) -> Result<ColourDepth, FormatError> {
    match options.colouring {
        Colouring::None => Ok(ColourDepth::None),
        Colouring::Auto => Ok(options.colour_depth.unwrap_or(ColourDepth::Bits24)),
        Colouring::Packed => Err(FormatError::NotPacked(Samples::Rgb8)),
        colouring => Err(FormatError::NotDensities { colouring, samples: Samples::Rgb8 }),
    }
}

/// Returns the edges of a voxel, which models do not define: as chosen, or 1 mm.
pub fn voxel_size(options: &ImportOptions) -> Vec3 {
    match options.mesh_size {
        MeshSize::VoxelMm(edge) => Vec3::splat(edge),
        MeshSize::LongestVx(_) => Vec3::ONE,
    }
}

/// Makes a sculpture from the voxels of a model. Its grid is the model's canvas if possible, else the bounding box of
/// the voxels.
pub fn to_contents(
    model: &dyn Model,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, FormatError> {
    let depth = colour_depth(options)?;
    let found = survey(model, progress)?;
    let tight = found.bounds();
    let edges = voxel_size(options);
    let fits = |(low, high)| Grid::check(dims_of(low, high), edges, limits.grid_bytes);
    let holds_all = |(low, high): &(I64Vec3, I64Vec3)| {
        tight.is_none_or(|(least, most)| low.cmple(least).all() && high.cmpge(most).all())
    };
    let canvas = model.canvas().filter(holds_all).filter(|canvas| fits(*canvas).is_ok());
    let (low, high) = canvas.or(tight).ok_or(FormatError::NoVoxels)?;
    let grid = Grid::new(dims_of(low, high), edges, limits.grid_bytes)?;
    let base = found.only_colour.unwrap_or(Rgb::STONE);
    let material = Material::for_grid(&grid, depth, base);
    let mut filler = Filler { grid, material, at_hand: None, budget: limits.colour_bytes };
    progress.begin("filling the grid");
    let mut done = 0;
    model.walk(&mut |v, rgb| {
        done += 1;
        if u64::is_multiple_of(done, PORTION) {
            go_on(progress)?;
            progress.advance(done as f32 / found.voxels as f32);
        }
        filler.put((v - low).as_uvec3(), rgb)
    })?;
    filler.put_back();
    progress.end();
    let Filler { grid, material, .. } = filler;
    Ok(Contents::new(grid, material))
}

/// Converts as [`to_contents`] does, rotated according to `options`.
pub fn turned(
    model: &dyn Model,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, FormatError> {
    let contents = to_contents(model, options, limits, progress)?;
    match model.turn(options) {
        Orientation::UPRIGHT => Ok(contents),
        turn => Ok(Reorientation::new(&contents, turn).run(limits, progress)?),
    }
}

/// Returns the size of a box; beyond all limits on overflow.
fn dims_of(low: I64Vec3, high: I64Vec3) -> UVec3 {
    (high - low).clamp(I64Vec3::ZERO, I64Vec3::splat(i64::from(u32::MAX))).as_uvec3()
}

/// The result of the first pass.
struct Survey {
    low: I64Vec3,
    high: I64Vec3,
    voxels: u64,
    /// The colour of all voxels, if it is the same.
    only_colour: Option<Rgb>,
}

impl Survey {
    fn bounds(&self) -> Option<(I64Vec3, I64Vec3)> {
        (self.voxels > 0).then_some((self.low, self.high + 1))
    }
}

fn survey(model: &dyn Model, progress: &dyn Progress) -> Result<Survey, FormatError> {
    let (low, high) = (I64Vec3::MAX, I64Vec3::MIN);
    let mut found = Survey { low, high, voxels: 0, only_colour: None };
    let mut colours = 0;
    model.walk(&mut |v, rgb| {
        found.low = found.low.min(v);
        found.high = found.high.max(v);
        if found.only_colour != Some(rgb) && colours < 2 {
            colours += 1;
            found.only_colour = Some(rgb);
        }
        found.voxels += 1;
        if found.voxels.is_multiple_of(PORTION) {
            go_on(progress)?;
            if found.voxels > MOST_VOXELS {
                return Err(FormatError::TooManyVoxels);
            }
        }
        Ok(())
    })?;
    found.only_colour = found.only_colour.filter(|_| colours == 1);
    Ok(found)
}

struct Filler {
    grid: Grid,
    material: Material,
    at_hand: Option<BrickAtHand>,
    budget: u64,
}

/// The brick that is being filled.
struct BrickAtHand {
    b: UVec3,
    brick: Brick,
    /// Its packed colours, once one of them is not the base colour.
    colours: Option<Vec<u8>>,
}

impl Filler {
    fn put(&mut self, v: UVec3, rgb: Rgb) -> Result<(), FormatError> {
        let b = v / BRICK_EDGE_VX;
        if self.at_hand.as_ref().is_none_or(|at_hand| at_hand.b != b) {
            self.put_back();
            let colours = self.material.page(b).map(|page| {
                let mut colours = vec![0; self.material.page_bytes()];
                page.write_to(&mut colours);
                colours
            });
            self.at_hand = Some(BrickAtHand { b, brick: *self.grid.brick(b), colours });
        }
        let Some(BrickAtHand { brick, colours, .. }) = &mut self.at_hand else { return Ok(()) };
        let UVec3 { x, y, z } = v % BRICK_EDGE_VX;
        brick.set(x, y, z, true);
        let depth = self.material.depth();
        if depth == ColourDepth::None {
            return Ok(());
        }
        if colours.is_none() && depth.quantise(rgb) != self.material.base() {
            let needed = self.material.heap_bytes() + self.material.bytes_for_pages(1, u64::MAX);
            check_colour_budget(needed, self.budget)?;
            let mut blank = vec![0; self.material.page_bytes()];
            let base = self.material.base();
            blank.chunks_exact_mut(depth.bytes()).for_each(|colour| depth.write(base, colour));
            *colours = Some(blank);
        }
        if let Some(colours) = colours {
            depth.write(rgb, &mut colours[local_index(x, y, z) as usize * depth.bytes()..]);
        }
        Ok(())
    }

    fn put_back(&mut self) {
        if let Some(BrickAtHand { b, brick, colours }) = self.at_hand.take() {
            self.grid.set_brick(self.grid.brick_index(b), brick);
            if let Some(colours) = colours {
                let page = Page::of_bytes(&colours, self.material.depth());
                self.material.set_page(b, Some(page));
            }
        }
    }
}
