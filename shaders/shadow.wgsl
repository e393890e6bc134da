// Whether the sun reaches a voxel: the twin of core/src/shade/shadow.rs.

//!include "march.wgsl"

// From the middle of a voxel to where its ray begins, along its normal.
const LIFT_VX: f32 = 1.5;

// A point of the unit disc; its middle for sample 0.
fn on_disc(voxel: vec3<i32>, sample: u32) -> vec2<f32> {
    let v = vec3<u32>(voxel);
    var hash = (v.x * 0x9e3779b1u) ^ (v.y * 0x85ebca77u) ^ (v.z * 0xc2b2ae3du);
    hash = (hash ^ (hash >> 15u)) * 0x2c1b3c6du;
    hash = (hash ^ (hash >> 12u)) * 0x297a2d39u;
    hash ^= hash >> 15u;
    let a = (hash + sample * 49472u) & 0xffffu;
    let b = ((hash >> 16u) + sample * 37345u) & 0xffffu;
    let square = vec2<f32>(f32(a), f32(b)) * (1.0 / 32768.0) - 1.0;
    let disc = square * sqrt(1.0 - 0.5 * square.yx * square.yx);
    return select(disc, vec2<f32>(0.0), sample == 0u);
}

// The part of the sun's light that reaches a voxel whose surface points `outwards`: 1 or 0.
fn sun_reaching(voxel: vec3<i32>, outwards: vec3<f32>, dims: vec3<i32>) -> f32 {
    let lift = unit_or(outwards, shading.sun_towards);
    var reaching = 1.0;
    // Where the surface is turned away, it gets none all the same.
    if dot(lift, shading.sun_towards) > 0.0 {
        let at = on_disc(voxel, shading.sun_sample);
        let direction = shading.sun_towards + shading.sun_right * at.x + shading.sun_up * at.y;
        let ray = make_ray(vec3<f32>(voxel) + 0.5 + lift * LIFT_VX, direction);
        reaching = select(1.0, 0.0, first_voxel(ray, dims, 0.0).found);
    }
    return reaching;
}
