// Compute shader for beam.wgsl: how far the rays of each tile can be advanced safely.

//!include "beam.wgsl"
//!include "square.wgsl"

@group(0) @binding(1) var starts: texture_storage_2d<r32float, write>;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let tile = pixel_of(group, lane);
    if all(tile < textureDimensions(starts)) {
        textureStore(starts, tile, vec4<f32>(start_of(tile), 0.0, 0.0, 0.0));
    }
}
