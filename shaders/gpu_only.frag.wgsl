// Samples and shades in one pass: each pixel's ray is traversed to the first voxel, which is lit at once. Depth
// is computed as in the composite.

//!include "layout.wgsl"
//!include "march.wgsl"
//!include "entry.wgsl"
//!include "surface.wgsl"
//!include "encoding.wgsl"

var<immediate> view: CompositeView;
@group(0) @binding(6) var starts: texture_2d<f32>;

struct Pixel {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn main(@builtin(position) position: vec4<f32>) -> Pixel {
    let on_map = (position.xy - vec2<f32>(view.left, view.upper))
        * vec2<f32>(view.scale_x, view.scale_y);
    let direction = view.corner + view.step_x * on_map.x + view.step_y * on_map.y;
    let ray = make_ray(view.origin, direction);
    let texel = min(vec2<u32>(on_map), view.size - vec2<u32>(1u));
    let start = textureLoad(starts, texel >> vec2<u32>(view.tile_log2), 0).x;
    let weights = vec3<i32>(shading.small_x, shading.small_y, shading.small_z);
    let small = SmallBricks(weights, shading.small_least);
    let seen = first_seen(ray, vec3<i32>(view.dims), start, small);
    if !seen.found {
        discard;
    }
    let t = entry_time(ray, seen.voxel, across_view(view.corner, view.step_x, view.step_y));
    // An eye inside the voxel sees it at the near plane.
    let depth = select(1.0, (view.depth_slope * t + view.depth_at_0) / t, t > 0.0);
    let colour = decoded(shaded(seen.voxel, NO_NORMAL), view.linear != 0u);
    return Pixel(vec4<f32>(colour, 1.0), clamp(depth, 0.0, 1.0));
}
