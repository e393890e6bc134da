// Colours a line with antialiased edges.

@fragment
fn main(
    @location(0) colour: vec4<f32>,
    @location(1) @interpolate(linear) across: vec2<f32>,
) -> @location(0) vec4<f32> {
    let cover = clamp(across.y + 0.5 - abs(across.x), 0.0, 1.0);
    return vec4<f32>(colour.xyz, colour.w * cover);
}
