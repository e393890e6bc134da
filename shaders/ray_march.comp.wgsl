// Compute shader for ray_march.wgsl: the index map of one eye.

//!include "ray_march.wgsl"
//!include "square.wgsl"

@group(0) @binding(2) var index_map: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = pixel_of(group, lane);
    if all(pixel < textureDimensions(index_map)) {
        textureStore(index_map, pixel, vec4<u32>(voxel_at(pixel), 0u, 0u, 0u));
    }
}
