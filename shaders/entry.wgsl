// When the ray of a pixel enters the voxel that the pixel shows.

//!include "ray.wgsl"

// The ray parameter at which a ray enters the voxel `low`; 0 or less if it starts inside. A ray that misses the voxel,
// which then stands for more than itself, meets it as far away as its middle: `across` times a position relative to
// the eye is its distance along the view.
fn entry_time(ray: Ray, low: vec3<i32>, across: vec3<f32>) -> f32 {
    let high = low + vec3<i32>(1);
    let enter = crossings(ray, select(high, low, ray.forward));
    let leave = crossings(ray, select(low, high, ray.forward));
    let t = max(max(enter.x, enter.y), enter.z);
    let missed = t > min(min(leave.x, leave.y), leave.z);
    return select(t, dot(across, vec3<f32>(low) + 0.5 - ray.origin), missed);
}

// What times a position relative to the eye is its distance along the view, in directions.
fn across_view(corner: vec3<f32>, step_x: vec3<f32>, step_y: vec3<f32>) -> vec3<f32> {
    let normal = cross(step_x, step_y);
    return normal / dot(normal, corner);
}
