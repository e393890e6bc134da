// What a pipeline that lights surfaces is made for: specialization constants (render/specialised.rs).
// build.rs makes one of number N of each literal 0x5bec0000 + N; WGSL has no other way to declare it
// to naga.

var<private> kind_lights: u32 = 0x5bec0000u;
var<private> kind_occlusion: u32 = 0x5bec0001u;
// Bytes of a voxel's colour; 0 where all have the base colour.
var<private> kind_colour_bytes: u32 = 0x5bec0002u;
