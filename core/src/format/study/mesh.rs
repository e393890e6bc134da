//! Describes a mesh before it is imported: its outline, and the grid that it would occupy.

use glam::{DVec3, Vec3};

use super::Outlook;
use crate::format::mesh_in::{Imported, MeshReader};
use crate::format::options::{Colouring, ImportOptions};
use crate::format::{FormatError, voxel};
use crate::sculpture::orientation::Up;
use crate::sculpture::{Grid, Limits};
use crate::voxelise::{MeshPlacement, bounds};

/// Greatest number of triangles that an outline shows.
const MOST_TRIANGLES: usize = 4000;

/// A mesh to be imported, without its triangles.
#[derive(Debug)]
pub struct MeshStudy {
    /// Number of its triangles.
    pub count: usize,
    /// Corners of a sample of its triangles, spread evenly over the file, in its coordinates.
    pub sample: Vec<[Vec3; 3]>,
    /// Whether it has colours.
    pub has_colours: bool,
    /// Display name of the format.
    pub kind: String,
    /// Notes on what was left out.
    pub notes: Vec<String>,
    format: &'static MeshReader,
    bounds: (DVec3, DVec3),
}

impl MeshStudy {
    pub(super) fn of(
        imported: Imported,
        format: &'static MeshReader,
    ) -> Result<MeshStudy, FormatError> {
        let Imported { mesh, kind, notes, .. } = imported;
        let corners = |t: &[u32; 3]| t.map(|corner| mesh.positions[corner as usize]);
        let is_finite = |t: &[Vec3; 3]| t.iter().all(|corner| corner.is_finite());
        let stride = mesh.triangles.len().div_ceil(MOST_TRIANGLES).max(1);
        let sample = mesh.triangles.iter().step_by(stride).map(corners).filter(is_finite).collect();
        let study = MeshStudy {
            count: mesh.triangles.len(),
            sample,
            has_colours: mesh.has_colours(),
            kind,
            notes,
            format,
            bounds: bounds(&mesh),
        };
        study.frame(&ImportOptions::default())?;
        Ok(study)
    }

    /// Returns whether the file defines its up axis.
    pub fn knows_up(&self) -> bool {
        self.format.knows_up
    }

    /// Returns the axis that points up.
    pub fn up(&self, options: &ImportOptions) -> Up {
        self.format.up(options)
    }

    /// Returns the grid that the mesh would occupy.
    pub fn frame(&self, options: &ImportOptions) -> Result<MeshPlacement, FormatError> {
        let (up, mm) = (self.up(options), self.format.mm_per_unit);
        Ok(MeshPlacement::of_bounds(self.bounds, options.mesh_size, up, mm)?)
    }

    /// Returns the sculpture that an import of the mesh would make; an error if it cannot be imported with these
    /// options. Triangles may need more memory than stated.
    pub fn outlook(
        &self,
        options: &ImportOptions,
        limits: &Limits,
    ) -> Result<Outlook, FormatError> {
        let depth = voxel::colour_depth(options)?;
        let frame = self.frame(options)?;
        Grid::check_size(frame.dims, frame.voxel_size)?;
        let voxels = frame.dims.as_u64vec3().element_product();
        let coloured = self.has_colours && options.colouring != Colouring::None;
        Ok(Outlook {
            dims: frame.dims,
            voxel_size: frame.voxel_size,
            // A bit for each voxel, three times.
            read_bytes: voxels.div_ceil(8) * 3,
            grid_bytes: Grid::bytes_for(frame.dims),
            colour_bytes: if coloured { voxels * depth.bytes() as u64 } else { 0 },
        })
    }
}
