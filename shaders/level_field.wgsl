// Levels of voxels, distances from the smooth surface: the twin of core/src/shade/level_set/mod.rs, in the layout of
// src/render/levels.rs.

// The page of each brick, filled up to a multiple of 128 numbers; then pages of 128 numbers, with a level in each byte.
@group(0) @binding(9) var<storage, read> level_field: array<u32>;

// Entries of bricks without a page: of full ones, and of those that are outside.
const FULL_BRICK: u32 = 0xfffffffeu;
const FAR_LEVEL: i32 = 127;
const LEAST_LEVEL: i32 = 3;
const LEVELS_PER_VX: i32 = 64;

// The level of a voxel inside the grid of `bricks`.
fn level_inside(voxel: vec3<i32>, bricks: vec3<u32>) -> i32 {
    let v = vec3<u32>(voxel);
    let brick = v >> vec3<u32>(3u);
    let page = level_field[brick.x + bricks.x * (brick.y + bricks.y * brick.z)];
    if page >= FULL_BRICK {
        return select(FAR_LEVEL, -FAR_LEVEL, page == FULL_BRICK);
    }
    let units = (bricks.x * bricks.y * bricks.z + 127u) & 0xffffff80u;
    let local = v & vec3<u32>(7u);
    let four = level_field[units + 128u * page + 16u * local.z + 2u * local.y + (local.x >> 2u)];
    return bitcast<i32>(four << (24u - 8u * (local.x & 3u))) >> 24u;
}

// The level of a voxel of a grid of `dims` voxels, or of a place outside. There a voxel at the border continues by
// one voxel.
fn level_at(voxel: vec3<i32>, dims: vec3<i32>, bricks: vec3<u32>) -> f32 {
    let inside = clamp(voxel, vec3<i32>(0), dims - vec3<i32>(1));
    let level = level_inside(inside, bricks);
    let beyond = select(FAR_LEVEL, max(level + LEVELS_PER_VX, LEAST_LEVEL), level < 0);
    return f32(select(level, beyond, any(inside != voxel)));
}
