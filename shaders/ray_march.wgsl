// The first existing voxel along a pixel's ray.

//!include "layout.wgsl"
//!include "march.wgsl"

var<immediate> view: MarchView;
@group(0) @binding(1) var starts: texture_2d<f32>;

fn voxel_at(pixel: vec2<u32>) -> u32 {
    let start = textureLoad(starts, pixel >> vec2<u32>(view.tile_log2), 0).x;
    if start >= FAR_AWAY {
        return NO_VOXEL;
    }
    let at = vec2<f32>(pixel) + 0.5;
    let ray = make_ray(view.origin, view.corner + view.step_x * at.x + view.step_y * at.y);
    let small = SmallBricks(view.small_weights, view.small_least);
    let seen = first_seen(ray, vec3<i32>(view.dims), start, small);
    let voxel = vec3<u32>(seen.voxel);
    let index = voxel.x + view.dims.x * (voxel.y + view.dims.y * voxel.z);
    return select(NO_VOXEL, index, seen.found);
}
