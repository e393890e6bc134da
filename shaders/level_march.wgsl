// Where a ray meets the smooth surface: the twin of core/src/shade/level_set/ray.rs. The volume is that of the cells, the
// cubes between the middles of eight voxels that have an existing one; cell `c` has the voxels `c - 1` to `c`.

//!include "march.wgsl"
//!include "level_field.wgsl"
//!include "normal_field.wgsl"

// Steps of the search for a root: far below a hundredth of a voxel.
const ROOT_STEPS: u32 = 6u;
// Weight of a corner beyond its share, so that a place in a corner of the cell has a normal, too.
const LEAST_SHARE: f32 = 1e-3;
// Beyond every place on the way through a cell.
const NO_ROOT: f32 = 2.0;

// The levels of the corners of a cell: corner `x + 2 y` of the lower and of the upper layer.
struct Corners {
    lower: vec4<f32>,
    upper: vec4<f32>,
}

struct OnSurface {
    // The existing voxel that is named for it.
    voxel: vec3<i32>,
    // Packed.
    normal: u32,
    found: bool,
}

fn corners_of(cell: vec3<i32>, dims: vec3<i32>, bricks: vec3<u32>) -> Corners {
    var layers = array<vec4<f32>, 2>();
    for (var z = 0; z < 2; z++) {
        let low = cell + vec3<i32>(-1, -1, z - 1);
        layers[z] = vec4<f32>(
            level_at(low, dims, bricks),
            level_at(low + vec3<i32>(1, 0, 0), dims, bricks),
            level_at(low + vec3<i32>(0, 1, 0), dims, bricks),
            level_at(low + vec3<i32>(1, 1, 0), dims, bricks),
        );
    }
    return Corners(layers[0], layers[1]);
}

fn trilinear(corners: Corners, place: vec3<f32>) -> f32 {
    let lower = corners.lower.xz + (corners.lower.yw - corners.lower.xz) * place.x;
    let upper = corners.upper.xz + (corners.upper.yw - corners.upper.xz) * place.x;
    let a = lower.x + (lower.y - lower.x) * place.y;
    let b = upper.x + (upper.y - upper.x) * place.y;
    return a + (b - a) * place.z;
}

// The polynomial `((p.w s + p.z) s + p.y) s + p.x`.
fn value(p: vec4<f32>, s: f32) -> f32 {
    return ((p.w * s + p.z) * s + p.y) * s + p.x;
}

// The roots of the polynomial's derivative, rising; any value outside of 0 to 1 where there are none.
fn extrema(p: vec4<f32>) -> vec2<f32> {
    let a = 3.0 * p.w;
    let b = 2.0 * p.z;
    let discriminant = b * b - 4.0 * a * p.y;
    // Without cancellation (Press et al., "Numerical Recipes", 5.6).
    let root = sqrt(max(discriminant, 0.0));
    let q = -0.5 * (b + select(root, -root, b < 0.0));
    let first = select(NO_ROOT, q / a, a != 0.0 && discriminant >= 0.0);
    let second = select(NO_ROOT, p.y / q, q != 0.0 && discriminant >= 0.0);
    return vec2<f32>(min(first, second), max(first, second));
}

// The root between two places with values of different signs: regula falsi with Illinois steps.
fn root_between(p: vec4<f32>, places: vec2<f32>, values: vec2<f32>) -> f32 {
    var low = vec2<f32>(places.x, values.x);
    var high = vec2<f32>(places.y, values.y);
    var middle = places.y;
    var side = 0;
    for (var i = 0u; i < ROOT_STEPS; i++) {
        middle = low.x + (high.x - low.x) * (low.y / (low.y - high.y));
        let at_middle = value(p, middle);
        if at_middle > 0.0 {
            low = vec2<f32>(middle, at_middle);
            high.y *= select(1.0, 0.5, side == 1);
            side = 1;
        } else {
            high = vec2<f32>(middle, at_middle);
            low.y *= select(1.0, 0.5, side == -1);
            side = -1;
        }
    }
    return middle;
}

// Where on the way from `begin` to `end` in a cell, as a share of it, the field is 0 or less for the first time.
fn first_root(corners: Corners, begin: vec3<f32>, end: vec3<f32>) -> f32 {
    let f0 = trilinear(corners, begin);
    if f0 <= 0.0 {
        return 0.0;
    }
    let f1 = trilinear(corners, begin + (end - begin) * (1.0 / 3.0));
    let f2 = trilinear(corners, begin + (end - begin) * (2.0 / 3.0));
    let f3 = trilinear(corners, end);
    // The polynomial through the four values.
    let p = vec4<f32>(
        f0,
        -5.5 * f0 + 9.0 * f1 - 4.5 * f2 + f3,
        9.0 * f0 - 22.5 * f1 + 18.0 * f2 - 4.5 * f3,
        4.5 * (f3 - f0) + 13.5 * (f1 - f2),
    );
    let turns = extrema(p);
    var low = vec2<f32>(0.0, f0);
    for (var i = 0u; i < 3u; i++) {
        let at = select(select(1.0, turns.y, i == 1u), turns.x, i == 0u);
        if at > low.x && at <= 1.0 {
            let high = vec2<f32>(at, value(p, at));
            if high.y <= 0.0 {
                return root_between(p, vec2<f32>(low.x, high.x), vec2<f32>(low.y, high.y));
            }
            low = high;
        }
    }
    return NO_ROOT;
}

// The number from 0 to 1 by which a sample of a pixel names voxels: the twin of core/src/shade/level_set/sample.rs.
fn naming(sample: u32, pixel: vec2<u32>) -> f32 {
    var hash = pixel.x ^ (pixel.y << 16u) ^ (pixel.y >> 16u);
    hash = (hash ^ (hash >> 16u)) * 0x85ebca6bu;
    hash = (hash ^ (hash >> 13u)) * 0xc2b2ae35u;
    let number = (hash ^ (hash >> 16u)) + sample * 0x9e3779b9u;
    return f32(number >> 8u) * (1.0 / 16777216.0);
}

fn corner(i: u32) -> vec3<u32> {
    return (vec3<u32>(i) >> vec3<u32>(0u, 1u, 2u)) & vec3<u32>(1u);
}

// The voxel and the normal at a place of a cell. `number` names one of the corners, the nearer, the more often; below
// 0 it is the nearest.
fn shown(
    cell: vec3<i32>,
    corners: Corners,
    place: vec3<f32>,
    bricks: vec3<u32>,
    number: f32,
) -> OnSurface {
    var normal = vec3<f32>(0.0);
    // An existing corner without a normal will do where there is no other.
    var named = cell;
    var most = -1.0;
    // Of the corners with normals.
    var shares_of = array<f32, 8>();
    var sum = 0.0;
    for (var i = 0u; i < 8u; i++) {
        let offset = corner(i);
        let level = select(corners.lower, corners.upper, vec4<bool>(i >= 4u))[i & 3u];
        if level < 0.0 {
            let voxel = cell - vec3<i32>(1) + vec3<i32>(offset);
            let shares = select(1.0 - place, place, offset == vec3<u32>(1u));
            let share = shares.x * shares.y * shares.z + LEAST_SHARE;
            var known = 0.0;
            let code = packed_normal(voxel, bricks);
            if code != NO_NORMAL {
                normal += normalize(unpacked_normal(code)) * share;
                known = 1.0;
                shares_of[i] = share;
                sum += share;
            }
            if share + known > most {
                named = voxel;
                most = share + known;
            }
        }
    }
    var rest = number * sum;
    for (var i = 0u; i < 8u; i++) {
        if shares_of[i] > 0.0 && rest >= 0.0 {
            named = cell - vec3<i32>(1) + vec3<i32>(corner(i));
            rest -= shares_of[i];
        }
    }
    return OnSurface(named, code_of_normal(normal), true);
}

// The first place on the smooth surface along a ray in coordinates of cells, none before `start`. `cells`: size of the
// grid of cells; `number`: see `shown`.
fn surface_along(ray: Ray, cells: vec3<i32>, start: f32, number: f32) -> OnSurface {
    let dims = cells - vec3<i32>(1);
    let bricks = (vec3<u32>(dims) + 7u) >> vec3<u32>(3u);
    var found = OnSurface(vec3<i32>(0), NO_NORMAL, false);
    var seen = entered(ray, cells, start);
    loop {
        if !seen.found {
            break;
        }
        seen = first_within(ray, seen.voxel, vec3<i32>(0), cells, NO_SMALL_BRICKS);
        if !seen.found {
            break;
        }
        let low = vec3<f32>(seen.voxel);
        let a = (low - ray.origin) * ray.inverse;
        let b = (low + 1.0 - ray.origin) * ray.inverse;
        let enters = min(a, b);
        let leaves = max(a, b);
        let near = max(max(enters.x, enters.y), max(enters.z, 0.0));
        let far = max(min(min(leaves.x, leaves.y), leaves.z), near);
        let one = vec3<f32>(1.0);
        let begin = clamp(ray.origin + ray.direction * near - low, vec3<f32>(0.0), one);
        let end = clamp(ray.origin + ray.direction * far - low, vec3<f32>(0.0), one);
        let corners = corners_of(seen.voxel, dims, bricks);
        let share = first_root(corners, begin, end);
        if share <= 1.0 {
            found = shown(seen.voxel, corners, begin + (end - begin) * share, bricks, number);
            break;
        }
        seen.voxel = next_cell(ray, seen.voxel, word_at(seen.voxel));
        seen.found = all(vec3<u32>(seen.voxel) < vec3<u32>(cells));
    }
    return found;
}
