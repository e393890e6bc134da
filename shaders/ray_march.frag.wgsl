// Fragment shader for ray_march.wgsl: the index map of one eye.

//!include "ray_march.wgsl"

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) u32 {
    return voxel_at(vec2<u32>(position.xy));
}
