//! Reads meshes of other programs: Wavefront `.obj` with `.mtl` and texture, `.stl`, `.ply`, `.glb`, `.gltf`
//! and `.3mf`.
//!
//! Takes the bytes of a file, and for `.obj` and `.gltf` its folder; gives triangles with their colours, in the axes of
//! the file. `crate::voxelise` makes voxels of them. Non-finite corners are kept; the voxeliser leaves their triangles
//! out.

mod glb;
mod glb_json;
mod gltf_files;
pub mod imported;
mod mtl;
mod obj;
mod ply;
mod ply_header;
mod stl;
mod three_mf;
mod three_mf_parts;

pub use self::imported::{Imported, MeshReader, load};
use super::spec::Format;

/// The formats, as texts list them: the most common export formats come first.
pub static FORMATS: &[Format] = &[&stl::SPEC, &glb::SPEC, &three_mf::SPEC, &ply::SPEC, &obj::SPEC];
