// Traversal of a ray from where its beam ends (beam.wgsl). The beam has skipped empty bricks; this skips empty
// words of 4^3 voxels.

//!include "walk.wgsl"
//!include "tile.wgsl"

struct Seen {
    voxel: vec3<i32>,
    found: bool,
}

// The first existing voxel along the ray in a grid of `dims` voxels; there is none before `start`.
fn first_voxel(ray: Ray, dims: vec3<i32>, start: f32) -> Seen {
    let zero = vec3<i32>(0);
    var enter = last_of(crossings(ray, select(dims, zero, ray.forward)));
    if start > enter.t {
        enter = Event(start, vec3<bool>(false), vec3<bool>(true));
    }
    var seen = Seen(zero, false);
    if any(before(crossings(ray, select(zero, dims, ray.forward)), enter)) {
        return seen;
    }
    var cell = cell_after(ray, enter, zero, dims);
    loop {
        let word = word_at(cell);
        if bit_of(word, cell) {
            seen = Seen(cell, true);
            break;
        }
        cell = next_cell(ray, cell, word);
        if any(vec3<u32>(cell) >= vec3<u32>(dims)) {
            break;
        }
    }
    return seen;
}
