// Beams: what beam.comp.wgsl leaves for the walks of single rays.

// The start of rays that meet nothing.
const FAR_AWAY: f32 = 3e38;
