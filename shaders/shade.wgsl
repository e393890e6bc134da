// The colour of a pixel from the index map; transparent where no voxel is seen.

//!include "layout.wgsl"
//!include "places.wgsl"
//!include "surface.wgsl"

@group(0) @binding(2) var index_map: texture_2d<u32>;

fn colour_at(pixel: vec2<u32>) -> vec4<f32> {
    let voxel = textureLoad(index_map, pixel, 0).x;
    if voxel == NO_VOXEL {
        return vec4<f32>(0.0);
    }
    return vec4<f32>(shaded(voxel_of(voxel, shading.dims)), 1.0);
}
