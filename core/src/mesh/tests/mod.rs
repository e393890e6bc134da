//! Tests of meshes, by a checker of its own and by counting voxels.

mod check;
mod surfaces;
