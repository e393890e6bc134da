// The semi-transparent faces of the tool preview. Shared by both stages.

struct Solid {
    clip_from_tool: mat4x4<f32>,
    // Rows of the matrix that takes normals to eye space, not normalised. Fourth elements: half extents of the
    // ellipsoid that rounds the solid, 1 where none does.
    eye_from_normal: array<vec4<f32>, 3>,
    // sRGB and opacity.
    colour: vec4<f32>,
}

var<immediate> solid: Solid;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) normal: vec3<f32>,
}
