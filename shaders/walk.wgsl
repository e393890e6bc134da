// The step of a ray through the bits of a grid: out of the whole word if it is empty, else to the next voxel. The
// twin of core/src/surface/raycast/walk.rs. It skips only empty space, so it finds the same voxel as a traversal
// voxel by voxel.

//!include "bits.wgsl"
//!include "ray.wgsl"
//!include "stand_in.wgsl"

// The cell after `cell`, whose word is `word`. One code path for both lengths of a step, because SIMD lanes
// execute every path that any of them takes.
fn next_cell(ray: Ray, cell: vec3<i32>, word: vec2<u32>) -> vec3<i32> {
    let zero = vec3<i32>(0);
    let one = select(vec3<i32>(-1), vec3<i32>(1), ray.forward);
    let ahead = select(zero, vec3<i32>(1), ray.forward);
    let some = any(word != vec2<u32>(0u));
    let end = select(cell & vec3<i32>(-4), cell, some) + ahead * select(4, 1, some);
    let event = first_of(crossings(ray, end));
    // The other axes cross at most three planes before that.
    let plane = cell + ahead;
    let crossed = select(zero, one, before(crossings(ray, plane), event))
        + select(zero, one, before(crossings(ray, plane + one), event))
        + select(zero, one, before(crossings(ray, plane + 2 * one), event));
    return select(cell + crossed, end - vec3<i32>(1) + ahead, event.axis);
}

// Where the traversal of a ray stands.
struct Seen {
    voxel: vec3<i32>,
    found: bool,
}

// The first existing voxel along the ray from the voxel `first` on, in the box `low..high`. Bricks among the small ones
// are hit as a whole.
fn first_within(
    ray: Ray,
    first: vec3<i32>,
    low: vec3<i32>,
    high: vec3<i32>,
    small: SmallBricks,
) -> Seen {
    var seen = Seen(first, false);
    var whole = false;
    loop {
        let word = word_at(seen.voxel);
        let brick = seen.voxel >> vec3<u32>(3u);
        let as_whole = is_small(small, brick);
        whole = has_voxels(brick, as_whole);
        seen.found = whole || (!as_whole && bit_of(word, seen.voxel));
        if seen.found {
            break;
        }
        seen.voxel = next_cell(ray, seen.voxel, word);
        if any(vec3<u32>(seen.voxel - low) >= vec3<u32>(high - low)) {
            break;
        }
    }
    let stands_in = stand_in(seen.voxel >> vec3<u32>(3u), ray.origin, whole);
    return Seen(select(seen.voxel, stands_in, whole), seen.found);
}
