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
    let place = core * (1.0 - round) + offset * round;
    let normal = ball_normal / round;
    let at = vec4<f32>(place, 1.0);
    let clip = vec4<f32>(dot(solid.clip_x, at), dot(solid.clip_y, at), 1.0, dot(solid.clip_w, at));
    let turned = vec3<f32>(
        dot(rows[0].xyz, normal),
        dot(rows[1].xyz, normal),
        dot(rows[2].xyz, normal),
    );
    let side = 1.0 - normal.y * normal.y / dot(normal, normal);
    return Corner(clip, turned, dot(normal, solid.eye - place), place, side);
}
