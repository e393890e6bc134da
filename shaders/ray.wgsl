// The arithmetic of a ray on the grid: the twin of src/surface/raycast/ray.rs. The same numbers
// in the same order, so that a GPU whose division rounds correctly meets the same voxels.

const STANDSTILL: f32 = 1e-20;
// Comes after every crossing that is behind the ray.
const START_AXIS: u32 = 3u;

struct Ray {
    origin: vec3<f32>,
    direction: vec3<f32>,
    inverse: vec3<f32>,
    forward: vec3<bool>,
}

// When a ray came where it is, and by a plane of which axis.
struct Event {
    t: f32,
    axis: u32,
}

fn make_ray(origin: vec3<f32>, direction: vec3<f32>) -> Ray {
    let still = abs(direction) < vec3<f32>(STANDSTILL);
    let moving = select(direction, vec3<f32>(STANDSTILL), still);
    return Ray(origin, moving, vec3<f32>(1.0) / moving, moving > vec3<f32>(0.0));
}

// When the ray crosses the plane of each axis.
fn crossings(ray: Ray, planes: vec3<i32>) -> vec3<f32> {
    return (vec3<f32>(planes) - ray.origin) * ray.inverse;
}

// Which of the crossings come before the event.
fn before(t: vec3<f32>, event: Event) -> vec3<bool> {
    let lower = vec3<u32>(0u, 1u, 2u) < vec3<u32>(event.axis);
    return (t < vec3<f32>(event.t)) | ((t == vec3<f32>(event.t)) & lower);
}

// The first of three crossings.
fn first_of(t: vec3<f32>) -> Event {
    var event = Event(t.x, 0u);
    if t.y < event.t {
        event = Event(t.y, 1u);
    }
    if t.z < event.t {
        event = Event(t.z, 2u);
    }
    return event;
}

// The last of the start and three crossings.
fn last_of(t: vec3<f32>) -> Event {
    var event = Event(0.0, START_AXIS);
    if t.x > event.t {
        event = Event(t.x, 0u);
    }
    if t.y > event.t || (t.y == event.t && event.axis < 1u) {
        event = Event(t.y, 1u);
    }
    if t.z > event.t || (t.z == event.t && event.axis < 2u) {
        event = Event(t.z, 2u);
    }
    return event;
}

fn is_axis(axis: u32) -> vec3<bool> {
    return vec3<u32>(0u, 1u, 2u) == vec3<u32>(axis);
}

// The cell in which the ray is just after `event`, known to lie in the box `low..high`. Guessed
// from the position, then corrected by the crossings themselves.
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
    return select(cell, first, is_axis(event.axis));
}
