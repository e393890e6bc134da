// What a pipeline is made for (render/surface_kind.rs). build.rs turns the literals 0x5bec0000 + N
// into specialization constants N, which WGSL has no other way to declare to it.
//
// Not uniforms: a branch that these decide costs nothing, while lavapipe would run both of its sides,
// and in some versions compiles a shader anew for each picture in which a uniform decides one.

var<private> kind_lights: u32 = 0x5bec0000u;
var<private> kind_occlusion: u32 = 0x5bec0001u;
// Bytes of a voxel's colour; 0 where all have the base colour.
var<private> kind_colour_bytes: u32 = 0x5bec0002u;
