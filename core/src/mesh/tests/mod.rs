//! Tests of meshes, by a checker of its own and by counting voxels.

pub(crate) mod check;
mod simplified;
mod surfaces;
