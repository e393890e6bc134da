// The step of a ray through the bits of a grid: out of a whole word where that is empty, else to the
// next voxel. The twin of src/surface/raycast/walk.rs; it skips only what is empty, so that it
// finds the voxel that a walk voxel by voxel finds.

//!include "bits.wgsl"
//!include "ray.wgsl"

// The cell after `cell`, whose word is `word`. One way for both lengths of a step: vectors of pixels
// go every way that one of them goes.
fn next_cell(ray: Ray, cell: vec3<i32>, word: vec2<u32>) -> vec3<i32> {
    let zero = vec3<i32>(0);
    let one = select(vec3<i32>(-1), vec3<i32>(1), ray.forward);
    let ahead = select(zero, vec3<i32>(1), ray.forward);
    let some = any(word != vec2<u32>(0u));
    let end = select(cell & vec3<i32>(-4), cell, some) + ahead * select(4, 1, some);
    let event = first_of(crossings(ray, end));
    // The other axes cross at most three planes before.
    let plane = cell + ahead;
    let crossed = select(zero, one, before(crossings(ray, plane), event))
        + select(zero, one, before(crossings(ray, plane + one), event))
        + select(zero, one, before(crossings(ray, plane + 2 * one), event));
    return select(cell + crossed, end - vec3<i32>(1) + ahead, event.axis);
}
