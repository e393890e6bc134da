// The bits of a grid as a 3D image: a texel is a word of 4^3 voxels (low and high 32 bits); the eight words of
// a brick are consecutive along x (render/volume.rs).

//!include "word.wgsl"

@group(0) @binding(0) var volume: texture_3d<u32>;

// The word that contains the voxel.
fn word_at(voxel: vec3<i32>) -> vec2<u32> {
    let half = (voxel >> vec3<u32>(2u)) & vec3<i32>(1);
    let word = half.x | (half.y << 1u) | (half.z << 2u);
    let brick = voxel >> vec3<u32>(3u);
    return textureLoad(volume, vec3<i32>((brick.x << 3u) | word, brick.y, brick.z), 0).xy;
}
