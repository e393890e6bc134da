// Draws the mean of pictures as an opaque picture: the inverse of mean_add.frag.wgsl.

//!include "layout.wgsl"

var<immediate> view: MeanView;
@group(0) @binding(0) var mean: texture_2d<f32>;

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let light = textureLoad(mean, vec2<u32>(position.xy), 0).xyz;
    return vec4<f32>(select(sqrt(light), light, view.linear != 0u), 1.0);
}
