// Keeps the pixels of a point's triangle whose rays meet the box of its voxel, or of the brick that it stands for, by
// the same order of crossings as the ray caster, so that neighbouring points meet without gap or overlap at any
// distance.

//!include "layout.wgsl"
//!include "ray.wgsl"
//!include "encoding.wgsl"

var<immediate> view: PointView;

struct Pixel {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn main(
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) low: vec3<i32>,
    @location(1) @interpolate(flat) high: vec3<i32>,
    @location(2) @interpolate(flat) colour: vec3<f32>,
) -> Pixel {
    let at = position.xy - vec2<f32>(view.left, view.upper);
    let ray = make_ray(view.origin, view.corner + view.step_x * at.x + view.step_y * at.y);
    let enter = last_of(crossings(ray, select(high, low, ray.forward)));
    if any(before(crossings(ray, select(low, high, ray.forward)), enter)) {
        discard;
    }
    // An eye inside the voxel sees it at the near plane.
    let depth = select(1.0, (view.depth_slope * enter.t + view.depth_at_0) / enter.t, enter.t > 0.0);
    return Pixel(vec4<f32>(decoded(colour, view.linear != 0u), 1.0), clamp(depth, 0.0, 1.0));
}
