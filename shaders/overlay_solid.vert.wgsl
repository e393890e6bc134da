// Transforms the faces of the tool preview.
//!include "overlay_solid.wgsl"

@vertex
fn main(@location(0) position: vec3<f32>, @location(1) normal: vec3<f32>) -> Corner {
    let clip = solid.clip_from_tool * vec4<f32>(position, 1.0);
    let rows = solid.eye_from_normal;
    let turned = vec3<f32>(
        dot(rows[0].xyz, normal),
        dot(rows[1].xyz, normal),
        dot(rows[2].xyz, normal),
    );
    return Corner(clip, turned);
}
