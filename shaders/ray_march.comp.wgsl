// The index map of one eye: for each pixel the first existing voxel along its ray.

//!include "layout.wgsl"
//!include "march.wgsl"

var<immediate> view: MarchView;
@group(0) @binding(2) var index_map: texture_storage_2d<r32uint, write>;

// Neighbouring invocations see neighbouring pixels: eight of them 4x2, thirty-two 8x4.
@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let x = (lane & 3u) | ((lane >> 1u) & 4u);
    let y = ((lane >> 2u) & 1u) | ((lane >> 3u) & 6u);
    let pixel = group.xy * 8u + vec2<u32>(x, y);
    if pixel.x >= view.width || pixel.y >= view.height {
        return;
    }
    let at = vec2<f32>(pixel) + 0.5;
    let ray = make_ray(view.origin, view.corner + view.step_x * at.x + view.step_y * at.y);
    let seen = first_voxel(ray, vec3<i32>(view.dims));
    let voxel = vec3<u32>(seen.voxel);
    let index = voxel.x + view.dims.x * (voxel.y + view.dims.y * voxel.z);
    let value = select(NO_VOXEL, index, seen.found);
    textureStore(index_map, pixel, vec4<u32>(value, 0u, 0u, 0u));
}
