// The colour of a pixel from the index map; transparent where no voxel is seen.

//!include "layout.wgsl"
//!include "places.wgsl"
//!include "surface.wgsl"

// The voxel, and the complement of its packed normal, which is 0 in a map without normals.
@group(0) @binding(2) var index_map: texture_2d<u32>;

fn colour_at(pixel: vec2<u32>) -> vec4<f32> {
    let seen = textureLoad(index_map, pixel, 0).xy;
    if seen.x == NO_VOXEL {
        return vec4<f32>(0.0);
    }
    return vec4<f32>(shaded(voxel_of(seen.x, shading.dims), seen.y ^ NO_NORMAL), 1.0);
}
