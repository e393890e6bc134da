// Transforms the faces of the tool preview.
//!include "overlay_solid.wgsl"

@vertex
fn main(
    @location(0) core: vec3<f32>,
    @location(1) offset: vec3<f32>,
    @location(2) ball_normal: vec3<f32>,
) -> Corner {
    let rows = solid.eye_from_normal;
    let round = vec3<f32>(rows[0].w, rows[1].w, rows[2].w);
    let position = core * (1.0 - round) + offset * round;
    let normal = ball_normal / round;
    let clip = solid.clip_from_tool * vec4<f32>(position, 1.0);
    let turned = vec3<f32>(
        dot(rows[0].xyz, normal),
        dot(rows[1].xyz, normal),
        dot(rows[2].xyz, normal),
    );
    return Corner(clip, turned);
}
