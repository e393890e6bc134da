//! Tools: which voxels a solid or a spray covers, as [`crate::sculpture::edit::Region`]s.
//! They compute masks and change nothing.

pub mod construct;
