// Traversal of a ray from where its beam ends (beam.wgsl). The beam has skipped empty bricks; this skips empty
// words of 4^3 voxels.

//!include "walk.wgsl"
//!include "tile.wgsl"

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

// The first existing voxel along the ray in a grid of `dims` voxels; there is none before `start`.
fn first_voxel(ray: Ray, dims: vec3<i32>, start: f32) -> Seen {
    return first_seen(ray, dims, start, NO_SMALL_BRICKS);
}

// The same in a picture with bricks that are hit as a whole.
fn first_seen(ray: Ray, dims: vec3<i32>, start: f32, small: SmallBricks) -> Seen {
    var seen = entered(ray, dims, start);
    if seen.found {
        seen = first_within(ray, seen.voxel, vec3<i32>(0), dims, small);
    }
    return seen;
}
