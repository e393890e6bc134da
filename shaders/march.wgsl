// Traversal of a ray from where its beam ends (beam.wgsl). The beam has skipped empty bricks; this skips empty
// words of 4^3 voxels.

//!include "walk.wgsl"
//!include "tile.wgsl"

struct Seen {
    voxel: vec3<i32>,
    found: bool,
}

// The voxel in which the ray is at `start`, or enters a grid of `dims` voxels after it; none if it misses the grid.
fn entered(ray: Ray, dims: vec3<i32>, start: f32) -> Seen {
    let zero = vec3<i32>(0);
    var enter = last_of(crossings(ray, select(dims, zero, ray.forward)));
    if start > enter.t {
        enter = Event(start, vec3<bool>(false), vec3<bool>(true));
    }
    if any(before(crossings(ray, select(zero, dims, ray.forward)), enter)) {
        return Seen(zero, false);
    }
    return Seen(cell_after(ray, enter, zero, dims), true);
}

// The first existing voxel along the ray from the voxel `first` on.
fn first_from(ray: Ray, dims: vec3<i32>, first: vec3<i32>) -> Seen {
    var seen = Seen(first, false);
    loop {
        let word = word_at(seen.voxel);
        if bit_of(word, seen.voxel) {
            seen.found = true;
            break;
        }
        seen.voxel = next_cell(ray, seen.voxel, word);
        if any(vec3<u32>(seen.voxel) >= vec3<u32>(dims)) {
            break;
        }
    }
    return seen;
}

// The first existing voxel along the ray in a grid of `dims` voxels; there is none before `start`.
fn first_voxel(ray: Ray, dims: vec3<i32>, start: f32) -> Seen {
    var seen = entered(ray, dims, start);
    if seen.found {
        seen = first_from(ray, dims, seen.voxel);
    }
    return seen;
}
