// Compute shader for shade.wgsl: the picture of one eye from its index map.

//!include "shade.wgsl"
//!include "square.wgsl"

@group(0) @binding(3) var picture: texture_storage_2d<rgba8unorm, write>;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let pixel = pixel_of(group, lane);
    if all(pixel < textureDimensions(picture)) {
        textureStore(picture, pixel, colour_at(pixel));
    }
}
