//! Tests of meshes, by a checker of its own and by counting voxels.

pub(crate) mod check;
mod kept;
mod simplified;
mod surfaces;
mod thin;
