//! The orientation of a mesh in its grid, and the size of the grid in voxels.

use std::fmt;
use std::str::FromStr;

use glam::{DVec3, I64Vec3, IVec3, UVec3, Vec3};

use super::crossings::{MOST_TRIANGLES, PlacedMesh, SUB_VX};
use super::{InputMesh, VoxeliseError};
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::orientation::Up;

/// The size of a mesh in voxels.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum MeshSize {
    /// Voxels of its longest side.
    LongestVx(u32),
    /// The edge of a voxel in millimetres.
    VoxelMm(f32),
}

impl Default for MeshSize {
    fn default() -> MeshSize {
        MeshSize::LongestVx(256)
    }
}

/// Writes `256` or `0.5mm`.
impl fmt::Display for MeshSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshSize::LongestVx(voxels) => write!(f, "{voxels}"),
            MeshSize::VoxelMm(mm) => write!(f, "{mm}mm"),
        }
    }
}

impl FromStr for MeshSize {
    type Err = String;

    fn from_str(text: &str) -> Result<MeshSize, String> {
        let size = match text.strip_suffix("mm") {
            Some(mm) => mm
                .trim()
                .parse()
                .ok()
                .filter(|mm: &f32| mm.is_finite() && *mm > 0.0)
                .map(MeshSize::VoxelMm),
            None => {
                text.parse().ok().filter(|n| (1..=MAX_AXIS_VX).contains(n)).map(MeshSize::LongestVx)
            }
        };
        size.ok_or_else(|| {
            format!(
                "`{text}` is not a size; give the voxels of the longest side, 1 to {MAX_AXIS_VX}, \
                 or the edge of a voxel, such as 0.5mm"
            )
        })
    }
}

/// The grid of a mesh, and the pose of the mesh in it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeshPlacement {
    /// Size in voxels.
    pub dims: UVec3,
    /// Edge of a voxel, in millimetres.
    pub voxel_size: Vec3,
    /// Rows of the rotation from the mesh's axes to the grid's.
    rows: [DVec3; 3],
    /// The mesh point at the centre of the grid.
    centre: DVec3,
    voxels_per_unit: f64,
}

impl MeshPlacement {
    /// Returns a grid that just holds the mesh. `mm_per_unit`: the length of a unit of the mesh.
    pub fn around(
        mesh: &InputMesh,
        size: MeshSize,
        up: Up,
        mm_per_unit: f64,
    ) -> Result<MeshPlacement, VoxeliseError> {
        MeshPlacement::of_bounds(bounds(mesh), size, up, mm_per_unit)
    }

    /// Returns the frame of a mesh of these [`bounds`].
    pub(crate) fn of_bounds(
        (low, high): (DVec3, DVec3),
        size: MeshSize,
        up: Up,
        mm_per_unit: f64,
    ) -> Result<MeshPlacement, VoxeliseError> {
        let turn = up.turned_upright();
        let axis = |from: IVec3| turn.destination(IVec3::ONE + from, UVec3::splat(3)) - IVec3::ONE;
        let columns = [IVec3::X, IVec3::Y, IVec3::Z].map(|from| axis(from).as_dvec3());
        let rows = [0, 1, 2].map(|row| DVec3::from_array(columns.map(|column| column[row])));
        let extent = (high - low).max_element();
        if !(extent.is_finite() && extent > 0.0) {
            return Err(VoxeliseError::Nothing);
        }
        let voxels_per_unit = match size {
            MeshSize::LongestVx(voxels) => f64::from(voxels) / extent,
            MeshSize::VoxelMm(mm) => mm_per_unit / f64::from(mm),
        };
        let sides = rows.map(|row| row.dot(high - low).abs() * voxels_per_unit);
        // Rounding errors must not cost an additional voxel.
        let dims = sides.map(|side| (side - 1e-3).ceil().clamp(1.0, f64::from(u32::MAX)) as u32);
        let voxel_size = Vec3::splat((mm_per_unit / voxels_per_unit) as f32);
        Ok(MeshPlacement {
            dims: dims.into(),
            voxel_size,
            rows,
            centre: (low + high) / 2.0,
            voxels_per_unit,
        })
    }

    /// Maps a point of the mesh to the grid, in voxels.
    pub fn in_grid(&self, at: Vec3) -> Vec3 {
        self.turned(at).as_vec3()
    }

    fn turned(&self, at: Vec3) -> DVec3 {
        let from_centre = at.as_dvec3() - self.centre;
        let turned = DVec3::from_array(self.rows.map(|row| row.dot(from_centre)));
        turned * self.voxels_per_unit + self.dims.as_dvec3() / 2.0
    }

    /// Returns the mesh in the grid's coordinates.
    pub(super) fn place(&self, mesh: &InputMesh) -> Result<PlacedMesh, VoxeliseError> {
        if mesh.triangles.len() > MOST_TRIANGLES {
            return Err(VoxeliseError::TooManyTriangles);
        }
        let corner = |at: &Vec3| {
            let at = self.turned(*at) * SUB_VX as f64;
            // Corners beyond the grid belong to triangles that are left out.
            let most = self.dims.as_dvec3() * SUB_VX as f64;
            let within = if at.is_finite() { at.clamp(DVec3::ZERO, most) } else { DVec3::ZERO };
            within.round().as_i64vec3()
        };
        let corners: Vec<I64Vec3> = mesh.positions.iter().map(corner).collect();
        let is_left_out = |t: &[u32; 3]| !is_finite(mesh, t);
        let triangles = mesh.triangles.iter().map(|t| if is_left_out(t) { [0; 3] } else { *t });
        Ok(PlacedMesh { dims: self.dims, triangles: triangles.collect(), corners })
    }
}

/// Returns the lowest and the highest coordinates of all triangles of finite size.
pub fn bounds(mesh: &InputMesh) -> (DVec3, DVec3) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in mesh.triangles.iter().filter(|t| is_finite(mesh, t)).flatten() {
        let at = mesh.positions[*corner as usize].as_dvec3();
        low = low.min(at);
        high = high.max(at);
    }
    (low, high)
}

fn is_finite(mesh: &InputMesh, triangle: &[u32; 3]) -> bool {
    triangle.iter().all(|corner| mesh.positions[*corner as usize].is_finite())
}
