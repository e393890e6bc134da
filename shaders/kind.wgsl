// Specialization constants of pipelines that light surfaces (render/specialised.rs). build.rs turns each literal
// 0x5bec0000 + N into the constant with id N, since naga does not write them from WGSL.

var<private> kind_lights: u32 = 0x5bec0000u;
var<private> kind_occlusion: u32 = 0x5bec0001u;
// Bytes of a voxel's colour; 0 if all voxels have the base colour.
var<private> kind_colour_bytes: u32 = 0x5bec0002u;
// Whether normals are incomplete, and estimates stand in for missing ones.
var<private> kind_estimates: u32 = 0x5bec0003u;
// Whether a matcap replaces all light.
var<private> kind_matcap: u32 = 0x5bec0004u;
// Whether a light throws shadows.
var<private> kind_shadow: u32 = 0x5bec0005u;
