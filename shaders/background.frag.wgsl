// A vertical gradient in sRGB values, with half a step of noise against bands.

struct Background {
    top: vec4<f32>,
    // Alpha: height of the picture in pixels.
    bottom: vec4<f32>,
}

var<immediate> background: Background;

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let t = clamp(position.y / background.bottom.w, 0.0, 1.0);
    let colour = mix(background.top.xyz, background.bottom.xyz, t);
    // Interleaved gradient noise (Jimenez, "Next generation post processing", 2014).
    let noise = fract(52.9829189 * fract(dot(position.xy, vec2<f32>(0.06711056, 0.00583715))));
    return vec4<f32>(colour + (noise - 0.5) / 255.0, 1.0);
}
