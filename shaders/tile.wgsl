// Beams: what beam.wgsl computes for the traversal of single rays.

// The start of rays that hit nothing.
const FAR_AWAY: f32 = 3e38;
