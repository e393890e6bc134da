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
    var cell = cell_after(ray, enter, low, high);
    let size = vec3<u32>(high - low);
    var found = false;
    loop {
        let word = word_at(cell);
        if bit_of(word, cell) {
            found = true;
            break;
        }
        cell = next_cell(ray, cell, word);
        if any(vec3<u32>(cell - low) >= size) {
            break;
        }
    }
    if !found {
        discard;
    }
    let voxel = vec3<u32>(cell);
    return voxel.x + view.dims.x * (voxel.y + view.dims.y * voxel.z);
}
