// The first existing voxel that the pixel's ray meets in one layer of the grid, by the exact traversal of the
// ray caster restricted to the layer. If there is none, the fragment is discarded, and a layer behind may show
// a voxel.

//!include "layout.wgsl"
//!include "walk.wgsl"

var<immediate> view: SliceView;

@fragment
fn main(
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) planes: vec2<u32>,
) -> @location(0) u32 {
    let direction = view.corner + view.step_x * position.x + view.step_y * position.y;
    let ray = make_ray(view.origin, direction);
    let across = vec3<u32>(0u, 1u, 2u) == vec3<u32>(view.axis);
    let low = select(vec3<i32>(0), vec3<i32>(i32(planes.x)), across);
    let high = select(vec3<i32>(view.dims), vec3<i32>(i32(planes.y)), across);

    let enter = last_of(crossings(ray, select(high, low, ray.forward)));
    if any(before(crossings(ray, select(low, high, ray.forward)), enter)) {
        discard;
    }
    let first = cell_after(ray, enter, low, high);
    let weights = vec3<i32>(view.small_x, view.small_y, view.small_z);
    let seen = first_within(ray, first, low, high, SmallBricks(weights, view.small_least));
    if !seen.found {
        discard;
    }
    let voxel = vec3<u32>(seen.voxel);
    return voxel.x + view.dims.x * (voxel.y + view.dims.y * voxel.z);
}
