// The pixels of a reference picture, interpolated between the four nearest; transparent ones have no colour.
//!include "reference.wgsl"

@group(0) @binding(0) var picture: texture_2d<f32>;

// Multiplied by its opacity.
fn texel(at: vec2<i32>) -> vec4<f32> {
    let last = vec2<i32>(reference.size) - vec2<i32>(1);
    let colour = textureLoad(picture, clamp(at, vec2<i32>(0), last), 0);
    return vec4<f32>(colour.xyz * colour.w, colour.w);
}

@fragment
fn main(corner: Corner) -> @location(0) vec4<f32> {
    // In pixels; the centre of the first is at 0.
    let at = corner.at * reference.size - 0.5;
    let low = floor(at);
    let share = at - low;
    let first = vec2<i32>(low);
    let upper = mix(texel(first), texel(first + vec2<i32>(1, 0)), share.x);
    let lower = mix(texel(first + vec2<i32>(0, 1)), texel(first + vec2<i32>(1, 1)), share.x);
    let seen = mix(upper, lower, share.y);
    return vec4<f32>(seen.xyz / max(seen.w, 1e-4), seen.w * reference.opacity);
}
