// The arithmetic of a ray on the grid: the twin of core/src/surface/raycast/ray.rs. The same operations in the
// same order, so that a GPU with correctly rounded division finds the same voxels. build.rs forbids that products and
// sums be fused in what includes this file.

const STANDSTILL: f32 = 1e-20;

struct Ray {
    origin: vec3<f32>,
    direction: vec3<f32>,
    inverse: vec3<f32>,
    forward: vec3<bool>,
}

// A crossing: its ray parameter, the axis of the plane, and which axes are lower than that one (all of them for
// the start, which comes after every crossing behind the ray). Masks instead of a number, and selects instead of
// branches, because they vectorise.
struct Event {
    t: f32,
    axis: vec3<bool>,
    lower: vec3<bool>,
}

fn make_ray(origin: vec3<f32>, direction: vec3<f32>) -> Ray {
    let still = abs(direction) < vec3<f32>(STANDSTILL);
    let moving = select(direction, vec3<f32>(STANDSTILL), still);
    return Ray(origin, moving, vec3<f32>(1.0) / moving, moving > vec3<f32>(0.0));
}

// The ray parameters at which the ray crosses the plane of each axis.
fn crossings(ray: Ray, planes: vec3<i32>) -> vec3<f32> {
    return (vec3<f32>(planes) - ray.origin) * ray.inverse;
}

// Which crossings come before the event.
fn before(t: vec3<f32>, event: Event) -> vec3<bool> {
    return (t < vec3<f32>(event.t)) | ((t == vec3<f32>(event.t)) & event.lower);
}

// The first of three crossings; if equal, that of the lowest axis.
fn first_of(t: vec3<f32>) -> Event {
    let x = (t.x <= t.y) & (t.x <= t.z);
    let y = !x & (t.y <= t.z);
    return Event(min(t.x, min(t.y, t.z)), vec3<bool>(x, y, !x & !y), vec3<bool>(!x, !x & !y, false));
}

// The last of the start and three crossings; if equal, that of the highest axis.
fn last_of(t: vec3<f32>) -> Event {
    let last = max(max(t.x, t.y), max(t.z, 0.0));
    let started = last == 0.0;
    let z = !started & (t.z == last);
    let y = !started & !z & (t.y == last);
    let x = !started & !z & !y;
    return Event(last, vec3<bool>(x, y, z), vec3<bool>(!x, started | z, started));
}

// The cell that contains the ray just after `event`, known to lie in the box `low..high`: an estimate from the
// position, then corrected by the crossings themselves.
fn cell_after(ray: Ray, event: Event, low: vec3<i32>, high: vec3<i32>) -> vec3<i32> {
    let first = select(high - vec3<i32>(1), low, ray.forward);
    let last = select(low, high - vec3<i32>(1), ray.forward);
    let one = select(vec3<i32>(-1), vec3<i32>(1), ray.forward);
    let ahead = select(vec3<i32>(0), vec3<i32>(1), ray.forward);
    let guess = vec3<i32>(floor(ray.origin + ray.direction * event.t));
    var cell = clamp(guess, low, high - vec3<i32>(1));
    let passed = before(crossings(ray, cell + ahead), event) & (cell != last);
    cell += select(vec3<i32>(0), one, passed);
    let reached = before(crossings(ray, cell + vec3<i32>(1) - ahead), event);
    cell -= select(vec3<i32>(0), one, !reached & (cell != first));
    return select(cell, first, event.axis);
}
