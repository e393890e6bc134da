// Covers the whole target, for passes that work per pixel.
//!include "screen.wgsl"

@vertex
fn main(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return screen_triangle(vertex);
}
