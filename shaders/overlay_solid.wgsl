// The semi-transparent faces of the tool preview. Shared by both stages.

struct Solid {
    // Rows of the matrix from tool space to clip space, over the clip z, which is the same everywhere.
    clip_x: vec4<f32>,
    clip_y: vec4<f32>,
    clip_w: vec4<f32>,
    // Rows of the matrix that takes normals to eye space, not normalised. Fourth elements: half extents of the
    // ellipsoid that rounds the solid, 1 where none does.
    eye_from_normal: array<vec4<f32>, 3>,
    // In tool space.
    eye: vec3<f32>,
    // sRGB and opacity, a byte each.
    colour: u32,
    // How far before a face the surface that it makes may lie: along the normal, and towards the eye at most, the
    // latter over the clip z.
    margin: f32,
    most: f32,
    // Twice the margin over the radius of curvature, times the square of the clip z; 0 for flat faces.
    bend: f32,
    // 1 where only the sides are curved, about the y axis, else 0.
    straight: f32,
}

var<immediate> solid: Solid;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) normal: vec3<f32>,
    // Of the eye above the face's plane, in lengths of the normal.
    @location(1) height: f32,
    // In tool space.
    @location(2) place: vec3<f32>,
    // From a flat end, 0, to a side, 1.
    @location(3) side: f32,
}
