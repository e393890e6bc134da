// Fragment shader for beam.wgsl: how far the rays of each tile can be advanced safely.

//!include "beam.wgsl"

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return start_of(vec2<u32>(position.xy));
}
