// The composite for a target that keeps the colours it is given.

//!include "composite.wgsl"

fn stored(colour: vec3<f32>) -> vec3<f32> {
    return colour;
}
