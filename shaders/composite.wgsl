// Draws the shaded sculpture over the target, with the depth of its surface, so that it occludes what is drawn
// later. The depth is where the pixel's ray enters the voxel that it sees. The voxels of a large sculpture
// have no linear index: the map has the time of entry in its place.

//!include "layout.wgsl"
//!include "entry.wgsl"
//!include "places.wgsl"

var<immediate> view: CompositeView;
@group(0) @binding(0) var index_map: texture_2d<u32>;
@group(0) @binding(1) var picture: texture_2d<f32>;

struct Pixel {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn main(@builtin(position) position: vec4<f32>) -> Pixel {
    let at = position.xy - vec2<f32>(view.left, view.upper);
    let on_map = at * vec2<f32>(view.scale_x, view.scale_y);
    let texel = min(vec2<u32>(on_map), view.size - vec2<u32>(1u));
    let voxel = textureLoad(index_map, texel, 0).x;
    if voxel == NO_VOXEL {
        discard;
    }
    let low = voxel_of(voxel, max(view.dims, vec3<u32>(1u)));
    let centre = vec2<f32>(texel) + 0.5;
    let ray = make_ray(view.origin, view.corner + view.step_x * centre.x + view.step_y * centre.y);
    let enter = entry_time(ray, low, across_view(view.corner, view.step_x, view.step_y));
    let t = select(enter, bitcast<f32>(voxel), view.dims.x == 0u);
    // An eye inside the voxel sees it at the near plane.
    let depth = select(1.0, (view.depth_slope * t + view.depth_at_0) / t, t > 0.0);
    let colour = stored(textureLoad(picture, texel, 0).xyz);
    return Pixel(vec4<f32>(colour, 1.0), clamp(depth, 0.0, 1.0));
}
