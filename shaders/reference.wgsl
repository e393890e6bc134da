// A reference picture: a translucent rectangle in the scene.

struct Reference {
    // From the picture, its upper left corner at (0, 0) and its lower right one at (1, 1).
    clip_from_picture: mat4x4<f32>,
    // Width and height in pixels.
    size: vec2<f32>,
    opacity: f32,
    pad: f32,
}

var<immediate> reference: Reference;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec2<f32>,
}
