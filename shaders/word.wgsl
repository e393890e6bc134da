// Words of 4^3 bits, x fastest: voxels of a grid or bricks of a block.

// Whether the voxel, or brick, is set in its word.
fn bit_of(word: vec2<u32>, place: vec3<i32>) -> bool {
    let local = vec3<u32>(place & vec3<i32>(3));
    let bit = local.x | (local.y << 2u) | ((local.z & 1u) << 4u);
    return ((select(word.x, word.y, local.z >= 2u) >> bit) & 1u) != 0u;
}
