// Samples and lights in one go: each pixel's ray walks to the first voxel, which is lit at once.
// Depth and background are the composite's.

//!include "layout.wgsl"
//!include "march.wgsl"
//!include "surface.wgsl"
//!include "encoding.wgsl"

var<immediate> view: CompositeView;

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
    let seen = first_voxel(ray, vec3<i32>(view.dims));
    if !seen.found {
        if view.keep != 0u {
            discard;
        }
        let down = on_map.y / f32(view.size.y);
        return Pixel(vec4<f32>(mix(view.top, view.bottom, down), 1.0), 0.0);
    }
    let low = seen.voxel;
    let enter = crossings(ray, select(low + vec3<i32>(1), low, ray.forward));
    let t = max(max(enter.x, enter.y), enter.z);
    // An eye within the voxel sees it at the near plane.
    let depth = select(1.0, (view.depth_slope * t + view.depth_at_0) / t, t > 0.0);
    let colour = decoded(shaded(low), view.linear != 0u);
    return Pixel(vec4<f32>(colour, 1.0), clamp(depth, 0.0, 1.0));
}
