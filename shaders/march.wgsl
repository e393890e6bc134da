// The walk of a ray through the grid by the largest empty blocks that it meets: 4^3 bricks, bricks,
// words of 4^3 voxels. The twin of src/surface/raycast/walk.rs; it skips only what is empty, so
// that it finds the voxel that a walk voxel by voxel finds.

//!include "bits.wgsl"
//!include "ray.wgsl"

// A texel for each block of 4^3 bricks, a bit for each brick (render/occupancy.rs).
@group(0) @binding(1) var occupancy: texture_3d<u32>;

struct Seen {
    voxel: vec3<i32>,
    found: bool,
}

// The first voxel after the aligned block of `size` voxels an edge that holds `cell`.
fn leave(ray: Ray, cell: vec3<i32>, size: i32) -> vec3<i32> {
    let ahead = select(vec3<i32>(0), vec3<i32>(1), ray.forward);
    let low = cell & vec3<i32>(-size);
    let end = low + ahead * size;
    let event = first_of(crossings(ray, end));
    let beside = cell_after(ray, event, low, low + size);
    return select(beside, end - vec3<i32>(1) + ahead, event.axis);
}

// The first existing voxel along the ray in a grid of `dims` voxels.
fn first_voxel(ray: Ray, dims: vec3<i32>) -> Seen {
    let zero = vec3<i32>(0);
    let enter = last_of(crossings(ray, select(dims, zero, ray.forward)));
    var seen = Seen(zero, false);
    if any(before(crossings(ray, select(zero, dims, ray.forward)), enter)) {
        return seen;
    }
    var cell = cell_after(ray, enter, zero, dims);
    let one = select(vec3<i32>(-1), vec3<i32>(1), ray.forward);
    let ahead = select(zero, vec3<i32>(1), ray.forward);
    var inside = true;
    loop {
        // To the next brick in use.
        loop {
            let brick = cell >> vec3<u32>(3u);
            let bricks = textureLoad(occupancy, brick >> vec3<u32>(2u), 0).xy;
            if bit_of(bricks, brick) {
                break;
            }
            cell = leave(ray, cell, select(8, 32, all(bricks == vec2<u32>(0u))));
            inside = all(vec3<u32>(cell) < vec3<u32>(dims));
            if !inside {
                break;
            }
        }
        if !inside {
            break;
        }
        // Through that brick.
        let low = cell & vec3<i32>(-8);
        loop {
            let word = word_at(cell);
            let corner = cell & vec3<i32>(-4);
            if all(word == vec2<u32>(0u)) {
                // Out of the whole word.
                let end = corner + ahead * 4;
                let event = first_of(crossings(ray, end));
                // The other axes cross at most three planes before.
                let next = cell + ahead;
                let count = select(zero, vec3<i32>(1), before(crossings(ray, next), event))
                    + select(zero, vec3<i32>(1), before(crossings(ray, next + one), event))
                    + select(zero, vec3<i32>(1), before(crossings(ray, next + 2 * one), event));
                cell = select(cell + count * one, end - vec3<i32>(1) + ahead, event.axis);
            } else {
                // Voxel by voxel through it.
                loop {
                    if bit_of(word, cell) {
                        seen = Seen(cell, true);
                        break;
                    }
                    let event = first_of(crossings(ray, cell + ahead));
                    cell += select(zero, one, event.axis);
                    if any((cell & vec3<i32>(-4)) != corner) {
                        break;
                    }
                }
            }
            if seen.found {
                break;
            }
            if any(vec3<u32>(cell - low) >= vec3<u32>(8u)) {
                break;
            }
        }
        inside = all(vec3<u32>(cell) < vec3<u32>(dims));
        if seen.found | !inside {
            break;
        }
    }
    return seen;
}
