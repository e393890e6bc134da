//! Describes a mesh before it is imported: its outline, and the grid that it would occupy.

use glam::{DVec3, Vec3};

use super::Outlook;
use crate::format::mesh_in::{Imported, MeshReader};
use crate::format::options::{Colouring, ImportOptions};
use crate::format::{FormatError, voxel};
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::orientation::Up;
use crate::sculpture::{Brick, Grid};
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
    /// options. The memory is an estimate: that of a shape with as much surface as the mesh's box. The voxels of rugged
    /// shapes may need more, and are refused then.
    pub fn outlook(&self, options: &ImportOptions) -> Result<Outlook, FormatError> {
        let depth = voxel::colour_depth(options)?;
        let frame = self.frame(options)?;
        Grid::check_size(frame.dims, frame.voxel_size)?;
        let size = frame.dims.as_u64vec3();
        let voxels = size.element_product();
        let surface_vx = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
        // Two rows of bricks beside each piece of the surface.
        let surface_bytes =
            surface_vx / u64::from(BRICK_EDGE_VX.pow(2)) * 2 * size_of::<Brick>() as u64;
        let coloured = self.has_colours && options.colouring != Colouring::None;
        Ok(Outlook {
            dims: frame.dims,
            voxel_size: frame.voxel_size,
            // The crossings along z, and a layer of 64 voxels.
            read_bytes: surface_vx * 8 + size.x * size.y * 8 * 2,
            grid_bytes: surface_bytes.min(Grid::bytes_for(frame.dims)),
            colour_bytes: if coloured { voxels * depth.bytes() as u64 } else { 0 },
        })
    }
}
