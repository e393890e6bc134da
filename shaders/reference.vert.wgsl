// The corners of a reference picture, as two triangles.
//!include "reference.wgsl"

@vertex
fn main(@builtin(vertex_index) vertex: u32) -> Corner {
    let right = vertex == 1u || vertex == 3u || vertex == 4u;
    let lower = vertex == 2u || vertex == 4u || vertex == 5u;
    let at = select(vec2<f32>(0.0), vec2<f32>(1.0), vec2<bool>(right, lower));
    return Corner(reference.clip_from_picture * vec4<f32>(at, 0.0, 1.0), at);
}
