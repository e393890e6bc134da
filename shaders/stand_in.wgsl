// The voxels that stand for bricks which are hit as a whole: the twin of `stand_in` in
// core/src/surface/small_bricks.rs.

//!include "bits.wgsl"
//!include "small_bricks.wgsl"

// Whether a brick has any voxel, if `wanted`. A loop, because SIMD lanes leave it at once where none of them wants it.
fn has_voxels(brick: vec3<i32>, wanted: bool) -> bool {
    let low = brick << vec3<u32>(3u);
    var some = false;
    for (var word = select(8, 0, wanted); word < 8; word++) {
        let half = vec3<i32>(word & 1, (word >> 1u) & 1, word >> 2u);
        some |= any(word_at(low + 4 * half) != vec2<u32>(0u));
        if some {
            break;
        }
    }
    return some;
}

// The eight voxels of a row along x of a brick.
fn row_of(low: vec3<i32>, y: i32, z: i32) -> u32 {
    let at = low + vec3<i32>(0, y, z);
    let shift = u32((y & 3) << 2u) | u32((z & 1) << 4u);
    let upper = (z & 2) != 0;
    let left = word_at(at);
    let right = word_at(at + vec3<i32>(4, 0, 0));
    let four = (select(left.x, left.y, upper) >> shift) & 15u;
    return four | (((select(right.x, right.y, upper) >> shift) & 15u) << 4u);
}

// The voxel that stands for a brick as seen from `eye`, if `wanted`.
fn stand_in(brick: vec3<i32>, eye: vec3<f32>, wanted: bool) -> vec3<i32> {
    let low = brick << vec3<u32>(3u);
    let beyond = eye >= vec3<f32>(low + vec3<i32>(4));
    let turn = select(vec3<i32>(0), vec3<i32>(7), beyond);
    var found = vec3<i32>(0);
    for (var row = select(64, 0, wanted); row < 64; row++) {
        let at = vec2<i32>(row & 7, row >> 3u) ^ turn.yz;
        let voxels = row_of(low, at.x, at.y);
        if voxels != 0u {
            let x = select(firstTrailingBit(voxels), firstLeadingBit(voxels), beyond.x);
            found = vec3<i32>(i32(x), at);
            break;
        }
    }
    return low + found;
}
