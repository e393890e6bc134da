//! Describes a model of another voxel editor before it is imported: its visible voxels, its palette, and its
//! orientation.

use std::collections::HashMap;

use glam::{IVec3, UVec3, Vec3};

use super::Outlook;
use crate::format::options::{Colouring, ImportOptions};
use crate::format::voxel::{self, Model};
use crate::format::{FormatError, go_on};
use crate::progress::Progress;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::history::Contents;
use crate::sculpture::orientation::{Orientation, Up};
use crate::sculpture::{ColourDepth, Grid, Limits, Rgb};

/// Greatest number of surface voxels that a picture shows: of more, some are skipped evenly.
const MOST_SURFACE: usize = 1 << 21;
/// Number of bricks between two checks for cancellation.
const PORTION: usize = 1 << 12;

/// A model to be imported.
#[derive(Debug)]
pub struct ModelStudy {
    /// Display name of the format and its parts.
    pub kind: String,
    /// Notes on what was left out.
    pub notes: Vec<String>,
    /// Number of existing voxels.
    pub voxels: u64,
    /// Its colours with their numbers of voxels, the most frequent first.
    pub palette: Vec<(Rgb, u64)>,
    /// Voxels of its surface.
    pub surface: Vec<SurfaceVoxel>,
    /// Size in the orientation of the format.
    dims: UVec3,
    /// The up axis of the format.
    up: Up,
    /// Memory of the colours at 24 bits, in bytes.
    colour_bytes: u64,
}

/// A voxel with an empty neighbour.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SurfaceVoxel {
    /// Its position, in the orientation of the format.
    pub at: IVec3,
    /// Its colour.
    pub colour: Rgb,
    /// A bit for each empty neighbour: at -x, +x, -y, +y, -z, +z, the first in the lowest.
    pub open_sides: u8,
}

/// The neighbours of a voxel, in the order of [`SurfaceVoxel::open_sides`].
const NEIGHBOURS: [IVec3; 6] =
    [IVec3::NEG_X, IVec3::X, IVec3::NEG_Y, IVec3::Y, IVec3::NEG_Z, IVec3::Z];

impl ModelStudy {
    pub(super) fn of(
        model: &dyn Model,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<ModelStudy, FormatError> {
        let options = ImportOptions::default();
        let Contents { grid, material, .. } =
            voxel::to_contents(model, &options, limits, progress)?;
        let mut counts: HashMap<Rgb, u64> = HashMap::new();
        // Neighbours mostly have the same colour, which then need not be looked up.
        let (mut last, mut run) = (Rgb::default(), 0);
        let mut surface = Vec::new();
        // One of every `stride` surface voxels is kept.
        let (mut stride, mut seen) = (1, 0);
        for (portion, (b, brick)) in grid.nonempty_bricks().enumerate() {
            if portion.is_multiple_of(PORTION) {
                go_on(progress)?;
            }
            let (page, corner) = (material.page(b), (b * BRICK_EDGE_VX).as_ivec3());
            brick.for_each(|local| {
                let colour = page.map_or(material.base(), |page| page.rgb(local));
                if colour != last {
                    *counts.entry(last).or_default() += run;
                    (last, run) = (colour, 0);
                }
                run += 1;
                let at = corner + UVec3::from(local_coords(local)).as_ivec3();
                let mut open_sides = 0;
                for (side, neighbour) in NEIGHBOURS.into_iter().enumerate() {
                    open_sides |= u8::from(!grid.get(at + neighbour)) << side;
                }
                if open_sides == 0 {
                    return;
                }
                if seen % stride == 0 {
                    surface.push(SurfaceVoxel { at, colour, open_sides });
                }
                seen += 1;
                if surface.len() > MOST_SURFACE {
                    let mut keep = false;
                    surface.retain(|_| {
                        keep = !keep;
                        keep
                    });
                    stride *= 2;
                }
            });
        }
        *counts.entry(last).or_default() += run;
        let mut palette: Vec<(Rgb, u64)> =
            counts.into_iter().filter(|(_, count)| *count > 0).collect();
        palette.sort_by_key(|(colour, count)| (std::cmp::Reverse(*count), colour.0));
        Ok(ModelStudy {
            kind: model.kind(),
            notes: model.notes(),
            voxels: grid.opaque_count(),
            palette,
            surface,
            dims: grid.dims(),
            up: model.up(),
            colour_bytes: material.heap_bytes(),
        })
    }

    /// Returns the axis of the file that would point up.
    pub fn up(&self, options: &ImportOptions) -> Up {
        options.upright.unwrap_or(self.up)
    }

    /// Returns the size of the sculpture.
    pub fn dims(&self, options: &ImportOptions) -> UVec3 {
        self.turn(options).size(self.dims)
    }

    /// Returns the map from points of the model to the grid of the sculpture; both in voxels.
    pub fn in_grid(&self, options: &ImportOptions) -> impl Fn(Vec3) -> Vec3 {
        let (turn, dims) = (self.turn(options), self.dims.as_vec3());
        move |point| {
            let mirrored = [0, 1, 2].map(|axis| {
                if turn.reverses(axis) { dims[axis] - point[axis] } else { point[axis] }
            });
            turn.permuted(mirrored).into()
        }
    }

    /// Returns the rotation of the model relative to the orientation of its format.
    fn turn(&self, options: &ImportOptions) -> Orientation {
        self.up.turned_upright().inverse().then(self.up(options).turned_upright())
    }

    /// Returns the sculpture that an import of the model would make; an error if it cannot be imported with these
    /// options.
    pub fn outlook(
        &self,
        options: &ImportOptions,
        limits: &Limits,
    ) -> Result<Outlook, FormatError> {
        let depth = voxel::colour_depth(options)?;
        let dims = self.dims(options);
        let grid_bytes = Grid::bytes_for(dims);
        let full = ColourDepth::Bits24.bytes() as u64;
        let colour_bytes = match options.colouring {
            Colouring::None => 0,
            _ => self.colour_bytes * depth.bytes() as u64 / full,
        };
        let voxel_size = voxel::voxel_size(options);
        Grid::check(dims, voxel_size, limits.grid_bytes)?;
        // A rotated model is in memory twice for a while.
        let times = if self.turn(options) == Orientation::UPRIGHT { 1 } else { 2 };
        let read_bytes = (grid_bytes + colour_bytes) * times;
        Ok(Outlook { dims, voxel_size, read_bytes, grid_bytes, colour_bytes })
    }
}
