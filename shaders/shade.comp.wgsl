// The picture of one eye from its index map; transparent where nothing is seen.

//!include "layout.wgsl"
//!include "places.wgsl"
//!include "surface.wgsl"

@group(0) @binding(2) var index_map: texture_2d<u32>;
@group(0) @binding(3) var picture: texture_storage_2d<rgba8unorm, write>;

// Neighbouring invocations see neighbouring pixels: eight of them 4x2, thirty-two 8x4.
@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let x = (lane & 3u) | ((lane >> 1u) & 4u);
    let y = ((lane >> 2u) & 1u) | ((lane >> 3u) & 6u);
    let pixel = group.xy * 8u + vec2<u32>(x, y);
    if any(pixel >= textureDimensions(index_map)) {
        return;
    }
    let voxel = textureLoad(index_map, pixel, 0).x;
    var colour = vec4<f32>(0.0);
    if voxel != NO_VOXEL {
        colour = vec4<f32>(shaded(voxel_of(voxel, shading.dims)), 1.0);
    }
    textureStore(picture, pixel, colour);
}
