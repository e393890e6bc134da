// Fragment shader for shade.wgsl: the picture of one eye from its index map.

//!include "shade.wgsl"

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return colour_at(vec2<u32>(position.xy));
}
