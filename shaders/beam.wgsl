// For each tile of a picture how far its rays may go before any of them can meet a brick in use.
// The ray through a tile's middle walks by bricks that neither hold anything nor touch one that
// does: as long as the tile is not wider than a brick to either side of that ray, all of its rays
// are in empty bricks there. After Laine and Karras, Efficient Sparse Voxel Octrees (2010), 4.3.

//!include "layout.wgsl"
//!include "ray.wgsl"
//!include "word.wgsl"
//!include "tile.wgsl"

var<immediate> view: MarchView;
// A texel for each block of 4^3 bricks, a bit for each brick (render/near_image.rs). It begins a
// block before the grid and ends one behind it.
@group(0) @binding(0) var near: texture_3d<u32>;

// Voxels that a ray may be beside the middle one: a brick, less what rounding can do.
const REACH_VX: f32 = 7.5;

// In lengths of the rays' directions.
fn start_of(tile: vec2<u32>) -> f32 {
    let pixels = tile << vec2<u32>(view.tile_log2);
    let half = 0.5 * f32(1u << view.tile_log2);
    let at = vec2<f32>(pixels) + half;
    let direction = view.corner + view.step_x * at.x + view.step_y * at.y;
    let aside = half * (abs(view.step_x) + abs(view.step_y));
    let limit = REACH_VX / max(max(aside.x, aside.y), aside.z);
    // In coordinates that begin where the texture does.
    let ray = make_ray(view.origin + vec3<f32>(32.0), direction);
    let size = ((vec3<i32>(view.dims) + vec3<i32>(31)) & vec3<i32>(-32)) + vec3<i32>(64);
    let zero = vec3<i32>(0);
    let enter = crossings(ray, select(size, zero, ray.forward));
    let border = select(zero, size, ray.forward);
    let exit = smallest(crossings(ray, border));
    // No ray of the tile is in there for longer: each is at least that fast, if it goes ahead.
    let speed = abs(direction) - aside;
    let times = abs(vec3<f32>(border) - ray.origin) / speed;
    let last_exit = smallest(select(vec3<f32>(FAR_AWAY), times, speed > vec3<f32>(0.0)));
    // A thousandth of a voxel is passed over at least, so that the walk ends.
    let least = 1e-3 / max(max(abs(direction.x), abs(direction.y)), abs(direction.z));
    var t = max(max(enter.x, enter.y), max(enter.z, 0.0));
    loop {
        if !(t < min(exit, limit)) {
            break;
        }
        let place = vec3<i32>(floor(ray.origin + ray.direction * t)) >> vec3<u32>(3u);
        let brick = clamp(place, zero, (size >> vec3<u32>(3u)) - vec3<i32>(1));
        let bricks = textureLoad(near, brick >> vec3<u32>(2u), 0).xy;
        if bit_of(bricks, brick) {
            break;
        }
        let edge = select(8, 32, all(bricks == vec2<u32>(0u)));
        let low = (brick << vec3<u32>(3u)) & vec3<i32>(-edge);
        let far = crossings(ray, select(low, low + vec3<i32>(edge), ray.forward));
        t = max(smallest(far) * 1.000002, t + least);
    }
    // If none was in reach as long as a ray can be in the grid, there is nothing to see.
    return select(min(t, limit), FAR_AWAY, t >= exit & last_exit <= limit);
}

fn smallest(v: vec3<f32>) -> f32 {
    return min(min(v.x, v.y), v.z);
}
