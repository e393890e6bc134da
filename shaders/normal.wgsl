// The gradient of existence about a voxel and how open its surroundings are: the twins of
// src/shade/normal.rs and src/shade/occlusion.rs.

//!include "bits.wgsl"

// The word whose lower corner is at `cell`; nothing outside of the grid.
fn word_or_nothing(cell: vec3<i32>, dims: vec3<i32>) -> vec2<u32> {
    let inside = all(vec3<u32>(cell) < vec3<u32>(dims));
    let word = word_at(select(vec3<i32>(0), cell, inside));
    return select(vec2<u32>(0u), word, inside);
}

// The four nibbles of 16 bits, a byte each: four rows of voxels.
fn spread(bits: u32) -> u32 {
    let pairs = (bits | (bits << 8u)) & 0x00ff00ffu;
    return (pairs | (pairs << 4u)) & 0x0f0f0f0fu;
}

fn count(bits: u32) -> i32 {
    return i32(countOneBits(bits));
}

// By how much more voxels are to the right than to the left in rows of five.
fn x_moment(rows: u32) -> i32 {
    return 2 * (count(rows & 0x10101010u) - count(rows & 0x01010101u))
        + count(rows & 0x08080808u) - count(rows & 0x02020202u);
}

// Minus the gradient of existence, the first moment over the 81 voxels at most sqrt(6) away: the
// 5^3 about the voxel without those that are two away on two axes.
fn gradient(voxel: vec3<i32>, dims: vec3<i32>) -> vec3<f32> {
    let low = voxel - vec3<i32>(2);
    let corner = low & vec3<i32>(-4);
    let inner = vec3<u32>(low & vec3<i32>(3));
    // Rows of eight voxels in x and y, the lower and the upper four of them, for the two words
    // along z and the two halves of each.
    var lower: array<vec2<u32>, 4>;
    var upper: array<vec2<u32>, 4>;
    for (var z = 0u; z < 2u; z++) {
        for (var y = 0u; y < 2u; y++) {
            let at = corner + vec3<i32>(0, i32(4u * y), i32(4u * z));
            let near = word_or_nothing(at, dims);
            let far = word_or_nothing(at + vec3<i32>(4, 0, 0), dims);
            for (var half = 0u; half < 2u; half++) {
                let a = select(near.x, near.y, half == 1u);
                let b = select(far.x, far.y, half == 1u);
                let rows = vec2<u32>(
                    spread(a & 0xffffu) | (spread(b & 0xffffu) << 4u),
                    spread(a >> 16u) | (spread(b >> 16u) << 4u),
                );
                let cut = (rows >> vec2<u32>(inner.x)) & vec2<u32>(0x1f1f1f1fu);
                if y == 0u {
                    lower[2u * z + half] = cut;
                } else {
                    upper[2u * z + half] = cut;
                }
            }
        }
    }
    var moment = vec3<i32>(0);
    let shift = 8u * inner.y;
    for (var k = 0u; k < 5u; k++) {
        let z = inner.z + k;
        let below = select(lower[z >> 1u].x, lower[z >> 1u].y, (z & 1u) == 1u);
        let above = select(upper[z >> 1u].x, upper[z >> 1u].y, (z & 1u) == 1u);
        // Four rows, and the fifth.
        let four = (below >> shift) | select(above << (32u - shift), 0u, shift == 0u);
        let outer = k == 0u || k == 4u;
        let rows = four & select(0x1f1f1f0eu, 0x0e0e0e00u, outer);
        let fifth = (above >> shift) & select(0x0eu, 0u, outer);
        moment += vec3<i32>(
            x_moment(rows) + x_moment(fifth),
            2 * (count(fifth) - count(rows & 0xffu)) + count(rows >> 24u) - count(rows & 0xff00u),
            (i32(k) - 2) * (count(rows) + count(fifth)),
        );
    }
    return vec3<f32>(-moment);
}

// How much of the light from everywhere reaches the voxel, 0 to 1: twice the empty share of the
// cube of 8^3 voxels about its middle, in which a word counts by its part within.
fn openness(voxel: vec3<i32>, dims: vec3<i32>) -> f32 {
    let low = voxel - vec3<i32>(4);
    let corner = low & vec3<i32>(-4);
    // The cube begins half a voxel behind the lower corner of `low`.
    let cut = vec3<f32>(low - corner) + 0.5;
    var filled = 0.0;
    for (var z = 0; z < 3; z++) {
        for (var y = 0; y < 3; y++) {
            for (var x = 0; x < 3; x++) {
                let at = vec3<i32>(x, y, z);
                let word = word_or_nothing(corner + 4 * at, dims);
                let part = select(
                    select(vec3<f32>(4.0), cut, at == vec3<i32>(2)),
                    4.0 - cut,
                    at == vec3<i32>(0),
                );
                let bits = f32(count(word.x) + count(word.y));
                filled += bits * part.x * part.y * part.z;
            }
        }
    }
    return clamp(2.0 - filled * (2.0 / 32768.0), 0.0, 1.0);
}
