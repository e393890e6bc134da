// What rays of a final picture meet: the twin of core/src/trace/scene.rs. Points are in grid coordinates, directions
// and normals in the world.

//!include "layout.wgsl"
//!include "march.wgsl"
//!include "normal_field.wgsl"
//!include "colours.wgsl"
//!include "encoding.wgsl"
//!include "trace_kind.wgsl"

@group(0) @binding(5) var<uniform> scene: TraceScene;

const CLEARANCE_VX: f32 = 1.5;
const EDGE_VX: f32 = 0.01;
const LEAST_CLEARANCE_VX: f32 = 0.02;
const CLEARANCE_PER_SLOPE: f32 = 30.0;
const OTHER_SIDE: f32 = -0.2;
const OPEN_GROUND_RADII: f32 = 4.0;

const NOTHING: u32 = 0u;
const SCULPTURE: u32 = 1u;
const GROUND: u32 = 2u;
const OPEN_GROUND: u32 = 3u;

struct Met {
    what: u32,
    t: f32,
    start: vec3<f32>,
    normal: vec3<f32>,
    albedo: vec3<f32>,
}

fn rows_times(rows: array<vec4<f32>, 3>, v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v));
}

fn world_point(p: vec3<f32>) -> vec3<f32> {
    let rows = scene.world_from_grid;
    return rows_times(rows, p) + vec3<f32>(rows[0].w, rows[1].w, rows[2].w);
}

fn distance_radii(p: vec3<f32>) -> f32 {
    return length(rows_times(scene.world_from_grid, p - scene.middle)) / scene.radius;
}

fn exists(cell: vec3<i32>) -> bool {
    if any(vec3<u32>(cell) >= scene.dims) {
        return false;
    }
    return bit_of(word_at(cell), cell);
}

// The first voxel on a ray, unless it is beyond `reach`.
fn voxel_on(origin: vec3<f32>, along: vec3<f32>, reach: f32) -> Seen {
    let per_t = 1.0 / along;
    let a = (scene.low - origin) * per_t;
    let b = (scene.high - origin) * per_t;
    let first = max(max(min(a.x, b.x), min(a.y, b.y)), min(a.z, b.z));
    let last = min(min(max(a.x, b.x), max(a.y, b.y)), max(a.z, b.z));
    if first > min(last, reach) || last < 0.0 {
        return Seen(vec3<i32>(0), false);
    }
    return first_voxel(make_ray(origin, along), vec3<i32>(scene.dims), 0.0);
}

struct Entry {
    t: f32,
    face: vec3<i32>,
}

// Where a ray enters a voxel, by a face without a voxel before it.
fn entry(origin: vec3<f32>, along: vec3<f32>, voxel: vec3<i32>) -> Entry {
    let near = vec3<f32>(voxel) + select(vec3<f32>(0.0), vec3<f32>(1.0), along < vec3<f32>(0.0));
    let outwards = select(vec3<i32>(-1), vec3<i32>(1), along < vec3<f32>(0.0));
    var found = Entry(-3e38, outwards);
    for (var axis = 0; axis < 3; axis++) {
        if along[axis] == 0.0 {
            continue;
        }
        let t = (near[axis] - origin[axis]) / along[axis];
        var face = vec3<i32>(0);
        face[axis] = outwards[axis];
        if t > found.t && !exists(voxel + face) {
            found = Entry(t, face);
        }
    }
    return Entry(max(found.t, 0.0), found.face);
}

fn height_of(p: vec3<f32>) -> f32 {
    return dot(scene.ground_height, p) + scene.ground_offset;
}

fn on_ground(p: vec3<f32>, t: f32) -> Met {
    let start = p + rows_times(scene.grid_from_world, scene.up) * (1e-4 * scene.radius);
    return Met(GROUND, t, start, scene.up, scene.ground_albedo);
}

// Returns the distance from `origin` that is free of voxels, up to `reach`.
fn free_distance(origin: vec3<f32>, direction: vec3<f32>, reach: f32) -> f32 {
    var cell = floor(origin);
    let ahead = select(vec3<f32>(1.0), vec3<f32>(0.0), direction < vec3<f32>(0.0));
    let step = ahead * 2.0 - 1.0;
    let still = direction == vec3<f32>(0.0);
    let per_t = select(1.0 / direction, vec3<f32>(3e38), still);
    var next = select((cell + ahead - origin) * per_t, vec3<f32>(3e38), still);
    // A path of 1.5 voxels crosses fewer planes.
    for (var i = 0; i < 16; i++) {
        let x = next.x <= next.y && next.x <= next.z;
        let y = !x && next.y <= next.z;
        let t = min(next.x, min(next.y, next.z));
        if t >= reach {
            break;
        }
        let axis = select(vec3<f32>(0.0), vec3<f32>(1.0), vec3<bool>(x, y, !x && !y));
        cell += axis * step;
        next += select(vec3<f32>(0.0), abs(per_t), axis > vec3<f32>(0.0));
        if exists(vec3<i32>(cell)) {
            return t;
        }
    }
    return reach;
}

fn clear_of_steps(p: vec3<f32>, face: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let size = abs(normal);
    let slope = min(max(size.x, size.y), max(min(size.x, size.y), size.z));
    let clearance = min(CLEARANCE_VX, CLEARANCE_PER_SLOPE * slope);
    let near = p + face * LEAST_CLEARANCE_VX;
    if clearance <= LEAST_CLEARANCE_VX {
        return near;
    }
    let free = free_distance(near, normal, clearance);
    return near + normal * select(clearance, 0.5 * free, free < clearance);
}

fn on_voxel(voxel: vec3<i32>, at: Entry, origin: vec3<f32>, along: vec3<f32>) -> Met {
    let colour = colour_of(voxel, scene.base, scene.bricks);
    let face = vec3<f32>(at.face);
    let hit = origin + along * at.t;
    let low = vec3<f32>(voxel);
    let within = clamp(hit, low + EDGE_VX, low + (1.0 - EDGE_VX));
    let plane = vec3<f32>(voxel + max(at.face, vec3<i32>(0)));
    let p = select(plane, within, at.face == vec3<i32>(0));
    var normal = face;
    let packed = packed_normal(voxel, scene.bricks);
    if packed != NO_NORMAL {
        let smooth_normal = normalize(unpacked_normal(packed));
        if dot(smooth_normal, face) >= OTHER_SIDE {
            normal = smooth_normal;
        }
    }
    let start = clear_of_steps(p, face, normal);
    let world = normalize(rows_times(scene.world_from_normal, normal));
    return Met(SCULPTURE, at.t, start, world, decoded(colour, true));
}

const MISSED: Met = Met(NOTHING, 3e38, vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));

// What a ray from a surface meets; `direction` is in the world.
fn meet(origin: vec3<f32>, direction: vec3<f32>) -> Met {
    let along = rows_times(scene.grid_from_world, direction);
    let seen = voxel_on(origin, along, 3e38);
    if seen.found {
        return on_voxel(seen.voxel, entry(origin, along, seen.voxel), origin, along);
    }
    let climb = dot(direction, scene.up);
    if trace_ground == 0u || climb >= 0.0 {
        return MISSED;
    }
    let t = max(height_of(origin) / -climb, 0.0);
    let p = origin + along * t;
    if distance_radii(p) > OPEN_GROUND_RADII {
        return Met(OPEN_GROUND, t, vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0));
    }
    return on_ground(p, t);
}

// Whether something lies between `origin` and `origin + direction * reach`.
fn is_blocked(origin: vec3<f32>, direction: vec3<f32>, reach: f32) -> bool {
    let along = rows_times(scene.grid_from_world, direction);
    let seen = voxel_on(origin, along, reach);
    if seen.found && entry(origin, along, seen.voxel).t < reach {
        return true;
    }
    let climb = dot(direction, scene.up);
    return trace_ground != 0u && climb < 0.0 && max(height_of(origin) / -climb, 0.0) < reach;
}

// What the eye sees.
fn met_by_eye(origin: vec3<f32>, along: vec3<f32>) -> Met {
    let seen = voxel_on(origin, along, 3e38);
    if seen.found {
        return on_voxel(seen.voxel, entry(origin, along, seen.voxel), origin, along);
    }
    let climb = dot(scene.ground_height, along);
    let height = height_of(origin);
    if trace_ground == 0u || climb >= 0.0 || height <= 0.0 {
        return MISSED;
    }
    let t = height / -climb;
    return on_ground(origin + along * t, t);
}
