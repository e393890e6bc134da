//! How far brushes reach and move clay at most, for the descriptions of their options, the checks of their uses, and the
//! computations.
//!
//! Numbers alone; knows no brush.

/// Smallest radius, in units of the smallest edge of a voxel: shorter steps would never end.
pub const MIN_RADIUS: f32 = 0.5;
/// Largest radius, in units of the smallest edge of a voxel: what is looked up stays below 200 MB.
pub const MAX_RADIUS: f32 = 96.0;
/// Furthest pull, in voxels along each axis.
pub const MAX_PULL_VX: f32 = 192.0;
/// Furthest twist, in degrees either way.
pub const MAX_TWIST_DEG: f32 = 360.0;
/// Furthest that a surface is raised or lowered, in units of the smallest edge of a voxel.
pub const MAX_HEIGHT: f32 = 16.0;
/// Largest reach of a brush around a voxel of the surface, in voxels.
pub const MAX_REACH_VX: f32 = 64.0;
