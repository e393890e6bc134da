// Looks up the normals of surface voxels: the twin of core/src/shade/normal_field/pages.rs, in the layout of
// src/render/normals.rs.

//!include "packed_normal.wgsl"

// The page of each brick, filled up to a multiple of 32 numbers; then pages and blocks of 32 numbers each.
@group(0) @binding(7) var<storage, read> normal_field: array<u32>;

const NO_PAGE: u32 = 0xffffffffu;

// The packed normal of a voxel.
fn packed_normal(voxel: vec3<i32>, bricks: vec3<u32>) -> u32 {
    let v = vec3<u32>(voxel);
    let brick = v >> vec3<u32>(3u);
    let page = normal_field[brick.x + bricks.x * (brick.y + bricks.y * brick.z)];
    if page == NO_PAGE {
        return NO_NORMAL;
    }
    let units = (bricks.x * bricks.y * bricks.z + 31u) & 0xffffffe0u;
    let start = units + 32u * page;
    let local = v & vec3<u32>(7u);
    // 16 numbers of masks, two for each layer; 4 of counts in halves; 8 of blocks.
    let lower = normal_field[start + 2u * local.z];
    let upper = normal_field[start + 2u * local.z + 1u];
    let in_upper = local.y >= 4u;
    let mask = select(lower, upper, in_upper);
    let bit = local.x + 8u * (local.y & 3u);
    if ((mask >> bit) & 1u) == 0u {
        return NO_NORMAL;
    }
    let counts = normal_field[start + 16u + (local.z >> 1u)];
    let before = (counts >> (16u * (local.z & 1u))) & 0xffffu;
    let in_layer = countOneBits(mask & ((1u << bit) - 1u)) + select(0u, countOneBits(lower), in_upper);
    let i = before + in_layer;
    let block = normal_field[start + 20u + (i >> 6u)];
    let pair = normal_field[units + 32u * block + ((i & 63u) >> 1u)];
    return (pair >> (16u * (i & 1u))) & 0xffffu;
}
