//! Voxel models of other programs: MagicaVoxel and Voxlap (`.vox`), Qubicle (`.qb`), Goxel (`.gox`), binvox.
//!
//! Each reader takes the bytes of a whole file and returns a [`Model`], which can be walked voxel by voxel as
//! often as needed without a copy of its own; `assemble` makes a sculpture of it. `vox_write` and `qb_write` go the
//! other way and write to a stream; `quantise` finds a palette. All models stand upright: readers turn z to y.
//! Knows no paths.

mod assemble;
mod binvox;
mod gox;
mod gox_layer;
mod palette;
mod qb;
mod qb_write;
mod quantise;
mod scene;
mod vox;
mod vox_write;
mod voxlap;

use glam::I64Vec3;

pub use self::assemble::{colour_depth, to_contents, turned, voxel_size};
pub use self::qb_write::write as write_qb;
pub use self::vox_write::write as write_vox;
use super::FormatError;
use super::options::ImportOptions;
use crate::sculpture::Rgb;
use crate::sculpture::history::SurfaceKind;
use crate::sculpture::orientation::{Orientation, Up};

/// Takes a voxel: its place, y up, and its colour. An error ends the walk.
pub type Sink<'a> = dyn FnMut(I64Vec3, Rgb) -> Result<(), FormatError> + 'a;

/// The program that a model comes from, by the ending of its file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// MagicaVoxel, or Voxlap where the file begins otherwise.
    Vox,
    /// Qubicle Binary.
    Qb,
    /// Goxel.
    Gox,
    /// The voxeliser binvox.
    Binvox,
}

impl Kind {
    /// The form in which its models are shown: what was built of cubes stays so; what was a mesh is smooth.
    pub fn surface(self) -> SurfaceKind {
        match self {
            Kind::Vox | Kind::Qb | Kind::Gox => SurfaceKind::Cubes,
            Kind::Binvox => SurfaceKind::Smooth,
        }
    }
}

/// A model, or several that belong together, as a file holds it.
pub trait Model {
    /// Format and parts, such as `MagicaVoxel, version 150, 3 models`.
    fn kind(&self) -> String;

    /// The box that the file sets aside for its voxels: its lowest voxel and one past its highest. None if it
    /// does not say, or if the box is not worth keeping.
    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)>;

    /// Calls `sink` for every voxel that exists; of two in one place the later one counts.
    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError>;

    /// The axis of the file that points up, as its format has it.
    fn up(&self) -> Up;

    /// How the model is turned, so that the axis that `options` name, if they name one, points up instead.
    fn turn(&self, options: &ImportOptions) -> Orientation {
        let up = options.upright.unwrap_or(self.up());
        self.up().turned_upright().inverse().then(up.turned_upright())
    }

    /// Notes on what is left out of the file, for the user.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Reads a file as far as its structure; damage of the voxels themselves is found by the walk.
pub fn read<'a>(kind: Kind, file: &'a [u8]) -> Result<Box<dyn Model + 'a>, FormatError> {
    Ok(match kind {
        Kind::Vox if file.starts_with(vox::MAGIC) => Box::new(vox::read(file)?),
        Kind::Vox => Box::new(voxlap::read(file)?),
        Kind::Qb => Box::new(qb::read(file)?),
        Kind::Gox => Box::new(gox::read(file)?),
        Kind::Binvox => Box::new(binvox::read(file)?),
    })
}

/// From the axes of MagicaVoxel, Goxel and Voxlap's models (z up, y away from the viewer) to ours, a rotation.
/// A voxel covers [v, v+1), so that the axis that is reversed also moves by one.
fn upright(v: I64Vec3) -> I64Vec3 {
    I64Vec3::new(v.x, v.z, -1 - v.y)
}

/// [`upright`] of a box, given by its lowest voxel and one past its highest.
fn upright_box((low, high): (I64Vec3, I64Vec3)) -> (I64Vec3, I64Vec3) {
    (I64Vec3::new(low.x, low.z, -high.y), I64Vec3::new(high.x, high.z, -low.y))
}
