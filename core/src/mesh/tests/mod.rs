//! Tests of meshes, by an independent checker and by counting voxels.

pub(crate) mod check;
mod kept;
mod simplified;
mod surfaces;
mod thin;
