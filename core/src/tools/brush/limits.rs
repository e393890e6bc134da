//! Limits of how far brushes reach and move clay, for the descriptions of their options, the checks of their uses, and
//! the computations.
//!
//! Numbers alone; knows no brush.

/// Smallest radius, in units of the smallest voxel edge: shorter steps would never end.
pub const MIN_RADIUS: f32 = 0.5;
/// Largest radius, in units of the smallest voxel edge: lookup tables stay below 200 MB.
pub const MAX_RADIUS: f32 = 96.0;
/// Greatest pull, in voxels along each axis.
pub const MAX_PULL_VX: f32 = 192.0;
/// Greatest twist, in degrees either way.
pub const MAX_TWIST_DEG: f32 = 360.0;
/// Greatest height by which a surface is raised or lowered, in units of the smallest voxel edge.
pub const MAX_HEIGHT: f32 = 16.0;
/// Largest reach of a brush around a voxel of the surface, in voxels.
pub const MAX_REACH_VX: f32 = 64.0;
