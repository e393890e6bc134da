// Adds a picture to the mean: its light, and as alpha its weight, by which the mean is blended.

//!include "layout.wgsl"

var<immediate> view: MeanView;
@group(0) @binding(0) var picture: texture_2d<f32>;

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let colour = textureLoad(picture, vec2<u32>(position.xy), 0).xyz;
    // Gamma 2, as where surfaces are lit, unless the device has decoded the picture.
    let light = select(colour * colour, colour, view.linear != 0u);
    return vec4<f32>(light, view.weight);
}
