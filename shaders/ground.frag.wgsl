// The ground for a target that stores colours as given.

//!include "ground.wgsl"

fn stored(colour: vec3<f32>) -> vec3<f32> {
    return colour;
}
