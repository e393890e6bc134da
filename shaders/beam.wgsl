// Beam optimisation: how far the rays of each tile can be advanced before any of them can hit a non-empty brick.
// The tile's centre ray steps through bricks that are empty and have only empty neighbours. As long as the
// tile extends no further than a brick to either side of that ray, all of its rays are in empty bricks there.
// After Laine and Karras, Efficient Sparse Voxel Octrees (2010), 4.3.

//!include "layout.wgsl"
//!include "ray.wgsl"
//!include "word.wgsl"
//!include "tile.wgsl"

var<immediate> view: MarchView;
// A texel for each block of 4^3 bricks, a bit for each brick (render/dilated_occupancy_image.rs). It
// begins a block before the grid and ends one behind it.
@group(0) @binding(0) var dilated: texture_3d<u32>;

// Distance in voxels that a ray may be from the centre ray: a brick, less a margin for rounding.
const REACH_VX: f32 = 7.5;

// In units of the rays' direction vectors.
fn start_of(tile: vec2<u32>) -> f32 {
    let pixels = tile << vec2<u32>(view.tile_log2);
    let half = 0.5 * f32(1u << view.tile_log2);
    let at = vec2<f32>(pixels) + half;
    let direction = view.corner + view.step_x * at.x + view.step_y * at.y;
    let aside = half * (abs(view.step_x) + abs(view.step_y));
    let limit = REACH_VX / max(max(aside.x, aside.y), aside.z);
    // In coordinates with the texture's origin.
    let ray = make_ray(view.origin + vec3<f32>(32.0), direction);
    let size = ((vec3<i32>(view.dims) + vec3<i32>(31)) & vec3<i32>(-32)) + vec3<i32>(64);
    let zero = vec3<i32>(0);
    let enter = crossings(ray, select(size, zero, ray.forward));
    let border = select(zero, size, ray.forward);
    let exit = smallest(crossings(ray, border));
    // No ray of the tile stays inside for longer: each advances at least this fast, if it points forward.
    let speed = abs(direction) - aside;
    let times = abs(vec3<f32>(border) - ray.origin) / speed;
    let last_exit = smallest(select(vec3<f32>(FAR_AWAY), times, speed > vec3<f32>(0.0)));
    // Each step advances by at least a thousandth of a voxel, so that the loop terminates.
    let least = 1e-3 / max(max(abs(direction.x), abs(direction.y)), abs(direction.z));
    var t = max(max(enter.x, enter.y), max(enter.z, 0.0));
    loop {
        if !(t < min(exit, limit)) {
            break;
        }
        let place = vec3<i32>(floor(ray.origin + ray.direction * t)) >> vec3<u32>(3u);
        let brick = clamp(place, zero, (size >> vec3<u32>(3u)) - vec3<i32>(1));
        let bricks = textureLoad(dilated, brick >> vec3<u32>(2u), 0).xy;
        if bit_of(bricks, brick) {
            break;
        }
        let edge = select(8, 32, all(bricks == vec2<u32>(0u)));
        let low = (brick << vec3<u32>(3u)) & vec3<i32>(-edge);
        let far = crossings(ray, select(low, low + vec3<i32>(edge), ray.forward));
        t = max(smallest(far) * 1.000002, t + least);
    }
    // If no brick was in reach along the whole way through the grid, the tile shows nothing.
    return select(min(t, limit), FAR_AWAY, t >= exit & last_exit <= limit);
}

fn smallest(v: vec3<f32>) -> f32 {
    return min(min(v.x, v.y), v.z);
}
