// Draws a line of constant width in pixels as two triangles; six vertices per instance.

struct Lines {
    clip_from_grid: mat4x4<f32>,
    // Width and height of the picture in pixels, factor on the opacity, factor on the depth.
    picture: vec4<f32>,
}

var<immediate> lines: Lines;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) colour: vec4<f32>,
    // Distance from the centre line and half the width, in pixels.
    @location(1) @interpolate(linear) across: vec2<f32>,
}

@vertex
fn main(
    @builtin(vertex_index) vertex: u32,
    // Ends in grid coordinates; w of the first: width in pixels.
    @location(0) first: vec4<f32>,
    @location(1) second: vec4<f32>,
    @location(2) colour: vec4<f32>,
) -> Corner {
    var a = lines.clip_from_grid * vec4<f32>(first.xyz, 1.0);
    var b = lines.clip_from_grid * vec4<f32>(second.xyz, 1.0);
    // Clip z is the near distance everywhere (reversed infinite depth). The part in front of the near plane is
    // clipped here, so that the division below is safe.
    let near = a.z;
    if (a.w < near && b.w < near) {
        return Corner(vec4<f32>(2.0, 2.0, 2.0, 1.0), colour, vec2<f32>(0.0, 1.0));
    }
    if (a.w < near) {
        a = mix(a, b, (near - a.w) / (b.w - a.w));
    } else if (b.w < near) {
        b = mix(b, a, (near - b.w) / (a.w - b.w));
    }
    let half_picture = 0.5 * lines.picture.xy;
    let way = (b.xy / b.w - a.xy / a.w) * half_picture;
    let long = length(way);
    var along = vec2<f32>(1.0, 0.0);
    if (long > 1e-4) {
        along = way / long;
    }
    // One pixel wider, for antialiasing.
    let half_width = 0.5 * first.w;
    let reach = half_width + 1.0;
    let at_b = vertex == 1u || vertex == 3u || vertex == 4u;
    let left = vertex == 0u || vertex == 1u || vertex == 3u;
    let side = select(-reach, reach, left);
    let shift = vec2<f32>(-along.y, along.x) * side / half_picture;
    var corner = a;
    if (at_b) {
        corner = b;
    }
    let position = vec4<f32>(
        corner.xy + shift * corner.w,
        min(corner.z * lines.picture.w, corner.w),
        corner.w,
    );
    let faded = vec4<f32>(colour.xyz, colour.w * lines.picture.z);
    return Corner(position, faded, vec2<f32>(side, half_width));
}
