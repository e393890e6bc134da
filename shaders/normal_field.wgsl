// Looks up the normals and the openness of surface voxels: the twin of core/src/shade/normal_field/pages.rs, in the layout of
// src/render/normals.rs.

//!include "packed_normal.wgsl"

// The page of each brick, filled up to a multiple of 32 numbers; then the pages.
@group(0) @binding(7) var<storage, read> normal_field: array<u32>;

// Of a voxel that is no surface voxel, or whose brick was not computed yet. A record has the packed normal, then the
// depth and the openness in a byte each.
const NO_RECORD: u32 = NO_NORMAL;

// The record of a voxel. The page of a brick without surface voxels has none.
fn surface_record(voxel: vec3<i32>, bricks: vec3<u32>) -> u32 {
    let v = vec3<u32>(voxel);
    let brick = v >> vec3<u32>(3u);
    let page = normal_field[brick.x + bricks.x * (brick.y + bricks.y * brick.z)];
    let units = (bricks.x * bricks.y * bricks.z + 31u) & 0xffffffe0u;
    let start = units + 32u * page;
    let local = v & vec3<u32>(7u);
    // 16 numbers of masks, two for each layer; 4 of counts in halves; then the records.
    let lower = normal_field[start + 2u * local.z];
    let upper = normal_field[start + 2u * local.z + 1u];
    let in_upper = local.y >= 4u;
    let mask = select(lower, upper, in_upper);
    let bit = local.x + 8u * (local.y & 3u);
    if ((mask >> bit) & 1u) == 0u {
        return NO_RECORD;
    }
    let counts = normal_field[start + 16u + (local.z >> 1u)];
    let before = (counts >> (16u * (local.z & 1u))) & 0xffffu;
    let in_layer = countOneBits(mask & ((1u << bit) - 1u)) + select(0u, countOneBits(lower), in_upper);
    return normal_field[start + 20u + before + in_layer];
}

// The packed normal of a voxel.
fn packed_normal(voxel: vec3<i32>, bricks: vec3<u32>) -> u32 {
    return surface_record(voxel, bricks) & 0xffffu;
}
