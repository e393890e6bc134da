// A voxel becomes a triangle in the picture that contains its box, or that of the brick for which it stands, lit as one
// point. Draw 3 vertices per point
// and no instances: instances would be shaded one by one. (Two triangles would cover less, but cost twice as
// much where points are small, and then there are many.)

//!include "layout.wgsl"
//!include "lighting.wgsl"
//!include "packed_normal.wgsl"
//!include "small_bricks.wgsl"

var<immediate> view: PointView;

// As core/src/shade/points.rs packs them: x and y, z of the voxel and its packed normal in 16 bits each; an
// estimate of the normal and openness in signed bytes, the last one inverted in shadow; colour in bytes.
@group(0) @binding(6) var<storage, read> points: array<vec4<u32>>;

// Enlargement of the box in voxels, to allow for rounding. The pixels that it adds are discarded.
const MARGIN_VX: f32 = 0.01;
// The same for each voxel of the distance from the eye, for eyes that are far away.
const MARGIN_PER_VX: f32 = 4e-7;

struct Corner {
    @builtin(position) position: vec4<f32>,
    // The lowest voxel of the box, and one past the highest.
    @location(0) @interpolate(flat) low: vec3<i32>,
    @location(1) @interpolate(flat) high: vec3<i32>,
    @location(2) @interpolate(flat) colour: vec3<f32>,
}

@vertex
fn main(
    @builtin(vertex_index) vertex: u32,
) -> Corner {
    let point = points[vertex / 3u];
    let corner = vertex % 3u;
    let voxel = vec3<u32>(point.x & 0xffffu, point.x >> 16u, point.y & 0xffffu);
    // unpack4xI8 would need a feature that not every device has.
    let bytes = vec4<i32>(vec4<u32>(point.z) << vec4<u32>(24u, 16u, 8u, 0u));
    let estimate = bytes >> vec4<u32>(24u);
    let packed = point.y >> 16u;
    let outwards = select(unpacked_normal(packed), vec3<f32>(estimate.xyz), packed == NO_NORMAL);
    let colour = unpack4x8unorm(point.w);
    let weights = vec3<i32>(shading.small_x, shading.small_y, shading.small_z);
    let small = SmallBricks(weights, shading.small_least);
    let is_whole = is_small(small, vec3<i32>(voxel >> vec3<u32>(3u)));
    let low = select(voxel, voxel & vec3<u32>(~7u), is_whole);
    let edge = select(1u, 8u, is_whole);
    let high = min(low + edge, shading.dims);
    let from_eye = vec3<f32>(low) + 0.5 * f32(edge) - view.origin;
    let w = dot(view.clip_w, from_eye);
    let distance = max(max(abs(from_eye.x), abs(from_eye.y)), abs(from_eye.z));
    let reach = 0.5 * f32(edge) + MARGIN_VX + MARGIN_PER_VX * distance;
    let nearest = w - reach * dot(abs(view.clip_w), vec3<f32>(1.0));
    // Corners of a triangle that contains the square from -1 to 1.
    let side = select(vec2<f32>(-1.0), vec2<f32>(3.0), vec2<bool>(corner == 1u, corner == 2u));
    let is_dark = estimate.w < 0;
    let open = f32(select(estimate.w, -1 - estimate.w, is_dark)) / 127.0;
    let seen = lit(vec3<f32>(voxel) + 0.5, outwards, colour.xyz, open, select(1.0, 0.0, is_dark));
    // A box that reaches the plane of the eye may be anywhere.
    var position = side;
    if nearest > 0.0 {
        let centre = vec2<f32>(dot(view.clip_x, from_eye), dot(view.clip_y, from_eye)) / w;
        // How far a corner of the box can be from its projected centre.
        let x = dot(abs(view.clip_x - centre.x * view.clip_w), vec3<f32>(1.0));
        let y = dot(abs(view.clip_y - centre.y * view.clip_w), vec3<f32>(1.0));
        // The rasteriser snaps corners to fractions of a pixel.
        let margin = vec2<f32>(view.margin_x, view.margin_y);
        position = centre + side * (vec2<f32>(x, y) * (reach / nearest) + margin);
    }
    return Corner(vec4<f32>(position, 0.5, 1.0), vec3<i32>(low), vec3<i32>(high), seen);
}
