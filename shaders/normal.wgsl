// The gradient of occupancy around a voxel and its ambient occlusion: the twins of core/src/shade/normal.rs and
// core/src/shade/occlusion.rs.

//!include "bits.wgsl"

// The word whose lower corner is at `cell`; empty outside the grid.
fn word_or_nothing(cell: vec3<i32>, dims: vec3<i32>) -> vec2<u32> {
    let inside = all(vec3<u32>(cell) < vec3<u32>(dims));
    let word = word_at(select(vec3<i32>(0), cell, inside));
    return select(vec2<u32>(0u), word, inside);
}

// Spreads the four nibbles of 16 bits to a byte each: four rows of voxels.
fn spread(bits: u32) -> u32 {
    let pairs = (bits | (bits << 8u)) & 0x00ff00ffu;
    return (pairs | (pairs << 4u)) & 0x0f0f0f0fu;
}

fn count(bits: u32) -> i32 {
    return i32(countOneBits(bits));
}

// First moments along x of rows of five voxels.
fn x_moment(rows: u32) -> i32 {
    return 2 * (count(rows & 0x10101010u) - count(rows & 0x01010101u))
        + count(rows & 0x08080808u) - count(rows & 0x02020202u);
}

// Five slices of a column of two words, starting with slice `first` (0 to 3): 16 bits each, two per number.
fn slices(below: vec2<u32>, above: vec2<u32>, first: u32) -> vec3<u32> {
    let later = first >= 2u;
    let a = select(below.x, below.y, later);
    let b = select(below.y, above.x, later);
    let c = select(above.x, above.y, later);
    let odd = (first & 1u) != 0u;
    return select(
        vec3<u32>(a, b, c),
        vec3<u32>((a >> 16u) | (b << 16u), (b >> 16u) | (c << 16u), c >> 16u),
        odd,
    );
}

// Moments of one of five slices from its four pieces of 4x4 voxels; `z` (-2 to 2) is its position.
fn slice_moment(pieces: vec4<u32>, inner: vec2<u32>, z: i32) -> vec3<i32> {
    // Four rows of eight voxels each.
    let below = ((spread(pieces.x) | (spread(pieces.y) << 4u)) >> inner.x) & 0x1f1f1f1fu;
    let above = ((spread(pieces.z) | (spread(pieces.w) << 4u)) >> inner.x) & 0x1f1f1f1fu;
    let shift = 8u * inner.y;
    // The five rows around the voxel: four of them, and the fifth.
    let four = (below >> shift) | select(above << ((32u - shift) & 31u), 0u, shift == 0u);
    let outer = abs(z) == 2;
    let rows = four & select(0x1f1f1f0eu, 0x0e0e0e00u, outer);
    let fifth = (above >> shift) & select(0x0eu, 0u, outer);
    return vec3<i32>(
        x_moment(rows) + x_moment(fifth),
        2 * (count(fifth) - count(rows & 0xffu)) + count(rows >> 24u) - count(rows & 0xff00u),
        z * (count(rows) + count(fifth)),
    );
}

// The negative gradient of occupancy: the first moment over the 81 voxels at most sqrt(6) away, which are the
// 5^3 around the voxel without those two away on two axes.
fn gradient(voxel: vec3<i32>, dims: vec3<i32>) -> vec3<f32> {
    let low = voxel - vec3<i32>(2);
    let at = low & vec3<i32>(-4);
    let inner = vec3<u32>(low & vec3<i32>(3));
    let x = vec3<i32>(4, 0, 0);
    let y = vec3<i32>(0, 4, 0);
    let z = vec3<i32>(0, 0, 4);
    let c00 = slices(word_or_nothing(at, dims), word_or_nothing(at + z, dims), inner.z);
    let c10 = slices(word_or_nothing(at + x, dims), word_or_nothing(at + x + z, dims), inner.z);
    let c01 = slices(word_or_nothing(at + y, dims), word_or_nothing(at + y + z, dims), inner.z);
    let c11 =
        slices(word_or_nothing(at + x + y, dims), word_or_nothing(at + x + y + z, dims), inner.z);
    let first = vec4<u32>(c00.x, c10.x, c01.x, c11.x);
    let second = vec4<u32>(c00.y, c10.y, c01.y, c11.y);
    let third = vec4<u32>(c00.z, c10.z, c01.z, c11.z);
    let half = vec4<u32>(0xffffu);
    let upper = vec4<u32>(16u);
    let moment = slice_moment(first & half, inner.xy, -2)
        + slice_moment(first >> upper, inner.xy, -1)
        + slice_moment(second & half, inner.xy, 0)
        + slice_moment(second >> upper, inner.xy, 1)
        + slice_moment(third & half, inner.xy, 2);
    return vec3<f32>(-moment);
}

// Ambient openness of the voxel, 0 to 1: 2.36 times the empty share of the cube of 8^3 voxels around its centre, in
// which each word counts by its part inside.
fn openness(voxel: vec3<i32>, dims: vec3<i32>) -> f32 {
    let low = voxel - vec3<i32>(4);
    let corner = low & vec3<i32>(-4);
    // The cube begins half a voxel after the lower corner of `low`.
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
    return clamp(2.36 - filled * (2.36 / 32768.0), 0.0, 1.0);
}
