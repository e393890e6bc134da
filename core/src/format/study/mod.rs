//! Describes a file before it is imported: the data that a dialog shows of it and the questions that it asks.
//!
//! Takes a path; gives a volume that can be cut into slices, the outline of a mesh, or the surface of a voxel model.
//! For given import options, also gives which voxels would exist, the size of the sculpture and its memory. Makes no
//! sculpture.

mod mesh;
mod model;
mod volume;

use std::path::Path;

pub use self::mesh::MeshStudy;
pub use self::model::{ModelStudy, SurfaceVoxel};
pub use self::volume::{Existing, VolumeStudy};
use super::options::ImportOptions;
use super::scan::Reading;
use super::spec::Import;
use super::{FormatError, budget_bytes, content, import, mesh_in, read_file, read_volume};
use crate::progress::Progress;
use crate::sculpture::Limits;
use glam::{UVec3, Vec3};

/// Groups of files with the same import options.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Family {
    /// Densities or colours in a box: scans, `.pvm`, `.raw`.
    Volume,
    /// Triangles.
    Mesh,
    /// Coloured voxels of other voxel editors.
    Model,
}

impl Family {
    /// All families with their names.
    pub const NAMED: [(Family, &'static str); 3] =
        [(Family::Volume, "volume"), (Family::Mesh, "mesh"), (Family::Model, "model")];
}

/// Returns the family of a file, which determines its import options. `None` for sculptures, which leave nothing open,
/// and for files that cannot be read.
pub fn family(path: &Path) -> Option<Family> {
    if content::needs_layout(path) {
        return Some(Family::Volume);
    }
    match content::format_of(path, false).ok()?.0.read {
        Import::Sculpture => None,
        Import::Model(_) => Some(Family::Model),
        Import::Volume(_) | Import::Scan(_) => Some(Family::Volume),
        Import::Mesh(_) => Some(Family::Mesh),
    }
}

/// The contents of a file.
#[derive(Debug)]
pub enum Study {
    /// Voxels.
    Volume(Box<VolumeStudy>),
    /// Triangles.
    Mesh(Box<MeshStudy>),
    /// Voxels of another voxel editor.
    Model(Box<ModelStudy>),
    /// Nothing is left open, as in a volume that this program has written.
    Settled,
}

/// The sculpture that an import would make.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Outlook {
    /// Size in voxels.
    pub dims: UVec3,
    /// Edges of a voxel, in millimetres where the file has a unit.
    pub voxel_size: Vec3,
    /// Memory during reading in bytes.
    pub read_bytes: u64,
    /// Memory of the shape afterwards in bytes.
    pub grid_bytes: u64,
    /// Greatest memory of the colours in bytes.
    pub colour_bytes: u64,
}

/// Reads a file for a study: a raw one with the layout of `options`, one of several channels or times as chosen there.
/// This may take as much memory as [`super::load`]. A volume whose sculpture would be too large is still read, since a
/// part of it may be chosen.
pub fn study(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Study, FormatError> {
    let (format, _) = content::format_of(path, options.raw.is_some())?;
    match &format.read {
        Import::Sculpture => Ok(Study::Settled),
        Import::Model(reader) => {
            let file = read_file(path, limits, progress)?;
            let model = (reader.read)(&file)?;
            let study = ModelStudy::of(&*model, limits, progress)?;
            Ok(Study::Model(Box::new(study)))
        }
        Import::Mesh(reader) => {
            let imported = mesh_in::load(path, reader, limits, progress)?;
            MeshStudy::of(imported, reader).map(|study| Study::Mesh(Box::new(study)))
        }
        Import::Volume(_) | Import::Scan(_) => {
            let ImportOptions { raw, channel, time, .. } = *options;
            let options = ImportOptions { raw, channel, time, ..ImportOptions::default() };
            let (grid_bytes, colour_bytes) = (budget_bytes(limits), 0);
            let limits = Limits { grid_bytes, colour_bytes, ..*limits };
            let (options, limits) = (&options, &limits);
            let reading = Reading { path, options, limits, progress, in_layers: false };
            let (volume, source) = read_volume(format, &reading)?;
            let volume = volume.held(budget_bytes(limits), progress)?;
            if import::trusted_signature(&volume.texts, volume.samples).is_some() {
                return Ok(Study::Settled);
            }
            VolumeStudy::of(volume, source).map(|study| Study::Volume(Box::new(study)))
        }
    }
}
