// The shaded colour of a voxel: from its colour, normal and ambient occlusion.

//!include "normal.wgsl"
//!include "colours.wgsl"
//!include "lighting.wgsl"

fn shaded(voxel: vec3<i32>) -> vec3<f32> {
    let dims = vec3<i32>(shading.dims);
    let colour = colour_of(voxel, shading.base, shading.bricks);
    var open = 1.0;
    if kind_occlusion != 0u {
        open = openness(voxel, dims);
    }
    return lit(vec3<f32>(voxel) + 0.5, gradient(voxel, dims), colour, open);
}
