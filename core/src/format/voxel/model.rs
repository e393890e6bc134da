//! A model of another voxel editor, which can be traversed voxel by voxel repeatedly without a copy; and axis
//! conversions shared by several formats. All models are upright: readers map z to y. Knows no format.

use std::io::Write;

use glam::I64Vec3;

use crate::format::FormatError;
use crate::format::options::ImportOptions;
use crate::progress::Progress;
use crate::sculpture::Rgb;
use crate::sculpture::history::{Contents, SurfaceKind};
use crate::sculpture::orientation::{Orientation, Up};

/// Receives a voxel: its position, y up, and its colour. An error ends the traversal.
pub type Sink<'a> = dyn FnMut(I64Vec3, Rgb) -> Result<(), FormatError> + 'a;

/// Reads the structure of a file.
pub type ReadModel = for<'a> fn(&'a [u8]) -> Result<Box<dyn Model + 'a>, FormatError>;

/// The reader of models of a format.
pub struct ModelReader {
    /// Reads the structure of a file; damage of the voxels themselves is detected during the traversal.
    pub read: ReadModel,
    /// The form in which the models are shown: models built of cubes as cubes, former meshes smooth.
    pub surface: SurfaceKind,
}

/// Writes a sculpture to a stream. Returns notes on what the format cannot store.
pub type ModelWriter =
    fn(&Contents, &mut dyn Write, &dyn Progress) -> Result<Vec<String>, FormatError>;

/// A model, or several that belong together, in the layout of a file.
pub trait Model {
    /// Returns the format and its parts, such as `MagicaVoxel, version 150, 3 models`.
    fn kind(&self) -> String;

    /// Returns the box that the file reserves for its voxels: its lowest voxel and one past its highest. `None` if it
    /// states none, or if the box is not worth keeping.
    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)>;

    /// Calls `sink` for every existing voxel; of two at one position the later one counts.
    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError>;

    /// Returns the up axis of the file according to its format.
    fn up(&self) -> Up;

    /// Returns the rotation that makes the axis given in `options`, if any, point up instead.
    fn turn(&self, options: &ImportOptions) -> Orientation {
        let up = options.upright.unwrap_or(self.up());
        self.up().turned_upright().inverse().then(up.turned_upright())
    }

    /// Returns notes on what is left out of the file, for the user.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Converts from the axes of MagicaVoxel, Goxel and Voxlap's models (z up, y away from the viewer) to ours, a rotation.
/// A voxel covers [v, v+1), so that the reversed axis also shifts by one.
pub fn upright(v: I64Vec3) -> I64Vec3 {
    I64Vec3::new(v.x, v.z, -1 - v.y)
}

/// Converts a box, given by its lowest voxel and one past its highest, as [`upright`] does.
pub(crate) fn upright_box((low, high): (I64Vec3, I64Vec3)) -> (I64Vec3, I64Vec3) {
    (I64Vec3::new(low.x, low.z, -high.y), I64Vec3::new(high.x, high.z, -low.y))
}
