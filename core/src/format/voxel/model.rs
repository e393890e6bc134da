//! A model of another voxel editor, which can be walked voxel by voxel as often as needed without a copy of its own; and
//! the axes that several formats have in common. All models stand upright: readers turn z to y. Knows no format.

use std::io::Write;

use glam::I64Vec3;

use crate::format::FormatError;
use crate::format::options::ImportOptions;
use crate::progress::Progress;
use crate::sculpture::Rgb;
use crate::sculpture::history::{Contents, SurfaceKind};
use crate::sculpture::orientation::{Orientation, Up};

/// Takes a voxel: its place, y up, and its colour. An error ends the walk.
pub type Sink<'a> = dyn FnMut(I64Vec3, Rgb) -> Result<(), FormatError> + 'a;

/// Reads a file as far as its structure.
pub type ReadModel = for<'a> fn(&'a [u8]) -> Result<Box<dyn Model + 'a>, FormatError>;

/// How models of a format are read.
pub struct ModelReader {
    /// Reads a file as far as its structure; damage of the voxels themselves is found by the walk.
    pub read: ReadModel,
    /// The form in which the models are shown: what was built of cubes stays so; what was a mesh is smooth.
    pub surface: SurfaceKind,
}

/// Writes a sculpture to a stream. Returns what the format has no room for.
pub type ModelWriter =
    fn(&Contents, &mut dyn Write, &dyn Progress) -> Result<Vec<String>, FormatError>;

/// A model, or several that belong together, as a file holds it.
pub trait Model {
    /// Format and parts, such as `MagicaVoxel, version 150, 3 models`.
    fn kind(&self) -> String;

    /// Returns the box that the file sets aside for its voxels: its lowest voxel and one past its highest. None if it
    /// does not say, or if the box is not worth keeping.
    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)>;

    /// Calls `sink` for every voxel that exists; of two in one place the later one counts.
    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError>;

    /// Returns the axis of the file that points up, as its format has it.
    fn up(&self) -> Up;

    /// Returns how the model is turned, so that the axis that `options` name, if they name one, points up instead.
    fn turn(&self, options: &ImportOptions) -> Orientation {
        let up = options.upright.unwrap_or(self.up());
        self.up().turned_upright().inverse().then(up.turned_upright())
    }

    /// Notes on what is left out of the file, for the user.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

/// From the axes of MagicaVoxel, Goxel and Voxlap's models (z up, y away from the viewer) to ours, a rotation.
/// A voxel covers [v, v+1), so that the axis that is reversed also moves by one.
pub fn upright(v: I64Vec3) -> I64Vec3 {
    I64Vec3::new(v.x, v.z, -1 - v.y)
}

/// [`upright`] of a box, given by its lowest voxel and one past its highest.
pub fn upright_box((low, high): (I64Vec3, I64Vec3)) -> (I64Vec3, I64Vec3) {
    (I64Vec3::new(low.x, low.z, -high.y), I64Vec3::new(high.x, high.z, -low.y))
}
