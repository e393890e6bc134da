//! The arguments of `convert` that say how a sculpture becomes a mesh.

use std::path::Path;

use clap::Args;

use crate::format::options::ExportForm;
use crate::format::{MeshOptions, MeshUp, is_mesh, meshes_of_points_text, meshes_with_up_text};
use crate::headless::MeshRequest;
use crate::mesh::MeshKind;

use super::choices;

/// How a mesh is made.
#[derive(Args, Debug, Clone)]
pub struct MeshArgs {
    /// Surface of a mesh (default: smooth, or greedy for models of cubes)
    #[arg(long, value_parser = choices::surfaces(), value_name = "SURFACE")]
    pub mesh: Option<MeshKind>,
    /// Simplify a mesh to this many triangles
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u64).range(4..))]
    pub triangles: Option<u64>,
    #[arg(long, help = format!("Write only the vertices of a mesh ({})", meshes_of_points_text()))]
    pub points: bool,
    #[arg(long, value_parser = choices::up_axes(), value_name = "AXIS", help = up_help())]
    pub up: Option<MeshUp>,
    /// Length of a voxel in a mesh in millimetres (default: the sculpture's voxel size)
    #[arg(long, alias = "millimeters", value_name = "MM", allow_negative_numbers = true)]
    pub millimetres: Option<f32>,
}

fn up_help() -> String {
    let [z, y] = [MeshUp::Z, MeshUp::Y].map(meshes_with_up_text);
    format!("Axis that points up in a mesh (default: z in {z}, y in {y})")
}

impl MeshArgs {
    /// Returns the options of the mesh for `output`; `None` if it is no mesh and no option of meshes was given.
    pub fn options(&self, output: &Path, form: ExportForm) -> Option<MeshRequest> {
        let MeshArgs { mesh, triangles, points, up, millimetres } = *self;
        let is_asked_for = mesh.is_some() || points || triangles.is_some();
        let is_asked_for = is_asked_for || up.is_some() || millimetres.is_some();
        (is_asked_for || is_mesh(output) && form == ExportForm::Auto).then(|| {
            let options = MeshOptions {
                points_only: points,
                up,
                voxel_mm: millimetres,
                triangles,
                ..MeshOptions::default()
            };
            MeshRequest { kind: mesh, options }
        })
    }
}
